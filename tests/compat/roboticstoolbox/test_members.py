"""Members of chains, links and robots: as in the toolbox where it has them, and the package's additions by their effect."""

from __future__ import annotations

import importlib
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from support.compat_packages import using
from support.two_pythons import both
from ulna.errors import InputError

pytest.importorskip("spatialmath")


@pytest.fixture(scope="module")
def rtb() -> Iterator[Any]:
    with using("roboticstoolbox"):
        yield importlib.import_module("roboticstoolbox")


def _same(ours: Any, theirs: Any) -> bool:
    if isinstance(theirs, list):
        return isinstance(ours, list) and len(ours) == len(theirs) and all(map(_same, ours, theirs))
    if isinstance(theirs, str) or isinstance(ours, str):
        return ours == theirs
    return math.isclose(ours, theirs, rel_tol=1e-7, abs_tol=1e-7) or (math.isnan(ours) and math.isnan(theirs))


def test_members_answer_and_refuse_as_in_the_toolbox(tmp_path: Path) -> None:
    pytest.importorskip("roboticstoolbox")
    pytest.importorskip("sympy")
    script = Path(__file__).parent / "asked_members.py"
    ours, theirs = both(script, tmp_path, package="roboticstoolbox")
    assert not [said for said in theirs if not _same(ours[said], theirs[said])]


@pytest.fixture(scope="module")
def chain(rtb: Any) -> Any:
    E = rtb.ET
    return (
        E.tz(0.3) * E.Rx(np.pi / 2) * E.Rz() * E.tx(1.0) * E.tx(0.25) * E.Ry() * E.ty(flip=True, qlim=[0, 1])
    )


Q = np.array([0.3, -0.4, 0.2])


@pytest.mark.parametrize("i", range(6))
def test_swapped_transforms_have_the_same_pose(chain: Any, i: int) -> None:
    """Those that commute, and those of which one is a quarter turn; others are refused."""
    if i in (2, 4):  # a joint about z, or a shift along x, beside what it does not commute with
        with pytest.raises(InputError, match="do not commute"):
            chain.swapped(i)
        return
    other = chain.swapped(i)
    assert other != chain
    np.testing.assert_allclose(other.eval(Q), chain.eval(Q), atol=1e-12)
    assert len(other) == len(chain)


def test_merged_transforms_have_the_same_pose(rtb: Any, chain: Any) -> None:
    E = rtb.ET
    assert len(chain.merged(3)) == len(chain) - 1
    np.testing.assert_allclose(chain.merged(3).eval(Q), chain.eval(Q))
    assert len((E.tx(1.0) * E.tx(-1.0) * E.Rz()).merged(0)) == 1
    for pair in (E.Rz() * E.Rz(0.3), E.Rz(0.3) * E.Rz()):
        (one,) = pair.merged(0).data
        assert one.offset == pytest.approx(0.3)
        np.testing.assert_allclose(one.A(0.5), E.Rz(0.8).A())
    for wrong in (E.tx(1.0) * E.ty(1.0), E.Rz() * E.Rz(), E.SE3(np.eye(4)) * E.SE3(np.eye(4))):
        with pytest.raises(InputError, match="cannot be merged"):
            wrong.merged(0)
    for i in (-1, 6):
        with pytest.raises(InputError, match="expected 0 to 5"):
            chain.merged(i)


def test_a_fixed_joint_is_a_constant(chain: Any) -> None:
    fixed = chain.fixjoint(1, -0.4)
    assert fixed.n == 2
    np.testing.assert_allclose(fixed.eval(Q[[0, 2]]), chain.eval(Q))
    np.testing.assert_allclose(chain.fixjoint(0, np.rad2deg(0.3), "deg").eval(Q[1:]), chain.eval(Q))
    np.testing.assert_allclose(chain.fixjoint(2, 0.2).eval(Q[:2]), chain.eval(Q))  # a flipped one
    for arguments, text in (((3, 0.0), "expected 0 to 2"), ((-1, 0.0), "expected 0 to 2"), ((True, 0.0), "expected"),
                            ((0, 0.0, "turns"), "'rad' or 'deg'"), ((2, 0.0, "deg"), "slides")):  # fmt: skip
        with pytest.raises(InputError, match=text):
            chain.fixjoint(*arguments)


