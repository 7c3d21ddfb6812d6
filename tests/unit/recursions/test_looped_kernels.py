"""Kernels that loop over a table of joints: the numbers of the traced ones, and what they can do and refuse."""

from __future__ import annotations

import pickle
import warnings
from typing import Any

import numpy as np
import pytest

import ulna
from support.long_robots import circles, configurations, long_robot
from support.random_models import random_model
from ulna import algorithms, kernels
from ulna.algorithms import Friction
from ulna.compiler import compile
from ulna.errors import InputError, NonFiniteError, ShapeError
from ulna.model import Model, ModelBuilder, Prismatic, Revolute
from ulna.recursions import composition, derivative_matrices, in_stages, quantities, regressors, whole_body
from ulna.recursions.recursion import specialized
from ulna.spatial import SE3, Inertia

REFERENCES = ("world", "local", "local_world_aligned")
FRAMES = [{"frame": frame, "reference": reference} for frame in ("tip", "side") for reference in REFERENCES]
LOADS = [{"forces": ("tip", "side", "tip"), "reference": reference} for reference in REFERENCES]
FRICTIONS: list[Any] = [True, Friction(0.3, 0.2, backward=0.1, static=0.4, stribeck=0.5, width=0.3)]
CASES: list[tuple[str, dict[str, Any]]] = [
    *(("fk", {"frame": frame}) for frame in (None, "side", "all", ("tip", "side"))),
    ("link_poses", {}),
    *(("jacobian", options) for options in FRAMES),
    *((name, options) for name in ("jacobian_dot", "hessian", "frame_velocity") for options in FRAMES),
    *(
        (f"frame_{name}_derivatives", {"frame": frame})
        for name in ("velocity", "acceleration")
        for frame in ("tip", "side")
    ),
    *(("frame_acceleration", {**options, "classical": k}) for k in (False, True) for options in FRAMES),
    *(
        (name, options)
        for name in ("inverse_dynamics", "forward_dynamics")
        for options in ({}, *LOADS, *({"friction": law} for law in FRICTIONS), {**LOADS[0], "friction": True})
    ),
    *((name, options) for name in ("bias_forces", "static_torque") for options in ({}, *LOADS)),
    ("gravity_forces", {}),
    ("mass_matrix", {}),
    ("inverse_mass_matrix", {}),
    *(
        (f"{name}_dynamics_derivatives", {"forces": forces})
        for name in ("forward", "inverse")
        for forces in ((), ("tip", "side", "tip"))
    ),
    *(
        (name, {})
        for name in sorted(
            {**whole_body.RECURSIONS, **derivative_matrices.RECURSIONS, **regressors.RECURSIONS}
        )
    ),
]
NAMES = sorted({name for name, _ in CASES})
OF_OTHERS = (
    "forward_dynamics_derivatives",
    "centroidal_matrix_dot",
    "com_velocity_derivatives",
    "jacobian_dot",
    "hessian",
    "frame_velocity_derivatives",
    "frame_acceleration_derivatives",
)
ONE_PROCEDURE = [
    (name, options)
    for name in NAMES
    if name not in OF_OTHERS
    for options in (
        {},
        *([{"forces": ("side", "tip")}] if "forces" in kernels.QUANTITIES[name].options else []),
    )
]


def robots() -> dict[str, Model]:
    rng = np.random.default_rng(5)
    return {
        "all kinds": random_model(rng, root="free_flyer", mimics=0),
        "mimic joints": random_model(rng, ("revolute", "prismatic", "helical"), 9, root="planar", mimics=4),
        "angles as pairs": circles(),
    }


ROBOTS = robots()


def arguments(model: Model, name: str, batch: int, seed: int = 0, forces: Any = ()) -> list[Any]:
    rng = np.random.default_rng(seed)
    made = {"q": configurations(model, rng, batch)}
    arrays = [
        made.get(array, rng.standard_normal((batch, model.nv))) for array in kernels.QUANTITIES[name].arrays
    ]
    return [*arrays, *([rng.standard_normal((batch, len(forces), 6))] if forces else [])]


