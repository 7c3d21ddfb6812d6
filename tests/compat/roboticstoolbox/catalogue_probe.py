"""Questions about every model of the catalogue, asked of the toolbox and of its face alike."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

BY_PARAMETERS = (
    "AL5D Ball Baxter Cobra600 Coil Hyper Hyper3d IRB140 Jaco KR5 LWR4 Mico Orion5 P8 Panda Planar2 Planar3 Puma560 "
    "Sawyer Stanford TwoLink UR10 UR3 UR5"
)
TREES = "LBR Puma560 px100 px150 rx150 rx200 vx300 vx300s wx200 wx250 wx250s AL5D FrankieOmni Panda"
ERRORS = {
    False: (ValueError, AttributeError, TypeError, IndexError),
    True: (),
}  # where the toolbox fails nothing is compared
SINGULAR = ("Ball", "Coil", "Hyper", "Hyper3d", "Planar_Y")  # wherever they are: no angles, no gradients
CHAINS = ("Panda", "Frankie", "Puma560", "GenericSeven", "XYPanda", "Planar_Y")
ALIKE = (
    *("Coil", "Hyper3d", "IRB140", "Jaco", "LWR4", "Mico", "Orion5", "TwoLink", "UR10", "UR3"),
    *("px150", "rx150", "rx200", "vx300", "wx200"),
)
"""Models with the structure of another one in the list: of them poses and Jacobians are compared, which have all their numbers."""


def everyone(rtb: Any, rooms: str = "DH ETS URDF") -> Iterator[tuple[str, Any, Any, dict[str, Any]]]:
    """Name, robot, a configuration within the limits, and which end is meant where there are several."""
    names = {"DH": BY_PARAMETERS.split(), "ETS": CHAINS, "URDF": TREES.split()}
    draw = np.random.default_rng(5)
    for room in rooms.split():
        for name in names[room]:
            robot = getattr(getattr(rtb.models, room), name)()
            low, high = robot.qlim if room != "ETS" else (-np.ones(robot.n), np.ones(robot.n))
            low, high = np.maximum(low, -3.0), np.minimum(high, 3.0)
            q = low + (high - low) * draw.uniform(0.3, 0.7, robot.n)
            single = robot.nbranches == 1 or len(robot.grippers) == 1
            yield f"{room} {name}", robot, q, {} if single else {"end": robot.ee_links[0].name}


def derivatives(rtb: Any, sm: Any) -> dict[str, Any]:
    """Jacobians, Hessians and what is made of them."""
    out: dict[str, Any] = {}
    for key, robot, q, end in everyone(rtb):
        out[f"{key} fkine"] = np.asarray(robot.fkine(q, **end).A)
        out[f"{key} jacob0"], out[f"{key} jacobe"] = robot.jacob0(q, **end), robot.jacobe(q, **end)
        if room_of(key) != "ETS":
            out[f"{key} qlim"] = robot.qlim
        if key.endswith(ALIKE):
            continue
        out[f"{key} hessian0"] = robot.hessian0(q, **end)
        turned = robot.ets() if room_of(key) == "DH" else robot  # theirs of DH robots forgets the tool
        out[f"{key} hessiane"] = turned.hessiane(q, **end)
        if robot.n >= 6 and not end and not key.endswith(SINGULAR):
            out[f"{key} dot"] = robot.jacob0_dot(q, 0.1 + 0.2 * q)
            for name in ("rpy/xyz", "rpy/zyx", "eul", "exp"):
                out[f"{key} analytical {name}"] = robot.jacob0_analytical(q, name)
            for method in ("yoshikawa", "minsingular", "invcondition"):
                for axes in ("all", "trans", "rot", [True, True, True, True, True, False]):
                    out[f"{key} {method} {axes}"] = robot.manipulability(q, method=method, axes=axes)
            out[f"{key} jacobm"] = robot.jacobm(q)
        if room_of(key) == "DH" and robot.n <= 7:
            third, all_of = robot.partial_fkine0(q, 3), range(robot.n)
            ordered = [(a, b, c) for c in all_of for a in all_of for b in all_of if max(a, b) <= c]
            out[f"{key} third"] = np.array(
                [third[a, b, :, c] for a, b, c in ordered]
            )  # theirs is right in order
    return out


def room_of(key: str) -> str:
    """Where it stands in the catalogue: "DH", "ETS" or "URDF"."""
    return key.split(maxsplit=1)[0]


def weights(rtb: Any, sm: Any) -> dict[str, Any]:
    """The dynamics of every model with masses."""
    out: dict[str, Any] = {}
    for key, robot, q, end in everyone(rtb, "DH URDF"):
        if not robot.hasdynamics or end or key in ("DH P8", "URDF Panda", "URDF FrankieOmni"):
            continue
        qd, qdd = 0.3 + 0.1 * q, 0.2 - 0.1 * q
        asked = {
            "rne": lambda r: r.rne(q, qd, qdd),  # noqa: B023
            "inertia": lambda r: r.inertia(q),  # noqa: B023
            "gravload": lambda r: r.gravload(q),  # noqa: B023
            "coriolis": lambda r: r.coriolis(q, qd),  # noqa: B023
            "friction": lambda r: r.friction(qd),  # noqa: B023
            "itorque": lambda r: r.itorque(q, qdd),  # noqa: B023
            "jointdynamics": lambda r: _without_motors(r, r.jointdynamics(q)),  # noqa: B023
        }
        if np.linalg.cond(robot.inertia(q)) < 1e6:  # some have joints that move no mass
            asked["accel"] = lambda r: r.accel(q, qd, qdd)  # noqa: B023
        for name, ask in asked.items():
            with contextlib.suppress(*ERRORS["for-roboticstoolbox" in rtb.__file__]):
                out[f"{key} {name}"] = ask(robot)
    return out


def _without_motors(robot: Any, found: Any) -> Any:
    """J and B of each joint; the toolbox counts the motor's inertia twice, which the first factor takes off."""
    joints = [link for link in robot.links if link.isjoint]
    theirs = "for-roboticstoolbox" not in type(robot).rne.__code__.co_filename
    twice = [link.Jm if theirs else 0.0 for link in joints]
    return np.array([[J - extra, B] for (_, (J, B)), extra in zip(found, twice, strict=True)])


