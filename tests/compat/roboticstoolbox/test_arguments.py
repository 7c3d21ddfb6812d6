"""Arguments of the Robotics Toolbox package have their effect: given matrices are used, limits come in pairs."""

from __future__ import annotations

import importlib
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from support.compat_packages import using
from ulna.errors import InputError

pytest.importorskip("spatialmath")
Q = np.array([0.1, -0.4, 0.2, -2.0, 0.3, 1.9, 0.6])
ELSEWHERE = Q + 0.2


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


def test_given_jacobians_are_used(panda: Any, puma: Any) -> None:
    J0, Je, H = panda.jacob0(ELSEWHERE), panda.jacobe(ELSEWHERE), panda.hessian0(ELSEWHERE)
    for arm in (panda, panda.ets()):
        np.testing.assert_allclose(arm.hessian0(J0=J0), H, atol=1e-12)
        np.testing.assert_allclose(arm.hessian0(Q, J0=J0), H, atol=1e-12)
        np.testing.assert_allclose(arm.hessiane(Je=Je), panda.hessiane(ELSEWHERE), atol=1e-12)
    np.testing.assert_allclose(puma.hessian0(None, puma.jacob0(Q[:6])), puma.hessian0(Q[:6]), atol=1e-12)
    np.testing.assert_allclose(panda.jacobm(J=J0), panda.jacobm(ELSEWHERE), atol=1e-12)
    np.testing.assert_allclose(
        panda.jacobm(J=J0, axes="trans"), panda.jacobm(ELSEWHERE, axes="trans"), atol=1e-12
    )
    np.testing.assert_allclose(panda.jacobm(Q, H=panda.hessian0(Q)), panda.jacobm(Q), atol=1e-12)
    rate = panda.jacob0_dot(None, Q, J0=J0)
    np.testing.assert_allclose(rate, panda.jacob0_dot(ELSEWHERE, Q), atol=1e-12)
    with pytest.raises(TypeError, match="`q` is None"):
        panda.jacob0_dot(None, Q)
    with pytest.raises(ValueError, match=r"\(6, 7\)"):
        panda.hessian0(J0=J0[:, :5])


def test_a_given_pose_turns_the_jacobian_of_a_dh_robot(puma: Any) -> None:
    q = Q[:6]
    T = puma.fkine(q + 0.3)
    np.testing.assert_allclose(puma.jacob0(q, T)[:3], T.R @ puma.jacobe(q)[:3], atol=1e-12)
    np.testing.assert_allclose(puma.jacob0_analytical(q), puma.jacob0(q), atol=0)
    both = [puma.jacob0_analytical(q, "eul", puma.fkine(q)), puma.jacob0_analytical(q, "eul")]
    np.testing.assert_allclose(*both, atol=1e-12)
    assert np.abs(puma.jacob0_analytical(q, "eul", T) - both[0]).max() > 0.01


def test_given_matrices_of_operational_space_are_used(puma: Any) -> None:
    q, v = Q[:6], np.arange(6.0)
    Ji = np.linalg.inv(puma.jacob0_analytical(q + 0.2, "rpy/xyz"))
    np.testing.assert_allclose(puma.inertia_x(q, Ji=Ji), Ji.T @ puma.inertia(q) @ Ji, atol=1e-9)
    np.testing.assert_allclose(puma.gravload_x(q, Ji=Ji), Ji.T @ puma.gravload(q), atol=1e-9)
    plain = puma.coriolis_x(q, v)
    np.testing.assert_allclose(puma.coriolis_x(q, v, pinv=True), plain, atol=1e-6)
    eye, J = np.eye(6), np.linalg.inv(Ji)
    for name, matrix in (("J", J), ("Ji", Ji), ("Jd", eye), ("C", eye), ("Mx", eye)):
        assert np.abs(puma.coriolis_x(q, v, **{name: matrix}) - plain).max() > 1e-3, name
    np.testing.assert_allclose(puma.coriolis_x(q, v, J=J), puma.coriolis_x(q, v, Ji=Ji), atol=1e-9)


