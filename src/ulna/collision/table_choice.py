"""Which pairs of links have tables of proved clearance: those whose spheres touch unduly; kept on disk."""

from __future__ import annotations

import json
import math
import zlib
from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache, partial

import numpy as np

from ulna import disk_cache
from ulna.collision.convex_pieces import convex_pieces
from ulna.collision.covering import link_content, solids_by_link
from ulna.collision.joint_chains import JointChain, joint_chain
from ulna.collision.pair_distance import PairDistance
from ulna.collision.pair_tables import MOST_JOINTS, PairTable, pair_table, ranges
from ulna.collision.pairs import LinkPair
from ulna.collision.solids import Missing, Solid
from ulna.collision.spheres import Spheres
from ulna.errors import MissingExtra
from ulna.model import Model
from ulna.model.content import fingerprint
from ulna.system.progress import progress
from ulna.typing import Array, Floats

_VERSION = "pair tables 11"
_TRIALS = 500
_QUERIES, _ALL_QUERIES = 60_000, 500_000  # distances that are asked for: of a pair, and of a robot
_OFTEN = 0.004  # share of configurations in which spheres touch and links do not, from which a table is made

Solids = tuple[Sequence[Solid], Sequence[Solid]]


@lru_cache(maxsize=32)
def pair_tables(
    model: Model, spheres: Spheres, pairs: tuple[LinkPair, ...], missing: Missing
) -> tuple[PairTable, ...]:
    """The tables of pairs of links whose spheres touch where the links do not.

    Args:
        model: The robot.
        spheres: Spheres of its links.
        pairs: Pairs of links.
        missing: What to do about mesh files that are missing: "error", or "skip" them with a warning.

    Returns:
        The tables; none where coal is not installed.
    """
    candidates, contents, name = _prepared(model, spheres, pairs, missing)
    stored = disk_cache.read(name)
    try:
        if stored is None:
            with progress("Measuring how near links come to each other") as report:
                return _made(model, spheres, candidates, contents, name, report)
        chosen = [pair for pair, is_chosen in zip(candidates, json.loads(stored), strict=True) if is_chosen]
        queries = _queries(len(chosen))
        return tuple(
            table
            for pair in chosen
            if (
                table := _cached_table(
                    model,
                    pair,
                    candidates[pair][0],
                    partial(_pieces, candidates[pair][1]),
                    contents[pair],
                    queries,
                    _no_progress,
                )
            )
            is not None
        )
    except MissingExtra:
        return ()


def are_known(model: Model, spheres: Spheres, pairs: tuple[LinkPair, ...], missing: Missing) -> bool:
    """Whether `pair_tables` has been called before, so that tables only have to be read.

    Args:
        model: The robot.
        spheres: Spheres of its links.
        pairs: Pairs of links.
        missing: What to do about mesh files that are missing: "error", or "skip" them with a warning.

    Returns:
        The truth value.
    """
    return disk_cache.read(_prepared(model, spheres, pairs, missing)[2]) is not None


def _prepared(
    model: Model, spheres: Spheres, pairs: tuple[LinkPair, ...], missing: Missing
) -> tuple[dict[LinkPair, tuple[JointChain, Solids]], dict[LinkPair, str], str]:
    """The pairs that can have tables, with joints and solids and what decides them, and where the choice is stored."""
    solids = solids_by_link(model, missing)
    candidates = {}
    for pair in pairs:
        chain = joint_chain(model, *pair) if all(name in solids for name in pair) else None
        if chain is not None and 0 < len(chain.columns) <= MOST_JOINTS and ranges(model, chain) is not None:
            candidates[pair] = chain, (solids[pair[0]], solids[pair[1]])
    shapes = {
        name: link_content(model, name, solids[name]) for name in {n for pair in candidates for n in pair}
    }
    contents = {pair: _content(model, pair, chain, shapes) for pair, (chain, _) in candidates.items()}
    choice = fingerprint([spheres.fingerprint, list(contents.values())])
    return candidates, contents, disk_cache.key(_VERSION, "choice", choice)


