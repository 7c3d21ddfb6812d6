"""A masked entry is no number: arrays with any are refused wherever numbers are taken, and say how to go on."""

from __future__ import annotations

import numpy as np
import pytest

import ulna
from ulna import SE3, trajectory
from ulna.errors import InputError


@pytest.fixture(scope="module")
def robot() -> ulna.Robot:
    return ulna.load("ur5", visuals="simple")


Q = np.ma.array(np.zeros((3, 6)), mask=[[1, 0, 0, 0, 0, 0], [0] * 6, [0] * 6])
ZERO = np.zeros(6)
POSE = np.ma.array(np.eye(4), mask=np.eye(4, dtype=bool))


@pytest.mark.parametrize(
    ("name", "call"),
    [
        ("q", lambda r: r.fk(Q)),
        ("q", lambda r: r.fk(Q[0])),
        ("q", lambda r: r.fk([Q[0], Q[1]])),
        ("q", lambda r: r.jacobian(Q)),
        ("q", lambda r: r.kernel("fk")(Q[0])),
        ("v", lambda r: r.inverse_dynamics(ZERO, Q[0], ZERO)),
        ("forces", lambda r: r.inverse_dynamics(ZERO, ZERO, ZERO, forces={"tool0": Q[0]})),
        ("T", lambda r: r.ik(POSE)),
        ("T", lambda r: r.ik_all(POSE)),
        ("q0", lambda r: r.ik(r.fk(ZERO), Q[0])),
        ("q0", lambda r: r.difference(Q, Q)),
        ("q0", lambda r: trajectory.quintic(Q[0], ZERO, 1.0)),
        ("q1", lambda r: trajectory.quintic_states(ZERO, Q[0], 1.0, [0.0, 1.0])),
        ("values", lambda r: r.kernel("mass_matrix").pattern().unpack(np.ma.array(np.ones(21), mask=True))),
        ("matrix", lambda r: SE3.from_matrix(POSE)),
        ("configuration", lambda r: r.with_configuration("a", Q[0])),
        ("x", lambda r: ulna.compile(lambda x: 2.0 * x, x=(6,))(Q)),
    ],
)
def test_masked_entries_are_refused(robot: ulna.Robot, name: str, call) -> None:
    with pytest.raises(InputError, match=rf"`{name}.*masked array with \d+ masked entr.*\.filled\(number\)"):
        call(robot)


def test_a_mask_that_hides_nothing_passes(robot: ulna.Robot) -> None:
    q = np.full((2, 6), 0.3)
    assert np.array_equal(np.asarray(robot.fk(np.ma.array(q))), robot.fk(q))
    chosen = Q[~np.ma.getmaskarray(Q).any(axis=-1)].data  # as the message says
    assert robot.fk(chosen).shape == (2, 4, 4)
    assert robot.fk(Q.filled(0.5)).shape == (3, 4, 4)
