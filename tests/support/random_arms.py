"""Random arms whose axes lie in the ways that matter for inverse kinematics; the same for the same seed."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ulna.model import Continuous, Model, ModelBuilder, Prismatic, Revolute
from ulna.spatial import SE3

Rng = np.random.Generator
Lines = list[tuple[np.ndarray, np.ndarray]]
"""Directions and points."""


def _any(rng: Rng) -> Lines:
    lines = []
    for _ in range(6):
        h = rng.standard_normal(3)
        lines.append((h / np.linalg.norm(h), rng.uniform(-0.5, 0.5, 3)))
    return lines


def _meeting(*groups: Sequence[int]) -> Callable[[Rng], Lines]:
    def make(rng: Rng) -> Lines:
        lines = _any(rng)
        for group in groups:
            for i in group:
                lines[i] = (lines[i][0], lines[group[0]][1])
        return lines

    return make


def _parallel(group: Sequence[int], *meeting: Sequence[int]) -> Callable[[Rng], Lines]:
    def make(rng: Rng) -> Lines:
        lines = _meeting(*meeting)(rng)
        return [(lines[group[0]][0], p) if i in group else (h, p) for i, (h, p) in enumerate(lines)]

    return make


def _quarter_turns(rng: Rng) -> Lines:
    """Like most robots: axes along the axes of space, some of them meeting."""
    while True:
        lines: Lines = []
        T = SE3.identity()
        for _ in range(6):
            lines.append((T.rotation[:, 2].round(), T.translation))
            step = SE3.trans(*(rng.uniform(0.1, 0.5, 3) * rng.integers(0, 2, 3)))
            turn = SE3.rz(0.5 * np.pi * rng.integers(4)) @ SE3.rx(0.5 * np.pi * rng.integers(4))
            T = T @ step @ SE3(turn.rotation.round(), np.zeros(3))
        if _is_able(lines, rng):
            return lines


def _is_able(lines: Lines, rng: Rng) -> bool:
    """Whether six such joints move the tool in every direction."""
    T, columns = SE3.identity(), []
    for h, p in lines:
        own = SE3.exp(np.concatenate([np.cross(p, h), h]) * rng.uniform(-2.0, 2.0))
        now, at = T.rotation @ h, T @ p
        columns.append(np.concatenate([np.cross(at, now), now]))
        T = T @ own
    return bool(np.linalg.svd(np.array(columns), compute_uv=False)[-1] > 0.02)


CLOSED: dict[str, Callable[[Rng], Lines]] = {
    "spherical wrist, 2 parallel 3": _parallel((1, 2), (3, 4, 5)),
    "spherical wrist, 1 meets 2": _meeting((3, 4, 5), (0, 1)),
    "spherical wrist": _meeting((3, 4, 5)),
    "spherical shoulder": _meeting((0, 1, 2)),
    "spherical shoulder, 5 meets 6": _meeting((0, 1, 2), (4, 5)),
    "spherical 2 3 4": _meeting((1, 2, 3)),
    "spherical 3 4 5, 1 parallel 2": _parallel((0, 1), (2, 3, 4)),
    "parallel 2 3 4, 5 meets 6": _parallel((1, 2, 3), (4, 5)),
    "parallel 1 2 3": _parallel((0, 1, 2)),
    "parallel 2 3 4": _parallel((1, 2, 3)),
    "parallel 3 4 5": _parallel((2, 3, 4)),
    "parallel 4 5 6": _parallel((3, 4, 5)),
}
"""Arms that closed forms solve."""

GENERAL: dict[str, Callable[[Rng], Lines]] = {
    "general": _any,
    "5 meets 6": _meeting((4, 5)),
    "1 meets 2, 3 meets 4, 5 meets 6": _meeting((0, 1), (2, 3), (4, 5)),
    "2 parallel 3": _parallel((1, 2)),
    "2 parallel 3, 5 meets 6": _parallel((1, 2), (4, 5)),
    "quarter turns": _quarter_turns,
}
"""Arms that closed forms do not solve, or not always."""


def model_of(lines: Lines, rng: Rng, *, lower: float = -np.pi, upper: float = np.pi) -> Model:
    """The arm with those axes: joints placed anywhere along them, a link and a tool with any pose after the last."""
    b = ModelBuilder("arm")
    b.add_link("link0")
    before = SE3.identity()
    for i, (h, p) in enumerate(lines):
        here = SE3(SE3.random(rng).rotation, p + h * rng.uniform(-0.2, 0.2))
        axis = here.rotation.T @ h
        b.add_link(f"link{i + 1}")
        kind = Revolute((axis[0], axis[1], axis[2]))
        b.add_joint(
            f"joint{i + 1}",
            kind,
            f"link{i}",
            f"link{i + 1}",
            before.inverse() @ here,
            lower=lower,
            upper=upper,
        )
        before = here
    b.add_frame("tip", f"link{len(lines)}", SE3.random(rng, reach=0.3)).set_tool("tip")
    return b.build()


def redundant(kinds: str, rng: Rng) -> Model:
    """An arm with joints R (revolute), C (continuous) and P (prismatic) whose last three axes meet."""
    b = ModelBuilder("redundant")
    b.add_link("link0")
    for i, letter in enumerate(kinds):
        place = SE3.random(rng, reach=0.4)
        if i > len(kinds) - 3:
            place = SE3(place.rotation, np.zeros(3))
        b.add_link(f"link{i + 1}")
        kind = {"R": Revolute, "C": Continuous, "P": Prismatic}[letter]((0.0, 0.0, 1.0))
        bounds = {"R": (-3.0, 3.0), "C": (None, None), "P": (-0.5, 0.5)}[letter]
        b.add_joint(
            f"joint{i + 1}", kind, f"link{i}", f"link{i + 1}", place, lower=bounds[0], upper=bounds[1]
        )
    b.add_frame("tip", f"link{len(kinds)}", SE3.random(rng, reach=0.3)).set_tool("tip")
    return b.build()
