"""Robots made of the tables beside this file: numbers that makers and papers publish, in SI units and radians.

| file | rows | sources |
|---|---|---|
| dh.json | parameters of Denavit and Hartenberg, masses, motors | Puma 560: Corke & Armstrong-Helouvry 1994, A search
  for consensus; Stanford arm: Paul 1981; Panda: Gaz et al. 2019; the others: data sheets of their makers |
| ets.json, urdf.json | transforms of each link, limits, masses | URDF descriptions by the makers |

The robots are those of the Robotics Toolbox 1.5 by Corke and Haviland (MIT licence), which collected the numbers.
"""

from __future__ import annotations

import importlib.util
import json
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from roboticstoolbox._common.errors import WrongType
from roboticstoolbox._ets.elementary_transform import ET
from roboticstoolbox._ets.ets import ETS
from roboticstoolbox._links.link import Link
from roboticstoolbox._robots.dh_links import DHLink, PrismaticDH, PrismaticMDH, RevoluteDH, RevoluteMDH
from roboticstoolbox._robots.dh_robot import DHRobot
from roboticstoolbox._robots.from_model import take_shapes
from roboticstoolbox._robots.robot import BaseRobot, Robot
from ulna.errors import InputError
from ulna.typing import Floats

_KINDS = {(0, 0): RevoluteDH, (1, 0): PrismaticDH, (0, 1): RevoluteMDH, (1, 1): PrismaticMDH}
_LENGTH = {"Hyper", "Hyper3d", "Coil"}
_COILED = {"Coil"}  # the fewer joints, the more each of them turns
_SYMBOLIC = {"Puma560"}
_MESHES = {
    "IRB140": "meshes/ABB/IRB140",
    "KR5": "meshes/KUKA/KR5_arc",
    "Panda": "meshes/FRANKA-EMIKA/Panda",
    "Puma560": "meshes/UNIMATE/puma560",
}
"""Folders of the package `rtb-data`."""


def _meshes(name: str) -> str | None:
    """The folder of a robot's meshes, if the package with them is installed."""
    return _MESHES.get(name) if importlib.util.find_spec("rtbdata") else None


def _with_symbolic_angles(entry: dict[str, Any]) -> dict[str, Any]:
    """The same entry, whose angles `alpha` are fractions of SymPy's pi."""
    import sympy

    turns = [sympy.nsimplify(row.get("alpha", 0) / np.pi, rational=True) * sympy.pi for row in entry["links"]]
    return entry | {"links": [row | {"alpha": x} for row, x in zip(entry["links"], turns, strict=True)]}


@cache
def table(name: str) -> dict[str, Any]:
    """The table "dh", "ets" or "urdf"."""
    return json.loads((Path(__file__).parent / f"{name}.json").read_text(encoding="utf-8"))


def _homogeneous(twelve: Any) -> Floats:
    return np.vstack([np.reshape(np.asarray(twelve, dtype=float), (3, 4)), [0.0, 0.0, 0.0, 1.0]])


def _about(entry: dict[str, Any]) -> dict[str, Any]:
    out = {
        key: entry[key] for key in ("name", "manufacturer", "gravity", "keywords", "comment") if key in entry
    }
    return out | {key: _homogeneous(entry[key]) for key in ("base", "tool") if key in entry}


def dh_links(entry: dict[str, Any]) -> list[DHLink]:
    """The links of an entry of "dh"."""
    out = []
    for row in entry["links"]:
        fields = {k: v for k, v in row.items() if k != "sigma"}
        fields.pop("d" if row["sigma"] else "theta", None)
        out.append(_KINDS[row["sigma"], entry["mdh"]](**fields))
    return out


def _links(entry: dict[str, Any]) -> list[Link]:
    by_name: dict[str, Link] = {}
    for row in entry["links"]:
        fields = {k: v for k, v in row.items() if k not in ("ets", "parent", "name")}
        transforms = []
        for axis, value, *flip in row.get("ets", ()):
            if axis == "SE3":
                transforms.append(ET("SE3", T=_homogeneous(value)))
            else:
                transforms.append(ET(axis, value, flip=bool(flip)))
        parent = by_name.get(row.get("parent", ""))
        chain = ETS(transforms) if transforms else None
        by_name[row["name"]] = Link(chain, name=row["name"], parent=parent, **fields)
    return list(by_name.values())