@pytest.mark.parametrize("convention", ["dh", "mdh"])
def test_chains_are_split_into_links_of_denavit_and_hartenberg(rtb: Any, convention: str) -> None:
    E = rtb.ET
    if convention == "dh":
        parts = [E.Rz() * E.tz(0.1) * E.tx(0.2) * E.Rx(0.3), E.Rz(0.4) * E.tz(qlim=[0, 1]) * E.Rx(0.5)]
    else:
        parts = [E.tx(0.2) * E.Rx(0.3) * E.Rz() * E.tz(0.1), E.Rx(0.5) * E.Rz(0.4) * E.tz(qlim=[0, 1])]
    before, after = E.ty(1.0) * E.Ry(0.2), E.ty(0.5)
    whole = before * parts[0] * parts[1] * after
    found = whole.split(method=convention)
    assert [str(part) for part in found] == [str(part) for part in rtb.ETS(whole).split(method=convention)]
    product = np.eye(4)
    for part in found:
        product = product @ part.eval(Q[:2] if part.n else [])
    np.testing.assert_allclose(product, whole.eval(Q[:2]), atol=1e-12)
    assert [part.n for part in found] == [0, 1, 1, 0]
    for wrong, text in ((E.tx(1.0), "no joints"), (E.Rx() * E.tx(1.0), "Rx")):
        with pytest.raises(InputError, match=text):
            (wrong * E.tx(1.0)).split(method=convention)


def test_torques_of_symbols_are_those_of_numbers(rtb: Any) -> None:
    sympy = pytest.importorskip("sympy")
    E = rtb.ET
    inertia = {"I": [0.1, 0.2, 0.3, 0.01, 0.02, 0.03], "Jm": 0.1, "B": 0.2}
    links = [
        rtb.Link(E.tz(0.3) * E.Rx(0.4) * E.Rz(), name="a", m=1.0, r=[0.1, 0.2, 0.3], G=2, **inertia),
        rtb.Link(
            E.tx(0.5) * E.Ry(flip=True), name="b", parent="a", m=2.0, r=[0.3, 0.1, 0.2], G=-3, **inertia
        ),
        rtb.Link(
            E.ty(0.2) * E.Rz(0.3) * E.tx(qlim=[0, 1]),
            name="c",
            parent="b",
            m=3.0,
            r=[0.2, 0.3, 0.1],
            G=1,
            **inertia,
        ),
    ]
    robot = rtb.Robot(links, gravity=[0.5, 1.0, 9.81])
    q, v, a = np.array([(0.3, -0.4, 0.2), (1.0, 2.0, -3.0), (-1.0, 0.5, 2.0)])
    symbols = sympy.symbols("q0:3 v0:3 a0:3")
    at = dict(zip(symbols, np.concatenate([q, v, a]), strict=True))
    torques = robot.rne(symbols[:3], symbols[3:6], symbols[6:])
    np.testing.assert_allclose([float(t.subs(at)) for t in torques], robot.rne(q, v, a), atol=1e-9)
    pushed = robot.rne(symbols[:3], symbols[3:6], symbols[6:], gravity=[1.0, 0.0, 2.0])
    expected = robot.rne(q, v, a, gravity=[1.0, 0.0, 2.0])
    np.testing.assert_allclose([float(t.subs(at)) for t in pushed], expected, atol=1e-9)
    with pytest.raises(InputError, match=r"\(3,\)"):
        robot.rne(symbols[:2], v, a)


