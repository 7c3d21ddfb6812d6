"""A URDF file repaired where the repair is known: inertias that no body can have."""

from __future__ import annotations

import os
from pathlib import Path

from ulna.errors import InputError, UnknownName
from ulna.formats.markup import read_file
from ulna.formats.urdf_repair import with_possible_inertias
from ulna.system.storage import replacing


def repair_inertias(path: str | os.PathLike[str], output: str | os.PathLike[str]) -> tuple[str, ...]:
    """Write a copy of a URDF file whose inertias bodies can have.

    An inertia with a negative principal moment, or one larger than the other two together, becomes the nearest that a
    body can have; comments and everything else stay. Masses, limits and meshes are for you to decide: see `diagnose`.

    Args:
        path: The URDF file.
        output: Where to write the repaired file, .urdf; it may be the same file.

    Returns:
        The names of the links whose inertia was changed.

    Raises:
        FormatError: The file is missing or broken.
        UnknownName: One of the paths does not end in .urdf.
        InputError: The file cannot be written.

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
    text, changed = with_possible_inertias(read_file(path), str(path))
    try:
        with replacing(output) as temporary:
            temporary.write_bytes(text)
    except OSError as error:
        raise InputError(f"Cannot write {str(output)!r}: {error.strerror or error}.") from error
    return changed
