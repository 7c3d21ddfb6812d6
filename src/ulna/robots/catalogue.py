"""The table of robots by name: which source knows a name, in which order they are asked.

| source | what | installed by |
|---|---|---|
| ulna | the robots written down in this package | always there |
| example-robot-data | 69 descriptions with CAD meshes | the extra "robots" |
| robot_descriptions | about 190 more, fetched on first use | pip install robot_descriptions |

A name is looked up in that order. "example-robot-data:panda" asks one source only.
"""

from __future__ import annotations

import importlib.util
import re
from collections.abc import Callable, Mapping
from typing import Literal

from ulna.data_classes import dataclass
from ulna.errors import MissingExtra, UnknownName
from ulna.geometry import Geometry
from ulna.model import JointKind, Model
from ulna.robots import example_robot_data, robot_descriptions

Source = Literal["ulna", "example-robot-data", "robot_descriptions"]
Visuals = Literal["auto", "simple", "cad"]

SOURCES: tuple[Source, ...] = ("ulna", "example-robot-data", "robot_descriptions")
VISUALS: tuple[Visuals, ...] = ("auto", "simple", "cad")


@dataclass(frozen=True)
class Entry:
    """A robot that can be loaded by name.

    Attributes:
        name: the name.
        source: who provides it.
        about: a few words.
        floating: whether the real robot moves about freely, so that a free-flyer root makes sense.
    """

    name: str
    source: Source
    about: str = ""
    floating: bool = False


OWN: dict[str, Entry] = {
    "panda": Entry("panda", "ulna", "Franka Emika Panda, 7 joints, hand with rigid fingers"),
    "panda_fingers": Entry("panda_fingers", "ulna", "Franka Emika Panda, 7 joints, hand with moving fingers"),
    "ur5": Entry("ur5", "ulna", "Universal Robots UR5, 6 joints"),
}
"""The robots written down in this package."""


def entries() -> tuple[Entry, ...]:
    """Every robot that can be loaded by name here and now, the first source to know a name taking it."""
    entries_by_name = dict(OWN)
    if example_robot_data.share_folder() is not None:
        for d in example_robot_data.DESCRIPTIONS.values():
            entries_by_name.setdefault(d.name, Entry(d.name, "example-robot-data", d.urdf, d.floating))
    for name in robot_descriptions.names():
        entries_by_name.setdefault(name, Entry(name, "robot_descriptions", "fetched on first use"))
    return tuple(entries_by_name.values())


def names() -> tuple[str, ...]:
    """The names of `entries()`."""
    return tuple(entry.name for entry in entries())


def find(name: str) -> Entry:
    """The entry that a name means.

    Args:
        name: a name in any case, "-" for "_" allowed; "source:name" asks one source only.

    Raises:
        UnknownName: no source knows it; offers the nearest name.
        MissingExtra: the source that is asked for, or the only one that knows the name, is not installed.
    """
    source, _, plain_name = name.rpartition(":")
    if source and source not in SOURCES:
        raise UnknownName("source of robots", source, SOURCES)
    plain = re.sub(r"[\s-]+", "_", plain_name.strip()).lower()
    for candidate in SOURCES:
        if source in ("", candidate):
            entry = _find_in(candidate, plain, is_requested=bool(source))
            if entry is not None:
                return entry
    if not source and plain in example_robot_data.DESCRIPTIONS:
        raise MissingExtra("example-robot-data", "robots", f"The robot {plain!r}")
    raise UnknownName("robot", name, names(), "Or pass the path of a .urdf or .xacro file.")


def _find_in(source: Source, name: str, is_requested: bool) -> Entry | None:
    if source == "ulna":
        return OWN.get(name)
    if source == "example-robot-data":
        if example_robot_data.share_folder() is None:
            if is_requested:
                raise MissingExtra(source, "robots", f"The robot {name!r}")
            return None
        d = example_robot_data.DESCRIPTIONS.get(name)
        if d is None and is_requested:
            raise UnknownName("robot of example-robot-data", name, example_robot_data.DESCRIPTIONS)
        return Entry(d.name, source, d.urdf, d.floating) if d else None
    module = robot_descriptions.module_name(name)
    if module is None and is_requested:
        robot_descriptions.fetch(name)  # raises, saying why
    return Entry(module, source, "fetched on first use") if module else None


def build_bundled(
    name: str, *, root: str | JointKind | None = None, visuals: str = "auto", mimic: bool = True
) -> Model:
    """A robot written down in this package.

    Args:
        name: one of `OWN`.
        root: how its base hangs in the world: None fixed, "free_flyer", or a joint kind.
        visuals: "simple" shapes, "cad" meshes of example-robot-data, or "auto": meshes where they are installed and
            can be read, else the shapes.
        mimic: whether mimic joints follow their leader; else each moves on its own.

    Returns:
        The model.

    Raises:
        UnknownName: there is no such robot, or no such word for visuals.
        MissingExtra: meshes were asked for and are not installed.
    """
    if visuals not in VISUALS:
        raise UnknownName("kind of visuals", visuals, VISUALS)
    makers: dict[str, Callable[[Mapping[str, tuple[Geometry, ...]] | None], Model]] = {
        "panda": lambda cad: _panda(False, cad, root, mimic),
        "panda_fingers": lambda cad: _panda(True, cad, root, mimic),
        "ur5": lambda cad: _ur5(cad, root),
    }
    if name not in makers:
        raise UnknownName("robot of ulna", name, makers)
    return makers[name](_cad(name, visuals))


def _panda(
    fingers: bool, cad: Mapping[str, tuple[Geometry, ...]] | None, root: str | JointKind | None, mimic: bool
) -> Model:
    from ulna.robots.panda import panda

    return panda(fingers=fingers, visuals=cad, root=root, mimic=mimic)


def _ur5(cad: Mapping[str, tuple[Geometry, ...]] | None, root: str | JointKind | None) -> Model:
    from ulna.robots.ur5 import ur5

    return ur5(visuals=cad, root=root)


def _cad(name: str, visuals: str) -> Mapping[str, tuple[Geometry, ...]] | None:
    if visuals == "simple" or (visuals == "auto" and not _meshes_can_be_read()):
        return None
    folder = example_robot_data.share_folder()
    if folder is None:
        if visuals == "cad":
            raise MissingExtra("example-robot-data", "robots", f"CAD meshes for {name!r}")
        return None
    from ulna.formats.resolve import Resolver  # readers of files are imported when a file is read
    from ulna.formats.urdf import link_visuals, read_urdf

    file, _ = example_robot_data.files(name.removesuffix("_fingers"))
    return link_visuals(read_urdf(file), Resolver(file, [folder.parent]))


def _meshes_can_be_read() -> bool:
    return all(importlib.util.find_spec(package) is not None for package in ("trimesh", "collada"))
