"""The geoms of a compiled MJCF file as geometries of links: which are drawn, which collide, where meshes lie."""

from __future__ import annotations

import os
from collections.abc import Sequence

import numpy as np

from ulna.formats.mjcf_parse import CompiledMjcf, pose_of
from ulna.geometry import Box, Capsule, Cylinder, Ellipsoid, Geometry, Material, Mesh, Plane, Shape, Sphere
from ulna.spatial import SE3

PLANE, FIELD, SPHERE, CAPSULE, ELLIPSOID, CYLINDER, BOX, MESH = range(8)
"""mjtGeom."""

DRAWN_GROUPS = (0, 1, 2)
"""The groups of geoms that MuJoCo's own viewers show when they start."""


NO_COLOUR = (0.5, 0.5, 0.5, 1.0)
"""What MuJoCo gives a geom whose colour is not said."""


class Shapes:
    """Geoms of one file; `left` counts those that have no shape here.

    Args:
        compiled: what MuJoCo made of the file.
        file: the name of the file; None for text.
        touching: indices of the geoms that can touch something.
        links: the names of the links, by the index of their body.
    """

    def __init__(
        self, compiled: CompiledMjcf, file: str | None, touching: frozenset[int], links: Sequence[str]
    ) -> None:
        self._m, self._touching, self._links = compiled.model, touching, links
        self._references = compiled.mesh_references
        folder = os.path.dirname(os.path.abspath(file)) if file else os.getcwd()
        self._folder = os.path.join(folder, compiled.mesh_folder)
        self.omitted: dict[str, int] = {}

    def of_body(self, body: int) -> tuple[tuple[Geometry, ...], tuple[Geometry, ...]]:
        """What a body looks like, and what it collides with."""
        m = self._m
        drawn: list[Geometry] = []
        hard: list[Geometry] = []
        for g in range(int(m.body_geomadr[body]), int(m.body_geomadr[body] + m.body_geomnum[body])):
            visible, touching = m.geom_group[g] in DRAWN_GROUPS, g in self._touching
            geometry = self._geometry(g) if visible or touching else None
            if geometry is not None and visible:
                drawn.append(geometry)
            if geometry is not None and touching:
                hard.append(geometry)
        return tuple(drawn), tuple(hard)

    def _geometry(self, g: int) -> Geometry | None:
        m = self._m
        shape = self._shape(g)
        if shape is None:
            return None
        place = pose_of(m.geom_pos[g], m.geom_quat[g])
        if isinstance(shape, Mesh):
            # MuJoCo moves a mesh into its principal axes; the file's own frame is that much further back.
            mesh = int(m.geom_dataid[g])
            place = place @ pose_of(m.mesh_pos[mesh], m.mesh_quat[mesh]).inverse() @ self._reference(mesh)
        return Geometry(m.geom(g).name or self._given_name(g), shape, place, self._material(g))

    def _given_name(self, g: int) -> str:
        """The name of a geom without one: its body, and its number there, as in Pinocchio."""
        body = int(self._m.geom_bodyid[g])
        return f"{self._links[body]}Geom_{g - int(self._m.body_geomadr[body])}"

    def _reference(self, mesh: int) -> SE3:
        """Where a mesh's own frame lies in the frame that `refpos` and `refquat` give it: s R^T (x - p)."""
        if mesh not in self._references:
            return SE3.identity()
        position, turn = self._references[mesh]
        back = SE3.from_quat_xyzw(np.roll(turn, -1)).rotation.T
        return SE3(back, -back @ (self._m.mesh_scale[mesh] * position))

    def _shape(self, g: int) -> Shape | None:
        m = self._m
        kind = int(m.geom_type[g])
        x, y, z = (float(s) for s in m.geom_size[g])
        if kind == PLANE:
            return Plane((2.0 * x, 2.0 * y))  # 0 means without end, there and here
        if kind == SPHERE:
            return Sphere(x)
        if kind == CAPSULE:
            return Capsule(x, 2.0 * y)
        if kind == ELLIPSOID:
            return Ellipsoid((x, y, z))
        if kind == CYLINDER:
            return Cylinder(x, 2.0 * y)
        if kind == BOX:
            return Box((2.0 * x, 2.0 * y, 2.0 * z))
        if kind == MESH:
            return self._mesh(int(m.geom_dataid[g]))
        return self._without("height fields" if kind == FIELD else "geoms of signed distance functions")

    def _mesh(self, mesh: int) -> Mesh | None:
        m = self._m
        start = int(m.mesh_pathadr[mesh])
        if start < 0:
            return self._without("meshes without a file")
        if mesh in self._references and any(self._references[mesh][1][1:]) and np.ptp(m.mesh_scale[mesh]):
            return self._without("meshes with refquat and unequal scales")
        path = bytes(m.paths[start:]).split(b"\0")[0].decode()
        file = os.path.join(self._folder, path)
        sx, sy, sz = (float(s) for s in m.mesh_scale[mesh])
        return Mesh(file, (sx, sy, sz), missing=not os.path.exists(file))

    def _material(self, g: int) -> Material | None:
        """The material of a geom; its own colour wins, if it is not the default, as in `mjv_updateScene`."""
        m = self._m
        named = int(m.geom_matid[g])
        has_own = tuple(m.geom_rgba[g]) != NO_COLOUR
        if named < 0 and not has_own:
            return None
        r, gr, b, a = (float(c) for c in (m.geom_rgba[g] if has_own else m.mat_rgba[named]))
        return Material("" if has_own else m.mat(named).name, (r, gr, b, a))

    def _without(self, what: str) -> None:
        self.omitted[what] = self.omitted.get(what, 0) + 1