def operational_space(rtb: Any, sm: Any) -> dict[str, Any]:
    """Operational space, of arms with six joints and with more."""
    out: dict[str, Any] = {}
    for name, q in (
        ("Puma560", [0.1, 0.5, -2.4, 0.3, 0.6, 0.2]),
        ("Stanford", [0.3, 0.8, 0.6, 0.4, 0.9, -0.5]),
    ):
        robot = getattr(rtb.models.DH, name)().nofriction(viscous=True)
        at, qd = np.array(q), np.array([0.1, -0.2, 0.3, 0.2, -0.1, 0.4])
        xd = robot.jacob0_analytical(at, "rpy/xyz") @ qd
        for words in ("rpy/xyz", "rpy/zyx", "eul"):
            key = f"{name} {words}"
            out[f"{key} inertia_x"] = robot.inertia_x(at, representation=words)
            out[f"{key} coriolis_x"] = robot.coriolis_x(at, qd, representation=words)
            out[f"{key} gravload_x"] = robot.gravload_x(at, representation=words)
            xd = robot.jacob0_analytical(at, words) @ qd
            wrench = np.array([1.0, 2.0, 3.0, 0.1, 0.2, 0.3])
            out[f"{key} accel_x"] = robot.accel_x(at, xd, wrench, representation=words)
        w = [3, -2, -9.81, 0.1, 0.2, 0.3]
        for frame in ("base", "ee"):
            out[f"{name} capacity {frame}"] = robot.payload_capacity(at, 200.0 * np.ones(6), w, frame)
        out[f"{name} rubs"] = robot.friction(qd)
        laden = getattr(rtb.models.DH, name)()  # theirs of a copy changes the original
        laden.payload(1.5, [0.0, 0.01, 0.1])
        out[f"{name} payload"] = laden.gravload(at)
    return out


