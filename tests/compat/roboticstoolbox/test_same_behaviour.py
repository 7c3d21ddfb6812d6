"""Behaviour of the Robotics Toolbox that generated calls found different, each with the value or the error of the toolbox."""

from __future__ import annotations

import copy
import importlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from support.compat_packages import using
from ulna.errors import InputError

pytest.importorskip("spatialmath")
Q = np.array([0.1, -0.4, 0.2, -2.0, 0.3, 1.9, 0.6])


@pytest.fixture(scope="module")
def rtb() -> Iterator[Any]:
    with using("roboticstoolbox"):
        yield importlib.import_module("roboticstoolbox")


@pytest.fixture(scope="module")
def panda(rtb: Any) -> Any:
    return rtb.models.Panda()


@pytest.fixture(scope="module")
def puma(rtb: Any) -> Any:
    return rtb.models.DH.Puma560()


def test_a_search_that_starts_at_the_goal_succeeds_without_a_pseudoinverse(panda: Any) -> None:
    T = panda.fkine(Q)
    for solve in (panda.ikine_NR, panda.ikine_GN, panda.ets().ikine_NR):
        solution = solve(T, q0=Q)
        assert solution.success and solution.iterations == 0 and (solution.q == Q).all()
        assert solve(T, q0=np.vstack([Q + 0.1, Q])).searches == 2
        missed = solve(T, q0=Q + 0.1)
        assert not missed.success and "pinv=True" in missed.reason
    both = panda.ikine_NR(panda.fkine(np.vstack([Q, Q + 0.1])), q0=Q)
    assert both.q.shape == (2, 7) and not both.success and "[1]" in both.reason


def test_pinv_damping_changes_the_steps(panda: Any) -> None:
    T, start = panda.fkine(Q), Q + 0.1
    plain, damped = panda.ik_NR(T, q0=start), panda.ik_NR(T, q0=start, pinv_damping=0.2)
    assert plain.success and damped.success
    assert damped.iterations > plain.iterations
    with pytest.raises(TypeError, match="pinv_damping"):
        panda.ik_GN(T, pinv_damping="x")


@pytest.mark.parametrize(
    "call",
    [
        lambda arm, q: arm.gravload(),
        lambda arm, q: arm.gravload("x"),
        lambda arm, q: arm.gravload_x(),
        lambda arm, q: arm.inertia_x(),
        lambda arm, q: arm.coriolis_x(q, None),
        lambda arm, q: arm.accel_x(q, np.zeros(6), None),
        lambda arm, q: arm.accel(q, q, "x"),
        lambda arm, q: arm.rne(q, q, "x"),
        lambda arm, q: arm.payload_capacity("x", np.ones(6), np.ones(6)),
        lambda arm, q: arm.fkine_all("x"),
        lambda arm, q: arm.links[0].A("x"),
    ],
)
def test_what_is_no_configuration_is_a_type_error_that_names_it(puma: Any, call: Any) -> None:
    with pytest.raises(TypeError, match=r"`\w+` is ('x'|None); expected numbers"):
        call(puma, Q[:6])


def test_a_single_row_among_vectors_is_one_configuration(puma: Any) -> None:
    q = Q[:6]
    tau = puma.rne(q, q, q)
    for arguments in ((q, q, q[None]), (q[None], q, q), (q, q[None], q[None])):
        np.testing.assert_allclose(puma.rne(*arguments), tau, atol=1e-12)
    assert puma.accel(q, q[None], q).shape == puma.itorque(q, q[None]).shape == (6,)
    assert puma.inertia_x(q[None]).shape == puma.coriolis_x(q[None], q[None]).shape == (6, 6)
    assert puma.rne(np.vstack([q, q]), q, q).shape == (2, 6)


def test_derivatives_of_rows_of_configurations_are_stacked(panda: Any) -> None:
    rows = np.vstack([Q, Q + 0.1])
    expected = [panda.partial_fkine0(q, 2) for q in rows]
    np.testing.assert_allclose(panda.partial_fkine0(rows, 2), expected, atol=1e-12)


