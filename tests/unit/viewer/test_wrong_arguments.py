"""Invalid values in place of one argument at a time: they raise errors of Ulna, and nothing is changed."""

import reprlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ulna
from ulna.errors import UlnaError
from ulna.geometry import Box
from ulna.sim import Body, Recording, Simulation, dynamic_step, kinematic_step, simulate
from ulna.viewer.graph.camera import Camera
from ulna.viewer.graph.theme import Theme
from ulna.viewer.mesh.surface import Surface
from ulna.viewer.robot.stick_figure import stick_figure
from ulna.viewer.viewer import Viewer

NAN, INF = float("nan"), float("inf")
OBJECTS: tuple[Any, ...] = (
    object(), {}, 1j, b"x", [[1, 2], [3]], ["a", "b", "c"], np.zeros((2, 2, 2, 2)), np.array(["a"]),
    [NAN, NAN, NAN], [1, 2], True + 0j,
)  # fmt: skip
NO_NUMBER: tuple[Any, ...] = (*OBJECTS, "x", "", NAN, INF, -INF, 10**400)
NO_LENGTH: tuple[Any, ...] = (*NO_NUMBER, None, -1.0, 0.0, 1e300, True, "1")
NO_NAME: tuple[Any, ...] = (*OBJECTS, "", "/", "a//b", 3, NAN, True)
NO_COLOUR: tuple[Any, ...] = (
    *OBJECTS, "redd", "#12", (255.0, 0.0, 0.0), (300, 0, 0), (-1.0, 0, 0), (NAN, 0, 0), 3, True,
)  # fmt: skip
NO_SHARE: tuple[Any, ...] = (*NO_NUMBER, None, -0.1, 1.1, 255, True)
NO_POSE: tuple[Any, ...] = (
    *OBJECTS, "x", 1.0, np.eye(3), np.zeros((4, 4)), np.diag([1.0, 1.0, -1.0, 1.0]), np.full((4, 4), NAN),
    np.diag([2.0, 2.0, 2.0, 1.0]), np.eye(4) + np.eye(4, k=-3), np.eye(4) + 1e300 * np.eye(4, k=3),
)  # fmt: skip
NO_PLACE: tuple[Any, ...] = (*NO_NUMBER, None, 1.0, (1, 2), (1e300, 0, 0), ((0, 0, 0),))
NO_POINTS: tuple[Any, ...] = (
    *NO_NUMBER,
    None,
    1.0,
    (1, 2, 3),
    ((1, 2), (3, 4)),
    [(NAN, 0, 0)],
    [(1e300, 0, 0)],
)
NO_FLAG: tuple[Any, ...] = (*OBJECTS, "no", "", 2, 0.5, NAN, [])
NO_WORDS: tuple[Any, ...] = (*OBJECTS, None, True, [])
NO_FUNCTION: tuple[Any, ...] = (*(o for o in OBJECTS if not callable(o)), None, "x", 3)
NO_CHOICE: tuple[Any, ...] = (*OBJECTS, "x", "", 3, True)
NO_COUNT: tuple[Any, ...] = (*NO_NUMBER, None, 0, -1, 1.5, True)
NO_Q: tuple[Any, ...] = (*NO_NUMBER, 1.0, np.zeros(6), np.full(7, NAN))
NO_PATH: tuple[Any, ...] = (*(o for o in OBJECTS if not isinstance(o, str)), 3, True, NAN, "a", "a.doc", "")
NO_RANGE: tuple[Any, ...] = (*NO_NUMBER, None, -1.0, True)

Q = np.zeros(7)
ALWAYS_REFUSED = ("remove", "remove from", "teach_panel", "html")  # without the right thing, or a page
PLAIN = (
    "add",
    "box",
    "sphere",
    "mesh",
    "copies",
    "fleet",
    "group",
    "axes",
    "arrow",
    "line",
    "points",
    "text",
    "grid",
)
COMMON = {
    "name": ("n", NO_NAME),
    "pose": (np.eye(4), NO_POSE),
    "color": ("C0", NO_COLOUR),
    "opacity": (0.5, NO_SHARE),
}
PLACED = {key: COMMON[key] for key in ("name", "pose", "opacity")}
POINTS = [(0, 0, 0), (1, 0, 0), (1, 1, 1)]


