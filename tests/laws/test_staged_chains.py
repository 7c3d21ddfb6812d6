"""Poses, Jacobians and dynamics of long chains of revolute joints, computed in segments."""

from __future__ import annotations

import ctypes
import pickle
from dataclasses import replace

import numpy as np
import pytest

from support.fenced import fenced
from support.long_robots import long_robot
from ulna import algorithms, kernels
from ulna.algorithms.multibody.chain_frames import chain_frames
from ulna.algorithms.multibody.tree import poses, steps
from ulna.compiler.codegen.module import emit_single
from ulna.compiler.runtime import jit
from ulna.model import Model, ModelBuilder, PointContact, Revolute
from ulna.robot import Robot
from ulna.spatial import SE3, Inertia

REFERENCES = ("world", "local", "local_world_aligned")


def chain(joints: int, seed: int = 0) -> Model:
    """Axes and offsets in general position, some parallel, some opposite, some that meet."""
    rng = np.random.default_rng(seed)
    builder = ModelBuilder("chain").add_link("l0")
    for k in range(joints):
        choice = rng.integers(5)
        axis = (0.0, 0.0, 1.0) if choice < 2 else tuple(rng.normal(size=3))
        turn = (np.pi * (choice == 1), 0.0, 0.0) if choice < 2 else rng.uniform(-2.0, 2.0, 3)
        placement = SE3.from_rpy(turn)
        placement = SE3(placement.rotation, rng.uniform(-0.3, 0.3, 3) * (rng.random(3) < 0.7))
        mass, inertia = rng.uniform(0.5, 1.5), np.diag(rng.uniform(0.02, 0.03, 3))
        builder = builder.add_link(f"l{k + 1}", Inertia.from_com(mass, rng.uniform(-0.2, 0.2, 3), inertia))
        joint = Revolute(axis)
        builder = builder.add_joint(f"j{k}", joint, f"l{k}", f"l{k + 1}", placement, lower=-3.0, upper=3.0)
    tip = SE3.trans(0.1, -0.2, 0.3) @ SE3.rx(0.7)
    builder = builder.add_frame("tip", f"l{joints}", tip).add_frame(
        "middle", f"l{min(joints, joints // 2 + 8)}", tip
    )
    return builder.set_tool("tip").build()


def is_in_stages(model: Model, name: str, **options) -> bool:
    return kernels.kernel(model, name, **options).function.columns is not None


@pytest.mark.parametrize("joints", [1, 2, 9, 30])
def test_frames_are_those_of_the_model(joints):
    model = chain(joints, joints)
    q = np.random.default_rng(joints).uniform(-3.0, 3.0, model.nq)
    frames = chain_frames(model)
    assert frames is not None
    mine, theirs = poses(frames.links.tree, q), poses(steps(model), q)
    for T, T_model, C in zip(mine, theirs, frames.links.frames, strict=True):
        assert np.abs((T_model @ C).matrix() - T.matrix()).max() < 1e-13
        assert np.count_nonzero(np.abs(T.rotation.T @ T.rotation - np.eye(3)) > 1e-14) == 0


@pytest.mark.parametrize("joints", [16, 17, 24, 31, 40, 63, 64, 65, 100, 129])
def test_segments_equal_the_definition(joints):
    model = chain(joints, joints)
    rng = np.random.default_rng(joints)
    q = rng.uniform(-3.0, 3.0, model.nq)
    if jit.target().register_bytes >= 32:
        assert is_in_stages(model, "fk") and is_in_stages(model, "jacobian")
    frame = model.frame("tip")
    wanted = {("fk", ()): algorithms.frame_pose(model, q, frame).matrix()}
    for name in REFERENCES:
        wanted["jacobian", (("reference", name),)] = algorithms.frame_jacobian(model, q, frame, name)
    for (name, options), right in wanted.items():
        kernel = kernels.kernel(model, name, **dict(options))
        for x in (kernel, pickle.loads(pickle.dumps(kernel))):
            np.testing.assert_allclose(x(q), right, atol=2e-13)
        np.testing.assert_allclose(kernel(np.stack([q, -q, q]))[2], right, atol=2e-13)
        single = kernels.kernel(model, name, dtype=np.float32, **dict(options))
        np.testing.assert_allclose(single(q.astype(np.float32)), right, atol=5e-5)


DYNAMICS = {
    "bias_forces": 2,
    "center_of_mass_jacobian": 1,
    "centroidal_matrix": 1,
    "centroidal_momentum": 2,
    "inverse_dynamics": 3,
    "inverse_mass_matrix": 1,
    "kinetic_energy": 2,
    "mass_matrix": 1,
    "mechanical_energy": 2,
}
"""How many arguments they take."""


