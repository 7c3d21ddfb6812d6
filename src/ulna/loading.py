"""A robot by its name or its file: `load("panda")`, `load("arm.urdf")`, `load("g1", root="free_flyer")`.

Readers of files and the catalogue are imported when they are used, so that `import ulna` stays light.
"""

from __future__ import annotations

import dataclasses
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ulna.checks.values import flag, short_repr
from ulna.data_classes import dataclass
from ulna.errors import InputError, UnknownName
from ulna.idioms import check_keywords
from ulna.model import JointKind, Model

if TYPE_CHECKING:
    from ulna.robot import Robot

_ENDINGS = (".urdf", ".xacro", ".xml", ".srdf", ".mjcf", ".sdf")

PathLike = str | os.PathLike[str]


@check_keywords
def load(
    name_or_path: PathLike,
    *,
    root: str | JointKind | None = None,
    visuals: str = "auto",
    package_dirs: Sequence[PathLike] | PathLike = (),
    srdf: PathLike | None = None,
    mimic: bool = True,
    xacro_args: Mapping[str, str] | None = None,
    trusted: bool = False,
    tool: str | None = None,
) -> Robot:
    """The robot of that name or in that file, ready to compute with.

    Args:
        name_or_path: "panda", "ur5", any name that `ulna list` gives, the path of a .urdf, .xacro or MJCF (.xml)
            file, or URDF or MJCF text (from "<").
        root: how the base hangs in the world; see `load_model`, also for the others.
        visuals: "auto", "simple" or "cad".
        package_dirs: folders to look for packages in.
        srdf: a file, or its text, with groups and named configurations.
        mimic: whether mimic joints follow their leader.
        xacro_args: values for the arguments of a .xacro file.
        trusted: for MJCF, whether MuJoCo compiles it in this process; otherwise another process does, which is ended
            after a minute, or when it needs more than 4 GiB. Other formats are read alike either way.
        tool: name of the frame that is the tool; None for that of a robot of Ulna's own, and else for the leaf link
            behind the most joints, the first of several, which may be a finger of a gripper.

    Returns:
        The robot.

    Raises:
        InputError: what is to be loaded is neither a name nor a path nor text; or `xacro_args` are no dictionary, or
            given for what is no xacro file.
        UnknownName: no robot, or no frame, of that name; offers the nearest one.
        FormatError: the file is missing or broken; says where and how to fix it.
        MissingExtra: the robot needs a package that is not installed.

    Example:
        >>> robot = ulna.load("panda")
        >>> robot.nq, robot.tool
        (7, 'panda_hand_tcp')
    """
    from ulna.robot import Robot

    model = load_model(
        name_or_path,
        root=root,
        visuals=visuals,
        package_dirs=package_dirs,
        srdf=srdf,
        mimic=mimic,
        xacro_args=xacro_args,
        trusted=trusted,
    )
    robot = Robot(model)
    return robot if tool is None else robot.with_tool(tool)


@check_keywords
def load_model(
    name_or_path: PathLike,
    *,
    root: str | JointKind | None = None,
    visuals: str = "auto",
    package_dirs: Sequence[PathLike] | PathLike = (),
    srdf: PathLike | None = None,
    mimic: bool = True,
    xacro_args: Mapping[str, str] | None = None,
    trusted: bool = False,
) -> Model:
    """The model of that name or in that file, without compiling anything.

    Args:
        name_or_path: a name of the catalogue, the path of a .urdf, .xacro or MJCF (.xml) file, or URDF or MJCF text
            (from "<").
        root: how the base hangs in the world: None fixed, "free_flyer", "planar", any joint kind, or "auto": a free
            flyer for the robots of the catalogue that move about.
        visuals: "auto", "simple" or "cad". For Ulna's own robots (panda, ur5): the shapes, the CAD
            meshes of example-robot-data, or the meshes where they are installed. For files, "simple" draws the
            collision shapes of the links that have any.
        package_dirs: folders to look for packages in, before all others.
        srdf: a file, or its text, with groups, named configurations and disabled collision pairs; robots of
            example-robot-data bring theirs.
        mimic: whether mimic joints follow their leader; False lets each move on its own.
        xacro_args: values for the arguments of a .xacro file; a warning (ModelWarning) names those that the file does
            not ask for.
        trusted: for MJCF, whether MuJoCo compiles it in this process; otherwise another process does, which is ended
            after a minute, or when it needs more than 4 GiB. Other formats are read alike either way.

    Returns:
        The model.

    Raises:
        InputError: what is to be loaded is neither a name nor a path nor text; or `xacro_args` are no dictionary, or
            given for what is no xacro file.
        UnknownName: no robot of that name; offers the nearest one.
        FormatError: the file is missing or broken; says where and how to fix it.
        MissingExtra: the robot needs a package that is not installed.
    """
    if not isinstance(name_or_path, (str, os.PathLike)):
        if isinstance(name_or_path, Model) or isinstance(getattr(name_or_path, "model", None), Model):
            raise InputError(
                f"`name_or_path` is {_described(name_or_path)}, loaded already. Use it as it is; "
                "ulna.Robot(model) makes a Robot of a Model."
            )
        raise InputError(
            f"`name_or_path` is {_described(name_or_path)}; expected a robot's name such as 'panda', the path of a "
            ".urdf, .xacro or MJCF (.xml) file, or URDF or MJCF text."
        )
    if isinstance(package_dirs, (str, os.PathLike)):
        package_dirs = (package_dirs,)
    from ulna.robots import catalogue

    if visuals not in catalogue.VISUALS:
        raise UnknownName("kind of visuals", visuals, catalogue.VISUALS)
    options = _Options(
        root,
        visuals,
        tuple(package_dirs),
        flag("mimic", mimic),
        _checked_args(xacro_args),
        flag("trusted", trusted),
    )
    if _is_file(name_or_path):
        model = _from_file(name_or_path, options)
    else:
        model = _from_catalogue(str(name_or_path), options)
    return model if srdf is None else _with_srdf(model, srdf)


