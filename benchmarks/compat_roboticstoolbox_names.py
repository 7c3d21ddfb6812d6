"""Which public names of the arm part of the Robotics Toolbox and its three companions the faces offer: a table for the docs.

Run: python benchmarks/compat_roboticstoolbox_names.py [--check | --record]

The names stand in compat_roboticstoolbox_names.json; `--record` takes them anew from the packages installed. "compared"
counts the names that a probe of tests/compat/roboticstoolbox asks both sides for. `--check` compares with what
docs/robotics_toolbox.md says, and exits with 1 where they differ, or where a name that is not supported raises without an explanation.
"""

from __future__ import annotations

import ast
import importlib
import importlib.util
import inspect
import json
import re
import subprocess
import sys
import textwrap
from pathlib import Path
from typing import Any

from _pair import environments

from ulna.compat.packages import FOLDERS

HERE = Path(__file__)
PAGE = HERE.parents[1] / "docs" / "robotics_toolbox.md"
PROBES = HERE.parents[1] / "tests" / "compat" / "roboticstoolbox"
RECORD = HERE.with_suffix(".json")
MARKS = ("<!-- names -->", "<!-- end of names -->")
CLASSES = {
    "roboticstoolbox": (
        "Robot", "Robot2", "DHRobot", "PoERobot", "Link", "Link2", "DHLink", "ET", "ET2", "ETS", "ETS2", "Gripper",
        "Trajectory", "IKSolution", "IKSolver", "IK_LM", "IK_NR", "IK_GN", "IK_QP",
    ),
    "spatialgeometry": (
        "SceneNode", "SceneGroup", "Shape", "CollisionShape", "CollisionShapeGroup", "Cuboid", "Sphere", "Cylinder",
        "Ellipsoid", "Mesh", "Axes", "Arrow", "Polyline",
    ),
    "swift": ("Swift", "AssemblyHandle", "Slider", "Button", "Label", "Select", "Checkbox", "Radio"),
    "spatialmath": (),
}  # fmt: skip
WHOLE = "spatialmath"  # the package itself runs
ALONE = "swift"  # of which there is nothing to ask in a test: its scripts are run instead

ASK = """
import importlib, json, os, sys, warnings
warnings.simplefilter("ignore")
os.environ["SWIFT_HEADLESS"] = "1"
import numpy as np, roboticstoolbox as rtb, spatialgeometry as sg, spatialmath as sm, swift
told = json.load(sys.stdin)
panda, puma, flat = rtb.models.Panda(), rtb.models.DH.Puma560(), rtb.models.ETS.Planar2()
env = swift.Swift()
env.launch(headless=True)
file = sys.argv[1]
open(file, "w").write("solid a\\nfacet normal 0 0 1\\nouter loop\\nvertex 0 0 0\\nvertex 1 0 0\\nvertex 0 1 0\\n"
                      "endloop\\nendfacet\\nendsolid a\\n")
things = {
    "Robot": panda, "Robot2": flat, "DHRobot": puma, "Link": panda.links[1], "Link2": flat.links[1],
    "PoERobot": rtb.PoERobot([rtb.PoERevolute([0, 0, 1], [0, 0, 0])], panda.base), "DHLink": puma.links[1],
    "ET": rtb.ET.Rz(), "ET2": rtb.ET2.R(), "ETS": rtb.ETS([rtb.ET.Rz()]), "ETS2": rtb.ETS2([rtb.ET2.R()]),
    "Gripper": panda.grippers[0], "IKSolution": rtb.IKSolution(np.zeros(1), True), "IK_LM": rtb.IK_LM(),
    "IKSolver": rtb.IK_LM(), "IK_NR": rtb.IK_NR(), "IK_GN": rtb.IK_GN(), "IK_QP": rtb.IK_QP(),
    "Trajectory": rtb.jtraj(panda.qz, panda.qr, 5), "SceneNode": sg.SceneNode(), "SceneGroup": sg.SceneGroup(),
    "Shape": sg.Sphere(1.0), "CollisionShape": sg.Sphere(1.0), "CollisionShapeGroup": sg.CollisionShapeGroup(),
    "Cuboid": sg.Cuboid([1, 1, 1]), "Sphere": sg.Sphere(1.0), "Cylinder": sg.Cylinder(1.0, 1.0),
    "Ellipsoid": sg.Ellipsoid([1, 1, 1]), "Mesh": sg.Mesh(file), "Axes": sg.Axes(1.0),
    "Arrow": sg.Arrow(1.0), "Polyline": sg.Polyline([[0, 1], [0, 1], [0, 1]]), "Swift": env,
    "AssemblyHandle": env.add(panda), "Slider": swift.Slider(), "Button": swift.Button(), "Label": swift.Label(),
    "Select": swift.Select(options=["a"]), "Checkbox": swift.Checkbox(options=["a"]),
    "Radio": swift.Radio(options=["a"]),
}
def word(thing, name):
    try:
        getattr(thing, name)
    except AttributeError as error:
        return None if name in getattr(type(thing), "__dict__", {}) else str(error)
    except Exception:
        return None
    return None
out = {}
for package, groups in told.items():
    for group, names in groups.items():
        room = group if group.startswith(package) else f"{package}.{group}"
        thing = things[group] if group in things else importlib.import_module(room)
        out[f"{package}: {group}"] = {name: word(thing, name) for name in names}
print(json.dumps(out))
"""


