"""Solids in files: meshes, in the colours of the file or in one."""

from __future__ import annotations

import os
from typing import Any

import numpy as np

from spatialgeometry._collision import CollisionShape
from ulna import geometry
from ulna.checks.arrays import number_or_array
from ulna.errors import InputError
from ulna.typing import Floats

__all__ = ["Mesh"]


class Mesh(CollisionShape):
    """A mesh file: dae, stl, obj, glb ...

    Args:
        filename: The file.
        scale: A factor for its lengths, or one along each axis.
        color: One colour for all of it; those of the file when not given.
        y_up: Whether its y is up; it is turned so that z is.
        kwargs: As for `CollisionShape`.

    Raises:
        FileNotFoundError: There is no such file.
    """

    kind, lengths, _has_colours = "mesh", ("scale",), True

    def __init__(
        self,
        filename: str | os.PathLike[str] | None = None,
        scale: Any = (1.0, 1.0, 1.0),
        color: Any = None,
        y_up: bool = False,
        **kwargs: Any,
    ) -> None:
        if filename is not None and not os.path.isfile(filename):
            raise FileNotFoundError(f"There is no mesh file {os.fspath(filename)!r}.")
        super().__init__(color=color, **kwargs)
        self._path, self._y_up = None if filename is None else os.path.abspath(filename), bool(y_up)
        self.scale = scale

    @property
    def filename(self) -> str | None:
        """The file."""
        return self._path

    @property
    def y_up(self) -> bool:
        """Whether its y is up in the file."""
        return self._y_up

    @property
    def scale(self) -> Floats:
        """Factors along x, y, z, shape (3,); one number can be assigned for all three."""
        return self._scale.copy()

    @scale.setter
    def scale(self, scale: Any) -> None:
        self._scale = number_or_array("scale", np.squeeze(scale), 3).copy()
        self.changes += 1

    @property
    def solid(self) -> geometry.Mesh:
        """The mesh it is."""
        if self._path is None:
            raise InputError("This mesh has no file. Give it one: Mesh('part.stl').")
        if self._y_up:
            raise InputError("Collisions of meshes whose y is up are not offered; export the file with z up.")
        return geometry.Mesh(self._path, tuple(self._scale.tolist()))

    def _draw(self, viewer: Any, name: str) -> None:
        viewer.group(name)
        if self._path is not None:
            upright = np.array([[1.0, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]])
            turn = upright if self._y_up else np.eye(4)
            viewer.mesh(self._path, self._scale, name=f"{name}/mesh", pose=turn)