@pytest.mark.parametrize("joints", [24, 33, 64, 81])
@pytest.mark.parametrize("name", DYNAMICS)
def test_dynamics_with_poses_in_segments_equal_the_definition(name, joints):
    model = chain(joints, joints)
    rng = np.random.default_rng(joints)
    arrays = [rng.uniform(-3.0, 3.0, model.nq), *rng.normal(size=(2, model.nv))][: DYNAMICS[name]]
    right = getattr(algorithms, name)(model, *arrays)
    scale = np.abs(right).max()
    kernel = kernels.kernel(model, name)
    if jit.target().register_bytes >= 32:
        assert kernel.function.columns is not None
    for x in (kernel, pickle.loads(pickle.dumps(kernel))):
        np.testing.assert_allclose(x(*arrays), right, rtol=1e-8, atol=1e-11 * scale)
    batch = [np.stack([x, -x, x]) for x in arrays]
    np.testing.assert_allclose(kernel(*batch)[2], right, rtol=1e-8, atol=1e-11 * scale)
    np.testing.assert_array_equal(kernel(*batch)[0], kernel(*batch)[2])
    if name != "inverse_mass_matrix":  # of which single precision loses too many digits
        single = kernels.kernel(model, name, dtype=np.float32)(*(x.astype(np.float32) for x in arrays))
        assert np.abs(single - right).max() < 3e-5 * scale


DERIVATIVES = {"forward_dynamics_derivatives": 3, "inverse_dynamics_derivatives": 3}
"""How many arguments they take."""


@pytest.mark.parametrize("name", DERIVATIVES)
def test_derivatives_with_sums_in_segments_equal_the_definition(name):
    """Also with drives, bodies without mass and gravity along no axis."""
    for model in (chain(33, 7006), far_chain(26)):
        rng = np.random.default_rng(7007)
        arrays = [rng.uniform(-3.0, 3.0, model.nq), *rng.normal(size=(2, model.nv))]
        kernel = kernels.kernel(model, name)
        if jit.target().register_bytes >= 32:
            assert any(type(stage).__name__ == "Scan" for stage in kernel.function.columns.stages)
        wanted = getattr(algorithms, name)(model, *arrays)
        for got, right in zip(kernel(*arrays), wanted, strict=True):
            np.testing.assert_allclose(got, right, rtol=1e-7, atol=1e-10 * np.abs(right).max())


SCANS = sorted(DYNAMICS.keys() - {"inverse_mass_matrix", "mass_matrix"})
"""Those that are nothing but walks along segments."""


def far_chain(joints: int) -> Model:
    """A chain with drives, bodies without mass and slanting gravity, whose root is 10 km from the world's origin."""
    rng = np.random.default_rng(7001)
    builder = ModelBuilder("far").add_link("l0")
    for k in range(joints):
        body = Inertia.zero()
        if k % 5:
            inertia = np.diag(rng.uniform(0.02, 0.03, 3))
            body = Inertia.from_com(rng.uniform(0.5, 1.5), rng.uniform(-0.2, 0.2, 3), inertia)
        place = rng.uniform(-0.3, 0.3, 3) if k else np.array([6e3, -7e3, 4e3])
        placement = SE3(SE3.from_rpy(rng.uniform(-2.0, 2.0, 3)).rotation, place)
        builder = builder.add_link(f"l{k + 1}", body).add_joint(
            f"j{k}", Revolute((0.0, 0.0, 1.0)), f"l{k}", f"l{k + 1}", placement, armature=0.1 + 0.01 * k
        )
    return replace(builder.build(), gravity=np.array([1.0, -2.0, -9.0]))


@pytest.mark.parametrize("name", SCANS)
def test_far_from_the_origin(name):
    """As precise as near it; of energies the potential is a product with a large distance."""
    model = far_chain(43)
    rng = np.random.default_rng(7002)
    arrays = [rng.uniform(-3.0, 3.0, model.nq), *rng.normal(size=(2, model.nv))][: DYNAMICS[name]]
    kernel = kernels.kernel(model, name)
    if jit.target().register_bytes >= 32:
        assert kernel.function.columns is not None
    right = getattr(algorithms, name)(model, *arrays)
    few = 1e-9 if name.startswith("centroidal") else 1e-13  # the definition loses these digits
    np.testing.assert_allclose(kernel(*arrays), right, rtol=0.0, atol=few * np.abs(right).max())
    at_origin = SE3(model.joints[0].placement.rotation, np.zeros(3))
    joints = (replace(model.joints[0], placement=at_origin), *model.joints[1:])
    if name != "mechanical_energy":
        there = kernels.kernel(replace(model, joints=joints), name)(*arrays)
        np.testing.assert_allclose(kernel(*arrays), there, rtol=0.0, atol=1e-13 * np.abs(there).max())