def test_screws_make_a_base_joints_and_an_end(rtb: Any) -> None:
    from spatialmath import SE3

    joints = [rtb.PoERevolute([0, 0, 2], [0, 0, 0]), rtb.PoERevolute([0, 1, 0], [0.4, 0, 0.2])]
    robot = rtb.PoERobot([*joints, rtb.PoEPrismatic([1, 0, 0], name="slide")], SE3(0.5, 0, 0.2))
    assert [link.name for link in robot.links] == ["link-0", "link-1", "link-2", "slide", "link-4"]
    assert str(robot.links[2]) == 'PoERevolute[twist=(-0.2 0 0.4; 0 1 0), name="link-2"]'
    assert str(robot.ets()).startswith("Rz(q0) ⊕ tx(0.4) ⊕ tz(0.2) ⊕ Ry(-26.57°) ⊕ Rx(-90°) ⊕ Rz(q1) ⊕ ")
    assert repr(robot).startswith("PoERobot([\n    PoELink([0.,0.,0.,0.,0.,0.]") and len(joints) == 2
    np.testing.assert_allclose(robot.T0.A, SE3(0.5, 0, 0.2).A)
    q = [0.3, -0.2, 0.1]
    expected = SE3(0.5, 0, 0.2)
    for link, angle in zip(robot.links[3:0:-1], q[::-1], strict=True):
        expected = link.S.exp(angle) * expected
    np.testing.assert_allclose(robot.fkine(q).A, expected.A, atol=1e-12)
    with pytest.raises(TypeError, match="no PoE link"):
        rtb.PoERobot([rtb.Link()], SE3())


def test_small_calls(rtb: Any, panda: Any) -> None:
    one = rtb.jtraj([1, 2], [3, 4], 1, qd0=[1, 1])
    assert (one.q == [[1, 2]]).all() and (one.qd == [[1, 1]]).all() and (one.t == [0]).all()
    with pytest.raises(ValueError, match="q0"):
        rtb.quintic([1, 2], 1, 5)
    with pytest.raises(ValueError, match="unit"):
        panda.addconfiguration_attr("home", Q, unit="foo")
    assert rtb.Link().number == 0
    link = rtb.RevoluteDH()
    link.mdh = True
    assert link.mdh == 1 and not isinstance(link.mdh, bool)


def test_chains_without_joints_have_empty_jacobians_and_rows_of_poses(rtb: Any, panda: Any) -> None:
    last, chain = panda.links[-1], rtb.ETS(rtb.ET.tx(2))
    assert panda.jacob0_analytical(Q, start=last, end=last).shape == (6, 0)
    assert panda.hessian0(Q, end=panda.links[0]).shape == (0, 6, 0)
    assert len(chain.fkine(np.zeros((0, 1)))) == 1  # a column of no coordinates
    assert len(chain.fkine(np.zeros((3, 2)))) == 3 and chain.fkine(None).t == pytest.approx([2, 0, 0])


def test_robots_in_the_plane_reach_several_poses_and_have_no_friction(rtb: Any) -> None:
    chain = rtb.ET2.R() * rtb.ET2.tx(1) * rtb.ET2.R() * rtb.ET2.tx(0.5)
    goals = chain.fkine(np.array([[0.1, 0.2], [0.3, 0.4]]))
    solution = chain.ikine_LM(goals)
    assert solution.success and solution.q.shape == (2, 2)
    np.testing.assert_allclose(np.array(chain.fkine(solution.q).A), np.array(goals.A), atol=1e-5)
    assert (rtb.models.ETS.Planar2().friction([1, 2]) == 0).all()


def test_jointdynamics_takes_one_configuration(panda: Any) -> None:
    with pytest.raises(ValueError, match=r"`q` has shape \(2, 7\)"):
        panda.jointdynamics(np.vstack([Q, Q]))


def test_figures_step_by_times_above_zero_only(rtb: Any) -> None:
    from roboticstoolbox.backends.PyPlot import PyPlot

    env = PyPlot()
    for dt in (0, -0.1, "x"):
        with pytest.raises(ValueError, match="dt"):
            env.step(dt)
    env.step(0.1)
    assert env.sim_time == pytest.approx(0.1)


def test_angles_that_are_singular_but_for_rounding_are_refused(puma: Any) -> None:
    for representation in ("rpy/xyz", "rpy/zyx"):
        with pytest.raises(ValueError, match="singular"):
            puma.gravload_x(puma.qn, representation=representation)
    expected = puma.gravload_x(puma.qn + 1e-6, representation="eul")
    near = puma.gravload_x(puma.qn + 1e-6, representation="rpy/zyx")
    np.testing.assert_allclose(near[:3], expected[:3], rtol=1e-6)  # forces do not depend on the angles
    np.testing.assert_allclose(puma.gravload_x(puma.qn, representation="exp")[:3], expected[:3], atol=1e-3)


