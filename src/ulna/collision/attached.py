"""Objects that links carry: their solids, the spheres that cover them, and what they are checked against."""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache

import numpy as np

from ulna import disk_cache
from ulna.collision.cover import cover
from ulna.collision.objects import Attachment
from ulna.collision.pairs import LinkPair
from ulna.collision.solids import Missing, Solid, solid_of
from ulna.collision.spheres import LinkSpheres, Spheres
from ulna.collision.world import World
from ulna.data_classes import dataclass
from ulna.errors import InputError, UnknownName
from ulna.geometry import HeightField, Plane, PointCloud, Shape
from ulna.model import Model
from ulna.model.content import fingerprint
from ulna.spatial import SE3

_TOLERANCE, _MOST = 0.004, 64  # of spheres around an object [m], and their number
_FINEST = 0.0025  # [m] edge of a cell, at least: smaller ones take seconds for thin objects and gain nothing
_VERSION = "spheres of attached objects 1"


@dataclass(frozen=True, eq=False)
class Carried:
    """The objects that a robot's links carry, as checks by spheres need them.

    Attributes:
        spheres: By name of the object, in the frame of the link that carries it.
        pairs: Objects with the links and other objects that they are checked against.
        carriers: By name of the object the link.
    """

    spheres: dict[str, LinkSpheres]
    pairs: tuple[LinkPair, ...]
    carriers: dict[str, str]


def carried(model: Model, world: World, spheres: Spheres, missing: Missing = "error") -> Carried:
    """The objects that a robot's links carry in a world.

    Args:
        model: The robot.
        world: The world, which says what they carry.
        spheres: Spheres of the links; links without are not checked.
        missing: What to do about a mesh file that is missing: "error", or "skip" it with a warning.

    Returns:
        The objects.

    Raises:
        UnknownName: If there is no such link, or nothing of a name that an object may touch.
        InputError: If a link does not move, or a shape is no body.
    """
    solids = attached_solids(model, world, missing)
    balls = attached_spheres(world, solids)
    carriers = {item.name: item.link for item in world.attachments if item.name in balls}
    return Carried(balls, attached_pairs(model, world, spheres.links, solids), carriers)


def attached_solids(model: Model, world: World, missing: Missing = "error") -> tuple[Solid, ...]:
    """The objects that a model's links carry, as solids on the joints that move these links.

    Args:
        model: The robot.
        world: The world, which says what they carry.
        missing: What to do about a mesh file that is missing: "error", or "skip" it with a warning.

    Returns:
        The solids, in the order of the world's attachments.

    Raises:
        UnknownName: If there is no such link, or nothing of a name that an object may touch.
        InputError: If a link does not move, or a shape is no body.
    """
    known = {*model.link_names, *world.names, *(a.name for a in world.attachments)}
    solids = []
    for item in world.attachments:
        link = model.links[model.link_index(item.link)]
        if link.joint < 0:
            raise InputError(
                f"Attached object {item.name!r}: link {item.link!r} does not move. Put the object into the world: "
                "world.add(name, shape, pose, touches=[link])."
            )
        if isinstance(item.shape, Plane | PointCloud | HeightField):
            raise InputError(
                f"Attached object {item.name!r} is a {item.shape.describe()}; expected a body, such as a Box around it."
            )
        for name in item.touches:
            if name not in known:
                raise UnknownName(f"link or object that {item.name!r} may touch", name, sorted(known))
        place = f"attached object {item.name!r}"
        solid = solid_of(place, item.name, item.shape, link.joint, link.placement @ item.pose, missing)
        if solid is not None:
            solids.append(solid)
    return tuple(solids)


def attached_pairs(
    model: Model, world: World, links: Iterable[str], solids: Iterable[Solid]
) -> tuple[LinkPair, ...]:
    """What attached objects are checked against, besides obstacles: links that move otherwise, and other objects.

    Args:
        model: The robot.
        world: The world.
        links: Names of the links that are checked.
        solids: The attached objects that are checked.

    Returns:
        Pairs of names; the first is that of an object.
    """
    pairs: list[LinkPair] = []
    joints = {solid.owner: solid.joint for solid in solids}
    carried_items = [item for item in world.attachments if item.name in joints]
    for k, item in enumerate(carried_items):
        pairs += [
            (item.name, name)
            for name in links
            if model.link(name).joint != joints[item.name] and name not in item.touches
        ]
        pairs += [
            (item.name, other.name)
            for other in carried_items[k + 1 :]
            if joints[other.name] != joints[item.name] and not may_touch(item, other)
        ]
    return tuple(pairs)


def may_touch(item: Attachment, other: Attachment) -> bool:
    """Whether two attached objects may touch each other.

    Args:
        item: One.
        other: The other.

    Returns:
        The truth value.
    """
    return other.name in item.touches or item.name in other.touches


def attached_spheres(world: World, solids: Iterable[Solid]) -> dict[str, LinkSpheres]:
    """Spheres that cover attached objects, in the frames of the links that carry them.

    Args:
        world: The world.
        solids: The attached objects.

    Returns:
        Spheres by name of the object.
    """
    spheres = {}
    for solid in solids:
        item = world.attached(solid.owner)
        balls = _covering(item.shape, solid.vertices.tobytes())
        spheres[item.name] = LinkSpheres(item.pose @ balls.centres, balls.radii, balls.excess)
    return spheres


@lru_cache(maxsize=256)
def _covering(shape: Shape, vertices: bytes) -> LinkSpheres:
    """Spheres around a shape in its own frame; the vertices distinguish versions of a mesh file. Kept on disk."""
    solid = solid_of("an attached object", "", shape, -1, SE3.identity(), "error")
    assert solid is not None
    name = disk_cache.key(_VERSION, fingerprint([shape, solid.triangles if vertices else None]), vertices)
    stored = disk_cache.read(name)
    if stored is None:
        centres, radii, excess = cover([solid], [SE3.identity()], _TOLERANCE, _MOST, _FINEST)
        disk_cache.write(name, np.append(np.column_stack([centres, radii]).ravel(), excess).tobytes())
        return LinkSpheres(centres, radii, excess)
    numbers = np.frombuffer(stored)
    rows = numbers[:-1].reshape(-1, 4)
    return LinkSpheres(rows[:, :3], rows[:, 3], float(numbers[-1]))
