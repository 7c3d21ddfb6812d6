"""GeometryObject: one shape on a joint, with how it looks."""

from __future__ import annotations

import contextlib
import copy
import dataclasses
import os
from collections.abc import Mapping
from typing import Any, ClassVar, final

import numpy as np

from pinocchio._containers.arguments import ArgumentError
from pinocchio._containers.arrays import NO_INDEX, index, vector
from pinocchio._containers.attributes import (
    AttributeKind,
    CheckedAttributes,
    flag,
    one_of,
    refused,
    text,
    whole,
)
from pinocchio._containers.files import Saved, register
from pinocchio._containers.former_names import replacement_message
from pinocchio._containers.keywords import reads_names
from pinocchio._geometry.materials import GeometryNoMaterial, GeometryPhongMaterial, PhysicsMaterial
from pinocchio._spatial.se3 import SE3, HasPlacement, as_placement
from ulna.errors import MissingExtra, excerpt
from ulna.files import special_kind
from ulna.geometry import Box, Capsule, Cone, Cylinder, Ellipsoid, Mesh, Shape, Sphere
from ulna.spatial import SE3 as Pose
from ulna.typing import Array, Floats

_GREY = (0.9, 0.9, 0.9, 1.0)
_SHAPE_NAMES = ("BOX", "SPHERE", "CYLINDER", "CAPSULE")
_NAMES = ("mesh_path", "mesh_scale", "override_material", "mesh_color", "mesh_texture_path", "mesh_material")


@final
@dataclasses.dataclass(frozen=True)
class ConvexMesh(Mesh):
    """A mesh in a file, taken as convex."""


def _arguments(
    parts: tuple[Any, ...], named: Mapping[str, Any]
) -> tuple[str, list[Any], Any, Any, dict[str, Any]]:
    """Name, indices of joint and frame, placement, geometry and other values of a GeometryObject.

    Raises:
        ArgumentError: They are not those of a GeometryObject.
    """
    values = {name: as_placement(value) for name, value in named.items()}
    others = [as_placement(part) for part in parts]
    name = str(values.pop("name") if "name" in values else others.pop(0) if others else "")
    ints = [values.pop(key) for key in ("parent_joint", "parent_frame") if key in values]
    while others and hasattr(others[0], "__index__"):
        ints.append(others.pop(0))
    pair = [others.pop(0) for _ in range(min(2, len(others)))]
    placement = values.pop("placement", next((x for x in pair if isinstance(x, SE3)), None))
    geometry = values.pop("collision_geometry", next((x for x in pair if not isinstance(x, SE3)), None))
    values |= dict(zip(_NAMES, others, strict=False))
    if not 1 <= len(ints) <= 2 or placement is None or geometry is None or set(values) - set(_NAMES):
        raise ArgumentError(
            f"GeometryObject was given {parts}, {named}; expected a name, the index of a joint, that of a frame "
            "(or none), a placement SE3, a geometry, and " + ", ".join(_NAMES) + "."
        )
    return name, ints, placement, geometry, values


_USUAL = {
    **{"meshPath": "", "meshTexturePath": "", "overrideMaterial": False, "disableCollision": False},
    **{"_mesh_loader": None, "_shape": None},
}
_USUAL_LOOKS = np.array([1.0, 1.0, 1.0, *_GREY])
_MADE_WHEN_READ = {"meshMaterial": GeometryNoMaterial, "physicsMaterial": PhysicsMaterial}
"""Attributes that a geometry does not have until they are read, with what they are then."""
_new = object.__new__


def _are_usual(name: Any, joint: Any, frame: Any, placement: Any, geometry: Any) -> bool:
    """Whether the parts of a geometry are a name, indices, a placement and a shape of coal."""
    return (
        type(name) is str
        and type(joint) is int
        and type(frame) is int
        and type(placement) is SE3
        and 0 <= joint <= NO_INDEX
        and 0 <= frame <= NO_INDEX
        and hasattr(type(geometry), "computeLocalAABB")
    )


