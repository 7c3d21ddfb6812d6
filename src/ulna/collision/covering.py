"""Fits spheres to all links of a robot: how many each link takes, and which pairs of links need finer ones.

| symbol | meaning | unit |
|---|---|---|
| E | how far spheres of the links at the tips may stick out | [m] |
| w | how much farther those of a link may: 1 at the tips, up to 2 at the base, less where links pass closely | |

E is the least length, not below the tolerance, with which all links together take no more spheres than allowed. Links
near the tips work near obstacles, those near the base rarely meet them.
"""

from __future__ import annotations

import json
import warnings
from collections.abc import Callable, Collection, Mapping, Sequence
from contextlib import nullcontext
from functools import partial
from typing import Any

import numpy as np

from ulna import algorithms
from ulna import disk_cache as cache
from ulna.collision.cover import Task, task
from ulna.collision.exact import Checker
from ulna.collision.link_covers import LinkCover
from ulna.collision.pairs import LinkPair, link_pairs
from ulna.collision.solids import Missing, Solid, link_solids
from ulna.collision.spheres import Spheres, sphere_centres
from ulna.errors import InputError, MissingExtra, ModelWarning
from ulna.geometry import Mesh
from ulna.model import Model
from ulna.model.content import fingerprint
from ulna.model.of_robot import model_of
from ulna.system.callers import level_of_caller
from ulna.system.progress import progress as long_task
from ulna.typing import Array

Report = Callable[[int, int], object]
"""Called with how many steps are done, and of how many."""

_TOLERANCE = 0.01  # [m]
_VERSION = 8  # of the fit: changed with every change to what it finds
_BASE = 2.0  # w of what no joint moves
_CLOSER = 0.6  # factor of w where links pass closely
_ROUNDS = 2
_RATIO = 1.06
_STEPS = 200
_TRIALS = 64
_OFTEN = (
    0.2  # share of configurations in which spheres touch and links do not, from which a pair counts as close
)


def fit(
    model: Model | Any,
    tolerance: float = _TOLERANCE,
    most: int | None = None,
    *,
    missing: Missing = "error",
    progress: Report | None = None,
) -> Spheres:
    """Spheres that cover the collision geometry of every link; kept on disk, since computing them takes seconds.

    Balls are taken as they are. Links near the tips get finer spheres than those near the base, and so do links that
    pass each other closely. A warning (ModelWarning) names the pairs whose spheres touch in every configuration tried
    though the links do not.

    Args:
        model: The Model, or its Robot.
        tolerance: How far spheres may stick out at the tips [m], up to twice that at the base; farther where
            `most` is too small for that.
        most: How many spheres a link has on average, at most, besides shapes that are balls; None allows 60 spheres
            and 5.5 more for each link, 120 for an arm with a gripper of 11 links.
        missing: What to do about a mesh file that is missing: "error", or "skip" it with a warning.
        progress: Called with the numbers of steps that are done, and of all; its exceptions end the work. None shows
            them in the terminal, in notebooks and in open pages.

    Returns:
        The spheres of each link.

    Raises:
        InputError: If tolerance or count make no sense.
        ModelError: If the robot has no collision geometry, or a mesh is missing.
        MissingExtra: If scipy is not installed.
    """
    model = model_of(model, "model")
    if not (np.isfinite(tolerance) and tolerance >= 1e-4):
        raise InputError(f"`tolerance` is {tolerance!r}; expected a length of at least 0.0001 [m].")
    if most is not None and (int(most) != most or most < 1):
        raise InputError(f"`most` is {most!r}; expected a count, 1 or more.")
    solids = solids_by_link(model, missing)
    contents = {name: link_content(model, name, parts) for name, parts in solids.items()}
    budget = _default_budget(solids) if most is None else int(most) * len(solids)
    key = _key(model, contents, float(tolerance), budget)
    stored = cache.read(key)
    if stored is None:
        shown = long_task("Covering links with spheres") if progress is None else nullcontext(progress)
        with shown as report:
            fitted, blocked = _fit(model, solids, contents, float(tolerance), budget, report)
        cache.write(key, json.dumps([fitted.to_json(), blocked]).encode())
    else:
        text, blocked = json.loads(stored.decode())
        fitted = Spheres.from_json(text)
    _warn_of_blocked(blocked)
    return fitted