def words(rtb: Any, sm: Any) -> dict[str, Any]:
    """Tables of links, parameters, masses; graphs."""
    out: dict[str, Any] = {}
    for key, robot, q, _ in everyone(rtb):
        table = str(robot).replace(", geometry", "").replace(", collision", "").replace(", dynamics", "")
        if key not in (
            "URDF FrankieOmni",
            "DH Baxter",
            "DH Orion5",
            "DH P8",
            "DH TwoLink",
        ):  # see docs: bases, hands
            out[f"{key} table"] = [table.replace("-0°", " 0°")]
        out[f"{key} degrees"] = np.concatenate([robot.todegrees(q), robot.toradians(q)])
        out[f"{key} kinds"] = [
            robot.structure,
            *map(str, robot.revolutejoints),
            *map(str, robot.prismaticjoints),
        ]
        if key in ("DH P8", "URDF FrankieOmni"):  # children twice there; two grippers in one
            continue
        out[f"{key} counts"] = [
            robot.n,
            robot.nlinks,
            robot.nbranches,
            len(robot.links),
            *map(int, _limits(robot, q)),
        ]
        out[f"{key} links"] = [
            f"{a.name} {a.parent_name} {a.isjoint} {a.isrevolute} {a.nchildren}" for a in robot.links
        ]
        if room_of(key) == "DH":
            out[f"{key} unique"] = [_printed(robot.dhunique)]
            if np.array_equal(robot.base.A, np.eye(4)):  # which theirs forgets
                out[f"{key} twists"] = np.array(robot.twists(q)[0].data)
            if robot.hasdynamics:
                out[f"{key} masses"] = [_printed(robot.dynamics).replace("-0,", " 0,")]
                out[f"{key} weights"] = [link.dyn(indent=3).replace(" -0 ", "  0 ") for link in robot.links]
        plain = all(link.name.isidentifier() for link in robot.links)
        for form in ("dot", "mermaid", "mermaid_fenced") if plain else ("mermaid",):
            out[f"{key} {form}"] = [robot.graph(form)]
        if plain:
            stream = io.StringIO()
            robot.dotfile(stream, etsbox=True, jtype=True, static=False)
            out[f"{key} boxes"] = [stream.getvalue(), robot.graph("dot", ets="brief")]
        out[f"{key} hierarchy"] = [_printed(robot.hierarchy)]
    return out


def _limits(robot: Any, q: Any) -> list[bool]:
    return [bool(x) for x in robot.islimit(q + 2.0)] if hasattr(robot, "d") else []


def _printed(show: Callable[[], None]) -> str:
    text = io.StringIO()
    with contextlib.redirect_stdout(text):
        show()
    return text.getvalue().rstrip()


def goals(rtb: Any, sm: Any) -> dict[str, Any]:
    """Inverse kinematics: reachable poses are reached, of the whole pose and of parts of it."""
    out: dict[str, Any] = {}
    for key, robot, q, end in everyone(rtb):
        if end or robot.n < 6 or key.endswith(SINGULAR):
            continue
        chain, start = robot.ets(), q + 0.05
        T = np.asarray(chain.eval(q))
        for name in ("ik_LM", "ik_NR", "ik_GN") if key in ("DH Puma560", "URDF Panda") else ("ik_LM",):
            options = {} if name == "ik_LM" else {"pinv": True}
            found = getattr(chain, name)(T, q0=start, **options)
            reached = np.abs(np.asarray(chain.eval(found.q)) - T).max() < 5e-3
            out[f"at least {key} {name}"] = float(bool(found.success) and reached)
        if key not in ("DH Puma560", "DH LWR4", "ETS GenericSeven", "URDF Panda"):
            continue
        found = chain.ik_LM(T, q0=start, mask=[1, 1, 1, 0, 0, 0])
        out[f"at least {key} place"] = float(
            np.abs(np.asarray(chain.eval(found.q))[:3, 3] - T[:3, 3]).max() < 3e-3
        )
    panda = rtb.models.Panda()
    T = panda.fkine(panda.qr + 0.2)
    for name in ("ikine_LM", "ikine_NR", "ikine_GN"):
        options = {} if name == "ikine_LM" else {"pinv": True}
        out[f"at least {name}"] = float(getattr(panda, name)(T, q0=panda.qr, **options).success)
    chain = panda.ets()
    for k, solver in enumerate(
        (
            rtb.IK_LM(),
            rtb.IK_LM(k=0.1, method="sugihara"),
            rtb.IK_LM(k=0.01, method="wampler", mask=[1, 1, 0.5, 1, 0, 1]),
            rtb.IK_NR(pinv=True),
            rtb.IK_GN(pinv=True),
        )
    ):
        E, q = solver.step(chain, T.A, panda.qr.copy())
        out[f"step {k}"] = np.array([E, *q])
        e, E = solver.error(chain.eval(panda.qr), T.A)
        out[f"error {k}"] = np.array([E, *e])
    return out


PARTS: dict[str, Callable[[Any, Any], dict[str, Any]]] = {
    "derivatives": derivatives,
    "weights": weights,
    "operational_space": operational_space,
    "words": words,
    "goals": goals,
}