def test_two_rows_of_torques_are_a_pair_of_limits(puma: Any) -> None:
    q, weight = np.array([0.0, 0.3, 0.2, 0.3, 0.5, 0.2]), [0.0, 0.0, -1.0, 0.0, 0.0, 0.0]
    low, high = np.full(6, -100.0), np.full(6, 150.0)
    pair = puma.payload_capacity(q, np.vstack([low, high]), weight)
    assert pair.shape == (1, 6)
    one = [puma.payload_capacity(q, limit, weight) for limit in (-low, high)]
    load = -puma.jacob0(q).T @ weight
    np.testing.assert_allclose(pair[0], np.where(load > 0.0, one[1][0], one[0][0]))
    with pytest.raises(ValueError, match="least and greatest"):
        puma.payload_capacity(q, np.ones((3, 6)), weight)


def test_times_of_trajectories_count_from_the_first(rtb: Any) -> None:
    from_zero = np.linspace(0.0, 2.0, 9)
    for law in (rtb.quintic, rtb.trapezoidal):
        expected = law(1, 2, from_zero)
        for begin in (5.0, -1.0):
            shifted = law(1, 2, from_zero + begin)
            np.testing.assert_array_equal(shifted.t, from_zero + begin)
            for name in ("q", "qd", "qdd"):
                np.testing.assert_allclose(getattr(shifted, name), getattr(expected, name), atol=1e-12)
            several = rtb.mtraj(law, [1, 0], [2, 3], from_zero + begin)
            np.testing.assert_allclose(several.q[:, 0], expected.q, atol=1e-12)
            assert several.q[-1] == pytest.approx([2, 3])
    with pytest.raises(ValueError, match="from 0 on"):
        rtb.jtraj([0.0], [1.0], np.linspace(-1, 1, 4))


def test_rows_of_q0_begin_a_search_each(panda: Any) -> None:
    goal = panda.fkine(Q)
    far = np.array([2.5, 1.5, -2.5, -0.2, 2.5, 3.5, -2.5])
    near = Q + 1e-3
    one = panda.ikine_LM(goal, q0=near, slimit=2)
    rows = panda.ikine_NR(goal, q0=np.vstack([far, near]), slimit=2, ilimit=8, pinv=True)
    alone = panda.ikine_NR(goal, q0=far, slimit=1, ilimit=8, pinv=True)
    assert one.success and rows.success and not alone.success
    assert np.abs(rows.q - Q).max() < 0.01 and rows.searches == 2
    with pytest.raises(ValueError, match="slimit"):
        panda.ikine_LM(goal, q0=np.tile(near, (3, 1)), slimit=2)
    with pytest.raises(ValueError, match="q0"):
        panda.ik_LM(goal, q0=np.vstack([far, near]))


def test_settings_of_solvers_have_their_effect(rtb: Any, panda: Any, capsys: Any) -> None:
    # kq counts where joints are near their limits, as two are here
    near = np.array([0.1, -0.4, 0.2, -0.25, 0.3, 0.2, 0.6])
    goal, chain, begin = panda.fkine(near), panda.ets(), near + 0.05
    for other in ({"kj": 1e-4}, {"ks": 1e4}, {"kq": 2.0}, {"km": 10.0}):
        mine = rtb.IK_QP(**({"kj": 1.0, "ks": 1.0} | other)).solve(chain, goal, begin)
        method = panda.ikine_QP(goal, q0=begin, **other)
        plain = panda.ikine_QP(goal, q0=begin)
        assert mine.success and np.array_equal(mine.q, method.q), other
        assert np.abs(mine.q - plain.q).max() > 1e-6, other
    assert rtb.IK_LM().name == "LM (Chan λ=1.0)"
    assert rtb.IK_NR(pinv=True, kq=1.0, km=1.0).name == "NR (pinv=True) Σ Jm"
    assert not capsys.readouterr().out
    panda.ikine_LM(goal, q0=Q, verbose=True)
    assert "reached" in capsys.readouterr().out
    with pytest.raises(ValueError):
        panda.ik_NR(goal, mask=[1, 1, 1])
    with pytest.raises(TypeError):
        panda.ik_LM(goal, nonsense=1)
    lost = panda.ikine_GN(goal, pinv=False)
    assert not lost.success and "pinv=True" in lost.reason