def fill(robot: BaseRobot, source: str, name: str) -> None:
    """Initialises a robot from an entry of a table.

    Args:
        robot: The robot, which is changed.
        source: "ets" or "urdf".
        name: Name of the entry.
    """
    entry = table(source)[name]
    links = _links(entry)
    grippers = dict(entry.get("grippers", ()))
    gripper_roots = [link for link in links if link.name in grippers]
    Robot.__init__(robot, links, gripper_links=gripper_roots or None, **_about(entry))  # type: ignore[arg-type]
    for gripper in robot.grippers:
        gripper.tool = _homogeneous(grippers[gripper.name])
    if "qdlim" in entry:
        robot.qdlim = np.array(entry["qdlim"])
    _name(robot, entry)


def _name(robot: BaseRobot, entry: dict[str, Any]) -> None:
    for key, q in entry.get("configs", {}).items():
        robot.addconfiguration_attr(key, q)


def _shorter(name: str, entry: dict[str, Any], count: int) -> dict[str, Any]:
    """An entry with its first `count` joints."""
    most = len(entry["links"])
    if not 1 <= count <= most:
        raise InputError(f"`N` is {count}; expected 1 to {most}: the package has {name} with {most} joints.")
    configs = {key: q[:count] for key, q in entry["configs"].items()}
    return entry | {"links": entry["links"][:count], "configs": configs}


def dh_class(name: str, module: str, *more: type) -> type:
    """The class of an entry of "dh".

    Args:
        name: Name of the entry.
        module: Name of the module that the class is in.
        *more: Further base classes.

    Returns:
        The class.
    """
    entry = table("dh")[name]

    def init(self: Any, N: int | None = None, a: float | None = None, **options: Any) -> None:
        symbolic = name in _SYMBOLIC and options.pop("symbolic", False)
        if options:
            raise WrongType(f"{name} takes no {', '.join(options)}.")
        chosen = _with_symbolic_angles(entry) if symbolic else entry
        if N is not None and name not in _LENGTH:
            chosen = _shorter(name, chosen, N)
        if name in _LENGTH and (N is not None or a is not None):
            count = 10 if N is None else N
            row = entry["links"][0] | {"a": 1.0 / count if a is None else a}
            turns = 10.0 / count if name in _COILED else 1.0
            row["alpha"] = turns * row.get("alpha", 0.0)
            configs = {key: [turns * q[0]] * count for key, q in entry["configs"].items()}
            chosen = entry | {"links": [row] * count, "configs": configs, "name": f"{name}{count}"}
        DHRobot.__init__(self, dh_links(chosen), _meshes(name), symbolic=symbolic, **_about(chosen))
        _name(self, chosen)

    about = f"{entry['name']}, {len(entry['links'])} joints, by Denavit and Hartenberg's parameters."
    return type(name, (DHRobot, *more), {"__init__": init, "__doc__": about, "__module__": module})


def tree_class(
    source: str,
    name: str,
    base: type,
    module: str,
    shapes: Sequence[str] = (),
    packages: Mapping[str, str] | None = None,
) -> type:
    """The class of an entry of "ets" or "urdf".

    Args:
        source: "ets" or "urdf".
        name: Name of the entry.
        base: Base class.
        module: Name of the module that the class is in.
        shapes: Paths of descriptions in the package `rtb-data` with the shapes of its links.
        packages: Folders of ROS packages that it names, in that package, by name.

    Returns:
        The class.
    """

    def init(self: Any) -> None:
        fill(self, source, name)
        for description in shapes:
            take_shapes(self, description, packages or {})

    return type(
        name, (base,), {"__init__": init, "__doc__": f"{name}, by frames of its links.", "__module__": module}
    )