@final
class GeometryObject(CheckedAttributes, HasPlacement, Saved):
    """One geometry on a joint.

    `GeometryObject(name, parent_joint, [parent_frame,] placement, geometry, mesh_path, mesh_scale,
    override_material, mesh_color, mesh_texture_path)`. Placement and geometry may change places, as they did.
    """

    _kinds: ClassVar[Mapping[str, AttributeKind]] = {
        **dict.fromkeys(("name", "meshPath", "meshTexturePath"), text),
        **dict.fromkeys(("parentJoint", "parentFrame"), whole),
        **dict.fromkeys(("overrideMaterial", "disableCollision"), flag),
        "meshMaterial": one_of(
            (GeometryNoMaterial, GeometryPhongMaterial), "a GeometryNoMaterial or a GeometryPhongMaterial"
        ),
        "physicsMaterial": one_of(PhysicsMaterial),
    }

    @reads_names(
        "otherGeometryObject",
        "name parent_joint parent_frame placement collision_geometry " + " ".join(_NAMES),
        "name parent_joint placement collision_geometry " + " ".join(_NAMES),
    )
    def __init__(self, *parts: Any, **named: Any) -> None:
        count = 0 if named else len(parts)
        if count == 5:
            name, joint, frame, placement, geometry = parts
        elif count == 4:
            (name, joint, placement, geometry), frame = parts, NO_INDEX
        else:
            parts = (named.pop("otherGeometryObject"),) if named.keys() == {"otherGeometryObject"} else parts
            if len(parts) == 1 and isinstance(parts[0], GeometryObject):
                self.__dict__.update(parts[0].copy().__dict__)
            else:
                self._set(*parts, **named)
            return
        if _are_usual(name, joint, frame, placement, geometry):
            own = self.__dict__  # attributes that are set are checked
            own.update(_USUAL)
            own["name"], own["parentJoint"], own["parentFrame"], own["_coal"] = name, joint, frame, geometry
            own["_placement"], own["_looks"] = placement.copy(), _USUAL_LOOKS.copy()
        else:
            self._set(*parts)

    def _set(self, *parts: Any, **named: Any) -> None:
        """Sets a new instance to what it is made of."""
        self.name, ints, placement, geometry, values = _arguments(parts, named)
        self.parentJoint = index(ints[0], NO_INDEX + 1, "joint", "model.getJointId(name) returns one.")
        """The index of the joint it moves with."""
        frame = ints[1] if len(ints) == 2 else NO_INDEX
        self.parentFrame = index(frame, NO_INDEX + 1, "frame", "model.getFrameId(name) returns one.")
        """The index of the frame it belongs to; 2**64 - 1 for none."""
        scale = vector(values.get("mesh_scale", np.ones(3)), 3, "meshScale")
        color = vector(values.get("mesh_color", _GREY), 4, "meshColor")
        self._placement, self._looks = SE3(placement), np.concatenate([scale, color])
        self._shape, self._coal = (geometry, None) if isinstance(geometry, Shape) else (None, geometry)
        self._mesh_loader: Any = None
        self.meshPath = str(values.get("mesh_path", ""))
        """The file of the mesh; "BOX", "SPHERE", ... for other shapes of a URDF file; else empty."""
        self.overrideMaterial = bool(values.get("override_material", False))
        """Whether `meshColor` hides the mesh's own colours."""
        self.meshTexturePath = str(values.get("mesh_texture_path", ""))
        """The file of a texture; empty for none."""
        if "mesh_material" in values:
            self.meshMaterial = values["mesh_material"]
        self.disableCollision = False
        """Whether pairs of it are left out when collisions are computed."""

    _shape: Shape | None
    _coal: Any
    _looks: Floats
    """Factors of the mesh, and its colour (7,)."""
    meshMaterial: GeometryNoMaterial | GeometryPhongMaterial
    """How its surface shines."""
    physicsMaterial: PhysicsMaterial
    """What it is made of."""
    _counters: tuple[Array, ...] = ()
    """Counts of changes (1,) of the lists that it is in, once placements are bound to them."""

    def _count_in(self, counter: Array) -> None:
        """Has changes of its attributes counted in an array (1,)."""
        if not any(known is counter for known in self._counters):
            self.__dict__["_counters"] = (*self._counters, counter)

    def __setattr__(self, name: str, value: Any) -> None:
        super().__setattr__(name, value)
        for counter in self._counters:
            counter[0] += 1

    def _assign(self, other: GeometryObject) -> None:
        """Takes over what another one is, as an entry of a list does."""
        if not isinstance(other, GeometryObject):
            raise ArgumentError(f"A geometry was given {excerpt(repr(other))}; expected a GeometryObject.")
        kept = {name: self.__dict__[name] for name in ("_placement", "_counters") if name in self.__dict__}
        self._placement._assign(other._placement)
        self.__setstate__(other.copy().__dict__ | kept)

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        if "_scale" in state:  # of pickles
            self.__dict__["_looks"] = np.concatenate(
                [self.__dict__.pop(name) for name in ("_scale", "_color")]
            )
        for counter in self._counters:
            counter[0] += 1

    @property
    def meshScale(self) -> Floats:
        """Factors of the mesh along x, y, z, live."""
        return self._looks[:3]

    @meshScale.setter
    def meshScale(self, value: Any) -> None:
        self._looks[:3] = vector(value, 3, "meshScale")

    @property
    def meshColor(self) -> Floats:
        """Red, green, blue, opacity from 0 to 1, live."""
        return self._looks[3:]

    @meshColor.setter
    def meshColor(self, value: Any) -> None:
        self._looks[3:] = vector(value, 4, "meshColor")

    @property
    def geometry(self) -> Any:
        """Its shape, as an object of coal, made when it is first read; where coal is missing, a shape of Ulna."""
        if self._coal is None and self._shape is not None:
            with contextlib.suppress(MissingExtra):
                self._coal = _of_coal(self.name, self._shape, self._mesh_loader)
                if not isinstance(self._shape, Mesh):
                    self._shape = None  # coal's object can be changed
        return self._shape if self._coal is None else self._coal

    def _read_mesh_with(self, mesh_loader: Any) -> None:
        """Has the file of its mesh read by a loader of coal, when the geometry is first read.

        Args:
            mesh_loader: A coal.MeshLoader.
        """
        self._mesh_loader = mesh_loader

    @geometry.setter
    def geometry(self, geometry: Any) -> None:
        known = isinstance(geometry, Shape) or hasattr(geometry, "computeLocalAABB")
        if not known:
            raise refused(
                "geometry", geometry, "a geometry of coal, such as coal.Sphere(0.1), or a shape of Ulna"
            )
        self._shape, self._coal = (geometry, None) if isinstance(geometry, Shape) else (None, geometry)

    @property
    def shape(self) -> Shape | None:
        """Its shape as Ulna says it; None for a mesh that was made in memory."""
        if self._drawn_from_file:
            return self._mesh()
        return self._shape or _shape_of(self._coal)

    @property
    def _drawn_from_file(self) -> bool:
        """Whether `meshPath` says what it looks like: shapes and convex hulls are what they are."""
        mesh = isinstance(self._shape, Mesh) or type(self._coal).__name__.startswith("BVH")
        return mesh and bool(self.meshPath) and self.meshPath not in _SHAPE_NAMES

    def _mesh(self) -> Mesh:
        return Mesh(self.meshPath, tuple(self._looks[:3].tolist()), missing=not os.path.isfile(self.meshPath))

    def copy(self) -> GeometryObject:
        """A copy that shares the geometry."""
        out = _new(GeometryObject)
        own = out.__dict__  # attributes that are set are checked, which takes most of the time
        own.update(self.__dict__)
        if "_counters" in own:
            del own["_counters"]
        if "physicsMaterial" in own:
            own["physicsMaterial"] = own["physicsMaterial"].copy()
        own["_placement"], own["_looks"] = own["_placement"].copy(), own["_looks"].copy()
        return out

    __copy__ = copy

    def clone(self) -> GeometryObject:
        """A copy, the geometry included."""
        out = self.copy()
        out._coal = copy.deepcopy(self._coal)
        return out

    def __deepcopy__(self, memo: Any) -> GeometryObject:
        return self.clone()

    def __getstate__(self) -> dict[str, Any]:
        shape = self._shape or _shape_of(self._coal)
        _ = self.meshMaterial, self.physicsMaterial  # they are made by now
        own = {name: value for name, value in self.__dict__.items() if name not in ("_counters", "_looks")}
        return {
            **own,
            "_scale": self._looks[:3].copy(),
            "_color": self._looks[3:].copy(),
            "_shape": shape,
            "_coal": None if shape else self._coal,
            "_mesh_loader": None,
        }

    @staticmethod
    def CreateCapsule(radius: float, length: float) -> GeometryObject:
        """A capsule about z at the universe.

        Args:
            length: Length without its ends [m].

        Returns:
            The geometry.
        """
        return GeometryObject("", 0, SE3(), Capsule(radius, length))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, GeometryObject):
            return NotImplemented
        own, its = self.__dict__, other.__dict__
        return (
            own["name"] == its["name"]
            and own["parentJoint"] == its["parentJoint"]
            and own["parentFrame"] == its["parentFrame"]
            and own["_placement"] == its["_placement"]
            and own["_looks"].tolist() == its["_looks"].tolist()
            and own["meshPath"] == its["meshPath"]
            and own["meshTexturePath"] == its["meshTexturePath"]
            and own["overrideMaterial"] == its["overrideMaterial"]
            and own["disableCollision"] == its["disableCollision"]
            and (
                own.get("meshMaterial") is its.get("meshMaterial") or self.meshMaterial == other.meshMaterial
            )
            and (
                (own["_coal"] is its["_coal"] and own["_shape"] is its["_shape"]) or self._has_shape_of(other)
            )
        )

    def _has_shape_of(self, other: GeometryObject) -> bool:
        """Whether two shapes, which are not one object, are equal."""
        shape = self.shape
        return shape == other.shape and (shape is not None or self._coal == other._coal)

    __hash__ = object.__hash__

    def __getattr__(self, name: str) -> Any:
        if name in _MADE_WHEN_READ:
            return self.__dict__.setdefault(name, _MADE_WHEN_READ[name]())
        text = f"'GeometryObject' object has no attribute {name!r}. {replacement_message('GeometryObject', name)}"
        raise AttributeError(text.rstrip(), name=name, obj=self)

    def __repr__(self) -> str:
        what = self.shape
        kind = type(self._coal).__name__ if what is None else what.describe()
        return f"<{kind} {self.name!r} on joint {self.parentJoint}>"


