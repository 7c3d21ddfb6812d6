"""A URDF file repaired where the repair is known: inertias that no body can have, or that are made up."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterable, Sequence

from ulna.checks.paths import checked_path
from ulna.checks.values import names
from ulna.diagnosis.shape_inertias import shape_inertias
from ulna.errors import InputError, ModelWarning
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
    body can have: zero, as of a point mass, where no second moment is above zero. The inertias of `links` are computed
    from their shapes instead: see `shape_inertias`. Comments and everything else stay. Limits and meshes are for you
    to decide: see `diagnose`.

    Args:
        path: The URDF file.
        output: Where to write the repaired file, .urdf; it may be the same file.
        links: Names of links whose inertias are computed anew, as solids that fill their shapes and have their masses.
        density: Of those of these links that have no mass [kg/m^3].
        package_dirs: Folders in which packages with meshes lie, as for `ulna.load`.

    Returns:
        `links`, and the names of the other links whose inertia was changed.

    Raises:
        FormatError: The file is missing or broken.
        UnknownName: One of the paths does not end in .urdf, or there is no such link.
        InputError: A path is none, `links` are no names, the file cannot be written, or an inertia cannot be computed.

    Example:
        >>> inertia = '<mass value="1"/><inertia ixx="1" iyy="1" izz="3" ixy="0" ixz="0" iyz="0"/>'
        >>> text = f'<robot name="arm"><link name="upper"><inertial>{inertia}</inertial></link></robot>'
        >>> from pathlib import Path
        >>> _ = Path("arm.urdf").write_text(text)
        >>> ulna.diagnosis.repair_inertias("arm.urdf", "repaired.urdf")
        ('upper',)
    """
    for argument, name in ((path, "path"), (output, "output")):
        checked_path(argument, "URDF file", (".urdf",), name)
    chosen = tuple(dict.fromkeys(names("links", links)))
    if density is not None and not chosen:
        raise InputError("`density` is for `links`, of which none is named.")
    text = read_file(path)
    if chosen:
        text = with_inertias(text, _from_shapes(path, chosen, density, package_dirs), str(path))
    text, changed = with_possible_inertias(text, str(path))
    try:
        with replacing(output) as temporary:
            temporary.write_bytes(text)
    except OSError as error:
        raise InputError(f"Cannot write {str(output)!r}: {error.strerror or error}.") from error
    return tuple(dict.fromkeys((*chosen, *changed)))


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
