"""Pairs of links that a plan with `joints=` moves only as one: their real shapes are compared once, at the start."""

from __future__ import annotations

from functools import lru_cache

from ulna.collision import Checker, LinkPair
from ulna.collision.segment import NEAR
from ulna.collision.solids import Missing
from ulna.errors import MissingExtra
from ulna.model import Model
from ulna.typing import Floats


@lru_cache(maxsize=16)
def divided_pairs(
    model: Model, pairs: tuple[LinkPair, ...], still: tuple[bool, ...]
) -> tuple[tuple[LinkPair, ...], tuple[LinkPair, ...]]:
    """The pairs of links that stay where they are relative to each other, and those that do not.

    Args:
        model: The robot.
        pairs: Pairs of names of links.
        still: Which numbers of a configuration do not change, (nq,).

    Returns:
        Those between which no joint moves; the others.
    """
    moving = set()
    for k, joint in enumerate(model.joints):
        source = joint if joint.mimic is None else model.joints[joint.mimic.source]
        if not all(still[source.idx_q : source.idx_q + source.kind.nq]):
            moving.add(k)
    carried_by = {link.name: moving & set(model.support(link.joint)) for link in model.links}
    together = tuple((a, b) for a, b in pairs if carried_by[a] == carried_by[b])
    return together, tuple((a, b) for a, b in pairs if carried_by[a] != carried_by[b])


def are_apart(model: Model, pairs: tuple[LinkPair, ...], q: Floats, margin: float, missing: Missing) -> bool:
    """Whether real shapes of pairs of links keep a distance.

    Args:
        model: The robot.
        pairs: Pairs of names of links.
        q: Configuration, shape (nq,) [rad, m].
        margin: The distance that they keep [m].
        missing: What to do about a mesh file that is not there: "error", or "skip" it with a warning.

    Returns:
        Whether they do; False where coal, which compares them, is not installed.

    Raises:
        ModelError: If a mesh is missing.
    """
    try:
        checker = _checker(model, pairs, missing)
    except MissingExtra:
        return False
    return bool(checker.distance(q).distance > margin + NEAR)


@lru_cache(maxsize=4)
def _checker(model: Model, pairs: tuple[LinkPair, ...], missing: Missing) -> Checker:
    return Checker(model, pairs=pairs, missing=missing)
