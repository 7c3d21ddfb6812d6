"""Moving at given velocities, up to the limits."""

import numpy as np
import pytest

import ulna
from ulna.errors import InputError, NonFiniteError, ShapeError, UnknownName
from ulna.model import FreeFlyer, ModelBuilder, Revolute
from ulna.sim import Recording, kinematic_step


@pytest.fixture(scope="module")
def panda() -> ulna.Robot:
    return ulna.load("panda", visuals="simple")


def test_a_free_step_is_the_velocity_times_the_time(panda: ulna.Robot) -> None:
    q = np.array(panda.configurations["qr"])
    v = np.linspace(-1, 1, 7)
    np.testing.assert_allclose(kinematic_step(panda, q, v, 0.01), q + 0.01 * v, rtol=0, atol=1e-15)


def test_the_example_of_constant_velocities(panda: ulna.Robot) -> None:
    q = np.array(panda.configurations["qr"])
    for _ in range(100):
        q = kinematic_step(panda, q, [0.1, 0, 0, 0, 0, 0, 0.1], 0.05)
    np.testing.assert_allclose(q, [0.5, -0.3, 0, -2.2, 0, 2, np.pi / 4 + 0.5], atol=1e-12)


def test_limits_hold_joint_by_joint(panda: ulna.Robot) -> None:
    q = kinematic_step(panda, panda.configurations["qr"], [100, -100, 0, 0, 0, 0, 0.1], 1.0)
    assert q[0] == panda.limits.upper[0]
    assert q[1] == panda.limits.lower[1]
    assert q[6] == pytest.approx(np.pi / 4 + 0.1)


def test_a_floating_base_turns_on_its_group() -> None:
    builder = ModelBuilder("float").add_link("base").add_link("arm")
    builder.add_joint("j", Revolute((0, 0, 1)), "base", "arm", lower=-1.0, upper=1.0)
    builder.root_joint(FreeFlyer())
    robot = ulna.Robot(builder.build())
    v = np.zeros(robot.nv)
    v[3:6] = (0.0, 0.0, np.pi / 2)
    q = kinematic_step(robot, robot.neutral, v, 1.0)
    np.testing.assert_allclose(q[:7], [0, 0, 0, 0, 0, np.sqrt(0.5), np.sqrt(0.5)], atol=1e-12)


def test_mistakes_are_named(panda: ulna.Robot) -> None:
    q = panda.configurations["qr"]
    with pytest.raises(ShapeError, match="`v`"):
        kinematic_step(panda, q, np.zeros(6), 0.1)
    with pytest.raises(NonFiniteError, match="`q"):
        kinematic_step(panda, np.full(7, np.nan), np.zeros(7), 0.1)
    with pytest.raises(NonFiniteError, match=r"`v\[2\]"):
        kinematic_step(panda, q, [0, 0, np.inf, 0, 0, 0, 0], 0.1)
    with pytest.raises(InputError, match="dt"):
        kinematic_step(panda, q, np.zeros(7), np.inf)


def test_a_recording_keeps_copies_in_columns() -> None:
    recording, q = Recording(), np.zeros(2)
    for k in range(3):
        q += 1
        recording.add(0.1 * k, q, error=k)
    assert len(recording) == 3
    np.testing.assert_allclose(recording["t"], [0, 0.1, 0.2])
    np.testing.assert_array_equal(recording["q"], [[1, 1], [2, 2], [3, 3]])
    np.testing.assert_array_equal(recording["error"], [0, 1, 2])
    with pytest.raises(UnknownName, match="'error'"):
        recording["eror"]
    with pytest.raises(ShapeError, match="`q`"):
        recording.add(1.0, np.zeros(3))


def test_a_recording_grows_and_a_missing_note_is_nan() -> None:
    recording = Recording()
    assert recording.t.shape == (0,)
    assert recording.duration == 0.0
    for k in range(200):
        recording.add(0.5 * k, [k], **({"late": 1.0} if k > 150 else {}))
    np.testing.assert_array_equal(recording.q[:, 0], np.arange(200))
    assert recording.duration == 99.5
    assert np.isnan(recording["late"][:151]).all()
    assert (recording["late"][151:] == 1.0).all()
    with pytest.raises(ValueError, match="read-only"):
        recording.q[0] = 1.0


def test_a_recording_has_where_the_robot_was(panda: ulna.Robot) -> None:
    recording = Recording()
    with pytest.raises(InputError, match="Nothing was recorded"):
        recording.at(0.0)
    q = panda.configurations["qr"]
    for k in range(3):
        recording.add(k, q + k)
    np.testing.assert_array_equal(recording.at(-1.0, panda), q)
    np.testing.assert_array_equal(recording.at(9.0, panda), q + 2)
    np.testing.assert_array_equal(recording.at(1.5), q + 1)
    np.testing.assert_allclose(recording.at(1.5, panda), q + 1.5)