def is_fitted(model: Model, missing: Missing = "error") -> bool:
    """Whether `fit(model)` has been called before, so that spheres only have to be read.

    Args:
        model: The robot.
        missing: What to do about a mesh file that is missing: "error", or "skip" it with a warning.

    Returns:
        The truth value.
    """
    solids = solids_by_link(model, missing)
    contents = {name: link_content(model, name, parts) for name, parts in solids.items()}
    return cache.read(_key(model, contents, _TOLERANCE, _default_budget(solids))) is not None


def _default_budget(solids: Mapping[str, object]) -> int:
    """How many spheres all links together may have."""
    return int(60 + 5.5 * len(solids))


def _key(model: Model, contents: Mapping[str, str], tolerance: float, budget: int) -> str:
    """Where the spheres of a robot are stored."""
    parts = [_VERSION, model.fingerprint, contents, link_pairs(model), tolerance, budget]
    return cache.key("spheres", fingerprint(parts))


def solids_by_link(model: Model, missing: Missing = "error") -> dict[str, list[Solid]]:
    """The collision geometry of each link that has one.

    Args:
        model: The robot.
        missing: What to do about a mesh file that is missing: "error", or "skip" it with a warning.

    Returns:
        Solids by link name.
    """
    by_link: dict[str, list[Solid]] = {}
    for solid in link_solids(model, missing):
        by_link.setdefault(solid.owner, []).append(solid)
    return by_link


def link_task(model: Model, name: str, solids: Sequence[Solid]) -> Task:
    """The solids of a link in its frame, ready to be covered.

    Args:
        model: The robot.
        name: The link.
        solids: Its solids.

    Returns:
        The task.
    """
    base = model.link(name).placement.inverse()
    return task(solids, [base @ solid.placement for solid in solids])


def link_content(model: Model, name: str, solids: Sequence[Solid]) -> str:
    """What decides the spheres of a link, as a fingerprint; equal for links of equal shape.

    Args:
        model: The robot.
        name: The link.
        solids: Its solids.

    Returns:
        The fingerprint.
    """
    base = model.link(name).placement.inverse()
    parts = [
        [s.shape, base @ s.placement, s.vertices[s.triangles] if isinstance(s.shape, Mesh) else None]
        for s in solids
    ]
    return fingerprint(parts)


def _fit(
    model: Model,
    solids: Mapping[str, list[Solid]],
    contents: Mapping[str, str],
    tolerance: float,
    budget: int,
    progress: Report,
) -> tuple[Spheres, list[LinkPair]]:
    """The spheres, and the pairs of links whose spheres always touch though the links do not."""
    steps = 2 * len(solids) + _ROUNDS
    by_content: dict[str, LinkCover] = {}
    for k, (name, parts) in enumerate(solids.items()):
        progress(k, steps)
        if contents[name] not in by_content:
            key = cache.key("spheres of a link", str(_VERSION), contents[name])
            by_content[contents[name]] = LinkCover(key, partial(link_task, model, name, parts))
        by_content[contents[name]].is_done  # noqa: B018 the task is made while its step is shown
    covers = {name: by_content[content] for name, content in contents.items()}
    weights = _weights(model, list(solids))
    exact_links = {name for name, cover in covers.items() if cover.is_done}
    for attempt in range(_ROUNDS):
        spheres = {}
        for k, (name, count) in enumerate(_counts(covers, weights, tolerance, budget).items()):
            if not attempt:
                progress(len(solids) + k, steps)
            spheres[name] = covers[name].solve(count)
        fitted = Spheres(spheres)
        progress(2 * len(solids) + attempt, steps)
        close = close_pairs(model, fitted, exact_links)
        if not any(share > _OFTEN for share in close.values()):
            break
        for name in {name for pair, share in close.items() if share > _OFTEN for name in pair}:
            weights[name] *= _CLOSER
    for cover in by_content.values():
        cover.keep()
    progress(steps, steps)
    return fitted, [pair for pair, share in close.items() if share == 1.0]