def close(a: Any, b: Any) -> bool:
    a, b = (x if isinstance(x, tuple) else (x,) for x in (a, b))
    return all(
        x.shape == y.shape and np.abs(x - y).max() <= 1e-12 * max(np.abs(y).max(), 1.0)
        for x, y in zip(a, b, strict=True)
    )


def test_every_quantity_with_loops_is_tested() -> None:
    of_constraints = {name for name in quantities._RECURSIONS if "constrain" in name}
    others = {"impulse_dynamics", "delassus_matrix"}  # of constraints, too: test_constrained_loops.py
    assert set(NAMES) == set(quantities._RECURSIONS) - of_constraints - others


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize("name", NAMES)
def test_the_numbers_are_those_of_the_traced_kernel(robot: str, name: str) -> None:
    model = ROBOTS[robot]
    for options in [o for n, o in CASES if n == name]:
        looped = kernels.looped(model, name, **options)
        assert looped is not None
        arrays = arguments(model, name, 19, 0, options.get("forces"))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            expected = kernels.function(model, name, **options)(*arrays)
        assert close(looped(*arrays), expected), options
        one = looped(*(x[7] for x in arrays))
        assert close(one, tuple(x[7] for x in expected) if isinstance(expected, tuple) else expected[7]), (
            options
        )


@pytest.mark.parametrize(
    ("name", "options"),
    [
        pytest.param(
            name, options, marks=() if name in ("gravity_forces", "static_torque") else pytest.mark.slow
        )
        for name, options in ONE_PROCEDURE
    ],
)
def test_no_access_is_beside_an_array(name: str, options: dict[str, Any]) -> None:
    """The code that checks every access computes the same, for one sample and for lanes."""
    model = ROBOTS["all kinds"]
    forces = options.get("forces")
    looped = kernels.looped(model, name, **options)
    assert looped is not None
    recursion = looped.evaluator.recursion
    if recursion.is_matrix:
        arrays = arguments(model, name, 2, 0, forces)
        matrices = [np.full((2, *shape), np.nan) for shape in recursion.outputs]
        inputs = [np.ascontiguousarray(x).reshape(2, -1, 1) for x in arrays]
        specialized(recursion.procedure, 4).checked(*recursion.storage(1), *inputs, *matrices, 2)
        assert close(tuple(matrices), looped(*arrays))
        return
    for lanes in (1, 4):
        given = arguments(model, name, lanes, 0, forces)
        arrays = [np.ascontiguousarray(x.reshape(lanes, -1).T)[None] for x in given]
        outputs = [np.zeros((1, int(np.prod(shape)), lanes)) for shape in recursion.outputs]
        procedure = specialized(recursion.procedure, lanes)
        procedure.checked(*recursion.storage(lanes), *arrays, *outputs, 1)
        expected = looped(*given)
        assert close(outputs[0][0].T.reshape(expected.shape), expected)


def test_the_interpreter_agrees() -> None:
    """The reference of the language, on a short robot: it is slow."""
    model = circles()
    looped = kernels.looped(model, "inverse_dynamics")
    assert looped is not None
    recursion = looped.evaluator.recursion
    arrays = [np.ascontiguousarray(x.T)[None] for x in arguments(model, "inverse_dynamics", 2)]
    tau = np.zeros((1, model.nv, 2))
    specialized(recursion.procedure, 2).interpret(*recursion.storage(2), *arrays, tau, 1)
    assert close(tau[0].T, looped(*arguments(model, "inverse_dynamics", 2)))


