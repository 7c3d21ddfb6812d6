"""Which solids are checked against which, and how far they must stay apart."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from ulna.collision.attached import may_touch
from ulna.collision.pairs import LinkPair
from ulna.collision.solids import Solid
from ulna.collision.world import World
from ulna.errors import UnknownName
from ulna.model import Model
from ulna.typing import Array, Floats


def pair_mask(
    model: Model,
    world: World,
    solids: Sequence[Solid],
    count: int,
    pairs: Iterable[LinkPair],
    without: Iterable[LinkPair],
) -> Array:
    """Which solids that move with the robot are checked against which of all.

    Args:
        model: The robot.
        world: Its obstacles.
        solids: The solids of the links, then those of attached objects, then those of the obstacles.
        count: How many are not of obstacles.
        pairs: Pairs of links to check.
        without: Pairs of links, attached objects and obstacles to leave out.

    Returns:
        Truth values, shape (count, n).

    Raises:
        UnknownName: An obstacle may touch a link that does not exist.
    """
    among, skip = ({frozenset(pair) for pair in chosen} for chosen in (pairs, without))
    attachments = {item.name: item for item in world.attachments}
    mask = np.zeros((count, len(solids)), dtype=bool)
    for i, a in enumerate(solids[:count]):
        for j, b in enumerate(solids):
            pair = frozenset((a.owner, b.owner))
            if j >= count:
                obstacle = world[b.owner]
                still = a.joint < 0 and not obstacle.moving
                allowed = a.owner in obstacle.touches or (
                    a.owner in attachments and b.owner in attachments[a.owner].touches
                )
                mask[i, j] = not (still or allowed or pair in skip)
            elif b.owner not in attachments:
                mask[i, j] = i < j and pair in among
            elif a.owner not in attachments:
                allowed = a.owner in attachments[b.owner].touches or pair in skip
                mask[i, j] = i < j and a.joint != b.joint and not allowed
            else:
                allowed = may_touch(attachments[a.owner], attachments[b.owner]) or pair in skip
                mask[i, j] = i < j and a.joint != b.joint and not allowed
    check_touches(model, world)
    return mask


def check_touches(model: Model, world: World) -> None:
    """Raises where an obstacle may touch, or a margin names, what does not exist.

    Args:
        model: The robot.
        world: Its obstacles.

    Raises:
        UnknownName: If there is no such link or object.
    """
    objects = {*world.names, *(item.name for item in world.attachments)}
    for obstacle in world:
        for name in obstacle.touches:
            if name not in objects:
                model.link_index(name)
    for pair in world.margins:
        for name in pair:
            if name not in objects and name not in model.link_names:
                known = sorted({*objects, *model.link_names})
                raise UnknownName("link or object of a margin", name, known)


def pair_margins(world: World, solids: Sequence[Solid], count: int) -> Floats:
    """How far solids must stay apart.

    Args:
        world: The world, which says so of their owners.
        solids: The solids, as for `pair_mask`.
        count: How many are not of obstacles.

    Returns:
        Lengths, shape (count, n) [m].
    """
    margins = np.zeros((count, len(solids)))
    if world.margins:
        for i, a in enumerate(solids[:count]):
            for j, b in enumerate(solids):
                margins[i, j] = world.margin(a.owner, b.owner)
    return margins