def _shape_of(geometry: Any) -> Shape | None:
    """A primitive of coal as a shape of Ulna; None for others."""
    match type(geometry).__name__:
        case "Box":
            x, y, z = (2.0 * float(half) for half in geometry.halfSide)
            return Box((x, y, z))
        case "Sphere":
            return Sphere(geometry.radius)
        case "Capsule":
            return Capsule(geometry.radius, 2.0 * geometry.halfLength)
        case "Cylinder":
            return Cylinder(geometry.radius, 2.0 * geometry.halfLength)
        case "Cone":
            return Cone(geometry.radius, 2.0 * geometry.halfLength)
        case "Ellipsoid":
            a, b, c = (float(r) for r in geometry.radii)
            return Ellipsoid((a, b, c))
    return None


def _of_coal(name: str, shape: Shape, mesh_loader: Any = None) -> Any:
    """The object of coal for a shape; a mesh is read by coal's loader, as Pinocchio has it read."""
    from ulna.collision import Obstacle, World
    from ulna.collision.narrow import coal, geometry_of
    from ulna.collision.solids import obstacle_solids

    named = shape.path if isinstance(shape, Mesh) and not shape.missing else None
    if isinstance(shape, Mesh) and named is not None and not special_kind(named):
        with contextlib.suppress(ValueError):  # a format that coal's reader does not know
            mesh = (mesh_loader or coal().MeshLoader()).load(named, np.array(shape.scale))
            if not isinstance(shape, ConvexMesh):
                return mesh
            mesh.buildConvexRepresentation(False)
            return mesh.convex
    world = World((Obstacle(name, shape, Pose.identity()),))
    return geometry_of(obstacle_solids(world)[0], False)


register(GeometryObject, ConvexMesh)