def test_large_robots_use_loops_and_small_ones_do_not(monkeypatch: pytest.MonkeyPatch) -> None:
    assert "loops over 1,200 joints" in repr(kernels.kernel(long_robot(1200), "fk"))
    robot = ulna.Robot(ROBOTS["all kinds"])
    assert robot.kernel("fk").operations > 0
    monkeypatch.setattr(kernels, "LOOPED_ABOVE", 0)
    assert "loops over" in repr(kernels.kernel(long_robot(8), "fk"))
    assert kernels.kernel(long_robot(9), "fk", parameters="placement").operations > 0


def test_humanoids_use_straight_line_code() -> None:
    """Their derivatives take a second or some to compile, and loops seven times as long to compute."""
    robot = random_model(np.random.default_rng(2), ("revolute",), 29, root="free_flyer", mimics=0)
    for name in ("forward_dynamics_derivatives", "inverse_dynamics_derivatives", "coriolis_matrix"):
        quantity = kernels.QUANTITIES[name]
        assert not kernels._is_long(robot, quantity, quantity.options), name
        assert kernels._is_long(long_robot(200), quantity, quantity.options), name


@pytest.mark.parametrize("has_registers", [True, False])
def test_derivatives_of_accelerations_use_stages_where_they_suit(
    has_registers: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(in_stages, "can_write_columns", lambda *_: has_registers)
    robot = random_model(np.random.default_rng(5), ("revolute",), 20, root="free_flyer", mimics=0)
    made = kernels.looped(robot, "forward_dynamics_derivatives")
    arrays = arguments(robot, "forward_dynamics_derivatives", 3, 4)
    expected = [algorithms.forward_dynamics_derivatives(robot, *(x[k] for x in arrays)) for k in range(3)]
    for k, results in enumerate(zip(*made(*arrays), strict=True)):  # type: ignore[misc]
        for got, right in zip(results, expected[k], strict=True):
            assert np.abs(got - right).max() < 1e-9 * np.abs(right).max()


def test_the_inverse_mass_matrix_of_many_branches() -> None:
    """Rows end where a branch ends, in the middle of a register."""
    robot = random_model(
        np.random.default_rng(6), ("revolute", "spherical"), 24, root=None, mimics=0, branching=0.8
    )
    q = arguments(robot, "inverse_mass_matrix", 1, 2)[0][0]
    inverse = kernels.looped(robot, "inverse_mass_matrix")(q)  # type: ignore[misc]
    expected = algorithms.inverse_mass_matrix(robot, q)
    assert np.abs(inverse - expected).max() < 1e-10 * np.abs(expected).max()


@pytest.fixture
def chain(monkeypatch: pytest.MonkeyPatch) -> ulna.Robot:
    monkeypatch.setattr(kernels, "LOOPED_ABOVE", 0)
    return ulna.Robot(long_robot(30, 0.3))


def test_calls_are_those_of_any_kernel(chain: ulna.Robot) -> None:
    q, v, a = arguments(chain.model, "inverse_dynamics", 40, 3)
    kernel = chain.kernel("inverse_dynamics")
    expected = kernels.function(chain.model, "inverse_dynamics")(q, v, a)
    assert close(kernel(q, v, a), expected)
    assert close(chain.inverse_dynamics(q, v, a), expected)
    assert close(kernel(q.reshape(5, 8, -1), v[0], a[:8]).reshape(40, -1)[9], kernel(q[9], v[0], a[1]))
    assert close(kernel(q[0].tolist(), a=a[0], v=v[0]), expected[0])
    assert close(kernel(q, v, a, threads=3), expected)
    assert kernel(np.zeros((0, 30)), v[0], a[0]).shape == (0, 30)
    with pytest.raises(ShapeError, match="`q`"):
        kernel(q[:, :-1], v, a)
    with pytest.raises(NonFiniteError, match="`v"):
        chain.inverse_dynamics(q, np.full(30, np.nan), a)


def test_results_are_written_where_asked(chain: ulna.Robot) -> None:
    q = configurations(chain.model, np.random.default_rng(0), 12)
    kernel = chain.kernel("gravity_forces")
    expected = kernel(q)
    for out in (np.zeros((12, 30)), np.zeros((30, 12)).T, np.zeros((12, 30), np.float32), q.copy()):
        assert kernel(q if out.shape != q.shape else q.copy(), out=out) is out
        assert np.abs(out - expected).max() < 1e-4
    wide = np.zeros((3, 12, 30))
    assert np.array_equal(kernel(q, out=wide), np.broadcast_to(expected, wide.shape))
    inside = q.copy()
    assert np.array_equal(kernel(inside, out=inside), expected)
    target = np.zeros(30)
    kernel.into(target)(q[3])
    assert np.array_equal(target, kernel(q[3]))


@pytest.mark.parametrize("checked", [False, True])
def test_samples_that_are_read_as_they_are(chain: ulna.Robot, checked: bool) -> None:
    kernel = chain.kernel("inverse_dynamics", checked=checked)
    q, v, a = (0.1 * x for x in np.random.default_rng(8).standard_normal((3, chain.nv)))
    wanted = kernel(*(x[None] for x in (q, v, a)))[0]
    out = np.full(chain.nv, np.nan)
    assert kernel(q, v, a, out=out) is out
    wide = np.repeat(a, 2)[::2]
    answers = [out, kernel(q, v, a), kernel(q, v, wide), kernel(q.tolist(), v, a), kernel(q, v=v, a=a)]
    answers += [kernel(q, v, a, out=(np.zeros(chain.nv),)), kernel(q, v, wide, out=wide)]
    for answer in answers:
        np.testing.assert_allclose(answer, wanted, rtol=1e-12, atol=1e-10)
    np.testing.assert_array_equal(answers[1], out)
    out.flags.writeable = False
    with pytest.raises(ValueError, match="read-only"):
        kernel(q, v, a, out=out)
    with pytest.raises(ShapeError):
        kernel(q, v, a[:-1])
    q[3] = np.nan
    if checked:
        with pytest.raises(NonFiniteError):
            kernel(q, v, a)
    else:
        assert np.isnan(kernel(q, v, a)).any()


def test_float32_is_rounded_at_the_end(chain: ulna.Robot) -> None:
    q = configurations(chain.model, np.random.default_rng(0), 3).astype(np.float32)
    small = chain.kernel("gravity_forces", dtype=np.float32)(q)
    large = chain.kernel("gravity_forces")(q)
    assert small.dtype == np.float32
    assert np.array_equal(small, large.astype(np.float32))


def test_what_needs_a_graph_says_that_there_is_none(chain: ulna.Robot) -> None:
    kernel = chain.kernel("fk")
    for name in ("operations", "operation_counts", "gufunc"):
        with pytest.raises(InputError, match="'fk' of 'robot30' loops over a table of 30 joints"):
            getattr(kernel, name)
    assert kernel.function.operations > 100
    report = kernel.report()
    assert report.operations is None and report.code_bytes > 500 and "a loop over joints" in str(report)
    assert "define" in kernel.ir() and "<" in kernel.ir(batch=True)
    assert "ret" in kernel.asm()
    assert kernel.signature == "(30)->(4,4)"
    assert kernel.__name__ == "fk" and "pose of a frame" in kernel.__doc__


def test_a_kernel_travels_to_other_processes(chain: ulna.Robot) -> None:
    q = configurations(chain.model, np.random.default_rng(0), 3)
    kernel = chain.kernel("fk", frame="l7")
    assert np.array_equal(pickle.loads(pickle.dumps(kernel))(q), kernel(q))


def test_a_call_inside_a_trace_becomes_straight_line_code(chain: ulna.Robot) -> None:
    q = configurations(chain.model, np.random.default_rng(0), 1)[0]
    height = compile(lambda q: chain.fk(q)[2, 3] * 2.0, q=(30,))
    assert abs(height(q) - 2.0 * chain.fk(q)[2, 3]) < 1e-12


def test_the_base_stands_still(chain: ulna.Robot) -> None:
    """A frame that no joint moves."""
    q = np.zeros((3, 30))
    assert np.array_equal(chain.fk(q, "l0"), np.broadcast_to(np.eye(4), (3, 4, 4)))
    assert not chain.jacobian(q, "l0").any()


def test_several_matrices_are_written_where_asked(chain: ulna.Robot) -> None:
    arrays = arguments(chain.model, "inverse_dynamics_derivatives", 3)
    kernel = chain.kernel("inverse_dynamics_derivatives")
    expected = kernel(*arrays)
    assert len(expected) == 3 and "->(30,30),(30,30),(30,30)" in kernel.signature
    out = (np.zeros((3, 30, 30)), np.zeros((3, 30, 30), np.float32), np.zeros((30, 30, 3)).transpose(2, 0, 1))
    results = kernel(*arrays, out=out)
    for result, target, right in zip(results, out, expected, strict=True):
        assert result is target
        assert np.abs(target - right).max() < 1e-5 * np.abs(right).max()
    shared = np.zeros((3, 30, 30))
    last = kernel(*arrays, out=(shared, shared, shared))[2]
    assert np.array_equal(last, expected[2])


def test_without_mass_there_is_no_centre() -> None:
    model = long_robot(4)
    assert kernels.looped(model, "center_of_mass") is not None
    assert kernels.looped(model, "center_of_mass", subtree=model.joint_names[2]) is None


def test_some_quantities_have_no_loops() -> None:
    model = ROBOTS["all kinds"]
    assert kernels.looped(model, "manipulability") is None
    assert kernels.looped(model, "operational_inertia") is None


def test_branches_keep_what_their_children_need() -> None:
    """The inverse mass matrix on trees with many branches: steps share places."""
    for seed in range(3):
        model = long_robot(40, 0.7, seed)
        q = configurations(model, np.random.default_rng(seed), 2)
        M, inverse = (kernels.looped(model, name) for name in ("mass_matrix", "inverse_mass_matrix"))
        assert M is not None and inverse is not None
        assert np.abs(M(q) @ inverse(q) - np.eye(40)).max() < 1e-10


@pytest.mark.parametrize("branching", [0.0, 0.05, 0.5])
def test_matrices_of_hundreds_of_joints(branching: float) -> None:
    robot = ulna.Robot(long_robot(400, branching))
    q, v, a = arguments(robot.model, "inverse_dynamics", 1)
    M = robot.mass_matrix(q[0])
    assert "loops over" in repr(robot.kernel("mass_matrix"))
    torques = robot.inverse_dynamics(q[0], v[0], a[0])
    assert np.abs(M @ a[0] + robot.bias_forces(q[0], v[0]) - torques).max() < 1e-10 * np.abs(torques).max()
    assert np.abs(robot.forward_dynamics(q[0], v[0], torques) - a[0]).max() < 1e-6


def test_hundreds_of_joints_of_which_some_mimic_others() -> None:
    """Torques and accelerations invert each other; derivatives are those along the tangent space."""
    robot = ulna.Robot(long_robot(300, 0.05, coupled=4))
    q, v, a = (x[0] for x in arguments(robot.model, "inverse_dynamics", 1))
    assert robot.nv == 225
    forces = {"l150": np.ones(6), "l300": -np.ones(6)}
    torques = robot.inverse_dynamics(q, v, a, forces, "local")
    assert "loops over" in repr(robot.kernel("forward_dynamics", forces=tuple(forces)))
    found = robot.forward_dynamics(q, v, torques, forces, "local")
    assert np.abs(found - a).max() < 1e-6
    by_q, by_v, M = robot.derivatives.inverse_dynamics(q, v, a, forces, "local")
    assert "loops over" in repr(robot.kernel("inverse_dynamics_derivatives", forces=tuple(forces)))
    scale = np.abs(torques).max()
    assert np.abs(M - robot.mass_matrix(q)).max() < 1e-11 * np.abs(M).max()
    assert np.abs(M @ robot.inverse_mass_matrix(q) - np.eye(robot.nv)).max() < 1e-8
    assert (
        np.abs(robot.coriolis_matrix(q, v) @ v + robot.gravity_forces(q) - robot.bias_forces(q, v)).max()
        < 1e-10 * scale
    )
    step, h = np.random.default_rng(1).standard_normal(robot.nv), 1e-6
    for k, matrix in enumerate((by_q, by_v)):
        before, after = (
            [q - sign * h * step, v] if k == 0 else [q, v - sign * h * step] for sign in (1.0, -1.0)
        )
        change = robot.inverse_dynamics(*after, a, forces, "local") - robot.inverse_dynamics(
            *before, a, forces, "local"
        )
        expected = matrix @ step
        assert np.abs(change / (2.0 * h) - expected).max() < 1e-5 * np.abs(expected).max()


def test_friction_joins_the_torques_of_loops(chain: ulna.Robot) -> None:
    q, v, a = (x[0] for x in arguments(chain.model, "inverse_dynamics", 1))
    plain = chain.inverse_dynamics(q, v, a)
    law = Friction(viscous=np.linspace(0.1, 1.0, 30), coulomb=0.3)
    assert np.abs(chain.inverse_dynamics(q, v, a, friction=law) - plain + law.torque(v)).max() < 1e-12
    assert np.abs(chain.forward_dynamics(q, v, plain - law.torque(v), friction=law) - a).max() < 1e-9


def finger_robot(joints: int, mass: float) -> Model:
    """A chain with a gripper: its second finger, of some mass, mimics the first."""
    body = Inertia.from_com(1.0, (0.05, -0.02, 0.08), np.diag([0.1, 0.2, 0.15]))
    builder = ModelBuilder("gripper").add_link("l0")
    for k in range(1, joints + 1):
        kind = Revolute(((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))[k % 3])
        builder.add_link(f"l{k}", body)
        builder.add_joint(f"j{k}", kind, f"l{k - 1}", f"l{k}", SE3.trans(0.03, 0.02, 0.01) @ SE3.rx(0.3))
    for k, size in ((1, 1.0), (2, mass)):
        builder.add_link(f"finger{k}", Inertia.from_com(size, (0.0, 0.0, 0.02), size * np.eye(3)))
        mimic = ("finger1", -1.0, 0.0) if k == 2 else None
        builder.add_joint(
            f"finger{k}",
            Prismatic((0.0, 1.0, 0.0)),
            f"l{joints}",
            f"finger{k}",
            SE3.identity(),
            armature=0.1,
            mimic=mimic,
        )
    return builder.set_tool(f"l{joints}").build()


@pytest.mark.parametrize(
    "model", [long_robot(60, 0.1, coupled=9), finger_robot(20, 1.0), finger_robot(20, 0.0)],
    ids=["many", "gripper", "massless finger"],
)  # fmt: skip
def test_few_mimic_joints_are_solved_one_by_one(model: Model) -> None:
    """Also a follower without mass, where every joint by itself would accelerate without bound."""
    tool = model.tool
    for options in ({}, {"friction": True}, {"forces": (tool,)}):
        looped = kernels.looped(model, "forward_dynamics", **options)
        torques = kernels.looped(model, "inverse_dynamics", **options)
        assert looped is not None and torques is not None
        q, v, tau, *rest = arguments(model, "forward_dynamics", 3, 0, options.get("forces"))
        a = looped(q, v, tau, *rest)
        taken = torques(q, v, a, *rest)
        size = np.abs(torques(q, v, 0.0 * v, *rest)).max()
        assert np.abs(taken - tau).max() <= 1e-9 * max(size, np.abs(tau).max())
    made = quantities._forward_dynamics(model, {"forces": ()})
    assert isinstance(made, composition.CoupledAccelerations)