def recording() -> Recording:
    out = Recording()
    for t in (0.0, 0.1):
        out.add(t, Q)
    return out


def method(name: str, of: Callable[[Viewer], Any] = lambda v: v) -> Callable[..., Any]:
    def call(viewer: Viewer, /, **given: Any) -> None:
        getattr(of(viewer), name)(**given)

    return call


def without_viewer(function: Callable[..., Any]) -> Callable[..., Any]:
    return lambda viewer, /, **given: function(**given)


def handle(make: Callable[[Viewer], Any], **attributes: tuple[Any, Any]) -> dict[str, Any]:
    def assign(attribute: str) -> Callable[..., Any]:
        return lambda viewer, value: setattr(make(viewer), attribute, value)

    return {name: (assign(name), {"value": given}) for name, given in attributes.items()}


def cases(
    panda: ulna.Robot, folder: Path
) -> dict[str, tuple[Callable[..., Any], dict[str, tuple[Any, Any]]]]:
    """Calls by name: a function of a viewer, and for each argument what is right and what is wrong."""
    mesh = folder / "one.obj"
    mesh.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    ways = {"show": ("visual", NO_CHOICE), "detail": ("full", NO_CHOICE)}
    size = {"width": (16, NO_COUNT), "height": (10, NO_COUNT), "samples": (1, (*NO_COUNT, 5))}
    common = {
        "control": ("torque", NO_CHOICE), "limits": ("all", NO_CHOICE), "friction": (None, NO_CHOICE),
        "record": (True, NO_FLAG),
    }  # fmt: skip
    line = {"thickness": (0.01, NO_LENGTH)}
    film = {"fps": (10.0, (*NO_LENGTH, 500.0)), "speed": (1.0, (*NO_RANGE, 0.0))}
    seen = {"camera": (Camera(), (*NO_CHOICE, Camera))}
    out: dict[str, Any] = {
        name: (method(name), given)
        for name, given in {
            "add": {"thing": (panda, (*OBJECTS, None, 3, "nowhere.stl")), "q": (Q, NO_Q), **COMMON, **ways},
            "box": {"size": ((1, 1, 0.1), (*NO_PLACE, (1, 1, -1), "123")), **COMMON},
            "sphere": {"radius": (1.0, (*NO_RANGE, 1e300))},
            "ellipsoid": {"radii": ((1, 1, 1), (*NO_PLACE, (1, 1, -1)))},
            "cylinder": {"radius": (1.0, NO_RANGE), "length": (1.0, (*NO_RANGE, 1e300))},
            "capsule": {"radius": (1.0, NO_RANGE), "length": (1.0, NO_RANGE)},
            "cone": {"radius": (1.0, NO_RANGE), "length": (1.0, NO_RANGE)},
            "mesh": {"path": (mesh, (*NO_PATH, folder)), "scale": (1.0, (*NO_NUMBER, 0.0, (1, 2), 1e300)), **COMMON},
            "copies": {
                "thing": (Box((1, 1, 1)), NO_PATH), "positions": (POINTS, NO_POINTS), **PLACED,
                "colors": ((1, 0, 0), (*NO_NUMBER, (1, 2), (2.0, 0, 0), "rde")),
                "scales": (1.0, (*NO_NUMBER, 0.0, -1.0, 1e300)),
            },
            "fleet": {
                "robot": (panda, (*OBJECTS, None, "x")), "q": (np.zeros((2, 7)), (*NO_Q, Q, np.zeros((2, 6)))), **COMMON,
                "bases": (np.tile(np.eye(4), (2, 1, 1)), (*NO_NUMBER, np.eye(4), np.zeros((2, 4, 4)))), "show": ways["show"],
            },
            "group": {"name": ("g", NO_NAME), "pose": (np.eye(4), NO_POSE)},
            "axes": {"length": (0.1, NO_LENGTH), **PLACED},
            "arrow": {
                "vector": ((0, 0, 1), NO_PLACE), "start": ((0, 0, 0), NO_PLACE), "radius": (0.1, NO_LENGTH),
                "size": (0.1, NO_LENGTH), "name": ("n", NO_NAME), "color": ("k", NO_COLOUR), "opacity": (1.0, NO_SHARE),
            },
            "line": {"points": (POINTS, NO_POINTS), **line, **COMMON},
            "curve": {"points": (POINTS, NO_POINTS), "steps": (3, NO_COUNT), **line},
            "points": {
                "positions": (POINTS, NO_POINTS), "size": (0.1, NO_LENGTH), **PLACED,
                "colors": ((0, 0, 1), (*NO_NUMBER, None, (1, 2), (2.0, 0, 0), "rde", np.zeros((2, 3)))),
            },
            "text": {
                "words": ("hi", NO_WORDS), "position": ((0, 0, 0), NO_PLACE), "height": (0.1, NO_LENGTH),
                "name": ("n", NO_NAME), "color": ("k", NO_COLOUR), "opacity": (1.0, NO_SHARE),
            },
            "grid": {"size": (1.0, (*NO_LENGTH, 0.01)), "cell": (0.1, (*NO_LENGTH, 2.0, 1e-9)), **COMMON},
            "picture": {"path": (folder / "a.png", NO_PATH), **size, **seen},
            "remove": {"thing": ("there", (*NO_CHOICE, None))},
            "simulate": {
                "realtime": (False, NO_FLAG), "speed": (1.0, (*NO_RANGE, 0.0)), "substep": (1e-3, (*NO_RANGE, 0.0)), **common,
            },
            "hold": {"seconds": (0.1, (*NO_NUMBER, -1.0, True))},
            "teach_panel": {"robot": ("", (*OBJECTS, None, "x"))},
        }.items()
    }  # fmt: skip

    def with_robot(name: str) -> Callable[..., Any]:
        def call(viewer: Viewer, **given: Any) -> None:
            viewer.add(panda, show="skeleton")
            getattr(viewer, name)(**given)

        return call

    no_recording = (*OBJECTS, "x", 3)
    out["film"] = (with_robot("film"), {"path": (folder / "a.gif", NO_PATH), "motion": (recording(), no_recording), **film, **size, **seen})  # fmt: skip
    out["film of a function"] = (
        lambda v, **k: v.film(folder / "a.gif", width=8, height=8, **k),
        {"move": (lambda t: None, NO_FUNCTION), "duration": (0.1, (*NO_RANGE, 1e300))},
    )
    out["html"] = (with_robot("html"), {"path": ("", NO_PATH), "fps": (10.0, (*NO_LENGTH, 500.0))})
    out["play"] = (with_robot("play"), {"motion": (recording(), no_recording), "speed": film["speed"]})
    out["time"] = (
        lambda v, value: setattr(_timeline(v, panda), "time", value),
        {"value": (0.1, (*NO_NUMBER, None))},
    )
    out["viewer"] = (
        lambda v, **k: Viewer(page=False, **k),
        {
            "port": (0, (*NO_NUMBER, -1, 70000)), "host": ("127.0.0.1", NO_WORDS), "browser": (False, NO_FLAG),
            "title": ("t", NO_WORDS), "theme": ("dark", (*NO_CHOICE, None)), "floor": (0.0, (*NO_NUMBER, 1e300, True)),
            **seen,
        },
    )  # fmt: skip
    out["camera"] = (
        lambda v, **k: Camera(**k),
        {
            "position": ((1, 1, 1), NO_PLACE), "target": ((0, 0, 0), (*NO_PLACE, (1, 1, 1))), "fov": (0.5, (*NO_LENGTH, 4.0)),
            "up": ((0, 0, 1), (*NO_PLACE, (0, 0, 0))),
        },
    )  # fmt: skip
    out["theme"] = (
        lambda v, **k: Theme(**k),
        {"dark": (True, NO_FLAG), "top": ((0, 0, 0), (*NO_PLACE, (0, 0, 256), (0.5, 0, 0))), "light_factor": (1.0, NO_RANGE), "shadow": (0.5, NO_SHARE)},
    )  # fmt: skip
    out["surface"] = (
        lambda v, **k: v.add(Surface(**k)),
        {
            "vertices": (np.eye(3), (*OBJECTS, "x", np.full((3, 3), NAN), np.full((3, 3), 1e300))),
            "triangles": ([(0, 1, 2)], (*OBJECTS[:4], "x", [(0, 1, 3)])),
            "normals": (np.eye(3), (*OBJECTS, np.eye(2))), "rgba": ("red", NO_COLOUR),
        },
    )  # fmt: skip
    look = {**{k: v for k, v in COMMON.items() if k != "name"}, "position": ((0, 0, 1), NO_PLACE)}
    look |= {
        "scale": (2.0, (*NO_NUMBER, None, 0.0, -1.0, (1, 2), True)),
        "visible": (False, (*NO_FLAG, None)),
    }
    made: dict[str, tuple[Callable[[Viewer], Any], dict[str, Any]]] = {
        "box": (lambda v: v.box((1, 1, 1)), look),
        "a robot": (
            lambda v: v.add(panda),
            {"q": (Q, (*NO_Q, None)), "qd": (Q, (*NO_Q, None)), "show": ("skeleton", (*NO_CHOICE, None))},
        ),
        "path": (lambda v: v.line(POINTS), {"points": (POINTS, NO_POINTS)}),
        "cloud": (lambda v: v.points(POINTS), {"points": (POINTS, NO_POINTS), "colors": ((1, 0, 0), (*NO_NUMBER, (1, 2)))}),
        "words": (lambda v: v.text("x"), {"text": ("y", NO_WORDS)}),
        "crowd": (
            lambda v: v.copies(Box((1, 1, 1)), positions=POINTS),
            {
                "poses": (np.eye(4)[None], (*NO_NUMBER, None, np.eye(4), np.zeros((2, 4, 4)))),
                "positions": (POINTS, NO_POINTS), "colors": ((1, 0, 0), (*NO_NUMBER, (2.0, 0, 0))),
            },
        ),
        "arrow": (lambda v: v.arrow((0, 0, 1)), {"vector": ((1, 0, 0), NO_PLACE), "size": (0.1, NO_LENGTH)}),
        "ghosts": (lambda v: v.add(panda).ghosts([Q]), {"q": ([Q], (*NO_Q, None, Q))}),
    }  # fmt: skip
    for kind, (make, attributes) in made.items():
        out |= {f"{kind}.{name}": case for name, case in handle(make, **attributes).items()}
    frame = {"frame": (None, NO_CHOICE), "color": ("k", NO_COLOUR)}
    for name, given in {
        "frames": {"frames": ("all", (*NO_CHOICE, None)), "length": (0.1, NO_LENGTH)},
        "center_of_mass": {"radius": (0.1, NO_LENGTH)},
        "manipulability": {"frame": (None, NO_CHOICE), "size": (0.1, NO_LENGTH), "of": ("force", NO_CHOICE)},
        "trace": {**frame, "most": (100, NO_COUNT), **line},
        "force": {**frame, "vector": ((0, 0, 1), NO_PLACE), "size": (0.1, NO_LENGTH)},
        "velocity": {**frame, "size": (0.1, NO_LENGTH)},
        "ghosts": {
            "q": ([Q], (*NO_Q, None, Q)),
            "color": ("k", NO_COLOUR),
            "opacity": (0.5, (*NO_SHARE, 0.0)),
        },
    }.items():
        out[f"robot.{name}"] = (method(name, lambda v: v["arm"]), given)
    for name, (function, given) in sim_cases(panda, common).items():
        out[name] = (without_viewer(function), given)
    out |= panel_cases()
    out["stick_figure"] = (
        lambda v, **k: stick_figure(**k),
        {
            "robot": (panda, (*OBJECTS, None)), "q": (Q, NO_Q), "ax": (None, NO_CHOICE), "frames": ((), (*NO_CHOICE, None)),
            "color": ("k", NO_COLOUR), "alpha": (0.5, NO_SHARE), "tool": (True, NO_FLAG),
        },
    )  # fmt: skip
    return out