def _made(
    model: Model, spheres: Spheres, candidates: dict[LinkPair, tuple[JointChain, Solids]],
    contents: dict[LinkPair, str], name: str, report: Callable[[int, int], object],
) -> tuple[PairTable, ...]:  # fmt: skip
    """Chooses pairs and makes their tables, and writes both."""
    parts: dict[str, list[Solid]] = {}

    def pieces(pair: LinkPair) -> Solids:
        first, second = (
            parts.get(name) or parts.setdefault(name, convex_pieces(solids))
            for name, solids in zip(pair, candidates[pair][1], strict=True)
        )
        return first, second

    steps, shares = 5 * len(candidates), {}
    for k, (pair, (chain, _)) in enumerate(candidates.items()):
        report(k, steps)
        shares[pair] = _false_contact_rate(model, spheres, pair, chain, partial(pieces, pair))
    chosen = [pair for pair, share in shares.items() if share >= _OFTEN]
    tables, queries = [], _queries(len(chosen))
    for k, pair in enumerate(chosen):
        tick = partial(report, len(candidates) + 4 * k * len(candidates) // len(chosen), steps)
        table = _cached_table(
            model, pair, candidates[pair][0], partial(pieces, pair), contents[pair], queries, tick
        )
        tables += [] if table is None else [table]
    disk_cache.write(name, json.dumps([pair in chosen for pair in candidates]).encode())
    report(steps, steps)
    return tuple(tables)


def _false_contact_rate(
    model: Model, spheres: Spheres, pair: LinkPair, chain: JointChain, pieces: Callable[[], Solids]
) -> float:
    """The share of random configurations in which spheres of links touch and the links do not."""
    low, span, *_ = _ranges(model, chain)
    q = np.zeros((_TRIALS, model.nq))
    q[:, list(chain.columns)] = low + np.random.default_rng(0).uniform(size=(_TRIALS, len(low))) * span
    T, _, _ = chain.poses(q)
    balls = [spheres.links[name] for name in pair]
    first, second = (
        model.link(name).placement @ those.centres for name, those in zip(pair, balls, strict=True)
    )
    second = second @ np.swapaxes(T.rotation, -1, -2) + T.translation[:, None]
    reach = balls[0].radii[:, None] + balls[1].radii
    hits = np.array([(np.linalg.norm(first[:, None] - c, axis=-1) <= reach).any() for c in second])
    if hits.mean() < _OFTEN:
        return 0.0
    T = type(T)(T.rotation[hits], T.translation[hits])
    return float((PairDistance(*pieces()).least(T) > 0.0).sum()) / _TRIALS


def _queries(count: int) -> int:
    """How many distances are asked for each of so many tables: robots of many pairs take coarser ones."""
    return min(_QUERIES, _ALL_QUERIES // max(count, 1))


def _pieces(solids: Solids) -> Solids:
    return convex_pieces(solids[0]), convex_pieces(solids[1])


def _no_progress() -> None:
    """Reports nothing: what was made before is only read."""


def _ranges(model: Model, chain: JointChain) -> tuple[Floats, Floats, Array, Floats, Floats]:
    position_ranges = ranges(model, chain)
    assert position_ranges is not None
    return position_ranges


def _content(model: Model, pair: LinkPair, chain: JointChain, shapes: Mapping[str, str]) -> str:
    """What decides the table of a pair, as a fingerprint."""
    links = [[name, shapes[name], model.link(name).placement] for name in pair]
    joints = [
        [j.step.kind, j.step.placement, j.step.multiplier, j.step.offset, j.step.ratio, j.is_upward, j.column,
         None if j.step.joint.mimic is None else j.step.joint.mimic.offset]
        for j in chain.joints
    ]  # fmt: skip
    return fingerprint([_VERSION, links, joints, *_ranges(model, chain)])


def _cached_table(
    model: Model, pair: LinkPair, chain: JointChain, pieces: Callable[[], Solids], content: str, queries: int,
    tick: Callable[[], object],
) -> PairTable | None:  # fmt: skip
    """The table of a pair, from the disk where it was made before."""
    name = disk_cache.key(_VERSION, "table", content, str(queries))
    stored = disk_cache.read(name)
    if stored is not None:
        shape = json.loads(stored[: stored.index(b"\n")])
        numbers = zlib.decompress(stored[stored.index(b"\n") + 1 :])
        size = math.prod(shape)
        codes = np.frombuffer(numbers, np.uint8, size).reshape(shape)
        slopes = np.frombuffer(numbers, np.int8, offset=size).reshape(*shape, len(shape))
        return PairTable(*pair, chain.columns, *_ranges(model, chain), codes, slopes)
    table = pair_table(model, pair, chain, pieces(), queries, tick)
    if table is not None:
        head = json.dumps(table.codes.shape).encode() + b"\n"
        disk_cache.write(name, head + zlib.compress(table.codes.tobytes() + table.slopes.tobytes(), 3))
    return table
