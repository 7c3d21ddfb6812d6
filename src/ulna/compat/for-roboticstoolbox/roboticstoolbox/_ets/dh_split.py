"""Chains parted into the links of Denavit and Hartenberg's conventions.

Standard: Rz(theta) tz(d) tx(a) Rx(alpha). Modified: tx(a) Rx(alpha) Rz(theta) tz(d). Every step may be missing.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

from ulna.errors import InputError

STEPS = {"dh": ("Rz", "tz", "tx", "Rx"), "mdh": ("tx", "Rx", "Rz", "tz")}
_JOINTS = ("Rz", "tz")


def split_by_convention(transforms: Sequence[Any], convention: str) -> list[Sequence[Any]]:
    """What is before the links, the links that one joint each moves, and what is after them.

    Args:
        transforms: Those of a chain.
        convention: "dh": what does not fit before the first link is apart; "mdh": what does not fit after the
            last.

    Returns:
        The parts, in the order of the chain.

    Raises:
        InputError: The transforms between two joints are no such links, or there are no joints.
    """
    steps, places = STEPS[convention], [i for i, et in enumerate(transforms) if et.isjoint]
    if not places:
        raise InputError("The chain has no joints, so no links of Denavit and Hartenberg.")
    for i in places:
        if transforms[i].kind not in _JOINTS:
            raise InputError(
                f"{transforms[i]} is no joint of a link of Denavit and Hartenberg; expected Rz or tz."
            )
    slots = [steps.index(transforms[i].kind) for i in places]
    first = 0
    if convention == "dh":
        first = places[0] - _fitting(transforms[: places[0]][::-1], steps[: slots[0]][::-1])
    starts = [first]
    for k, (place, slot) in enumerate(zip(places, slots, strict=True)):
        following = places[k + 1] if k + 1 < len(places) else len(transforms)
        end = place + 1 + _fitting(transforms[place + 1 : following], steps[slot + 1 :])
        if following == len(transforms):
            starts.append(end if convention == "mdh" else following)
            break
        gap = transforms[end:following]
        if _fitting(gap, steps[: slots[k + 1]]) != len(gap):
            raise InputError(f"{gap[0]} does not fit between two links of the convention {convention!r}.")
        starts.append(end)
    parts = [transforms[a:b] for a, b in pairwise(starts)]
    return [transforms[:first], *parts, transforms[starts[-1] :]]


def _fitting(transforms: Sequence[Any], steps: Sequence[str]) -> int:
    """How many of the first transforms are steps, in their order."""
    slot = 0
    for count, et in enumerate(transforms):
        if et.kind not in steps[slot:]:
            return count
        slot = list(steps).index(et.kind, slot) + 1
    return len(transforms)
