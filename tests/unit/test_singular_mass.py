"""Models whose mass matrix cannot be inverted, or hardly: refused by name, or warned of."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

from ulna import kernels
from ulna.algorithms import aba, by_mass_matrix, integrate, mass_matrix
from ulna.algorithms.dynamics.conditioning import conditioning
from ulna.algorithms.dynamics.pivots import _pivots, conditioning_by_pivots
from ulna.errors import ModelError, ModelWarning
from ulna.model import ModelBuilder, Prismatic, Revolute, Spherical, Universal
from ulna.quantities.mass import check_mass
from ulna.robot import Robot
from ulna.spatial import SE3, Inertia

Z, Y, X = (0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (1.0, 0.0, 0.0)
BODY = Inertia.from_box(2.0, (0.3, 0.2, 0.1))
OUT = SE3.trans(0.3, 0.0, 0.0)


def chain(*links, name="arm"):
    """A chain of (kind, inertia, placement, armature)."""
    builder = ModelBuilder(name).add_link("l0")
    for k, (kind, inertia, placement, armature) in enumerate(links, 1):
        builder.add_link(f"l{k}", inertia)
        builder.add_joint(f"j{k}", kind, f"l{k - 1}", f"l{k}", placement, armature=armature)
    return Robot(builder.build())


def point_on_axis(mass=1.0, armature=0.0):
    """The second link has a mass on its axis and no rotational inertia."""
    return chain(
        (Revolute(Z), BODY, SE3.identity(), 0.0),
        (Revolute(Y), Inertia.from_point(mass, (0.0, 0.1, 0.0)), OUT, armature),
    )


SINGULAR = {
    "a point mass on the axis": (point_on_axis(), ["j2"]),
    "two joints on one axis": (
        chain((Revolute(Z), Inertia.zero(), OUT, 0.0), (Revolute(Z), BODY, SE3.identity(), 0.0)),
        ["j1", "j2"],
    ),
    "a whole chain about parallel axes": (
        chain(
            (Revolute(Z), Inertia.from_point(1.0), SE3.identity(), 0.0),
            (Revolute(Z), Inertia.from_point(1.0), OUT, 0.0),
            (Revolute(Z), Inertia.from_point(1.0), OUT, 0.0),
        ),
        ["j3"],
    ),
    "a point mass at the centre of a ball": (
        chain((Revolute(Z), BODY, SE3.identity(), 0.0), (Spherical(), Inertia.from_point(1.0), OUT, 0.0)),
        ["j2"],
    ),
    "four joints for a point": (
        chain(
            (Prismatic(X), Inertia.zero(), SE3.identity(), 0.0),
            (Prismatic(Y), Inertia.zero(), SE3.identity(), 0.0),
            (Prismatic(Z), Inertia.zero(), SE3.identity(), 0.0),
            (Prismatic(X), Inertia.from_point(1.0), SE3.identity(), 0.0),
        ),
        ["j1", "j4"],
    ),
    "a cross joint": (
        chain(
            (Revolute(Z), BODY, SE3.identity(), 0.0),
            (Universal(X, Y), Inertia.from_point(1.0, (0.0, 0.2, 0.0)), OUT, 0.0),
        ),
        ["j2"],
    ),
    "an axis that is no coordinate axis": (
        chain(
            (Revolute(Z), BODY, SE3.identity(), 0.0),
            (Revolute((1.0, 2.0, 3.0)), Inertia.from_point(1.0, (0.1, 0.2, 0.3)), OUT @ SE3.rx(0.3), 0.0),
        ),
        ["j2"],
    ),
}
CALLS = {
    "forward_dynamics": lambda r, x: r.forward_dynamics(r.neutral, x, x),
    "inverse_mass_matrix": lambda r, x: r.inverse_mass_matrix(r.neutral),
    "forward_dynamics_derivatives": lambda r, x: r.forward_dynamics_derivatives(r.neutral, x, x),
    "operational_inertia": lambda r, x: r.operational_inertia(r.neutral),
    "float32": lambda r, x: r.kernel("forward_dynamics", dtype=np.float32),
    "impulse_dynamics": lambda r, x: r.kernel("impulse_dynamics"),
    "constrained_dynamics": lambda r, x: r.kernel("constrained_dynamics"),
}


@pytest.mark.parametrize("case", SINGULAR)
@pytest.mark.parametrize("call", CALLS)
def test_a_motion_without_inertia_is_refused_by_name(case: str, call: str) -> None:
    robot, names = SINGULAR[case]
    with pytest.raises(ModelError, match="without bound") as refused:
        CALLS[call](robot, np.zeros(robot.nv))
    text = str(refused.value)
    assert [name for name in robot.joint_names if repr(name) in text] == names
    assert "armature" in text and "robot.lock" in text


def test_what_does_not_divide_by_inertia_goes_on() -> None:
    robot = point_on_axis()
    q = np.array([0.3, 0.4])
    M = robot.mass_matrix(q)
    assert M[1, 1] == pytest.approx(0.0, abs=1e-15)
    assert np.allclose(robot.inverse_dynamics(q, q, q), M @ q + robot.bias_forces(q, q))


def test_armature_or_an_inertia_makes_it_regular() -> None:
    robot = point_on_axis(armature=0.1)
    q = np.array([0.3, 0.4])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        a = robot.forward_dynamics(q, q, np.ones(2))
    assert np.allclose(robot.inverse_dynamics(q, q, a), np.ones(2), atol=1e-12)


@pytest.mark.parametrize("parameters", [("placement",), ("base",), ("gravity",), ("damping",)])
def test_a_kernel_with_parameters_is_refused_where_they_cannot_help(parameters: tuple[str, ...]) -> None:
    with pytest.raises(ModelError, match="'j2'"):
        kernels.kernel(point_on_axis().model, "forward_dynamics", parameters=parameters)


def test_a_kernel_with_inertias_as_inputs_takes_them_when_called() -> None:
    robot, better = point_on_axis(), point_on_axis(armature=0.2)
    q = np.array([0.3, 0.4])
    given = kernels.kernel(robot.model, "forward_dynamics", parameters="armature")
    assert np.allclose(given(q, q, q, [0.0, 0.2]), better.forward_dynamics(q, q, q), atol=1e-12)
    assert not np.isfinite(given(q, q, q, [0.0, 0.0])).all()


@pytest.mark.parametrize("algorithm", [aba, by_mass_matrix])
def test_the_algorithms_name_the_entry_of_v(algorithm: object) -> None:
    model, x = point_on_axis().model, np.zeros(2)
    with pytest.raises(ModelError, match="Entry 1 of v"):
        algorithm(model, x, x, x)  # pyright: ignore[reportCallIssue]


def coaxial(ratio: float, name: str) -> Robot:
    """A heavy body on a light one, both about one axis: condition number about 4 / ratio."""
    light = Inertia.from_box(2.0 * ratio, (0.3, 0.2, 0.1))
    return chain((Revolute(Z), light, OUT, 0.0), (Revolute(Z), BODY, SE3.identity(), 0.0), name=name)


def test_a_mass_matrix_close_to_singular_is_warned_of_once() -> None:
    robot = coaxial(1e-16, "warned")
    q = np.array([0.3, 0.4])
    with pytest.warns(ModelWarning, match=r"condition number 4\.\de\+16: 'j1', 'j2' .* none of their digits"):
        robot.inverse_mass_matrix(q)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        robot.forward_dynamics(q, q, q)


def test_float32_is_warned_of_where_float64_is_not() -> None:
    robot = coaxial(1e-7, "single")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        robot.kernel("inverse_mass_matrix")
    with pytest.warns(ModelWarning, match="in float32.*compute in float64"):
        robot.kernel("inverse_mass_matrix", dtype=np.float32)


def test_a_configuration_that_is_singular_is_named() -> None:
    through = chain(
        (Revolute(Z), Inertia.zero(), SE3.identity(), 0.0),
        (Prismatic(X), Inertia.from_point(1.0), SE3.identity(), 0.0),
        name="through the axis",
    )
    with pytest.warns(ModelWarning, match="is singular at the neutral configuration: 'j1'"):
        through.kernel("forward_dynamics")
    a = through.forward_dynamics([0.0, 0.5], [0.0, 0.0], [1.0, 0.0])
    assert np.allclose(a, [4.0, 0.0])


def test_scales_alone_are_no_reason_to_warn() -> None:
    """A grain on a ship: the factors keep their digits, whatever the units."""
    huge = Inertia.from_box(1e9, (30.0, 20.0, 10.0))
    grain = Inertia.from_box(1e-12, (1e-3, 1e-3, 1e-3))
    robot = chain((Revolute(Z), huge, OUT, 0.0), (Revolute(Y), grain, OUT, 0.0), name="grain")
    q = np.array([0.3, 0.4])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        inverse = robot.inverse_mass_matrix(q)
    assert np.allclose(inverse @ robot.mass_matrix(q), np.eye(2), atol=1e-9)


def test_the_condition_number_is_that_of_the_scaled_mass_matrix() -> None:
    robot = coaxial(1e-3, "number")
    q = np.array([0.3, 0.4])
    M = mass_matrix(robot.model, q)
    d = np.sqrt(np.diag(M))
    assert conditioning(robot.model, q).kappa == pytest.approx(np.linalg.cond(M / np.outer(d, d)), rel=1e-9)


def test_a_rotor_without_mass_has_inertia() -> None:
    rotor = Inertia(0.0, np.zeros(3), 0.5 * np.eye(3))
    robot = chain((Revolute(Z), rotor, OUT, 0.0), name="rotor")
    assert np.allclose(robot.forward_dynamics([0.3], [0.0], [1.0]), [2.0])


def test_mimic_joints_count_as_part_of_their_source() -> None:
    """Two slides that undo each other: neither moves what lies beyond both."""
    builder = ModelBuilder("undone").add_link("l0").add_link("l1").add_link("l2", BODY)
    builder.add_joint("j1", Prismatic(X), "l0", "l1")
    builder.add_joint("j2", Prismatic(X), "l1", "l2", mimic=("j1", -1.0, 0.0))
    with pytest.raises(ModelError, match="'j1'"):
        Robot(builder.build()).kernel("forward_dynamics")


@pytest.mark.parametrize("case", SINGULAR)
def test_pivots_find_a_joint_of_each(case: str) -> None:
    robot, names = SINGULAR[case]
    model = robot.model
    q = np.asarray(integrate(model, model.neutral, np.random.default_rng(0).uniform(-1.0, 1.0, model.nv)))
    found = conditioning_by_pivots(model, q)
    owners = [j.name for j in model.joints for k in found.loose if j.idx_v <= k < j.idx_v + j.nv]
    assert len(owners) == 1 and owners[0] in names


def test_pivots_are_those_of_the_mass_matrix() -> None:
    robot = chain(
        *((Revolute(Z), BODY, OUT @ SE3.rx(0.3), 0.1), (Prismatic(Y), BODY, OUT, 0.0)),
        *((Universal(X, Y), BODY, OUT, 0.0), (Revolute(Z), BODY, OUT @ SE3.ry(0.4), 0.02)),
    )
    q = np.array([0.3, -0.2, 0.5, 0.7, -0.4])
    factor = np.linalg.cholesky(
        robot.mass_matrix(q)[::-1, ::-1]
    )  # eliminates from the tip, as the recursion does
    assert np.allclose(_pivots(robot.model, q)[0], np.diag(factor)[::-1] ** 2, rtol=1e-12)


def long_chain(tip: Inertia, count: int = 400) -> Robot:
    """A robot of so many joints that it is computed by loops."""
    places = [(Revolute(Z), BODY, OUT @ SE3.rx(0.3), 0.0)] * (count - 1)
    return chain(*places, (Revolute(Z), tip, OUT @ SE3.rx(0.3), 0.0), name="long")


@pytest.mark.parametrize("call", ["forward_dynamics", "inverse_mass_matrix"])
def test_a_large_robot_is_refused_by_name_too(call: str) -> None:
    robot = long_chain(Inertia.from_point(1.0, (0.0, 0.0, 0.1)))
    with pytest.raises(ModelError, match="accelerate 'j400' of 'long' without bound: what it moves has mass"):
        CALLS[call](robot, np.zeros(robot.nv))


def test_a_large_robot_that_is_close_to_it_is_warned_of() -> None:
    small = Inertia.from_com(1.0, (0.0, 0.0, 0.1), 1e-15 * np.diag([1.0, 1.0, 1.0]))
    with pytest.warns(ModelWarning, match="'j400' can move almost without inertia"):
        check_mass(long_chain(small).model)
