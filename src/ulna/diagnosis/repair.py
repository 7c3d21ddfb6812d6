"""A URDF file repaired where the repair is known: inertias that no body can have, or that are made up."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterable, Sequence
from pathlib import Path

from ulna.diagnosis.shape_inertias import shape_inertias
from ulna.errors import InputError, ModelWarning, UnknownName
from ulna.formats.markup import read_file
from ulna.formats.urdf_repair import with_inertias, with_possible_inertias
from ulna.loading import load_model
from ulna.spatial import Inertia
from ulna.system.storage import replacing


def repair_inertias(
    path: str | os.PathLike[str],
    output: str | os.PathLike[str],
    links: Iterable[str] = (),
    *,
    density: float | None = None,
    package_dirs: Sequence[str | os.PathLike[str]] = (),
) -> tuple[str, ...]:
    """Write a copy of a URDF file whose inertias bodies can have.

    An inertia with a negative principal moment, or one larger than the other two together, becomes the nearest that a
    body can have. The inertias of `links` are computed from their shapes instead: see `shape_inertias`. Comments and
    everything else stay. Limits and meshes are for you to decide: see `diagnose`.

    Args:
        path: The URDF file.
        output: Where to write the repaired file, .urdf; it may be the same file.
        links: Names of links whose inertias are computed anew, as solids that fill their shapes and have their masses.
        density: Of those of these links that have no mass [kg/m^3].
        package_dirs: Folders in which packages with meshes lie, as for `ulna.load`.

    Returns:
        The names of the links whose inertia was changed.

    Raises:
        FormatError: The file is missing or broken.
        UnknownName: One of the paths does not end in .urdf, or there is no such link.
        InputError: The file cannot be written, or an inertia cannot be computed.

    Example:
        >>> inertia = '<mass value="1"/><inertia ixx="1" iyy="1" izz="3" ixy="0" ixz="0" iyz="0"/>'
        >>> text = f'<robot name="arm"><link name="upper"><inertial>{inertia}</inertial></link></robot>'
        >>> from pathlib import Path
        >>> _ = Path("arm.urdf").write_text(text)
        >>> ulna.diagnosis.repair_inertias("arm.urdf", "repaired.urdf")
        ('upper',)
    """
    for name in (path, output):
        if Path(name).suffix.lower() != ".urdf":
            raise UnknownName("kind of file", Path(name).suffix, (".urdf",), f"The path is {str(name)!r}.")
    if isinstance(links, str):
        raise InputError(f"`links` is {links!r}; expected a list of names: [{links!r}].")
    names = tuple(dict.fromkeys(links))
    if density is not None and not names:
        raise InputError("`density` is for `links`, of which none is named.")
    text = read_file(path)
    if names:
        text = with_inertias(text, _from_shapes(path, names, density, package_dirs), str(path))
    text, changed = with_possible_inertias(text, str(path))
    try:
        with replacing(output) as temporary:
            temporary.write_bytes(text)
    except OSError as error:
        raise InputError(f"Cannot write {str(output)!r}: {error.strerror or error}.") from error
    return (*names, *changed)


def _from_shapes(
    path: str | os.PathLike[str],
    links: tuple[str, ...],
    density: float | None,
    package_dirs: Sequence[str | os.PathLike[str]],
) -> dict[str, Inertia]:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ModelWarning)  # of the inertias that are to be repaired
        model = load_model(str(path), package_dirs=package_dirs)
    return shape_inertias(model, links, density=density)