def test_a_chain_with_joints_needs_coordinates(rtb: Any, panda: Any) -> None:
    with pytest.raises(ValueError, match=r"\(7,\)"):
        panda.ets().fkine(None)
    with pytest.raises(ValueError):
        panda.ets().eval()
    assert rtb.ETS(rtb.ET.tx(2)).fkine(None).t == pytest.approx([2, 0, 0])


def test_robots_in_the_plane_begin_and_end_at_the_links_passed(rtb: Any) -> None:
    """Planar2: two links of 1 m; `link1` begins at the end of the first, `start` before the transforms of its link."""
    flat, q = rtb.models.ETS.Planar2(), np.array([0.3, -0.8])
    c, s = np.cos(q[0]), np.sin(q[0])
    c2, s2 = np.cos(q.sum()), np.sin(q.sum())
    np.testing.assert_allclose(
        flat.fkine(q).A, [[c2, -s2, c + c2], [s2, c2, s + s2], [0, 0, 1]], rtol=0, atol=1e-15
    )
    middle = [[c2, -s2, c], [s2, c2, s], [0, 0, 1]]
    np.testing.assert_allclose(flat.fkine(q, end="link1").A, middle, rtol=0, atol=1e-15)
    np.testing.assert_array_equal(flat.qz, [0, 0])
    np.testing.assert_allclose(flat.qb, [0, np.pi / 2])
    c1, s1 = np.cos(q[1]), np.sin(q[1])
    last = [[c1, -s1, 1 + c1], [s1, c1, s1], [0, 0, 1]]
    np.testing.assert_allclose(flat.fkine(q, start="link1").A, last, rtol=0, atol=1e-15)
    np.testing.assert_allclose(flat.jacobe(q), [[np.sin(q[1]), 0], [1 + c1, 1], [1, 1]], rtol=0, atol=1e-15)
    np.testing.assert_allclose(flat.jacob0(q, end="link1"), [[-s, 0], [c, 0], [1, 1]], rtol=0, atol=1e-15)
    np.testing.assert_allclose(flat.jacob0(q), [[-s - s2, -s2], [c + c2, c2], [1, 1]], rtol=0, atol=1e-15)
    assert [str(axis) for axis in flat.ets(end="link1")] == [str(axis) for axis in flat.ets()][:3]


