"""Questions about DH robots, dynamics and the models, asked of the toolbox and of its face alike."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

RNG = np.random.default_rng(3)
Q, QD, QDD = RNG.uniform(-1.2, 1.2, (3, 3, 6))


def _torques(robot: Any, q: Any, qd: Any, qdd: Any) -> dict[str, Any]:
    out = {"rne": robot.rne(q, qd, qdd), "inertia": robot.inertia(q), "gravload": robot.gravload(q)}
    out["still"] = robot.rne(q, 0.0 * qd, qdd)
    out["friction"] = robot.friction(qd)
    out["itorque"] = robot.itorque(q, qdd)
    out["accel"] = robot.accel(q, qd, 10.0 * qdd)
    out["other gravity"] = robot.gravload(q, gravity=[1.0, 2.0, 3.0])
    return out


def puma(rtb: Any, sm: Any) -> dict[str, Any]:
    """The Puma 560, with motors and friction."""
    robot = rtb.models.DH.Puma560()
    out: dict[str, Any] = {
        "table": str(robot).replace(", geometry", ""),
        "links": [str(a) for a in robot.links],
    }
    out["ets"] = str(robot.ets())
    out["reprs"] = [repr(a) for a in robot.links]
    out["parameters"] = np.array([robot.theta, robot.d, robot.a, robot.alpha, robot.offset])
    out["spherical"] = [robot.isspherical(), robot.mdh]
    for i in range(3):
        q, qd, qdd = Q[i], QD[i], QDD[i]
        out |= {f"{k} {i}": v for k, v in _torques(robot, q, qd, qdd).items()}
        out[f"coriolis {i}"] = robot.coriolis(q, qd)
        out[f"fext {i}"] = robot.rne(q, qd, qdd, fext=[1, 2, 3, 0.1, 0.2, 0.3])
        out[f"fkine {i}"] = np.asarray(robot.fkine(q).A)
        out[f"fkine all {i}"] = np.asarray(robot.fkine_all(q).A)
        out[f"jacob0 {i}"], out[f"jacobe {i}"] = robot.jacob0(q), robot.jacobe(q)
        out[f"jacob0 dot {i}"] = robot.jacob0_dot(q, qd)
        out[f"hessian0 {i}"] = robot.hessian0(q)
        out[f"asada {i}"] = robot.manipulability(q, method="asada")
        out[f"A {i}"] = np.asarray(robot.A([1, 3], q).A)
    for name in ("rne", "coriolis", "gravload", "inertia", "accel"):
        rows = {"rne": (Q, QD, QDD), "coriolis": (Q, QD), "accel": (Q, QD, QDD)}.get(name, (Q,))
        out[f"{name} many"] = getattr(robot, name)(*rows)
    q = Q[0]
    out["inertia_x"] = robot.inertia_x(q)
    out["gravload_x"] = robot.gravload_x(q)
    for frame in ("base", "ee"):
        out[f"capacity {frame}"] = robot.payload_capacity(
            q, [56.0, 97.0, 52.0, 10.0, 10.0, 10.0], [3, -2, -9.81, 0.1, 0.2, 0.3], frame
        )
    free = robot.nofriction()
    out["free"] = free.rne(q, QD[0], QDD[0])
    out["freer"] = robot.nofriction(viscous=True).rne(q, QD[0], QDD[0])
    moved = free.fdyn(0.3, robot.qn, dt=0.1)
    out["fdyn t"], out["fdyn q"], out["fdyn qd"] = moved.t, moved.q, moved.qd
    pushed = free.fdyn(
        0.2, robot.qn, Q=lambda r, t, q, qd, k: k * np.sin(t) * np.ones(6), Q_args={"k": 2.0}, dt=0.1
    )
    out["pushed"] = pushed.q
    robot.payload(2.5, [0, 0, 0.1])
    out["payload"] = robot.gravload(q)
    robot.links[2].m = 7.0
    out["heavier"] = robot.gravload(q)
    robot.base = sm.SE3(1, 0, 0) * sm.SE3.Rx(0.4)
    out["tilted"] = robot.gravload(q)
    out["tilted fkine"] = np.asarray(robot.fkine(q).A)
    out["tilted jacob0"] = robot.jacob0(q)
    robot.tool = sm.SE3(0, 0, 0.2)
    out["tool"] = np.asarray(robot.fkine(q).A)
    robot.gravity = [0, 0, 3.0]
    out["moon"] = robot.gravload(q)
    return out


def own(rtb: Any, sm: Any) -> dict[str, Any]:
    """Robots made by hand: both conventions, slides, offsets, flips, frames."""
    solid = {"m": 1.0, "r": [0.1, 0.2, 0.3], "I": [1, 2, 3, 0.1, 0.2, 0.3]}
    standard = rtb.DHRobot(
        [
            rtb.RevoluteDH(a=1, qlim=[-1, 1], offset=0.2, **solid),
            rtb.PrismaticDH(theta=0.3, offset=0.1, qlim=[0, 2], Jm=0.1, G=10, B=0.2, Tc=0.3, **solid),
            rtb.RevoluteDH(alpha=0.2, d=0.4, **solid),
        ],
        name="zz",
        tool=sm.SE3(0, 0, 0.1),
    )
    modified = rtb.DHRobot(
        [
            rtb.RevoluteMDH(a=1, alpha=0.3, d=0.2, Jm=0.1, G=-10, B=0.2, Tc=[0.3, -0.2], **solid),
            rtb.PrismaticMDH(theta=0.3, qlim=[0, 2], **solid),
            rtb.RevoluteMDH(offset=0.4, **solid),
        ],
        name="mm",
    )
    out: dict[str, Any] = {}
    q, qd, qdd = Q[0][:3], QD[0][:3], QDD[0][:3]
    for robot in (standard, modified):
        out[f"{robot.name} ets"] = str(robot.ets())
        out[f"{robot.name} links"] = [str(a) for a in robot.links]
        out[f"{robot.name} fkine"] = np.asarray(robot.fkine(q).A)
        out[f"{robot.name} jacob0"] = robot.jacob0(q)
        out |= {f"{robot.name} {k}": v for k, v in _torques(robot, q, qd, qdd).items()}
    flipped = rtb.DHRobot([rtb.RevoluteDH(a=1, flip=True), rtb.RevoluteDH(a=0.5, offset=0.2, flip=True)])
    out["flipped"] = np.asarray(flipped.fkine([0.3, 0.4]).A)
    tilted = rtb.PoERevolute([0, 0.6, 0.8], [1, 0, 0])
    screws = [rtb.PoERevolute([0, 0, 1], [0, 0, 0]), tilted, rtb.PoEPrismatic([1, 0, 0])]
    poe = rtb.PoERobot(screws, sm.SE3(2, 0, 0) * sm.SE3.Rx(0.2))
    out["poe"] = np.asarray(poe.fkine(q).A)
    out["poe jacob0"], out["poe jacobe"] = poe.jacob0(q), poe.jacobe(q)
    ET, Link = rtb.ET, rtb.Link
    a = Link(ET.Rz(jindex=0), name="a", m=1, r=[0.1, 0, 0], I=[1, 2, 3])
    b = Link(ET.tx(1) * ET.Rx(jindex=1), name="b", parent=a, m=2, r=[0.5, 0, 0], I=[1, 2, 3, 0, 0, 0])
    c = Link(
        ET.tx(1) * ET.ty(jindex=2, qlim=[0, 1]),
        name="c",
        parent=b,
        m=1,
        r=[0.5, 0.1, 0],
        I=[1, 2, 3, 0, 0, 0],
    )
    robot = rtb.Robot([a, b, c], name="two", gravity=[0, -9.81, 0])
    out["frames table"] = str(robot)
    out["frames rne"] = robot.rne(q, qd, qdd)
    out["frames inertia"] = robot.inertia(q)
    out["frames fkine"] = np.asarray(robot.fkine(q).A)
    turned = Link(ET.tx(1) * ET.Ry(0.3) * ET.Rx(jindex=1), name="turned")
    fixed = Link(ET.tx(1) * ET.tz(2), name="fixed")
    out["frames Ts"] = np.array([b.Ts, turned.Ts, fixed.Ts])
    out["frames kinds"] = [
        f"{link.name} {link.v} {link.isjoint} {link.isrevolute} {link.isprismatic} {link.isflip} {link.jindex}"
        for link in (a, b, c, turned, fixed)
    ]
    out["frames A"] = np.array([np.asarray(link.A(0.3).A) for link in (a, b, c, turned)])
    return out


def models(rtb: Any, sm: Any) -> dict[str, Any]:
    """Every model: what it is called, and its kinematics at random configurations."""
    out: dict[str, Any] = {}
    rng = np.random.default_rng(11)
    tree = "LBR Puma560 px100 px150 rx150 rx200 vx300 vx300s wx200 wx250 wx250s AL5D FrankieOmni"
    names = [("DH", n) for n in sorted(rtb.models.DH.__all__)]
    names += [("ETS", n) for n in ("Panda", "Frankie", "Puma560", "GenericSeven", "XYPanda", "Planar2")]
    names += [("URDF", n) for n in tree.split()]
    for room, name in names:
        robot = getattr(getattr(rtb.models, room), name)()
        q = rng.uniform(-1.0, 1.0, robot.n)
        key = f"{room} {name}"
        out[f"{key} words"] = [robot.name, robot.manufacturer, robot.structure]
        out[f"{key} configs"] = np.concatenate([np.zeros(1), *robot.configs.values()])
        end = {} if robot.nbranches == 1 or len(robot.grippers) == 1 else {"end": robot.ee_links[0].name}
        out[f"{key} fkine"] = np.asarray(robot.fkine(q, **end).A)
        out[f"{key} jacob0"] = robot.jacob0(q, **end)
        if room == "DH" and robot.hasdynamics and name != "P8":
            out[f"{key} rne"] = robot.rne(q, 0.3 * q, 0.2 * q)
        if room == "DH":
            out[f"{key} links"] = [a.name for a in robot.links]
    return out


PARTS: dict[str, Callable[[Any, Any], dict[str, Any]]] = {"puma": puma, "own": own, "models": models}