def test_the_method_of_servoing_is_known_by_its_beginning(rtb: Any, panda: Any) -> None:
    T = panda.fkine(Q)
    goal = T * type(T).Rx(0.3) * type(T).Tx(0.1)
    expected = rtb.p_servo(T, goal, method="angle-axis")[0]
    for method in ("a", "angle"):
        assert (rtb.p_servo(T, goal, method=method)[0] == expected).all()
    for wrong in ("r", "RPY", "", 3):
        with pytest.raises(LookupError):
            rtb.p_servo(T, goal, method=wrong)


def test_robots_and_links_are_tested_against_groups_of_shapes(panda: Any) -> None:
    import spatialgeometry as sg
    from spatialmath import SE3

    far, near = sg.Sphere(0.1, pose=SE3(2, 0, 0)), sg.Cuboid([0.1] * 3, pose=panda.fkine(Q))
    group = sg.CollisionShapeGroup([far, near])
    assert panda.iscollided(Q, near) and panda.iscollided(Q, group) and not panda.iscollided(Q, far)
    for inf_dist in (1.0, 3.0):
        distance, at, _ = panda.closest_point(Q, group, inf_dist)
        alone = panda.closest_point(Q, near, inf_dist)
        assert distance == pytest.approx(alone[0]) and at == pytest.approx(alone[1])
    panda.q = Q
    touched = [link.name for link in panda.links if link.collision and link.iscollided(group)]
    assert touched == [link.name for link in panda.links if link.collision and link.iscollided(near)]


def test_solvers_in_python_say_success(rtb: Any, panda: Any) -> None:
    """Those in C++ say nothing, and nothing is said of several poses."""
    T = panda.fkine(Q)
    for solve in (panda.ikine_LM, panda.ets().ikine_LM, panda.ikine_QP):
        assert solve(T, q0=Q + 0.01).reason == "Success"
    assert panda.ikine_NR(T, q0=Q + 0.01, pinv=True).reason == "Success"
    assert rtb.IK_LM().solve(panda.ets(), T, Q + 0.01).astuple()[5] == "Success"
    assert (
        panda.ik_LM(T, q0=Q + 0.01).reason
        == ""
        == panda.ikine_LM(panda.fkine(np.vstack([Q, Q])), q0=Q).reason
    )
    assert panda.ikine_LM(T, q0=np.vstack([Q + 0.01, Q])).reason == "Success"


def test_greatest_speeds_are_set_by_classes_of_robots(rtb: Any, panda: Any, puma: Any) -> None:
    assert panda.qdlim.tolist() == [2.175] * 4 + [2.61] * 3 + [3.0] * 2
    assert rtb.models.URDF.FrankieOmni().qdlim.tolist() == [4.0] * 3 + panda.qdlim.tolist()

    class Mine(rtb.Robot):
        def __init__(self) -> None:
            super().__init__(rtb.ET.Rz() * rtb.ET.tx(0.5) * rtb.ET.Ry())
            self.qdlim = np.array([1.0, 2.0])

    assert Mine().qdlim.tolist() == [1.0, 2.0] == Mine().copy().qdlim.tolist() and puma.qdlim is None


@pytest.mark.parametrize("wrong", ["fast", -1.0, [1.0, float("nan")], 1j, object()])
def test_greatest_speeds_and_torques_are_numbers_not_below_zero(rtb: Any, wrong: Any) -> None:
    robot = rtb.models.DH.Puma560()
    with pytest.raises(InputError, match="`qdlim` is"):
        robot.qdlim = wrong
    assert robot.qdlim is None
    for name in ("qdlim", "tlim"):
        with pytest.raises(InputError, match=f"`{name}` is"):
            rtb.Link(rtb.ET.Rz(), **{name: wrong})
        with pytest.raises(InputError, match=f"`{name}` is"):
            setattr(robot.links[0], name, wrong)
    robot.links[0].qdlim = robot.qdlim = None
    robot.qdlim = [1, np.inf]
    assert robot.qdlim == [1, np.inf], "as it was given"