def _set_by(cls: type) -> set[str]:
    """Public names that a class gives its objects: its own, and what its methods assign to `self`."""
    names = set(dir(cls))
    for base in cls.__mro__[:-1]:
        try:
            tree = ast.parse(textwrap.dedent(inspect.getsource(base)))
        except (OSError, TypeError, IndentationError):
            continue
        for node in ast.walk(tree):
            if isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store):
                names |= (
                    {node.attr} if isinstance(node.value, ast.Name) and node.value.id == "self" else set()
                )
    return {name for name in names if not name.startswith("_")}


def _refused_as_mobile() -> set[str]:
    place = FOLDERS["roboticstoolbox"] / "roboticstoolbox" / "__init__.py"
    spec = importlib.util.spec_from_file_location("face", place)
    assert spec is not None and spec.loader is not None
    face = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(face)
    return face._MOBILE


def record() -> dict[str, dict[str, list[str]]]:
    """The names of the packages installed; of those that are not, the names recorded before."""
    known = json.loads(RECORD.read_text(encoding="utf-8")) if RECORD.is_file() else {}
    out: dict[str, dict[str, list[str]]] = {}
    for package, classes in CLASSES.items():
        try:
            module = importlib.import_module(package)
        except ImportError:
            out[package] = known[package]
            continue
        shown = getattr(module, "__all__", None) or [n for n in dir(module) if n[0].isupper()]
        groups = {package: sorted({n for n in shown if not n.startswith("_")})}
        for kind in classes:
            groups[kind] = sorted(_set_by(getattr(module, kind, None) or _found(module, kind)))
        out[package] = groups
    toolbox = out["roboticstoolbox"]
    toolbox["roboticstoolbox"] = sorted(set(toolbox["roboticstoolbox"]) - _refused_as_mobile())
    models: Any = importlib.import_module("roboticstoolbox").models
    toolbox |= {f"models.{room}": sorted(getattr(models, room).__all__) for room in ("DH", "ETS", "URDF")}
    base: Any = importlib.import_module("spatialmath.base")
    out["spatialmath"]["spatialmath.base"] = sorted(base.__all__)
    return out


def _found(module: Any, kind: str) -> type:
    """A class that the package has, but not at the top."""
    for name in ("tools.trajectory", "geom"):
        try:
            room = importlib.import_module(f"{module.__name__}.{name}")
        except ImportError:
            continue
        if hasattr(room, kind):
            return getattr(room, kind)
    raise AttributeError(kind)


def asked() -> set[str]:
    """The names that probes ask for: attributes in them, and words of lists that they go through."""
    out: set[str] = set()
    for file in sorted(PROBES.glob("*_probe.py")):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Attribute):
                out.add(node.attr)
            elif isinstance(node, ast.Constant) and isinstance(node.value, str):
                out |= {word for word in node.value.split() if word.isidentifier()}
    return out


def lines(place: str) -> tuple[str, list[str]]:
    """The table with the messages of names that are not supported, and the names that raise without one.

    Args:
        place: A file that may be written.
    """
    theirs = json.loads(RECORD.read_text(encoding="utf-8"))
    command = [sys.executable, "-c", ASK, place]
    variables, _ = environments("roboticstoolbox")
    done = subprocess.run(
        command, env=variables, input=json.dumps(theirs), stdout=subprocess.PIPE, text=True, check=True
    )
    ours: dict[str, dict[str, str | None]] = json.loads(done.stdout.splitlines()[-1])
    probed = asked()
    rows = ["| of | names | supported | compared | not supported |", "|---|---|---|---|---|"]
    messages: dict[str, list[str]] = {}
    silent, whole = [], [0, 0, 0]
    for key, answers in ours.items():
        package, group = key.split(": ")
        unsupported = {name: message for name, message in answers.items() if message is not None}
        compared = [
            name for name in answers if name in probed and name not in unsupported and package != ALONE
        ]
        listed = ", ".join(f"`{name}`" for name in unsupported)
        counts = [len(answers), len(answers) - len(unsupported), len(compared)]
        shown = {WHOLE: "the package itself", ALONE: "by scripts"}.get(package, str(counts[2]))
        rows.append(f"| `{group}` | {counts[0]} | {counts[1]} | {shown} | {listed} |")
        if package != WHOLE:
            whole = [a + b for a, b in zip(whole, counts, strict=True)]
        for name, message in unsupported.items():
            if re.search(r"has no (attribute )?'\w+'\.?$", message):
                silent.append(f"{group}.{name}")
            hint = re.sub(r"^.* has no '\w+'[.;] ", "", message)
            messages.setdefault(hint, []).append(f"`{group}.{name}`")
    share = 100 * whole[1] / whole[0]
    rows.append(f"| all, without spatialmath | {whole[0]} | {whole[1]} ({share:.1f} %) | {whole[2]} | |")
    listing = [f"- {', '.join(names)}: {message}" for message, names in messages.items()]
    return "\n".join(
        [*rows, "", "Names that raise an AttributeError, with its message:", "", *listing]
    ), silent


def main() -> int:
    """Prints the table, checks the docs, or records the names."""
    import tempfile

    if "--record" in sys.argv:
        RECORD.write_text(json.dumps(record(), indent=1) + "\n", encoding="utf-8")
        return 0
    with tempfile.TemporaryDirectory() as folder:
        table, silent = lines(str(Path(folder) / "triangle.stl"))
    if silent:
        print(f"not supported, without an explanation: {', '.join(silent)}")
    if "--check" not in sys.argv:
        print(table)
        return 0
    documented = PAGE.read_text(encoding="utf-8").split(MARKS[0])[1].split(MARKS[1])[0].strip()
    if documented != table:
        print(f"{PAGE.name} is out of date; expected:\n{table}")
    return int(documented != table or bool(silent))


if __name__ == "__main__":
    raise SystemExit(main())
