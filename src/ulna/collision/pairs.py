"""Which pairs of links need a collision check: all, less those that are joined, and those the model rules out."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from ulna.checks.values import flag, short_repr
from ulna.errors import InputError
from ulna.model import FreeFlyer, Model
from ulna.model.of_robot import model_of

LinkPair = tuple[str, str]
"""The names of two links."""


def link_pairs(
    model: Model | Any, *, without: Iterable[LinkPair] = (), adjacent: bool = False, disabled: bool = False
) -> tuple[LinkPair, ...]:
    """The pairs of links to check against each other, in the order of `model.links`.

    Left out are links without collision geometry, links joined rigidly, links joined by one movable joint (they touch
    by construction; those that a free flyer joins do not), and the pairs that the model's SRDF disables.

    Args:
        model: The Model, or its Robot.
        without: More pairs to exclude.
        adjacent: Whether links joined by one movable joint are checked anyway.
        disabled: Whether the pairs that the model disables are checked anyway.

    Returns:
        Pairs of link names.

    Raises:
        InputError: If `model` is neither.
        UnknownName: If `without` names a link that the model does not have.
    """
    model = model_of(model, "model")
    flag("adjacent", adjacent)
    skip = {frozenset(pair) for pair in checked_pairs(model, without)}
    if not flag("disabled", disabled):
        skip |= {frozenset(pair) for pair in model.disabled_pairs}
    links = [link for link in model.links if link.collisions]
    # No joint has the number of a free flyer's parent: what it carries is no neighbour of anything.
    parents = [None if isinstance(joint.kind, FreeFlyer) else joint.parent for joint in model.joints]
    pairs = []
    for k, a in enumerate(links):
        for b in links[k + 1 :]:
            if a.joint == b.joint or frozenset((a.name, b.name)) in skip:
                continue
            near = (a.joint >= 0 and parents[a.joint] == b.joint) or (
                b.joint >= 0 and parents[b.joint] == a.joint
            )
            if adjacent or not near:
                pairs.append((a.name, b.name))
    return tuple(pairs)


def checked_pairs(model: Model, pairs: Iterable[LinkPair]) -> tuple[LinkPair, ...]:
    """Pairs of two different links of a model.

    Args:
        model: The robot.
        pairs: The pairs of names.

    Returns:
        The same pairs.

    Raises:
        InputError: If an entry is not a pair of two different names.
        UnknownName: If there is no such link; names the nearest.
    """
    if isinstance(pairs, str) or not isinstance(pairs, Iterable):
        raise InputError(
            f"{short_repr(pairs)} is no list of pairs of links; expected such as [('link1', 'link4')]."
        )
    out = []
    for pair in pairs:
        if isinstance(pair, str) or not isinstance(pair, Iterable) or len(tuple(pair)) != 2:
            raise InputError(f"{pair!r} is no pair of links; expected two names, such as ('link1', 'link4').")
        a, b = pair
        for name in (a, b):
            model.link_index(name)
        if a == b:
            raise InputError(f"The pair ({a!r}, {b!r}) names one link twice; expected two different links.")
        out.append((a, b))
    return tuple(out)