def test_transforms_of_a_link_are_set(rtb: Any) -> None:
    ET = rtb.ET
    arm = rtb.Robot([rtb.Link(ET.Rz(), name="a"), rtb.Link(ET.tx(1) * ET.Ry(), name="b")])
    before = arm.fkine([0.1, 0.2]).t
    arm.links[1].ets = ET.tx(2) * ET.Ry()
    assert np.allclose(arm.fkine([0.1, 0.2]).t, 2 * before) and arm.links[1].jindex == 1
    with pytest.raises(ValueError, match="belongs to a robot of 2 joints"):
        arm.links[1].ets = ET.tx(2)
    with pytest.raises(ValueError, match="one joint at most"):
        arm.links[1].ets = ET.Rx() * ET.Ry()
    free = rtb.Link(ET.Rz(), name="c")
    free.ets = rtb.ETS(ET.tz(0.3))
    assert not free.isjoint and free.A().t[2] == 0.3


def test_poses_of_links_with_symbols_have_no_factors_of_one(rtb: Any) -> None:
    sympy = pytest.importorskip("sympy")
    q, a = sympy.symbols("q a")
    T = rtb.RevoluteDH(a=a).A(q).A
    assert T[0, 0] == sympy.cos(q) and T[1, 3] == a * sympy.sin(q)


def test_folders_of_meshes(rtb: Any, tmp_path: Path) -> None:
    arm = rtb.DHRobot([rtb.RevoluteDH(), rtb.RevoluteDH(a=1)], meshdir=tmp_path)
    assert arm.meshdir == tmp_path.resolve() and arm.basemesh == arm.meshdir / "link0.stl"
    assert [link.mesh.name for link in arm.links] == ["link1.stl", "link2.stl"]
    assert arm.hasgeometry and ", geometry" in str(arm) and arm.copy().meshdir == arm.meshdir
    plain = rtb.DHRobot([rtb.RevoluteDH()])
    assert (
        plain.basemesh is None is plain.links[0].mesh
        and not plain.hasgeometry
        and not hasattr(plain, "meshdir")
    )


def test_the_catalogue_has_the_columns_of_the_toolbox(rtb: Any, capsys: pytest.CaptureFixture[str]) -> None:
    rtb.models.catalog(mtype="DH", keywords="Sawyer")
    cells = [
        [cell.strip() for cell in line.split("│")[1:-1]]
        for line in capsys.readouterr().out.splitlines()
        if "│" in line
    ]
    assert cells[0][4:] == ["DoF", "dims", "structure", "dynamics", "geometry", "keywords"]
    assert cells[1][4:] == ["7", "3d", "RRRRRRR", "", "", "redundant, symbolic"]


def test_backends_and_catalogues_by_their_names(rtb: Any) -> None:
    names: dict[str, Any] = {}
    exec(
        "from roboticstoolbox.backends import Connector\nfrom roboticstoolbox.backends.Connector import Connector as C",
        names,
    )
    assert names["Connector"] is names["C"] and isinstance(names["C"], type)
    with pytest.raises(KeyError, match="There are: 'DH', 'ETS', 'URDF'"):
        rtb.models.catalog(mtype="XX")


def test_the_pumas_first_joints_are_below_half_a_turn(puma: Any) -> None:
    """As there: half a turn is -pi, which is within the limits of the third joint."""
    for letters in ("ru", "ld"):
        assert np.isclose(puma.ikine_a(puma.fkine(puma.qn), letters).q[2], -np.pi)


def test_files_say_where_each_link_is_and_how_its_joint_is_called(rtb: Any, tmp_path: Path) -> None:
    """Also a link in the place of the one before it: its transforms begin with a pose, as there."""
    file = tmp_path / "arm.urdf"
    file.write_text(
        '<robot name="t"><link name="base"/><link name="a"/><link name="b"/>'
        '<joint name="j0" type="fixed"><parent link="base"/><child link="a"/></joint>'
        '<joint name="j1" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 1 0"/></joint></robot>'
    )
    arm = rtb.models.URDF.URDFRobot(file)
    assert str(arm.ets()) == "SE3() ⊕ SE3() ⊕ Ry(q)"
    assert [link._joint_name for link in arm.links] == [None, "j0", "j1"]


def test_torques_of_a_simulation_are_a_function(puma: Any) -> None:
    pytest.importorskip("scipy")
    with pytest.raises(ValueError, match="expected a function"):
        puma.fdyn(0.01, puma.qn, Q=3)