def test_a_robot_with_shapes_is_taught_in_the_viewer_where_there_is_a_screen(
    panda: Any, puma: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("viser")
    monkeypatch.delenv("SWIFT_HEADLESS", raising=False)
    for robot in (panda, puma):
        monkeypatch.setattr(type(robot), "_teach_in_viewer", lambda *_: "viewer")
        monkeypatch.setattr(type(robot), "_teach_in_figure", lambda *_: "figure")
    for screen, where in ((True, "viewer"), (False, "figure")):
        monkeypatch.setattr("ulna.viewer.page.browser.has_screen", lambda screen=screen: screen)
        assert panda.hasgeometry and panda.teach(block=False) == where
        assert panda.teach(block=False, backend="pyplot") == "figure"
        assert panda.teach(block=False, backend="swift") == "viewer"
    monkeypatch.setattr("ulna.viewer.page.browser.has_screen", lambda: True)
    assert puma.teach(block=False) == "figure"


def test_what_is_recommended_instead_of_an_absent_name_exists(rtb: Any, panda: Any, puma: Any) -> None:
    """By the name that is not offered: the owner of what is recommended, and its name."""
    for name, (owner, other) in {
        "ikine_LMS": (panda, "ikine_LM"),
        "ikine_min": (panda, "ikine_QP"),
        "pay": (panda, "payload"),
        "paycap": (panda, "payload_capacity"),
        "URDF_read": (rtb.models.URDF, "URDFRobot"),
        "ikine_a": (puma, "analytic_ik"),
        "ikine_6s": (panda.ulna, "ik_all"),
        "analytic_ik": (panda.ulna, "ik_all"),
        "ikine_analytic": (panda.ulna, "ik_all"),
        "twists": (rtb, "PoERobot"),
    }.items():
        with pytest.raises(AttributeError, match=rf"`{name}` of a robot is not offered; use .*\b{other}\b"):
            getattr(panda, name)
        assert hasattr(owner, other)


def test_newton_and_gauss_reach_poses_of_arms_with_few_joints(rtb: Any) -> None:
    ET = rtb.ET
    chain = ET.tz(0.5) * ET.Rz() * ET.tx(0.4) * ET.Ry() * ET.tz(0.3) * ET.tx(qlim=[0, 1]) * ET.Rx(0.3)
    q = np.array([0.2, -0.4, 0.3])
    for solve in (chain.ik_NR, chain.ik_GN):
        solution = solve(chain.fkine(q), q0=q + 0.05)
        assert solution.success
        np.testing.assert_allclose(solution.q, q, atol=1e-3)


def test_as_there_in_smaller_things(rtb: Any, puma: Any) -> None:
    q = puma.qn
    assert puma.inertia(q[None]).shape == (6, 6) and puma.rne(q[None], q[None], q[None]).shape == (6,)
    assert puma.nofriction().name == "NF/Puma 560" and "dynamics" in puma.keywords
    assert rtb.trapezoidal(0, 1, 5).tblend == pytest.approx(4 / 3)
    assert rtb.RevoluteDH(0.1, 0.2, 0.3, 0.1, [-1, 1], True).isflip
    link = rtb.Link(rtb.ET.Rz(), m=1.0, I=[0.1, 0.2, 0.3, 0.01, 0.02, 0.03])
    assert "I=[0.1, 0.2, 0.3, 0.01, 0.03, 0.02]" in str(link)
    assert type(rtb.models.ETS.Planar2().fkine_all([0.1, 0.2])).__name__ == "SE2"
    with pytest.warns(UserWarning, match="several ends"):
        assert rtb.models.ETS.Planar_Y().ets().n == 4
    chain = rtb.ETS(rtb.ET.Rz()) * rtb.ET.tx(1)
    assert chain.manipulability([0.1], method="minsingular") == pytest.approx(np.sqrt(2.0))
    with pytest.raises(TypeError, match="ET2"):
        chain.append(rtb.ET2.R())


def test_unknown_angles_are_no_quarter_turns(rtb: Any) -> None:
    sympy = pytest.importorskip("sympy")
    n = sympy.Symbol("n", integer=True)
    for angle in (n * sympy.pi / 2, sympy.nan, sympy.oo, np.nan, np.inf, -np.inf):
        axes = rtb.ET.Rz(angle) * rtb.ET.tx(1.0)
        with pytest.raises(InputError, match="not exactly one of them is a constant quarter turn"):
            axes.swap(0)
    for angle, place in ((sympy.pi / 2, [0, 1, 0]), (-np.pi / 2, [0, -1, 0]), (5 * sympy.pi, [-1, 0, 0])):
        axes = rtb.ET.Rz(angle) * rtb.ET.tx(1.0)
        axes.swap(0)
        assert axes[1].axis == "Rz"
        np.testing.assert_allclose(np.array(axes.fkine([]).A, dtype=float)[:3, 3], place, atol=1e-15)


def test_a_wrench_on_the_last_link_may_be_a_row_or_a_column(puma: Any) -> None:
    q, wrench = Q[:6], np.arange(6.0)
    expected = puma.rne(q, q, q) + puma.jacobe(q).T @ wrench
    for given in (wrench, wrench[None], wrench[:, None], list(wrench)):
        np.testing.assert_allclose(puma.rne(q, q, q, fext=given), expected, atol=1e-12)


def test_one_joint_takes_a_number_for_its_torque(rtb: Any) -> None:
    arm = rtb.DHRobot([rtb.RevoluteDH(a=1.0, m=2.0, r=[-0.5, 0, 0], Jm=0.1)])
    np.testing.assert_allclose(arm.accel([0.3], [0.1], 2.0), arm.accel([0.3], [0.1], [2.0]))
