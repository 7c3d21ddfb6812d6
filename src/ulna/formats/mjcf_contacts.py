"""Which bodies of a compiled MJCF file may touch: its masks, exclusions, pairs and flags as pairs of links.

Source: MuJoCo documentation, "Computation", collision detection: the selection of pairs of geoms.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ulna.formats.mjcf_parse import FREE
from ulna.formats.mjcf_switches import Switches

Masks = tuple[tuple[int, int], ...]
"""contype and conaffinity of the geoms of a body, each pair of numbers once."""


@dataclass(frozen=True)
class Contacts:
    """The selection of contacts of a file.

    Attributes:
        geoms: indices of the geoms that can touch something.
        disabled: pairs of bodies, by index, that never touch.
        mixed: pairs of bodies of which some geoms may touch and others not.
        neighbours: pairs of bodies that <pair> names, joined rigidly or by one joint.
    """

    geoms: frozenset[int]
    disabled: tuple[tuple[int, int], ...]
    mixed: tuple[tuple[int, int], ...]
    neighbours: tuple[tuple[int, int], ...] = ()


def contacts(m: Any, switches: Switches) -> Contacts:
    """What may touch in a compiled model.

    Args:
        m: The compiled `mujoco.MjModel`.
        switches: What the file switches off.

    Returns:
        The geoms that may touch, and the pairs of bodies that never or only partly may.
    """
    paired = {int(g) for ends in (m.pair_geom1, m.pair_geom2) for g in ends}
    geoms = [g for g in range(m.ngeom) if m.geom_contype[g] or m.geom_conaffinity[g] or g in paired]
    if not switches.contacts:
        return Contacts(frozenset(), (), ())
    excluded = {(one, two) for one, two in map(_bodies, m.exclude_signature) if one != two}
    chosen = _chosen(m)
    masks = _masks(m, geoms)
    disabled, mixed = set(excluded), []
    bodies = sorted(masks)
    welded = m.body_weldid.tolist()
    before = m.body_weldid[m.body_parentid[m.body_weldid]].tolist()
    alike = len({mask for of_body in masks.values() for mask in of_body}) == 1
    for k, one in enumerate(bodies):
        # Where all masks are equal, and that is nearly always, only neighbours need a look.
        others = bodies[k + 1 :]
        if alike and _meet(masks[one][0], masks[one][0]):
            others = [b for b in others if before[b] == welded[one] or before[one] == welded[b]]
        for two in others:
            if (one, two) in excluded or m.body_weldid[one] == m.body_weldid[two]:
                continue
            allowed = {_meet(a, b) for a in masks[one] for b in masks[two]}
            if allowed == {False} or _filtered(m, one, two, switches):
                disabled.add((one, two))
            elif len(allowed) == 2:
                mixed.append((one, two))
    partly = [pair for pair, every in sorted(chosen.items()) if pair in disabled and not every]
    neighbours = tuple(pair for pair in sorted(chosen) if _are_neighbours(m, *pair))
    return Contacts(
        frozenset(geoms), tuple(sorted(disabled.difference(chosen))), (*mixed, *partly), neighbours
    )


def _chosen(m: Any) -> dict[tuple[int, int], bool]:
    """The pairs of bodies of which <pair> names geoms, and whether it names all their geoms that can touch."""
    named: dict[tuple[int, int], set[tuple[int, int]]] = {}
    for ends in zip(m.pair_geom1, m.pair_geom2, strict=True):
        one, two = sorted((int(g) for g in ends), key=lambda g: int(m.geom_bodyid[g]))
        named.setdefault((int(m.geom_bodyid[one]), int(m.geom_bodyid[two])), set()).add((one, two))
    paired = {int(g) for ends in (m.pair_geom1, m.pair_geom2) for g in ends}
    touching = (m.geom_contype != 0) | (m.geom_conaffinity != 0)
    touching[list(paired)] = True
    count = np.bincount(m.geom_bodyid[touching], minlength=m.nbody)
    return {(a, b): len(pairs) == count[a] * count[b] for (a, b), pairs in named.items()}


def _masks(m: Any, geoms: list[int]) -> dict[int, Masks]:
    masks_of: dict[int, dict[tuple[int, int], None]] = {}
    for g in geoms:
        mask = (int(m.geom_contype[g]), int(m.geom_conaffinity[g]))
        masks_of.setdefault(int(m.geom_bodyid[g]), {})[mask] = None
    return {body: tuple(masks) for body, masks in masks_of.items()}


def _meet(one: tuple[int, int], two: tuple[int, int]) -> bool:
    return bool(one[0] & two[1] or two[0] & one[1])


def _filtered(m: Any, one: int, two: int, switches: Switches) -> bool:
    """Whether two bodies do not touch because one carries the other, by more than one joint.

    Links joined by one joint are left out of the checks of collision in any case.
    """
    if not switches.filtered_parents:
        return False
    a, b = int(m.body_weldid[one]), int(m.body_weldid[two])
    for child, other in ((a, b), (b, a)):
        if child and other and m.body_weldid[m.body_parentid[child]] == other and m.body_jntnum[child] > 1:
            return True
    return False


def _are_neighbours(m: Any, one: int, two: int) -> bool:
    """Whether two bodies are one, or joined rigidly, or by one joint that is not free."""
    a, b = int(m.body_weldid[one]), int(m.body_weldid[two])
    if a == b:
        return True
    for child, other in ((a, b), (b, a)):
        if child and m.body_weldid[m.body_parentid[child]] == other and m.body_jntnum[child] == 1:
            return bool(m.jnt_type[m.body_jntadr[child]] != FREE)
    return False


def _bodies(signature: Any) -> tuple[int, int]:
    one, two = int(signature) >> 16, int(signature) & 0xFFFF
    return (one, two) if one < two else (two, one)