@dataclass(frozen=True)
class _Options:
    root: str | JointKind | None
    visuals: str
    package_dirs: tuple[PathLike, ...]
    mimic: bool
    xacro_args: dict[str, str]
    trusted: bool


def _checked_args(xacro_args: Any) -> dict[str, str]:
    """The arguments of a xacro file, if they are a dictionary by name."""
    if xacro_args is None:
        return {}
    if not (isinstance(xacro_args, Mapping) and all(isinstance(name, str) for name in xacro_args)):
        raise InputError(
            f"`xacro_args` is {short_repr(xacro_args)}; expected a dictionary of values by name, such as "
            "{'prefix': 'left_'}."
        )
    return dict(xacro_args)


def _check_takes_args(what: str, options: _Options) -> None:
    """Refuses arguments of a xacro file for what is none."""
    if options.xacro_args:
        raise InputError(
            f"`xacro_args` has {', '.join(map(repr, options.xacro_args))}, but {what} is not read as xacro, and has no "
            "arguments. Leave it out, or pass the path of a .xacro file."
        )


def _is_file(name_or_path: PathLike) -> bool:
    if not isinstance(name_or_path, str):
        return True
    text = name_or_path.strip("\ufeff \t\r\n")
    return text.startswith("<") or "/" in text or os.sep in text or text.lower().endswith(_ENDINGS)


def _described(value: object) -> str:
    return "None" if value is None else f"of type {type(value).__name__}"


def _with_srdf(model: Model, path_or_text: PathLike) -> Model:
    from ulna.formats.srdf import parse_srdf, read_srdf
    from ulna.formats.srdf_apply import with_srdf

    text = path_or_text.lstrip("\ufeff \t\r\n") if isinstance(path_or_text, str) else ""
    return with_srdf(model, parse_srdf(text) if text.startswith("<") else read_srdf(path_or_text))


def _from_file(path_or_text: PathLike, options: _Options) -> Model:
    from ulna.formats.markup import read_file, root_tag
    from ulna.formats.resolve import Resolver
    from ulna.formats.urdf import model_from_urdf
    from ulna.formats.urdf_parse import parse_urdf
    from ulna.formats.xacro import expand_xacro
    from ulna.robots import example_robot_data

    file: str | None = None
    if isinstance(path_or_text, str) and path_or_text.lstrip("\ufeff \t\r\n").startswith("<"):
        text: bytes | str = path_or_text.lstrip("\ufeff \t\r\n")
    else:
        file = os.path.expanduser(os.fspath(path_or_text))
        text = b""
    if file is not None and file.lower().endswith((".xml", ".mjcf")):
        text = read_file(file)
    is_xacro = file is not None and file.lower().endswith(".xacro")
    if not is_xacro:
        _check_takes_args(repr(file) if file is not None else "a text", options)
    if root_tag(text) == "mujoco" or (file or "").lower().endswith(".mjcf"):
        return _from_mjcf(path_or_text if file is None else file, options)
    # The data package names itself in its mesh paths; then it is found even for a copy of one of its files.
    share = example_robot_data.share_folder()
    resolver = Resolver(file, (*options.package_dirs, *((share.parent,) if share else ())))
    if file is not None:
        text = expand_xacro(file, options.xacro_args, resolver) if is_xacro else read_file(file)
    document = parse_urdf(text, file)
    if options.visuals == "simple":
        document = _with_simple_visuals(document)
    root = None if options.root == "auto" else options.root
    model = model_from_urdf(document, root=root, mimic=options.mimic, resolver=resolver)
    return dataclasses.replace(model, source=str(Path(file).absolute()) if file else None)


def _from_mjcf(path_or_text: PathLike, options: _Options) -> Model:
    from ulna.formats.mjcf import model_from_mjcf

    root = None if options.root == "auto" else options.root
    model = model_from_mjcf(path_or_text, root=root, mimic=options.mimic, trusted=options.trusted)
    return _with_simple_visuals(model) if options.visuals == "simple" else model


def _with_simple_visuals(made: Any) -> Any:
    """A document or model whose links look like what they collide with."""
    links = tuple(dataclasses.replace(x, visuals=x.collisions or x.visuals) for x in made.links)
    return dataclasses.replace(made, links=links)


def _from_catalogue(name: str, options: _Options) -> Model:
    from ulna.robots import catalogue, example_robot_data, robot_descriptions

    entry = catalogue.find(name)
    if options.root == "auto":
        options = dataclasses.replace(options, root="free_flyer" if entry.floating else None)
    if entry.source == "ulna":
        _check_takes_args(f"the robot {name!r}", options)
        return catalogue.build_bundled(
            entry.name, root=options.root, visuals=options.visuals, mimic=options.mimic
        )
    if entry.source == "example-robot-data":
        urdf, srdf = example_robot_data.files(entry.name)
        model = _from_file(urdf, options)
        return model if srdf is None else _with_srdf(model, srdf)
    checkout = robot_descriptions.fetch(entry.name)
    options = dataclasses.replace(
        options,
        package_dirs=(*options.package_dirs, *checkout.package_dirs),
        xacro_args={**checkout.xacro_args, **options.xacro_args},
    )
    return _from_file(checkout.file, options)