def sim_cases(panda: ulna.Robot, common: dict[str, Any]) -> dict[str, Any]:
    positive, robot = (*NO_RANGE, 0.0), (*OBJECTS, None, "x")
    errors = (*(x for x in positive if x is not None), 10**30)

    def simulation() -> Simulation:
        sim = Simulation()
        sim.add(panda, name="arm")
        return sim

    def assign(attribute: str) -> Callable[..., Any]:
        return lambda value: setattr(simulation()["arm"], attribute, value)

    state = (*NO_Q, None)
    return {
        "Simulation": (Simulation, {"realtime": (False, NO_FLAG), "speed": (1.0, positive), "substep": (0.1, positive)}),
        "step": (lambda **k: simulation().step(**k), {"dt": (0.1, (*positive, "x"))}),
        "run": (
            lambda **k: simulation().run(**k),
            {"duration": (0.1, (*positive, 1e300)), "dt": (0.1, (*positive, 1e-300)), "until": (lambda s: 1, (*NO_FUNCTION[:-3], 3))},
        ),
        "each_step": (lambda **k: simulation().each_step(**k), {"function": (str, NO_FUNCTION)}),
        "remove from": (lambda body: simulation().remove(body), {"body": (None, robot)}),
        "find in": (lambda name: simulation()[name], {"name": ("arm", (*NO_CHOICE, None))}),
        **{
            f"sim.{name}": (lambda value, name=name: setattr(simulation(), name, value), {"value": given})
            for name, given in {
                "speed": (1.0, positive), "realtime": (False, NO_FLAG), "substep": (0.1, positive), "paused": (False, NO_FLAG),
            }.items()
        },
        "Body": (Body, {"robot": (panda, robot), "q": (Q, NO_Q), "qd": (Q, NO_Q), "name": ("x", NO_WORDS[:-3]), **common}),
        **{
            f"body.{name}": (assign(name), {"value": given})
            for name, given in {
                "q": (Q, state), "qd": (Q, state), "qdd": (Q, state), "tau": (Q, state), "target": (Q, NO_Q), **common,
            }.items()
            if name != "friction"
        },
        "Recording.add": (lambda **k: Recording().add(**k), {"t": (0.0, (*NO_NUMBER, None)), "q": (Q, (*OBJECTS[:6], "x"))}),
        "Recording.at": (lambda **k: recording().at(**k), {"t": (0.0, (*NO_NUMBER, None)), "robot": (panda, (*OBJECTS, "x"))}),
        "Recording[]": (lambda name: recording()[name], {"name": ("q", (*NO_CHOICE, None))}),
        "kinematic_step": (
            kinematic_step,
            {"robot": (panda, robot), "q": (Q, state), "v": (Q, state), "dt": (0.1, (*NO_NUMBER, None))},
        ),
        "dynamic_step": (
            dynamic_step,
            {
                "robot": (panda, robot), "q": (Q, state), "v": (Q, state), "tau": (Q, state), "dt": (1e-3, positive),
                "friction": common["friction"],
            },
        ),
        "simulate by itself": (
            simulate,
            {
                "robot": (panda, robot), "q": (Q, state), "v": (Q, NO_Q), "torque": (Q, NO_Q), "duration": (1e-3, (*positive, 1e300)),
                "dt": (1e-3, (*positive, 1e-300)), "method": ("rk4", NO_CHOICE), "friction": common["friction"],
                "constraints": ((), (*OBJECTS, None, "x", 3)), "kp": (100.0, NO_RANGE), "every": (1, NO_COUNT[-5:]),
            },
        ),
        "simulate by a solver": (
            lambda **k: simulate(panda, Q, duration=1e-3, method="adaptive", **k),
            {"solver": ("RK45", NO_CHOICE), "rtol": (1e-6, errors), "atol": (1e-8, errors)},
        ),
    }  # fmt: skip