def test_a_simulation_takes_rows_columns_and_times_back(puma: Any) -> None:
    """As the toolbox, which follows the motion back in time where the duration is below 0."""
    pytest.importorskip("scipy")
    arm, q, qd = puma.nofriction(), np.array(puma.qn), np.full(6, 0.1)
    forth = arm.fdyn(0.02, q, qd0=qd)
    for shape in ((1, 6), (6, 1)):
        again = arm.fdyn(np.array(0.02), q.reshape(shape), lambda *_: np.zeros(6), qd0=qd.reshape(shape))
        assert np.array_equal(forth.q, again.q) and np.array_equal(forth.qd, again.qd)
    precise = {"rtol": 1e-9, "atol": [1e-9] * 12, "max_step": np.inf, "first_step": None}
    end = arm.fdyn(0.02, q, qd0=qd, solver_args=precise)
    back = arm.fdyn(-0.02, end.q[-1], qd0=end.qd[-1], solver_args=precise)
    assert back.t[-1] == -0.02 and np.abs(back.q[-1] - q).max() < 1e-8
    assert np.allclose(arm.fdyn(-0.02, q, dt=-0.01).t, [0.0, -0.01])
    assert arm.fdyn(0.0, q, dt=0.1).q.shape == (0, 6) and len(arm.fdyn(0, q).t) == 2


def test_few_searches_are_as_many_as_were_asked_for(rtb: Any, panda: Any) -> None:
    import spatialmath as sm

    far, near = sm.SE3(5, 5, 5), panda.fkine(Q)
    for count in (1, 3, 7):
        assert panda.ik_LM(far, slimit=count).searches == count == panda.ikine_LM(far, slimit=count).searches
    alone = panda.ik_LM(near, q0=Q + 0.1, slimit=1)
    assert alone.success and alone.searches == 1
    assert panda.ikine_LM(near, q0=np.vstack([Q + 3.0, Q + 0.1])).searches == 2


def test_descriptions_of_rtb_data_by_their_paths(rtb: Any) -> None:
    pytest.importorskip("rtbdata")
    pytest.importorskip("xacrodoc")
    from_file = rtb.models.URDF.URDFRobot("trossen_descriptions/urdf/px100.urdf.xacro")
    arm = rtb.models.URDF.px100()
    poses = [robot.fkine(arm.q, end="/gripper_link").A for robot in (from_file, arm)]
    assert from_file.name == arm.name == "px100" and np.allclose(*poses)
    for robot in (from_file, arm, rtb.models.URDF.LBR(), rtb.models.URDF.FrankieOmni()):
        assert robot.hasgeometry and robot.hascollision
    assert [len(link.collision) for link in arm.links] == [len(link.collision) for link in from_file.links]


def test_ros_packages_by_names_that_their_folders_do_not_have(rtb: Any, tmp_path: Path) -> None:
    pytest.importorskip("trimesh")
    shapes = tmp_path / "folder" / "meshes"
    shapes.mkdir(parents=True)
    corners = "vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
    (shapes / "a.stl").write_text(
        f"solid a\nfacet normal 0 0 1\nouter loop\n{corners}endloop\nendfacet\nendsolid a\n"
    )
    file = tmp_path / "arm.urdf"
    file.write_text(
        '<robot name="t"><link name="base"><visual><geometry><mesh filename="package://named/meshes/a.stl"/>'
        "</geometry></visual></link></robot>"
    )
    arm = rtb.models.URDF.URDFRobot(file, extra_packages={"named": str(tmp_path / "folder")})
    assert type(arm.links[0].geometry[0]).__name__ == "Mesh"


def test_shallow_copies_of_a_robot_have_their_own_links(rtb: Any) -> None:
    """As in the toolbox: `copy.copy` copies the links, and their dynamics are those of the copy."""
    robot = rtb.models.DH.Puma560()
    before = robot.gravload(robot.qn)
    duplicate = copy.copy(robot)
    assert duplicate.links[1] is not robot.links[1] and duplicate.links[1].robot is duplicate
    np.testing.assert_array_equal(duplicate.gravload(robot.qn), before)
    duplicate.links[1].m = 100.0
    assert abs(duplicate.gravload(robot.qn)[1]) > 2.0 * abs(before[1])
    np.testing.assert_array_equal(robot.gravload(robot.qn), before)


def test_links_beside_a_robot_are_copied_once(rtb: Any) -> None:
    robot = rtb.models.DH.Puma560()
    robot.favourite = robot.links[3]
    duplicate, link = copy.deepcopy([robot, robot.links[2]])
    assert link is duplicate.links[2] and duplicate.favourite is duplicate.links[3]
