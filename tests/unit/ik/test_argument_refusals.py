"""What inverse kinematics refuses about its arguments, and forms of arguments that mean the same."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import ulna
from ulna.errors import InputError, UnknownName

TOOL, OTHER = "panda_hand_tcp", "panda_link5"


@pytest.fixture(scope="module")
def panda() -> ulna.Robot:
    return ulna.load("panda", visuals="simple")


REFUSED: list[tuple[Callable[[ulna.Robot, Any], Any], type[Exception], str]] = [
    (lambda r, T: r.ik({TOOL: T}, frame=TOOL), InputError, "`frame` must be None"),
    (lambda r, T: r.ik({}), InputError, "empty dictionary"),
    (lambda r, T: r.ik(T, frame=[]), InputError, "`frame` is empty"),
    (lambda r, T: r.ik({TOOL: T}, mask={"nothing": "pose"}), UnknownName, "frame of `mask`.*'nothing'"),
    (lambda r, T: r.ik({TOOL: T, OTHER: T}, mask=["pose"]), InputError, "1 entries for 2 frames"),
    (lambda r, T: r.ik(np.stack([T, T]), frame=[TOOL, TOOL]), InputError, "one goal only"),
    (lambda r, T: r.ik(T, joints=["nothing"]), UnknownName, "nothing"),
    (lambda r, T: r.ik_all(T, samples=0), InputError, "expected a count from 1"),
]


def test_samples_of_an_arm_that_takes_none_are_refused() -> None:
    ur5 = ulna.load("ur5")
    T = ur5.fk(ur5.configurations["ready"])
    for samples in (32, [0.0, 1.0]):
        with pytest.raises(InputError, match="no joint of this arm is given values"):
            ur5.ik_all(T, samples=samples)
    assert ur5.ik_all(T).q.shape[-1] == 6


@pytest.mark.parametrize(("call", "error", "text"), REFUSED, ids=[text for *_, text in REFUSED])
def test_it_is_refused(panda: ulna.Robot, call: Any, error: type[Exception], text: str) -> None:
    with pytest.raises(error, match=text):
        call(panda, panda.fk(panda.configurations["qr"]))


def test_forms_of_a_goal_mean_the_same(panda: ulna.Robot) -> None:
    q0 = np.array(panda.configurations["qr"])
    T = panda.fk(q0 + 0.1)
    expected = panda.ik(T, q0=q0).q
    for same in (
        panda.ik(T, q0=q0, frame=[TOOL]),
        panda.ik(T[None], q0=q0, frame=[TOOL]),
        panda.ik({TOOL: T}, q0=q0),
        panda.ik(T, q0=q0, mask="pose"),
        panda.ik({TOOL: T}, q0=q0, mask={TOOL: "pose"}),
        panda.ik(T, q0=q0, mask=[1, 1, 1, 1, 1, 1]),
        panda.ik({TOOL: T}, q0=q0, mask=["pose"]),
    ):
        np.testing.assert_allclose(np.ravel(same.q), expected, atol=1e-9)


def test_a_single_solution_has_no_length_and_no_entries(panda: ulna.Robot) -> None:
    single = panda.ik(panda.fk(panda.configurations["qr"]))
    with pytest.raises(TypeError, match="no length"):
        len(single)
    with pytest.raises(TypeError, match="cannot be indexed"):
        single[0]


def test_solutions_of_an_arm_are_listed_and_explained() -> None:
    arm = ulna.load("ur5", visuals="simple")
    q = np.array([0.3, -0.9, 1.1, -0.4, 0.7, 0.2])
    T = arm.fk(q)
    found = arm.ik_all(T)
    assert found.count == len(found) == len(list(found)) and found.reason == ""
    assert found.found == found.total >= found.count
    np.testing.assert_array_equal(found[0], found.q[0])
    far = T.copy()
    far[:3, 3] = (9.0, 0.0, 0.0)
    batch = arm.ik_all(np.stack([T, far]))
    assert len(batch) == 2 and batch.count.tolist() == [found.count, 0]
    reasons = batch.reason
    assert reasons[0] == "" and reasons[1].startswith("no configuration reaches the pose")
    np.testing.assert_allclose(batch[0].q, found.q, atol=1e-9)
    assert len(batch[1]) == 0