def test_links_of_a_robot_change_with_effect(rtb: Any) -> None:
    E = rtb.ET
    links = [rtb.Link(E.Rz(), name="a"), rtb.Link(E.tx(1.0) * E.Rz(), name="b", parent="a")]
    robot = rtb.Robot(links)
    robot.links[1].qlim = [-0.5, 0.5]
    np.testing.assert_allclose(robot.qlim[:, 1], (-0.5, 0.5))
    assert robot.islimit([0.0, 0.6]) == [False, True]
    assert robot.islimit([0.0, -0.6]) == [False, True]
    assert robot.islimit([0.0, 0.5]) == [False, False]
    chain = robot.ets()
    chain.qlim = [[-1, -2], [1, 2]]
    np.testing.assert_array_equal(chain.qlim, [[-1, -2], [1, 2]])
    with pytest.raises(InputError, match=r"\(2, 2\)"):
        chain.qlim = [[1, 2]]
    single = rtb.ETS(E.Rz())
    single.qlim = (-1, 1)
    np.testing.assert_array_equal(single.qlim, [[-1], [1]])
    with pytest.raises(InputError, match="no joint, so no limits"):
        rtb.Link(E.tx(1.0), name="rigid").qlim = [0, 1]
    with pytest.raises(InputError, match="expected a link, or its name"):
        links[1].parent = 3
    with pytest.raises(InputError, match="has no limits"):
        _ = rtb.ETS(E.tz()).qlim
    assert robot.reach == 1.0
    assert rtb.Robot(rtb.ETS(E.tz(qlim=[-3, 2]) * E.tx(1.0) * E.SE3(np.diag([1, 1, 1, 1.0])))).reach == 4.0


def test_curves_are_drawn_as_they_are_asked_for(rtb: Any) -> None:
    plt = pytest.importorskip("matplotlib.pyplot")
    from roboticstoolbox.tools import xplot  # type: ignore[attr-defined]

    q = np.cumsum(np.ones((5, 6)), axis=0)
    (axes,) = xplot(q)
    assert [line.get_label() for line in axes.lines] == [f"q{k}" for k in range(6)]
    np.testing.assert_array_equal(axes.lines[2].get_xdata(), np.arange(5.0))
    np.testing.assert_array_equal(axes.lines[2].get_ydata(), q[:, 2])
    assert axes.get_xlabel() == "Time (s)" and axes.get_ylabel() == "Joint coordinates (rad,m)"
    stacked = xplot(np.arange(5) / 2, q[:, :2], stack=True, labels="left right")
    assert [a.get_ylabel() for a in stacked] == ["left", "right"]
    assert stacked[0].get_xlim() == (0.0, 2.0)
    (alone,) = xplot(q[:, 0], unwrap=True)
    assert len(alone.lines) == 1 and np.abs(np.diff(alone.lines[0].get_ydata())).max() <= np.pi
    with pytest.raises(InputError, match=r"\(5,\)"):
        xplot(np.arange(4), q)
    with pytest.raises(InputError):
        xplot(q, labels=3)
    figure = rtb.quintic(1, 3, 7).plot()
    assert [a.get_ylabel() for a in figure.axes] == ["$q(k)$", "$dq/dk$", "$d^2q/dk^2$"]
    assert figure.axes[-1].get_xlabel() == "k (step)"
    timed = rtb.jtraj(np.zeros(2), np.ones(2), np.linspace(0, 2, 9)).plot(plotargs={"marker": "x"})
    assert timed.axes[-1].get_xlabel() == "t (seconds)"
    assert timed.axes[0].lines[0].get_marker() == "x"
    assert timed.axes[0].get_xlim() == (0.0, 2.0)
    plt.close("all")


def test_a_class_of_a_script_is_printed_with_its_kind(rtb: Any) -> None:
    class Lab(rtb.DHRobot):
        def __init__(self) -> None:
            super().__init__([rtb.RevoluteDH(a=1.0)], name="arm")

    class Mine(rtb.models.DH.Puma560):
        pass

    first = "DHRobot.Lab: arm, 1 joints (R), standard DH parameters"
    assert str(Lab()).splitlines()[0] == first
    assert str(Mine()).startswith("Puma560.Mine: Puma 560")
    assert str(rtb.DHRobot([rtb.RevoluteDH(a=1.0)], name="arm")).startswith("DHRobot: arm")
