"""Questions to ask of the toolbox and of its face alike."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

RNG = np.random.default_rng(7)
Q = RNG.uniform(-1.0, 1.0, (4, 7)) * [1.5, 1.0, 1.5, 0.8, 1.5, 1.0, 1.5] + [0, 0, 0, -1.7, 0, 1.6, 0]
QD = RNG.normal(size=(4, 7))


def _pose(T: Any) -> Any:
    return np.asarray(T.A)


def panda(rtb: Any, sm: Any) -> dict[str, Any]:
    """The Panda's kinematics."""
    robot = rtb.models.Panda()
    out: dict[str, Any] = {"n": robot.n, "qlim": robot.qlim, "qr": robot.qr, "qz": robot.configs["qz"]}
    out["names"] = [link.name for link in robot.links]
    out["all names"] = list(robot.link_dict)
    out["structure"] = robot.structure
    out["nlinks"] = robot.nlinks
    out["ets"] = str(robot.ets())
    out["table"] = str(robot).split("\n", 1)[1]
    tool = sm.SE3(0.1, 0.2, 0.3) * sm.SE3.Rx(0.4)
    for i, q in enumerate(Q):
        out[f"fkine {i}"] = _pose(robot.fkine(q))
        out[f"fkine end {i}"] = _pose(robot.fkine(q, end="panda_link5"))
        out[f"fkine start {i}"] = _pose(robot.fkine(q, start="panda_link2", end="panda_link5"))
        out[f"fkine up {i}"] = _pose(robot.fkine(q, start="panda_link5", end="panda_link2"))
        out[f"fkine tool {i}"] = _pose(robot.fkine(q, tool=tool))
        out[f"fkine all {i}"] = np.asarray(robot.fkine_all(q).A)
        out[f"jacob0 {i}"] = robot.jacob0(q)
        out[f"jacob0 tool {i}"] = robot.jacob0(q, tool=tool)
        out[f"jacob0 part {i}"] = robot.jacob0(q, start="panda_link2", end="panda_link5")
        out[f"jacobe {i}"] = robot.jacobe(q)
        out[f"jacobe link {i}"] = robot.jacobe(q, end=robot.links[4])
        out[f"hessian0 {i}"] = robot.hessian0(q)
        out[f"hessiane {i}"] = robot.hessiane(q)
        out[f"jacob0 dot {i}"] = robot.jacob0_dot(q, QD[i])
        for name in ("rpy/xyz", "rpy/zyx", "eul", "exp"):
            out[f"analytical {name} {i}"] = robot.jacob0_analytical(q, name)
        for method in ("yoshikawa", "minsingular", "invcondition"):
            for axes in ("all", "trans", "rot"):
                out[f"{method} {axes} {i}"] = robot.manipulability(q, method=method, axes=axes)
        out[f"jacobm {i}"] = robot.jacobm(q)
        out[f"degrees {i}"] = robot.todegrees(q)
    out["fkine many"] = np.asarray(robot.fkine(Q).A)
    out["eval row"], out["jacob0 row"] = robot.ets().eval(Q[:1]), robot.jacob0(Q[:1])
    out["eval many"] = robot.ets().eval(Q)
    robot.base = sm.SE3(1, 2, 3) * sm.SE3.Rz(0.5)
    out["fkine base"] = _pose(robot.fkine(Q[0]))
    out["fkine no base"] = _pose(robot.fkine(Q[0], include_base=False))
    out["jacob0 base"] = robot.jacob0(Q[0])
    robot.tool = tool
    out["fkine own tool"] = _pose(robot.fkine(Q[0]))
    out["jacobe own tool"] = robot.jacobe(Q[0])
    return out