def panel_cases() -> dict[str, Any]:
    label, change = ("label", NO_WORDS), {"on_change": (str, NO_FUNCTION)}
    options = (("a", "b"), (*OBJECTS[:5], None, "ab", (), ("a", "a"), 3))
    out: dict[str, Any] = {
        name: (method(name, lambda v: v.panel), given)
        for name, given in {
            "slider": {
                "label": label, "low": (0.0, (*NO_NUMBER, None, 2.0, True)), "high": (1.0, (*NO_NUMBER, None, -2.0)), **change,
                "value": (0.5, NO_NUMBER), "step": (0.1, (*NO_RANGE[:-3], -1.0, 0.0)), "unit": ("N", NO_WORDS),
            },
            "number": {"label": label, "value": (1.0, (*NO_NUMBER, None, True)), "unit": ("N", NO_WORDS), **change},
            "checkbox": {"label": label, "value": (True, (*NO_FLAG, None)), **change},
            "select": {"label": label, "options": options, "value": ("a", NO_CHOICE[:-1]), **change},
            "radio": {"label": label, "options": options, "value": ("a", NO_CHOICE[:-1]), **change},
            "button": {"label": label, "on_click": (str, NO_FUNCTION), "hint": ("h", NO_WORDS[:11])},
            "buttons": {"label": label, "options": options, "on_click": (str, NO_FUNCTION)},
            "plot": {
                "title": label, "series": options, "seconds": (1.0, (*NO_RANGE, 0.0)), "height": (99, NO_COUNT), "unit": ("N", NO_WORDS),
            },
        }.items()
    }  # fmt: skip
    out["words of the panel"] = (lambda v, content: v.panel.text(content), {"content": ("x", NO_WORDS)})
    for kind, (make, attributes) in {
        "slider": (
            lambda v: v.panel.slider("s", 0, 1),
            {
                "value": (0.5, (*NO_NUMBER, None)),
                "low": (0.1, (*NO_NUMBER, None, 2.0)),
                "high": (2.0, (*NO_NUMBER, -1.0)),
                "limits": ((0, 1), (*NO_NUMBER[:8], None, 1.0, (1, 0), (0, INF), (0, 1, 2))),
                "step": (0.1, (*NO_RANGE, 0.0)),
                "unit": ("N", NO_WORDS),
                "label": label,
                "visible": (True, NO_FLAG),
                "disabled": (True, NO_FLAG),
            },
        ),
        "checkbox": (lambda v: v.panel.checkbox("c"), {"value": (True, (*NO_FLAG, None))}),
        "menu": (lambda v: v.panel.select("c", ("a", "b")), {"value": ("a", NO_CHOICE), "options": options}),
        "plot": (lambda v: v.panel.plot("p", ("a",)), {"seconds": (1.0, (*NO_RANGE, 0.0)), "label": label}),
    }.items():
        out |= {f"{kind} {name}": case for name, case in handle(make, **attributes).items()}
    rows = {"t": (0.0, (*NO_NUMBER, None)), "values": (1.0, (*NO_NUMBER, None, (1, 2)))}
    out["plot.add"] = (lambda v, **k: v.panel.plot("p", ("a",)).add(**k), rows)
    return out