@pytest.mark.parametrize("name", SCANS)
def test_dynamics_of_thousands_of_joints(name):
    """Beside loops over joints."""
    model = chain(1100, 7003)
    rng = np.random.default_rng(7003)
    arrays = [rng.uniform(-3.0, 3.0, model.nq), *rng.normal(size=(2, model.nv))][: DYNAMICS[name]]
    right = kernels.looped(model, name)(*arrays)
    scale = np.abs(right).max()
    kernel = kernels.kernel(model, name)
    np.testing.assert_allclose(kernel(*arrays), right, rtol=0.0, atol=1e-12 * scale)
    batch = [np.stack([x, -x, x]) for x in arrays]
    np.testing.assert_allclose(kernel(*batch)[2], right, rtol=0.0, atol=1e-12 * scale)
    single = kernels.kernel(model, name, dtype=np.float32)(*(x.astype(np.float32) for x in arrays))
    assert np.abs(single - right).max() < 1e-4 * scale


@pytest.mark.filterwarnings("ignore:The mass matrix of:ulna.errors.ModelWarning")
@pytest.mark.parametrize(("name", "count"), [("inverse_mass_matrix", 1), ("forward_dynamics_derivatives", 3)])
def test_single_precision_of_long_chains_is_that_of_double(name, count):
    """Masses of long chains need float64: stages compute in it, and results are rounded."""
    model = chain(80, 7008)
    rng = np.random.default_rng(7008)
    arrays = [rng.uniform(-3.0, 3.0, (2, model.nq)), *rng.normal(size=(2, 2, model.nv))][:count]
    arrays = [x.astype(np.float32) for x in arrays]
    single, double = (kernels.kernel(model, name, dtype=dtype) for dtype in (np.float32, np.float64))
    wanted = double(*(x.astype(float) for x in arrays))
    found, wanted = (x if isinstance(x, tuple) else (x,) for x in (single(*arrays), wanted))
    for got, right in zip(found, wanted, strict=True):
        assert got.dtype == np.float32
        np.testing.assert_allclose(got, right, rtol=1e-5, atol=1e-7 * np.abs(right).max())


def test_torques_may_lie_on_the_argument():
    model = chain(30, 7004)
    rng = np.random.default_rng(7004)
    arrays = [rng.uniform(-3.0, 3.0, model.nq), *rng.normal(size=(2, model.nv))]
    kernel = kernels.kernel(model, "inverse_dynamics")
    expected = kernel(*arrays)
    for k in range(3):
        given = [x.copy() for x in arrays]
        kernel(*given, out=given[k])
        np.testing.assert_array_equal(given[k], expected)