def chains(rtb: Any, sm: Any) -> dict[str, Any]:
    """Chains of transforms: words, changes of form, kinematics."""
    ET, ET2 = rtb.ET, rtb.ET2
    e = ET.tz(1) * ET.Rx(0.5) * ET.Rx(0.2) * ET.tx(1) * ET.Rz(flip=True) * ET.tz(3) * ET.ty(qlim=[0, 1])
    q = np.array([0.3, 0.4])
    out: dict[str, Any] = {
        "words": [str(e), str(e.inv()), str(e.compile()), str(e.merged(1)), str(e.swapped(4))]
    }
    out["words"] += [str(e.fixjoint(0, 0.3)), str(e[1:5]), str(e[0]), str(e[4]), e.structure]
    out["words"] += [str(e.replaced(i, "z")) for i in range(7)] + [
        str(part) for part in e.split() if len(part)
    ]
    out["words"] += [str(ET.SE3(sm.SE3(1, 2, 3) * sm.SE3.Rx(0.3))), str(ET.Rz(30, "deg"))]
    out["counts"] = [e.n, e.m, len(e), *e.jindices, *e.joint_idx()]
    out["s"] = np.array([et.s for et in e])
    out["eval"] = e.eval(q)
    out["replaced"] = e.replaced(1, "z").replaced(3, "y").eval(q)
    out["inverse"] = e.inv().eval(q)
    out["jacob0"] = e.jacob0(q)
    out["jacobe"] = e.jacobe(q)
    out["hessian0"] = e.hessian0(q)
    out["base and tool"] = e.eval(q, base=sm.SE3(1, 0, 0), tool=sm.SE3(0, 0, 1))
    out["A"] = np.array([et.A(0.3) if et.isjoint else et.A() for et in e])
    out["qlim"] = e.qlim
    swapped = rtb.ETS([ET.Rz(jindex=1), ET.tx(1), ET.Rx(jindex=0)])
    out["swapped"] = swapped.eval(q)
    out["swapped J"] = swapped.jacob0(q)
    far = ET.Rz(jindex=2) * ET.tx(1) * ET.Rz(jindex=3)
    out["far"] = far.eval([0, 1, 0.3, 0.4])
    out["far own"] = far.eval([0.3, 0.4])
    out["constant"] = rtb.ETS(ET.Rz(0.3)).eval()
    e2 = ET2.R() * ET2.tx(1) * ET2.R() * ET2.ty(2) * ET2.tx(qlim=[0, 1])
    q2 = [0.1, 0.2, 0.3]
    out["words"] += [str(e2), str(e2.inv()), str(e2[0]), str(e2[1])]
    out["planar"] = e2.eval(q2)
    out["planar jacob0"] = e2.jacob0(q2)
    out["planar jacobe"] = e2.jacobe(q2)
    robot = rtb.Robot(ET.Rz() * ET.tx(1) * ET.Rz() * ET.tx(1), name="x", manufacturer="m")
    out["table"] = str(robot)
    out["robot"] = _pose(robot.fkine([0.1, 0.2]))
    planar = rtb.Robot2(e2, name="flat")
    out["planar robot"] = np.asarray(planar.fkine(q2).A)
    out["planar robot J"] = planar.jacob0(q2)
    return out


def trajectories(rtb: Any, sm: Any) -> dict[str, Any]:
    """Trajectories and servoing."""
    a, b = Q[0], Q[1]
    out: dict[str, Any] = {}
    for name, t in (("count", 11), ("times", np.linspace(0.0, 2.0, 11))):
        for law, made in (
            ("jtraj", rtb.jtraj(a, b, t)),
            ("jtraj rates", rtb.jtraj(a, b, t, QD[0], QD[1])),
            ("mtraj quintic", rtb.mtraj(rtb.quintic, a, b, t)),
            ("mtraj trapezoidal", rtb.mtraj(rtb.trapezoidal, a, b, t)),
            ("quintic", rtb.quintic(0.2, 1.4, t, 0.1, -0.2)),
            ("trapezoidal", rtb.trapezoidal(0.2, 1.4, t)),
        ):
            out[f"{law} {name} t"], out[f"{law} {name} q"], out[f"{law} {name} qd"] = made.t, made.q, made.qd
            if "trapezoidal" not in law:
                out[f"{law} {name} qdd"] = made.qdd
            out[f"{law} {name} words"] = str(made)
        out[f"ctraj {name}"] = np.asarray(rtb.ctraj(sm.SE3(1, 2, 3), sm.SE3.Rx(1.0) * sm.SE3.Ry(0.4), t).A)
    out["ctraj s"] = np.asarray(rtb.ctraj(sm.SE3(1, 2, 3), sm.SE3.Rx(1.0), s=[0, 0.3, 1]).A)
    out["trapezoidal V"] = rtb.trapezoidal(0.0, 1.0, 21, V=0.06).q
    out["quintic_func"] = np.array(rtb.quintic_func(0.0, 1.0, 5.0)(2.0))
    points = np.array([[0, 0], [1, 2], [3, 1.0], [2, 0.5]])
    for name, options in (("qdmax", {"qdmax": [2, 1]}), ("tsegment", {"tsegment": [1.0, 2.0, 1.5]})):
        made = rtb.mstraj(points, dt=0.1, tacc=0.2, **options)
        out[f"mstraj {name} t"], out[f"mstraj {name} q"], out[f"mstraj {name} arrive"] = (
            made.t,
            made.q,
            made.arrive,
        )
    T, goal = sm.SE3(1, 2, 3) * sm.SE3.RPY(0.1, 0.2, 0.3), sm.SE3(1.1, 2.2, 2.9) * sm.SE3.RPY(0.4, 0.1, 0.2)
    for method in ("rpy", "angle-axis"):
        for gain in (1, 2.5, [1, 2, 3, 4, 5, 6]):
            v, arrived = rtb.p_servo(T, goal, gain, 0.5, method)
            out[f"p_servo {method} {gain}"] = np.array([*v, arrived])
    out["p_servo arrays"] = rtb.p_servo(T.A, goal.A, 1.0, 0.5)[0]
    out["angle_axis"] = rtb.angle_axis(T.A, goal.A)
    out["null"] = np.abs(rtb.null(rtb.models.Panda().jacob0(a)))
    out["jacobian_numerical"] = np.round(rtb.jacobian_numerical(lambda x: x * x, np.array([1.0, 2.0])), 6)
    return out


PARTS: dict[str, Callable[[Any, Any], dict[str, Any]]] = {
    "panda": panda,
    "chains": chains,
    "trajectories": trajectories,
}
