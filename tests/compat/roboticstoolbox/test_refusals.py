"""What the Robotics Toolbox package refuses, with a message that names it; former names that still work, with a warning."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Iterator
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from support.compat_packages import using
from ulna.errors import InputError

pytest.importorskip("spatialmath")


@pytest.fixture(scope="module")
def rtb() -> Iterator[Any]:
    with using("roboticstoolbox"):
        yield importlib.import_module("roboticstoolbox")


@pytest.fixture(scope="module")
def named(rtb: Any) -> Any:
    """What the calls below speak of."""
    from spatialmath import SE3

    E = rtb.ET
    puma = rtb.models.DH.Puma560()
    chain = E.Rz() * E.tx(1.0) * E.Ry() * E.tx(0.5)
    bare = rtb.Robot([rtb.Link(E.Rz(), name="a"), rtb.Link(E.tx(1.0) * E.Rz(), name="b", parent="a")])
    return SimpleNamespace(
        rtb=rtb,
        E=E,
        E2=rtb.ET2,
        SE3=SE3,
        puma=puma,
        q=np.zeros(6),
        chain=chain,
        bare=bare,
        panda=rtb.models.Panda(),
    )


REFUSED: list[tuple[Callable[[Any], Any], str]] = [
    (lambda n: n.E.Rz("q1", jindex=2), "says `jindex`"),
    (lambda n: n.rtb.Robot([n.rtb.Link(n.E.Rz()), 3]), "3 is no link; expected links"),
    (lambda n: n.E.Rz("q0_"), "counts from 1"),
    (lambda n: n.E.Rz(qlim=[1]), r"\(2,\)"),
    (lambda n: setattr(n.E.SE3(n.SE3(1, 2, 3)), "param", 1.0), "whole pose"),
    (lambda n: setattr(n.E.tx(1.0), "offset", 1.0), "no joint"),
    (lambda n: n.E.Rz(jindex=-1), "0 or more"),
    (lambda n: n.chain.hessian0([0, 0], J0=np.zeros((3, 3))), "6"),
    (lambda n: n.chain.jacob0_analytical([0, 0], "nothing"), "nothing"),
    (lambda n: n.chain.manipulability([0, 0], method="nothing"), "measure of manipulability"),
    (lambda n: n.chain.manipulability([0, 0], axes="nothing"), "choice of axes"),
    (lambda n: n.chain.manipulability([0, 0], axes=[True]), "six truth values"),
    (lambda n: n.rtb.ETS([n.E.tx(1.0), 3]), "ET"),
    (lambda n: n.rtb.ETS([n.E.Rz(jindex=1), n.E.Rz(), n.E.Rz(jindex=0)]), "`jindex`"),
    (lambda n: n.rtb.ETS(n.E.tz()).qlim, "no limits"),
    (lambda n: n.chain.insert(0, 3), "ET"),
    (lambda n: n.rtb.ETS(n.E.Rz() * n.E.tx(1.0)).merged(5), "expected 0 to 0"),
    (lambda n: n.puma.rne(n.q[:3], n.q, n.q), r"6"),
    (lambda n: n.puma.rne(n.q, n.q, n.q, gravity=[1, 2]), r"\(3,\)"),
    (lambda n: n.bare.rne([0, 0], [0, 0], [0, 0]), "mass|dynamics|inertia"),
    (lambda n: n.puma.accel(n.q, n.q, 5.0), r"`torque` has shape \(\); expected \(6,\)"),
    (lambda n: n.puma.accel(n.q, n.q, [5.0]), r"`torque` has shape \(1,\); expected \(6,\)"),
    (lambda n: n.puma.accel(n.q, n.q, np.ones((6, 1))), r"`torque` has shape \(6, 1\); expected \(6,\)"),
    (lambda n: n.puma.accel(n.q, 1.0, n.q), r"`qd` has shape \(\); expected \(6,\)"),
    (lambda n: n.puma.accel(n.q, n.q, n.q + np.nan), r"`torque\[0\]` is nan"),
    (lambda n: n.puma.itorque(n.q, np.ones(3)), r"`qdd` has shape \(3,\); expected \(6,\)"),
    (lambda n: n.puma.itorque(n.q, 1.0), r"`qdd` has shape \(\); expected \(6,\)"),
    (lambda n: n.puma.itorque(n.q, n.q + np.nan), r"`qdd\[0\]` is nan"),
    (lambda n: n.puma.itorque(n.q, n.q + 1j), "`qdd` is .*; expected numbers"),
    (lambda n: n.puma.rne(n.q, n.q + 1j, n.q), "`qd` is .*; expected numbers"),
    (lambda n: n.puma.rne(n.q, [None] * 6, n.q), "`qd` is .*None.*; expected numbers"),
    (lambda n: n.puma.friction(["1"] * 6), "`qd` is .*'1'.*; expected numbers"),
    (lambda n: n.puma.rne(n.q, n.q, n.q, fext=np.ones(3)), r"`fext` has shape \(3,\); expected \(6,\)"),
    (lambda n: n.puma.rne(n.q, n.q, n.q, fext=1j * np.ones(6)), "`fext` is .*; expected numbers"),
    (lambda n: n.puma.gravload(n.q, [0, 0, 9.81j]), "`gravity` is .*; expected numbers"),
    (lambda n: n.puma.jacob0_dot(None, n.q), "`q`"),
    (lambda n: n.puma.manipulability(), "Neither `q` nor `J`"),
    (lambda n: n.puma.fdyn(1.0, np.zeros(3)), r"\(6,\)"),
    (lambda n: n.puma.fdyn(1.0, np.zeros(6), solver="nothing"), "solver"),
    (lambda n: n.puma.fdyn(np.nan, n.q), "`T` is nan; expected finite"),
    (lambda n: n.puma.fdyn(np.inf, n.q), "`T` is inf; expected finite"),
    (lambda n: n.puma.fdyn("1", n.q), "`T` is '1'; expected numbers"),
    (lambda n: n.puma.fdyn(None, n.q), "`T` is None; expected numbers"),
    (lambda n: n.puma.fdyn([0.0, 1.0], n.q), r"`T` has shape \(2,\); expected one number"),
    (lambda n: n.puma.fdyn(0.1, "qn"), "`q0` is 'qn'; expected numbers"),
    (lambda n: n.puma.fdyn(0.1, None), "`q0` is None; expected numbers"),
    (lambda n: n.puma.fdyn(0.1, 1j * n.q), "`q0` is .*; expected numbers"),
    (lambda n: n.puma.fdyn(0.1, n.q + np.nan), r"`q0\[0\]` is nan"),
    (lambda n: n.puma.fdyn(0.1, n.q, qd0=n.q + np.inf), r"`qd0\[0\]` is inf"),
    (lambda n: n.puma.fdyn(0.1, n.q, qd0=np.zeros(5)), r"`qd0` has shape \(5,\); expected \(6,\)"),
    (lambda n: n.puma.fdyn(0.1, n.q, dt=0), "`dt` is 0; expected a time above 0"),
    (lambda n: n.puma.fdyn(0.1, n.q, dt=-0.01), "`dt` is -0.01; expected a time above 0"),
    (lambda n: n.puma.fdyn(-0.1, n.q, dt=0.01), "`dt` is 0.01; expected a time below 0, as `T` = -0.1"),
    (lambda n: n.puma.fdyn(0.1, n.q, dt=np.nan), "`dt` is nan"),
    (lambda n: n.puma.fdyn(0.1, n.q, dt="a"), "`dt` is 'a'"),
    (lambda n: n.puma.fdyn(0.1, n.q, lambda *_: np.zeros(5)), r"`Q\(...\)` has shape \(5,\); expected \(6,\)"),
    (lambda n: n.puma.fdyn(0.1, n.q, lambda *_: None), r"`Q\(...\)` is None; expected numbers"),
    (lambda n: n.puma.fdyn(0.1, n.q, lambda *_: n.q + np.nan), r"`Q\(...\)\[0\]` is nan"),
    (lambda n: n.puma.fdyn(0.1, n.q, lambda *_: n.q, Q_args=(2,)), r"`Q_args` is \(2,\); expected a dict"),
    (lambda n: n.puma.fdyn(0.1, n.q, solver_args=[1]), r"`solver_args` is \[1\]; expected a dict"),
    (lambda n: n.puma.fdyn(0.1, n.q, solver_args={"rtol": np.nan}), r"`solver_args\['rtol'\]` is nan"),
    (lambda n: n.puma.fdyn(0.1, n.q, solver_args={"atol": n.q + np.nan}), r"`solver_args\['atol'\]` is nan"),
    (lambda n: n.puma.fdyn(0.1, n.q, solver_args={"max_step": "a"}), "`max_step` is 'a'"),
    (lambda n: n.puma.fkine(n.q, end="nothing"), "nothing"),
    (lambda n: n.panda.fkine(n.panda.qr, end="nothing"), "No link|link"),
    (lambda n: n.panda.fkine(n.panda.qr, end=3), "is no link"),
    (lambda n: n.panda["nothing"], "nothing"),
    (lambda n: n.panda.addconfiguration("a", [1, 2]), r"\(7,\)"),
    (lambda n: setattr(n.panda, "control_mode", "x"), "'p', 'v' or 'a'"),
    (lambda n: setattr(n.panda, "q", [1, 2]), r"\(7,\)"),
    (lambda n: setattr(n.bare, "qlim", [[0], [1]]), r"\(2, 2\)"),
    (lambda n: setattr(n.bare.links[0], "parent", 3), "expected a link, or its name"),
    (lambda n: n.rtb.Link(n.E.tx(1.0), name="rigid").qlim.shape, "NoneType"),
    (lambda n: n.rtb.Link(n.E.Rz(), I=np.arange(9.0).reshape(3, 3)), "not symmetric"),
    (lambda n: n.rtb.Link(n.E.Rz(), I=[1, 2]), "Ixx"),
    (lambda n: n.rtb.Link(n.E.Rz(), Tc=[-0.5, 0.5]), r"Tc\+"),
    (lambda n: n.rtb.Link(n.E.Rz(), r=[1, 2]), r"\(3,\)"),
    (lambda n: n.rtb.Link(n.E.Rz(), parent=3), "expected a link, or its name"),
    (lambda n: n.rtb.Link(n.E.Rz() * n.E.tx(1.0)), "one joint at most, at the end"),
    (lambda n: n.rtb.Robot([3]), "is no link"),
    (lambda n: n.rtb.Robot([n.rtb.Link(name="a"), n.rtb.Link(name="a")]), "Two links are named 'a'"),
    (lambda n: n.rtb.Robot([n.rtb.Link(name="a", parent="b")]), "'b'"),
    (lambda n: n.rtb.Robot([n.rtb.Link(n.E.Rz(jindex=0), name="a"), n.rtb.Link(n.E.Rz(), name="b", parent="a")]), "`jindex`"),
    (lambda n: n.rtb.Robot(3), "3"),
    (lambda n: n.rtb.DHRobot([]), "at least one link"),
    (lambda n: n.rtb.DHRobot([n.rtb.RevoluteDH(), n.rtb.RevoluteMDH()]), "one convention"),
    (lambda n: n.rtb.DHRobot([n.rtb.RevoluteDH()], meshdir="there"), "no data file 'there'"),
    (lambda n: n.rtb.Gripper([]), "at least one link"),
    (lambda n: n.rtb.Gripper([3]), "link"),
    (lambda n: n.bare.ikine_LM(n.SE3(), mask=[1, 1]), r"\(6,\)"),
    (lambda n: n.rtb.IK_LM(mask=[1, 1]), r"\(6,\)"),
    (lambda n: n.bare.vellipse([0, 0], opt="nothing"), "'trans' or 'rot'"),
    (lambda n: n.bare.plot([0, 0, 0]), r"\(2,\) or \(m, 2\)"),
    (lambda n: n.bare.plot([0, 0], backend="nothing"), "backend"),
    (lambda n: n.bare.plot_ellipse(3), "llipse"),
    (lambda n: n.bare.dotfile("x", ets="nothing"), "'full' or 'brief'"),
    (lambda n: n.rtb.models.catalog(mtype="nothing"), "kind of model"),
    (lambda n: n.rtb.models.catalog(sorton="nothing"), "column"),
    (lambda n: n.rtb.models.DH.Nothing, "Nothing"),
    (lambda n: n.rtb.models.ETS.Nothing, "Nothing"),
    (lambda n: n.rtb.models.URDF.Nothing, "Nothing"),
    (lambda n: n.rtb.models.Nothing, "Nothing"),
    (lambda n: n.rtb.nothing, "nothing"),
    (lambda n: n.rtb.models.DH.Puma560(nothing=1), "nothing"),
    (lambda n: n.rtb.quintic(0, 1, [[0, 1]]), "times"),
    (lambda n: n.rtb.quintic(0, 1, 1), "at least 2 steps"),
    (lambda n: n.rtb.quintic(0, 1, "a"), "a count, or times"),
    (lambda n: n.rtb.mtraj(n.rtb.quintic, [0, 1], [1], 5), r"\(2,\)"),
    (lambda n: n.rtb.jtraj([0, 1], [1], 5), "q"),
    (lambda n: n.rtb.ctraj(n.SE3(), n.SE3(), t=5, s=[0, 1]), "one of them"),
    (lambda n: n.rtb.ctraj(n.SE3(), n.SE3()), "one of them"),
    (lambda n: n.rtb.mstraj([[0], [1]], 0.1, 0.2), "one of them"),
    (lambda n: n.rtb.rtb_get_param("missing"), "missing"),
    (lambda n: n.rtb.rtb_load_matfile("nothing.mat"), r"nothing\.mat"),
    (lambda n: n.rtb.backends.nothing, "nothing"),
]  # fmt: skip


@pytest.mark.parametrize("i", range(len(REFUSED)))
def test_it_is_refused(named: Any, i: int) -> None:
    call, text = REFUSED[i]
    with pytest.raises((ValueError, TypeError, AttributeError, LookupError, FileNotFoundError), match=text):
        call(named)


def test_former_names_work_and_warn(named: Any, capsys: pytest.CaptureFixture[str]) -> None:
    rtb, puma, q = named.rtb, named.puma, named.q + 0.1
    with pytest.warns(DeprecationWarning, match="inertia_x"):
        np.testing.assert_array_equal(puma.cinertia(q), puma.inertia_x(q))
    with pytest.warns(DeprecationWarning, match="DHRobot"):
        assert rtb.SerialLink([rtb.RevoluteDH(a=1.0)]).n == 1
    with pytest.warns(FutureWarning, match="trapezoidal"):
        np.testing.assert_array_equal(rtb.lspb(0, 1, 5).q, rtb.trapezoidal(0, 1, 5).q)
    with pytest.warns(FutureWarning, match=r"models\.catalog"):
        rtb.models.list(mtype="ETS")
    listed = capsys.readouterr().out
    rtb.models.catalog(mtype="ETS")
    assert capsys.readouterr().out == listed
    with pytest.warns(DeprecationWarning, match="former name of ET.param"):
        et = named.E.tx(1.0)
        et.eta = 2.0
    assert et.param == 2.0
    with pytest.warns(DeprecationWarning, match="former name of ET.param"):
        assert et.eta == 2.0
    with pytest.warns(DeprecationWarning, match="former name of ET.kind"):
        assert et.axis == et.kind == "tx"
    with pytest.warns(DeprecationWarning, match="`eta` is the former name"):
        assert named.E.tx(eta=3.0).param == 3.0


def test_robots_of_the_toolbox_that_others_describe_have_its_names(rtb: Any) -> None:
    names = {"UR3", "UR5", "UR10", "PR2", "Jaco", "KinovaGen3", "Fetch", "YuMi", "Valkyrie"}
    assert names <= set(rtb.models.URDF.__all__)
    assert all(getattr(rtb.models.URDF, name).__name__ == name for name in names)


def test_modules_that_scripts_import_from_have_their_names(rtb: Any) -> None:
    from roboticstoolbox._common.module_names import PLACES  # pyright: ignore[reportMissingImports]

    assert len(PLACES) > 20 and "ET" in PLACES["ets.ET"]
    for module, names in PLACES.items():
        found = importlib.import_module(f"roboticstoolbox.{module}")
        assert all(getattr(found, name) is not None for name in names), module


@pytest.mark.parametrize(
    "call",
    [
        lambda n, q: n.puma.fkine(q),
        lambda n, q: n.puma.jacob0(q),
        lambda n, q: n.puma.ikine_LM(n.puma.fkine(n.q), q0=q),
        lambda n, q: n.rtb.jtraj(n.q, q, 5),
        lambda n, q: n.puma.rne(n.q, q, n.q),
        lambda n, q: n.puma.gravload(n.q, q[:3]),
        lambda n, q: n.chain.fkine(q[:2]),
        lambda n, q: setattr(n.puma, "q", q),
    ],
)
def test_masked_entries_are_refused(named: Any, call: Any) -> None:
    masked = np.ma.array(np.ones(6), mask=[True, False, False, False, False, False])
    with pytest.raises(InputError, match="masked array with 1 masked entry"):
        call(named, masked)
    call(named, np.ma.array(np.ones(6)))


def test_states_are_rows_or_columns(rtb: Any) -> None:
    """Matrices of as many entries were taken, in the order of their rows."""
    puma = rtb.models.DH.Puma560()
    for shape in ((6,), (1, 6), (6, 1)):
        puma.q = np.arange(6.0).reshape(shape)
        assert puma.q.tolist() == list(range(6))
    for name in ("q", "qd", "qdd"):
        with pytest.raises(InputError, match=rf"`{name}` has shape \(2, 3\); expected \(6,\)"):
            setattr(puma, name, np.zeros((2, 3)))


def test_angles_are_converted_for_all_joints_or_refused(rtb: Any) -> None:
    stanford = rtb.models.DH.Stanford()
    expected = [np.pi, np.pi, 180.0, np.pi, np.pi, np.pi]
    np.testing.assert_allclose(stanford.toradians(np.full((2, 6), 180.0)), [expected] * 2)
    np.testing.assert_allclose(stanford.todegrees(expected), np.full(6, 180.0))
    for wrong in (None, np.ones(4), 3.0):
        with pytest.raises(InputError, match="`q` "):
            stanford.todegrees(wrong)


def test_poses_out_of_reach_have_no_trajectory(rtb: Any) -> None:
    from spatialmath import SE3

    puma = rtb.models.DH.Puma560()
    T = puma.fkine([0.1, 0.7, -2.5, 0.3, 0.9, 0.2])
    end = puma.jtraj(np.zeros(6), T, 5).q[-1]
    np.testing.assert_allclose(puma.fkine(end).A, T.A, atol=1e-5)
    with pytest.raises(InputError, match="`qf` is a pose for which no configuration is found"):
        puma.jtraj(np.zeros(6), SE3(9.0, 0.0, 0.0), 5)


def test_names_of_other_attributes_are_no_configurations(rtb: Any) -> None:
    """`addconfiguration_attr("n", ...)` made an array of the number of joints."""
    puma = rtb.models.DH.Puma560()
    for name in ("n", "name", "fkine"):
        with pytest.raises(InputError, match=f"another attribute '{name}'"):
            puma.addconfiguration_attr(name, np.zeros(6))
    puma.addconfiguration_attr("mine", np.zeros(6))
    puma.addconfiguration_attr("mine", np.ones(6))
    assert puma.mine.tolist() == [1.0] * 6 == puma.configs["mine"].tolist()
