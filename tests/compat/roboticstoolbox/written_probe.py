"""Calls as scripts write them, asked of the toolbox and of its face alike."""

from __future__ import annotations

import contextlib
import importlib
import io
from collections.abc import Callable
from typing import Any

import numpy as np


def via_points(rtb: Any, sm: Any) -> dict[str, Any]:
    """Motions through points: corners of any length, slow and fast axes, speeds at both ends."""
    points = np.array([[0, 0], [1, 1], [2, 0.5], [3, 0.0]])
    square = (sm.SO2(30, unit="deg") * np.array([[-1, 1, 1, -1, -1], [1, 1, -1, -1, 1]])).T
    asked: dict[str, tuple[Any, dict[str, Any]]] = {
        "no corners": (square, {"dt": 0.2, "tacc": 0, "qdmax": [2, 1]}),
        "long corners": (square, {"dt": 0.2, "tacc": 2, "qdmax": [2, 1]}),
        "one speed": (points, {"dt": 0.1, "tacc": 0.35, "qdmax": 1.5}),
        "short segments": (points, {"dt": 0.1, "tacc": 0.3, "tsegment": [1, 2, 1]}),
        "corners one by one": (points, {"dt": 0.1, "tacc": [0.2, 0.4, 0.5], "qdmax": 1}),
        "moving": (
            points,
            {"dt": 0.1, "tacc": 0.3, "qdmax": 1, "q0": [0.2, 0.1], "qd0": [0.1, 0.2], "qdf": [0.3, 0]},
        ),
    }
    out: dict[str, Any] = {}
    for name, (through, options) in asked.items():
        made = rtb.mstraj(through, **options)
        for part in ("t", "q", "qd", "qdd", "arrive", "via"):
            out[f"{name} {part}"] = getattr(made, part)
        out[f"{name} info"] = np.array([[np.nan if x is None else x for x in row] for row in made.info])
    return out


def places(rtb: Any, sm: Any) -> dict[str, Any]:
    """Where scripts import names from."""
    out: dict[str, Any] = {}
    for place, names in {
        "roboticstoolbox.robot.ERobot": ("ERobot", "ERobot2"),
        "roboticstoolbox.robot.Robot": ("Robot", "Robot2"),
        "roboticstoolbox.robot.Link": ("Link",),
        "roboticstoolbox.robot.DHRobot": ("DHRobot",),
        "roboticstoolbox.robot.DHLink": ("DHLink", "RevoluteDH"),
        "roboticstoolbox.robot": ("DHRobot", "ET", "ETS", "Gripper", "PoERobot"),
        "roboticstoolbox.ets": ("ET", "ETS2"),
        "roboticstoolbox.tools": ("jtraj", "null", "p_servo", "xplot"),
        "roboticstoolbox.tools.p_servo": ("p_servo", "angle_axis"),
        "roboticstoolbox.tools.numerical": ("jacobian_numerical",),
        "roboticstoolbox.tools.trajectory": ("mstraj",),
    }.items():
        room = importlib.import_module(place)
        out[place] = [f"{name} {getattr(room, name) is getattr(rtb, name)}" for name in names]
    space: dict[str, Any] = {}
    exec("from roboticstoolbox import *", space)
    out["all"] = [name for name in ("DHRobot", "backends", "jtraj", "models", "mstraj") if name in space]
    out["version"] = rtb.__version__
    return out


def arms(rtb: Any, sm: Any) -> dict[str, Any]:
    """Payloads put on and off, paths of links, chains in parts, words of grippers and singular Jacobians."""
    puma, panda = rtb.models.DH.Puma560(), rtb.models.Panda()
    out: dict[str, Any] = {}
    for mass in (2.5, 1.0, 0):
        puma.payload(mass, [0, 0, 0.1])
        out[f"payload {mass}"] = puma.gravload(puma.qn)
    links, count, _ = panda.get_path(end="panda_link3")
    out["path"] = [*(link.name for link in links), str(count)]
    chain = rtb.ET.tz(1) * rtb.ET.Rz() * rtb.ET.tx(1) * rtb.ET.Ry() * rtb.ET.tx(0.5)
    for method in ("first", "last"):
        out[f"split {method}"] = [str(part) for part in chain.split(method)]
    first, second = (rtb.DHRobot([rtb.RevoluteDH(a=a, alpha=0.2)], name="arm") for a in (1, 2))
    out["joined"], out["joined fkine"] = str(first + second), np.asarray((first + second).fkine([0.1, 0.2]).A)
    screws = [rtb.PoERevolute([0, 0, 1], [0, 0, 0]), rtb.PoEPrismatic([0, 1, 0])]
    out["screws"] = str(rtb.PoERobot(screws, sm.SE3(1, 0, 0)))
    out["gripper"] = str(panda.grippers[0])
    with contextlib.redirect_stdout(io.StringIO()) as said:
        rtb.jsingu(panda.jacob0(panda.qz))
    out["singular"] = said.getvalue()
    out["A 3"] = np.asarray(puma.A(3, puma.qn).A)
    return out


PARTS: dict[str, Callable[[Any, Any], dict[str, Any]]] = {
    "via points": via_points,
    "places": places,
    "arms": arms,
}