def _timeline(viewer: Viewer, panda: ulna.Robot) -> Any:
    viewer.add(panda)
    return viewer.play(recording())


@pytest.fixture(scope="module")
def panda() -> ulna.Robot:
    return ulna.load("panda", visuals="simple")


def test_invalid_arguments_raise_ulna_errors_and_change_nothing(panda: ulna.Robot, tmp_path: Path) -> None:
    pytest.importorskip("trimesh")
    pytest.importorskip("matplotlib").use("Agg")
    pytest.importorskip("PIL")
    faults = []
    for call, (function, arguments) in cases(panda, tmp_path).items():
        right = {name: right for name, (right, _) in arguments.items()}
        trials = [("", right)] if call not in ALWAYS_REFUSED else []
        trials += [(name, right | {name: wrong}) for name, (_, some) in arguments.items() for wrong in some]
        for argument, given in trials:
            viewer = Viewer(page=False)
            if call.startswith("robot."):
                viewer.add(panda, show="skeleton", name="arm")
            before = viewer.scene.names
            what = f"{call}({argument}={reprlib.repr(given.get(argument))})"
            try:
                function(viewer, **given)
                if argument:
                    faults.append(f"{what} is accepted")
            except UlnaError as error:
                made = set(viewer.scene.names) - set(before)
                if not argument:
                    faults.append(f"{call} does not work: {error}")
                    break
                elif len(str(error)) > 1200:
                    faults.append(f"{what} says {len(str(error))} letters")
                elif made and (call in PLAIN or call.startswith("robot.")):
                    faults.append(f"{what} leaves {made}")
            except Exception as error:
                faults.append(f"{what} raises {type(error).__name__}: {error}")
                if not argument:
                    break
    assert not faults, "\n".join(faults)
