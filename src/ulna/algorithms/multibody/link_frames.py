"""Moving frames chosen so that passing a vector from one to the next takes the fewest operations.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| P, J(q), X | pose of the fixed frame, of the joint, of the moving frame in the parent's | SE3 | [m] | X = P J(q) |
| u | axis of a revolute or prismatic step | (3) | [1] | |
| C | the new moving frame in the old one | SE3 | [m] | a turn and a slide along u, after which u is a coordinate axis |
| X' | the same for the new frames | SE3 | [m] | X' = C_p^-1 X C = P' J'(q + offset) |

A turn about u and a slide along it commute with J, so the new frame is as good as the old one: S is the same. They are
chosen, axis by axis from the root, among those that make an entry of P' or of a child's placement vanish; the turns
become offsets of the angles. What is left are the parameters of Denavit & Hartenberg (Siciliano, section 2.8.2), or
fewer where that form would be denser than the file's. The choice is made once for a model, on numbers.
"""

from __future__ import annotations

import math
import weakref
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from ulna.algorithms.multibody.tree import Step, chain, steps
from ulna.model import Continuous, Frame, JointKind, Model, Prismatic, Revolute
from ulna.numeric import is_symbolic
from ulna.spatial import SE3
from ulna.typing import Array, Floats

_EXACT = 1e-14
_TURN_COST = {3: 0, 4: 6, 5: 12, 6: 15, 7: 18, 8: 24, 9: 30}  # operations by how many entries are not zero
_SLIDE_COST = (0, 4, 8, 12)
_CHOICES = (
    8  # children from whose placements turns and slides are taken; the cost of each counts all children
)
_LONG, _LONGEST = 24, 200
"""Steps of a chain for which the frames are chosen where only poses are asked for.

Files of robots with fewer mostly have axes along coordinate axes; for more, the choice takes longer than compiling."""


class LinkFrames(NamedTuple):
    """Steps between optimised link frames."""

    tree: tuple[Step, ...]
    frames: tuple[SE3, ...]
    """C: the pose of each moving frame in the one that the model names."""


def frame_chain(model: Model, frame: Frame, q: Array) -> tuple[Sequence[Step], SE3]:
    """The steps between the world and a frame, and the frame's pose in the moving frame of the last one.

    Args:
        model: The robot.
        frame: A frame of the model.
        q: Configuration, shape (..., nq) [rad, m]. Where it is traced, the moving frames of many steps are optimised.

    Returns:
        The steps, root first, and the pose [m].
    """
    tree = chain(model, frame)
    if not (_LONG <= len(tree) <= _LONGEST and is_symbolic(q)):
        return tree, frame.placement
    links = choose_link_frames(model, model.support(frame.joint))
    return links.tree, links.frames[-1].inverse() @ frame.placement


def choose_link_frames(model: Model, joints: Sequence[int] | None = None) -> LinkFrames:
    """The steps of a model between moving frames whose placements have as few entries other than 0 and 1 as possible.

    Args:
        model: The robot; where its placements are not numbers, the frames it names are returned.
        joints: The joints whose steps are wanted, parents first and each with its parent; None for all.

    Returns:
        The steps between the new frames, and the poses of these in the old ones.
    """
    key = id(model)
    found = _chosen.get(key) if joints is None else None
    if found is not None and found[0]() is model:
        return found[1]
    old = steps(model, joints)
    if is_symbolic(*(x for s in old for x in (s.placement.rotation, s.placement.translation))):
        return LinkFrames(old, tuple(SE3.identity() for _ in old))
    links = _choose(old)
    if joints is None:
        _chosen[key] = weakref.ref(model, lambda _, chosen=_chosen: chosen.pop(key, None)), links
    return links


_chosen: dict[int, tuple[weakref.ref[Model], LinkFrames]] = {}
"""What was chosen for a model, by its address, while it lives.

A choice takes a tenth to a third of the time of tracing a kernel, and each kernel of the model would make it anew."""


def _choose(old: Sequence[Step]) -> LinkFrames:
    """The steps between new frames for steps whose placements are numbers."""
    children: list[list[int]] = [[] for _ in old]
    for i, step in enumerate(old):
        if step.parent >= 0:
            children[step.parent].append(i)
    tree: list[Step] = []
    frames: list[SE3] = []
    for i, step in enumerate(old):
        P = frames[step.parent].inverse() @ step.placement if step.parent >= 0 else step.placement
        kind, C = _aligned(step.kind)
        P = _clean(P @ C)
        offset = 0.0
        u = _axis(kind)
        if u is not None:
            outer = [(C.inverse() @ old[c].placement, _axis(_aligned(old[c].kind)[0])) for c in children[i]]
            if isinstance(kind, Revolute):
                rotation, offset = _absorbed(P.rotation, u)
                P = SE3(rotation, P.translation)
            turn, slide = _best(P, u, outer, may_turn=isinstance(kind, Revolute))
            P = _clean(P @ SE3(np.eye(3), slide * u))
            offset += turn
            C = C @ SE3(_about(u, turn), slide * u)
        offset = math.remainder(offset, 2.0 * math.pi)
        tree.append(replace(step, placement=P, kind=kind, offset=offset))
        frames.append(C)
    return LinkFrames(tuple(tree), tuple(frames))


