"""Pairs of links that a plan with `joints=` moves only as one: their real shapes are compared once, at the start.

Objects that links carry count as these links do.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from functools import lru_cache

from ulna.collision import Checker, LinkPair, World
from ulna.collision.segment import NEAR
from ulna.collision.solids import Missing
from ulna.errors import MissingExtra
from ulna.model import Model
from ulna.typing import Floats

Still = tuple[bool, ...]
"""Which numbers of a configuration do not change, (nq,)."""


@lru_cache(maxsize=16)
def divided_pairs(
    model: Model, pairs: tuple[LinkPair, ...], still: Still
) -> tuple[tuple[LinkPair, ...], tuple[LinkPair, ...]]:
    """The pairs of links that stay where they are relative to each other, and those that do not.

    Args:
        model: The robot.
        pairs: Pairs of names of links.
        still: Which numbers of a configuration do not change, (nq,).

    Returns:
        Those between which no joint moves; the others.
    """
    movers = _movers(model, still)
    together = tuple((a, b) for a, b in pairs if movers[a] == movers[b])
    return together, tuple((a, b) for a, b in pairs if movers[a] != movers[b])


@lru_cache(maxsize=16)  # one world each time, for the caches of what is made from it
def divided_worlds(model: Model, world: World, still: Still) -> tuple[World, World]:
    """The carried objects, checked against what stays beside them, and the world with them checked against the rest.

    Args:
        model: The robot.
        world: The obstacles, and what links carry.
        still: Which numbers of a configuration do not change, (nq,).

    Returns:
        The first, without obstacles, and the second, with them.
    """
    movers = _movers(model, still)
    for item in world.attachments:
        movers[item.name] = movers.get(item.link, frozenset())
    beside, apart = [], []
    for item in world.attachments:
        own = movers[item.name]
        stays = {name for name, those in movers.items() if those == own and name != item.name}
        robot = [name for name in item.touches if name in movers]
        beside.append(replace(item, touches=_names(robot, movers.keys() - stays - {item.name})))
        apart.append(replace(item, touches=_names(item.touches, stays)))
    attachments = replace(world, obstacles=(), attachments=tuple(beside))
    return attachments, replace(world, attachments=tuple(apart))


def _names(first: Iterable[str], others: Iterable[str]) -> tuple[str, ...]:
    """Names without repetition, in an order that does not change."""
    return tuple(dict.fromkeys((*first, *sorted(others))))


def _movers(model: Model, still: Still) -> dict[str, frozenset[int]]:
    """For each link the joints that move it."""
    moving = set()
    for k, joint in enumerate(model.joints):
        source = joint if joint.mimic is None else model.joints[joint.mimic.source]
        if not all(still[source.idx_q : source.idx_q + source.kind.nq]):
            moving.add(k)
    return {link.name: frozenset(moving & set(model.support(link.joint))) for link in model.links}


def are_apart(
    model: Model, pairs: tuple[LinkPair, ...], carried: World, q: Floats, margin: float, missing: Missing
) -> bool:
    """Whether real shapes of pairs of links, and of carried objects, keep a distance.

    Args:
        model: The robot.
        pairs: Pairs of names of links.
        carried: What links carry, and how far pairs must stay apart.
        q: Configuration, shape (nq,) [rad, m].
        margin: The distance that they keep [m].
        missing: What to do about a mesh file that is not there: "error", or "skip" it with a warning.

    Returns:
        Whether they do; False where coal, which compares them, is not installed.

    Raises:
        ModelError: If a mesh is missing.
    """
    try:
        checker = _checker(model, carried, pairs, missing)
    except MissingExtra:
        return False
    return bool(checker.distance(q).distance > margin + NEAR)


@lru_cache(maxsize=4)
def _checker(model: Model, carried: World, pairs: tuple[LinkPair, ...], missing: Missing) -> Checker:
    return Checker(model, carried, pairs=pairs, missing=missing)