def _weights(model: Model, links: Sequence[str]) -> dict[str, float]:
    """w of each link: by the share of the joints on the way to the farthest tip that come before it."""
    depth = [0] * len(model.joints)
    for k, joint in enumerate(model.joints):
        depth[k] = 1 + (depth[joint.parent] if joint.parent >= 0 else 0)
    farthest = list(depth)
    for k in reversed(range(len(depth))):
        if model.joints[k].parent >= 0:
            farthest[model.joints[k].parent] = max(farthest[model.joints[k].parent], farthest[k])
    weights = {}
    for name in links:
        j = model.link(name).joint
        weights[name] = _BASE if j < 0 else _BASE + (1.0 - _BASE) * depth[j] / farthest[j]
    return weights


def _counts(
    covers: Mapping[str, LinkCover], weights: Mapping[str, float], tolerance: float, budget: int
) -> dict[str, int]:
    """How many spheres each link takes with the least E that keeps to the budget."""

    def counts(step: int) -> dict[str, int]:
        E = tolerance * _RATIO**step
        return {name: cover.count(E * weights[name]) for name, cover in covers.items()}

    low, high = -1, _STEPS
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if sum(counts(middle).values()) <= budget else (middle, high)
    return counts(high)


def close_pairs(model: Model, spheres: Spheres, exact_links: Collection[str] = ()) -> dict[LinkPair, float]:
    """Pairs of moving links whose spheres touch in configurations in which the links do not.

    Args:
        model: The robot.
        spheres: Spheres of its links.
        exact_links: Links whose shapes are these very spheres: two of them touch where their spheres do.

    Returns:
        By pair the share of such configurations among some random ones; empty where coal is not installed.
    """
    q = algorithms.random(model, np.random.default_rng(0), (_TRIALS,))
    pairs = [pair for pair in link_pairs(model) if not set(pair) <= set(exact_links)]
    touching = {pair: hits for pair, hits in _sphere_hits(model, spheres, pairs, q).items() if hits.any()}
    if not touching:
        return {}
    try:
        checker = Checker(model, pairs=touching, missing="skip")
    except MissingExtra:
        return {}
    exact = checker.touching(q)
    owners = {frozenset(pair): k for k, pair in enumerate(checker.owners)}
    shares = {}
    for pair, hits in touching.items():
        k = owners.get(frozenset(pair))
        shares[pair] = float((hits & ~exact[:, k]).mean()) if k is not None else float(hits.mean())
    return {pair: share for pair, share in shares.items() if share > 0.0}


def _sphere_hits(
    model: Model, spheres: Spheres, pairs: Sequence[LinkPair], q: Array
) -> dict[LinkPair, Array]:
    """By pair of moving links, in which configurations spheres touch."""
    if not pairs:
        return {}
    placed = {
        name: np.broadcast_to(points, (len(q), *points.shape[-2:]))
        for name, points in sphere_centres(model, q, spheres).items()
    }
    hits = {}
    for a, b in pairs:
        if model.link(a).joint < 0 or model.link(b).joint < 0 or not {a, b} <= placed.keys():
            continue  # fixed links need no spheres against others; what was skipped has none
        reach = spheres.links[a].radii[:, None] + spheres.links[b].radii
        hit = np.zeros(len(q), dtype=bool)
        for k, radii in enumerate(reach):
            apart = ((placed[a][:, k, None] - placed[b]) ** 2).sum(axis=-1)
            hit |= (apart <= radii**2).any(axis=1)
        hits[a, b] = hit
    return hits


def _warn_of_blocked(pairs: Sequence[LinkPair]) -> None:
    if pairs:
        blocked = [f"{a!r} and {b!r}" for a, b in pairs]
        shown = ", ".join(blocked[:5]) + (" ..." if len(blocked) > 5 else "")
        warnings.warn(
            f"The spheres of {shown} touch in every configuration tried, though the links do not: by spheres the robot "
            "is never free. Take finer spheres (a larger `most`, or ulna.collision.refine), or disable the pairs.",
            ModelWarning,
            stacklevel=level_of_caller(),
        )