def _aligned(kind: JointKind) -> tuple[JointKind, SE3]:
    """A joint like this about or along z, unless its axis is a coordinate axis, and the frame it is so in."""
    if not isinstance(kind, (Revolute, Continuous, Prismatic)):
        return kind, SE3.identity()
    u = np.asarray(kind.axis)
    if np.count_nonzero(u) == 1:
        return kind, SE3.identity()
    x = np.cross(np.eye(3)[np.abs(u).argmin()], u)
    x /= np.linalg.norm(x)
    return type(kind)((0.0, 0.0, 1.0)), SE3(np.stack([x, np.cross(u, x), u], axis=-1), np.zeros(3))


def _axis(kind: JointKind) -> Floats | None:
    return np.asarray(kind.axis) if isinstance(kind, (Revolute, Continuous, Prismatic)) else None


def _best(
    P: SE3, u: Floats, outer: Sequence[tuple[SE3, Floats | None]], may_turn: bool
) -> tuple[float, float]:
    """The turn [rad] and the slide [m] along u with the fewest operations in P and in the children's placements."""
    k = int(np.abs(u).argmax())
    chosen = outer[:_CHOICES]
    turns = list(dict.fromkeys(_turns(u, chosen))) if may_turn else [0.0]
    slides = [0.0, -float(P.translation @ P.rotation @ u), *(float(p.translation @ u) for p, _ in chosen)]
    slides = list(dict.fromkeys(slides))
    along = {slide: _count([p.translation[k] - slide * u[k] for p, _ in outer], 1) for slide in slides}
    own_cost = {slide: _slide_cost(P.translation + P.rotation @ u * slide) for slide in slides}
    costs: list[tuple[float, float, float]] = []
    for turn in turns:
        across, rotations = _outer_costs(_about(u, -turn), k, outer)
        for slide in slides:
            entries = int(np.take(_SLIDE_COST, across + along[slide]).sum())
            total = own_cost[slide] + rotations + entries + 0.5 * (turn != 0.0) + 0.1 * (slide != 0.0)
            costs.append((total, turn, slide))
    _, turn, slide = min(costs, key=lambda cost: cost[0])
    return turn, slide


def _outer_costs(R: Floats, k: int, outer: Sequence[tuple[SE3, Floats | None]]) -> tuple[Floats, int]:
    """Of placements in a frame turned by R^-1: entries of translations across axis k, cost of all rotations."""
    across = _count([np.delete(R @ placement.translation, k) for placement, _ in outer], 2)
    total = 0
    for placement, axis in outer:
        rotation = R @ placement.rotation
        rotation = rotation if axis is None else _absorbed(rotation, axis)[0]
        total += _TURN_COST[int(_count([rotation], 9)[0])]
    return across, total


def _count(rows: Sequence[Any], width: int) -> Any:
    """How many entries of each row, `width` wide, are not zero."""
    return (np.abs(np.reshape(rows, (len(rows), width))) > _EXACT).sum(axis=1)


def _turns(u: Floats, outer: Sequence[tuple[SE3, Floats | None]]) -> Iterator[float]:
    """Angles that bring a child's axis or origin into a coordinate plane."""
    yield 0.0
    k = int(np.abs(u).argmax())
    a, b = (k + 1) % 3, (k + 2) % 3
    for placement, axis in outer:
        for w in (placement.translation, None if axis is None else placement.rotation @ axis):
            if w is not None and min(abs(w[a]), abs(w[b])) > _EXACT:
                yield float(u[k] * np.arctan2(w[b], w[a]))


def _absorbed(R: Floats, u: Floats) -> tuple[Floats, float]:
    """R' and an angle with R = R' Rot(u, angle), R' as sparse as can be."""
    w = R @ u
    w = np.where(np.abs(w) < _EXACT, 0.0, w)
    candidates = [R]
    k = int(np.abs(u).argmax())
    a, b = (k + 1) % 3, (k + 2) % 3
    for n in range(3):
        side = np.cross(np.eye(3)[n], w)
        if np.linalg.norm(side) < 0.1:
            continue
        side = side / np.linalg.norm(side)
        other = np.empty((3, 3))
        other[:, k], other[:, a] = u[k] * w, side
        other[:, b] = np.cross(other[:, k], side)
        candidates.append(_snapped(other))
    best = min(candidates, key=lambda C: int((np.abs(C) > _EXACT).sum()))
    turned = best.T @ R
    return best, 0.0 if best is R else float(u[k] * np.arctan2(turned[b, a], turned[a, a]))


def _about(u: Floats, angle: float) -> Floats:
    k = int(np.abs(u).argmax())
    a, b = (k + 1) % 3, (k + 2) % 3
    R = np.eye(3)
    R[a, a] = R[b, b] = np.cos(angle)
    R[b, a] = u[k] * np.sin(angle)
    R[a, b] = -R[b, a]
    return R


def _clean(T: SE3) -> SE3:
    return SE3(_snapped(T.rotation), np.where(np.abs(T.translation) < _EXACT, 0.0, T.translation))


def _snapped(R: Floats) -> Floats:
    for value in (0.0, 1.0, -1.0):
        R = np.where(np.abs(R - value) < _EXACT, value, R)
    return R


def _slide_cost(p: Floats) -> int:
    return _SLIDE_COST[int((np.abs(p) > _EXACT).sum())]