def test_forces_friction_and_parts_of_a_chain_keep_straight_line_code():
    model = chain(30, 7005)
    rng = np.random.default_rng(7005)
    q, v, a = rng.uniform(-3.0, 3.0, model.nq), *rng.normal(size=(2, model.nv))
    robot = Robot(model)
    law = algorithms.Friction(viscous=0.3)
    np.testing.assert_allclose(
        robot.inverse_dynamics(q, v, a, friction=law), robot.inverse_dynamics(q, v, a) + 0.3 * v, rtol=1e-9
    )
    wrench = np.array([1.0, 2.0, 3.0, 0.0, 0.0, 0.0])
    lever = robot.jacobian(q, "tip").T @ wrench
    for loaded, free in (
        (robot.inverse_dynamics(q, v, a, {"tip": wrench}), robot.inverse_dynamics(q, v, a)),
        (robot.bias_forces(q, v, {"tip": wrench}), robot.bias_forces(q, v)),
    ):
        np.testing.assert_allclose(loaded, free - lever, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(
        robot.centroidal.jacobian(q, "j9"), algorithms.center_of_mass_jacobian(model, q, "j9"), atol=1e-13
    )
    assert not is_in_stages(model, "center_of_mass_jacobian", subtree="j9")


def test_impacts_keep_frames_that_constraints_refer_to():
    """Constraints are placed before poses are computed, in the frames that the model has then."""
    model = chain(26, 4)
    rng = np.random.default_rng(0)
    q, v = rng.uniform(-3.0, 3.0, model.nq), rng.normal(size=model.nv)
    kernel = kernels.kernel(model, "impulse_dynamics", constraints=(PointContact("tip"),))
    after = kernel(q, v)[0]
    J = algorithms.frame_jacobian(model, q, model.frame("tip"))[:3]
    assert np.abs(J @ after).max() < 1e-7 * np.abs(after).max()


@pytest.mark.parametrize("register_bytes", [32, 64])
@pytest.mark.parametrize("name", DYNAMICS)
def test_dynamics_in_all_widths_of_registers(name, register_bytes):
    """Arrays end at pages without access."""
    model = chain(29, 3)
    f = kernels.kernel(model, name).function
    rng = np.random.default_rng(3)
    arrays = [rng.uniform(-3.0, 3.0, model.nq), *rng.normal(size=(2, model.nv))][: DYNAMICS[name]]
    held = _computed(f, arrays, register_bytes, True)
    right = getattr(algorithms, name)(model, *arrays)
    np.testing.assert_allclose(held, right, rtol=1e-8, atol=1e-11 * np.abs(right).max())


def _computed(f, arrays, register_bytes, at_end):
    """What a kernel for registers of that width computes, between pages without access."""
    ir = emit_single(f, replace(jit.target(), register_bytes=register_bytes))
    code = jit.load_text(
        ir.replace("define internal void @one(", "define void @one("), ("one",), has_loops=False
    )
    held = [
        fenced(int(np.prod(port.shape)), float, at_end).reshape(port.shape)
        for port in (*f.inputs, *f.outputs)
    ]
    for place, x in zip(held, arrays, strict=False):
        place[...] = x
    pointers = [ctypes.c_void_p(x.ctypes.data) for x in held]
    ctypes.CFUNCTYPE(None, *[ctypes.c_void_p] * len(pointers))(code.address("one"))(*pointers)
    return held[-1]


def test_frames_within_the_chain_and_several_frames():
    model = chain(40)
    q = np.random.default_rng(1).uniform(-3.0, 3.0, model.nq)
    robot, middle = Robot(model), model.frame("middle")
    np.testing.assert_allclose(
        robot.fk(q, "middle"), algorithms.frame_pose(model, q, middle).matrix(), atol=1e-13
    )
    np.testing.assert_allclose(
        robot.jacobian(q, "middle"), algorithms.frame_jacobian(model, q, middle), atol=1e-13
    )
    assert not is_in_stages(model, "fk", frame=("middle", "tip"))
    assert not is_in_stages(model, "jacobian", frame="middle")
    both = robot.fk(q, ["middle", "tip"])
    np.testing.assert_allclose(both[1], robot.fk(q), atol=1e-13)


def test_digits_of_a_long_product():
    """Beside 40 digits; what rounding errors of 300 products add up to."""
    mpmath = pytest.importorskip("mpmath")
    model = chain(300, 5)
    q = np.random.default_rng(5).uniform(-3.0, 3.0, model.nq)
    with mpmath.workdps(40):
        T = mpmath.eye(4)
        for step in steps(model):
            x, y, z = map(mpmath.mpf, step.kind.axis)
            K = mpmath.matrix([[0, -z, y], [z, 0, -x], [-y, x, 0]])
            angle, turn = mpmath.mpf(float(q[step.joint.idx_q])), mpmath.eye(4)
            turn[:3, :3] = mpmath.eye(3) + mpmath.sin(angle) * K + (1 - mpmath.cos(angle)) * K * K
            T = T * mpmath.matrix(step.placement.matrix().tolist()) * turn
        T = T * mpmath.matrix(model.frame("tip").placement.matrix().tolist())
        exact = np.array(T.tolist(), dtype=float)
    kernel = kernels.kernel(model, "fk")
    assert np.abs(kernel(q) - exact).max() < 1e-12
    assert np.abs(kernel(np.stack([q, q]))[1] - exact).max() < 1e-12


def test_thousands_of_joints():
    """Batches, too, are computed in segments."""
    model = chain(1500, 2)
    q = np.random.default_rng(2).uniform(-3.0, 3.0, (3, model.nq))
    for name, reference in (("fk", algorithms.frame_pose), ("jacobian", algorithms.frame_jacobian)):
        kernel = kernels.kernel(model, name)
        right = reference(model, q[2], model.frame("tip"))
        right = right.matrix() if name == "fk" else right
        np.testing.assert_allclose(kernel(q[2]), right, atol=3e-12)
        np.testing.assert_allclose(kernel(q)[2], right, atol=3e-12)


@pytest.mark.parametrize("at_end", [False, True])
@pytest.mark.parametrize("register_bytes", [32, 64])
@pytest.mark.parametrize("joints", [16, 29, 70])
@pytest.mark.parametrize("name", ["fk", "jacobian"])
def test_all_widths_of_registers_touch_nothing_else(name, joints, register_bytes, at_end):
    """Arrays begin or end at pages without access."""
    model = chain(joints, 3)
    f = kernels.kernel(model, name).function
    q = np.random.default_rng(3).uniform(-3.0, 3.0, model.nq)
    got = _computed(f, [q], register_bytes, at_end)
    frame = model.frame("tip")
    right = (
        algorithms.frame_pose(model, q, frame).matrix()
        if name == "fk"
        else algorithms.frame_jacobian(model, q, frame)
    )
    np.testing.assert_allclose(got, right, atol=1e-13)


def test_results_may_lie_on_the_argument():
    model = chain(17, 4)
    q = np.random.default_rng(4).uniform(-3.0, 3.0, model.nq)
    memory = np.zeros(6 * model.nv)
    memory[5 : 5 + model.nq] = q
    expected = kernels.kernel(model, "jacobian")(q)
    out = memory.reshape(6, model.nv)
    kernels.kernel(model, "jacobian")(memory[5 : 5 + model.nq], out=out)
    np.testing.assert_array_equal(out, expected)


def test_what_is_not_finite_is_seen():
    model = chain(20, 6)
    q = np.random.default_rng(6).uniform(-3.0, 3.0, model.nq)
    for k in (0, 7, 19):
        bad = q.copy()
        bad[k] = np.nan
        assert np.isnan(kernels.kernel(model, "fk")(bad)[:3, :3]).any()


def test_other_chains_keep_straight_line_code():
    """Axes that are nearly parallel, other joints, joints that mimic others, branches, parameters."""
    model = chain(20, 7)
    bent = [joint.placement for joint in model.joints]
    bent[5] = SE3.rx(1e-3) @ SE3.trans(0.1, 0.2, 0.3)
    axes = [joint.kind.axis for joint in model.joints]
    axes[4] = axes[5] = (0.0, 0.0, 1.0)
    builder = ModelBuilder("bent").add_link("l0")
    for k, (placement, axis) in enumerate(zip(bent, axes, strict=True)):
        builder = builder.add_link(f"l{k + 1}").add_joint(
            f"j{k}", Revolute(axis), f"l{k}", f"l{k + 1}", placement
        )
    nearly = builder.set_tool("l20").build()
    assert chain_frames(nearly) is None
    for other in (nearly, long_robot(30), long_robot(30, branching=0.4), long_robot(30, coupled=3)):
        q = np.random.default_rng(7).uniform(-1.0, 1.0, other.nq)
        frame = other.frame(other.tool)
        kernel = kernels.kernel(other, "fk")
        assert kernel.function.columns is None
        np.testing.assert_allclose(kernel(q), algorithms.frame_pose(other, q, frame).matrix(), atol=1e-12)
    with_placements = kernels.kernel(model, "fk", parameters="placement")
    assert with_placements.function.columns is None


def test_chains_of_100_joints_agree_with_pinocchio():
    pin = pytest.importorskip("pinocchio")
    from support.pinocchio_models import to_pinocchio

    model = chain(100, 8)
    twin = to_pinocchio(model)
    data = twin.pin.createData()
    q = np.random.default_rng(8).uniform(-3.0, 3.0, model.nq)
    pin.computeJointJacobians(twin.pin, data, twin.q(q))
    pin.updateFramePlacements(twin.pin, data)
    index = dict((f.name, i) for f, i in twin.frames)["tip"]
    np.testing.assert_allclose(Robot(model).fk(q), data.oMf[index].homogeneous, atol=2e-13)
    for name in REFERENCES:
        J = pin.getFrameJacobian(twin.pin, data, index, getattr(pin, name.upper()))
        np.testing.assert_allclose(Robot(model).jacobian(q, reference=name), twin.columns(J), atol=2e-13)
    v = np.random.default_rng(9).normal(size=model.nv)
    theirs = twin.columns(pin.computeCentroidalMap(twin.pin, data, twin.q(q)))
    assert np.abs(Robot(model).centroidal.momentum_matrix(q) - theirs).max() < 1e-12 * np.abs(theirs).max()
    theirs = pin.computeCentroidalMomentum(twin.pin, data, twin.q(q), twin.v(v)).vector
    assert np.abs(Robot(model).centroidal.momentum(q, v) - theirs).max() < 1e-12 * np.abs(theirs).max()
