"""Ulna's models as robots of the toolbox: files, and robots of the catalogue."""

from __future__ import annotations

import atexit
import importlib.util
import shutil
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from roboticstoolbox._common.errors import MissingFile
from roboticstoolbox._ets.elementary_transform import ET
from roboticstoolbox._ets.ets import ETS
from roboticstoolbox._links.link import Link
from ulna.errors import FormatError, ModelError
from ulna.loading import load_model
from ulna.model import Link as CoreLink
from ulna.model import Model, Prismatic, Revolute

_LETTERS = "xyz"


def read_model(path: Any, packages: Mapping[str, str] | None = None) -> tuple[Model, str]:
    """The model in a file, or of a name of the catalogue, and where it was read from.

    Args:
        path: Path of the file, or a name of the catalogue; also the path of a description in the package `rtb-data`,
            such as "trossen_descriptions/urdf/px100.urdf.xacro".
        packages: Folders of ROS packages by name, also in the package `rtb-data`; None for no more than are found.

    Returns:
        The model, and the path as text.

    Raises:
        MissingFile: There is no such file.
        FormatError: The file is broken.
    """
    folder = descriptions_folder()
    folders = [_package_folder(name, _within(folder, place)) for name, place in (packages or {}).items()]
    file = path if Path(path).exists() else _within(folder, path)
    if file is not path and folder is not None:
        folders.append(folder)
    try:
        return load_model(file, mimic=False, package_dirs=tuple(folders)), str(Path(file))
    except FormatError as error:
        if Path(file).exists() or error.file is None or Path(error.file) != Path(file):
            raise
        raise MissingFile("there is no such file.", file=str(file)) from None


def _within(folder: Path | None, place: Any) -> Any:
    """A path in a folder, if there is such a file or folder; else the path itself."""
    return folder / place if folder is not None and (folder / place).exists() else place


def _package_folder(name: str, folder: Any) -> Path:
    """A folder of the name of a package: that of the package, or one that leads to it while Python runs."""
    path = Path(folder).absolute()
    if path.name == name or not path.is_dir():
        return path
    place = Path(tempfile.mkdtemp(prefix="ulna-packages-"))
    atexit.register(shutil.rmtree, place, ignore_errors=True)
    (place / name).symlink_to(path, target_is_directory=True)
    return place / name


def descriptions_folder() -> Path | None:
    """The folder with descriptions of robots in the package `rtb-data`; None where it is not installed."""
    spec = importlib.util.find_spec("rtbdata")
    places = [] if spec is None else list(spec.submodule_search_locations or ())
    return next((Path(place) / "xacro" for place in places if (Path(place) / "xacro").is_dir()), None)


def take_shapes(robot: Any, path: str, packages: Mapping[str, str]) -> None:
    """Gives the links of a robot the shapes of a description in the package `rtb-data`, where that is installed.

    Args:
        robot: The robot, whose links are changed.
        path: Path of the description in the package.
        packages: Folders of ROS packages in it, by name.
    """
    folder = descriptions_folder()
    if folder is None or not (folder / path).is_file():
        return
    parts = {part.name: part for part in read_model(path, packages)[0].links}
    for link in robot.link_dict.values():
        if link.name in parts:
            link.geometry, link.collision = parts[link.name].visuals, parts[link.name].collisions


def from_model(
    kind: Any,
    model: Model,
    gripper_link: str | None = None,
    tool: Any = None,
    leave_out: tuple[str, ...] = (),
    carriers: Mapping[str, str] | None = None,
    **more: Any,
) -> Any:
    """A robot of the class `kind` with the links of a model.

    Args:
        kind: `Robot`, or a class of its kind.
        model: The model.
        gripper_link: First link of the gripper.
        tool: The gripper's tool, (4, 4).
        leave_out: Links not to take.
        carriers: Links to put between a link and all that comes after it, as firsts of grippers: by name, the
            link.
        **more: Arguments of the robot.

    Returns:
        The robot.
    """
    links: list[Link] = []
    by_name: dict[str, Link] = {}
    for part in model.links:
        if part.name not in leave_out:
            by_name[part.name] = link = _link(model, part, by_name.get(part.parent or ""))
            links.append(link)
    gripper_roots = [by_name[gripper_link]] if gripper_link else []
    for name, before in (carriers or {}).items():
        carrier = Link(name=name, parent=by_name[before])
        for link in links:
            if link.parent is by_name[before]:
                link._parent = carrier
        links.append(carrier)
        gripper_roots.append(carrier)
    robot = kind._from_links(links, gripper_roots or None, name=model.name, gravity=model.gravity, **more)
    robot._disabled = [pair for pair in model.disabled_pairs if all(name in by_name for name in pair)]
    if tool is not None and robot.grippers:
        robot.grippers[0].tool = tool
    return robot


def _link(model: Model, part: CoreLink, parent: Link | None) -> Link:
    """A link of a model, with the joint that moves it."""
    joint = model.joint(part.parent_joint) if part.parent_joint in model.joint_names else None
    is_root = part.parent is None and np.array_equal(part.origin.matrix(), np.eye(4))
    transforms = [] if is_root else [ET.SE3(part.origin.matrix())]
    extra: dict[str, Any] = {"joint_name": part.parent_joint}
    if joint is not None:
        transforms += _joint_transforms(joint.kind, part.name)
        limits = joint.limits
        if np.isfinite([*limits.lower, *limits.upper]).all():
            transforms[-1].qlim = [limits.lower[0], limits.upper[0]]
        extra["qdlim"] = limits.velocity[0] if np.isfinite(limits.velocity[0]) else None
        extra |= {"B": joint.damping[0], "Tc": joint.friction[0]}
        extra["tlim"] = limits.effort[0] if np.isfinite(limits.effort[0]) else None
    if part.inertia.mass:
        extra |= {"m": part.inertia.mass, "r": part.inertia.com, "I": part.inertia.inertia}
    return Link(
        ETS(transforms) if transforms else None,
        name=part.name,
        parent=parent,
        geometry=part.visuals,
        collision=part.collisions,
        **extra,
    )


def _joint_transforms(kind: Any, name: str) -> list[Any]:
    """A joint as transforms: along its axis, between turns where that is none of the frame's."""
    if not isinstance(kind, (Revolute, Prismatic)):
        raise ModelError(
            f"The joint of link {name!r} is {kind!r}; the toolbox knows turning and sliding joints."
        )
    axis = np.asarray(kind.axis, dtype=float)
    letter = "R" if isinstance(kind, Revolute) else "t"
    for i in range(3):
        if abs(abs(axis[i]) - 1.0) < 1e-12:
            return [getattr(ET, letter + _LETTERS[i])(flip=bool(axis[i] < 0.0))]
    raise ModelError(
        f"The joint of link {name!r} turns about {axis}; the toolbox knows joints about x, y and z."
    )
