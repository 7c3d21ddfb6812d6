"""Few spheres that cover a region and stick out of it as little as possible: a k-centre problem.

| symbol | meaning | shape | unit |
|---|---|---|---|
| x | points to cover: of the surface, and of the inside | (n, 3) | [m] |
| c, r | centres and radii of spheres | (k, 3), (k,) | [m] |
| s | signed distance of a centre from the surface, negative inside | (k,) | [m] |
| C | excess of a sphere about c that just covers x: abs(x - c) + s(c) | (n, m) | [m] |
| e | the largest excess | | [m] |

A point of a sphere is no farther from the region than abs(point - c) + s(c), for the ball about c with radius -s(c)
is inside: so r + s(c) bounds how far the sphere sticks out. To cover all x with k spheres and the least e is to
choose k centres with the least max over x of min over c of C. A greedy cover decides how many spheres an e takes;
from there each point goes to the sphere with the least C, and each centre to where the largest C of its points is
least, first among given candidates, then by shorter and shorter steps.

Sources: Hochbaum and Shmoys, A best possible heuristic for the k-center problem, Mathematics of Operations Research 10
(1985); Chvatal, A greedy heuristic for the set-covering problem, ibid. 4 (1979); Lloyd, Least squares quantization in
PCM, IEEE Transactions on Information Theory 28 (1982), with the largest instead of the mean.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ulna.collision.problem import Problem, distances_between, squared_distances
from ulna.typing import Array, Floats

_ROUNDS = 40
_SWAPS, _FAILURES = 8, 2
_CORNERS = np.stack(np.meshgrid(*[[-1.0, 1.0]] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
_DIRECTIONS = np.vstack([np.eye(3), -np.eye(3), _CORNERS / np.sqrt(3.0)])


def place(problem: Problem, count: int) -> Floats:
    """Centres of spheres with a small largest excess.

    Args:
        problem: What to cover.
        count: How many spheres.

    Returns:
        Centres, shape (k, 3) [m], k at most `count`.
    """
    if problem.is_empty:
        return np.zeros((0, 3))
    chosen = _local_optimum(problem.cost, np.array(problem.start(count)))
    c = _pattern_search(problem, problem.candidates[chosen].copy())
    while len(c) < count:
        c = _pattern_search(problem, _with_largest_split(problem, c))
    return _improved_by_swaps(problem, c)


def _with_largest_split(problem: Problem, c: Floats) -> Floats:
    """Centres with two in place of the one with the largest excess."""
    costs = distances_between(problem.points, c) + problem.region.signed(c)
    least = costs.min(axis=1)
    largest = int(costs[least.argmax()].argmin())
    half = (problem.points[least.argmax()] - c[largest]) / 2.0
    return np.vstack([np.delete(c, largest, axis=0), c[largest] + half, c[largest] - half])


def _local_optimum(cost: Floats, chosen: Array) -> Array:
    """Candidates after Lloyd's iteration: each has the least largest excess for the samples assigned to it."""
    best, least = chosen, np.inf
    for _ in range(_ROUNDS):
        costs = cost[:, chosen]
        worst = float(costs.min(axis=1).max())
        if worst >= least - 1e-6:
            break
        best, least = chosen, worst
        owners = costs.argmin(axis=1)
        mine = [cost[owners == k] for k in range(len(chosen))]
        chosen = np.array([int(rows.max(axis=0).argmin()) for rows in mine if len(rows)])
    return best


def divided(problem: Problem, c: Floats, numbers: Sequence[int]) -> Floats:
    """Centres with two in place of each of some, moved to where their excess is least.

    Args:
        problem: What to cover.
        c: Centres, shape (k, 3) [m].
        numbers: Which to divide.

    Returns:
        Centres, shape (n, 3) [m], n = k + the count of `numbers`.
    """
    owners = (distances_between(problem.points, c) + problem.region.signed(c)).argmin(axis=1)
    more = []
    for k in numbers:
        x = problem.points[owners == k]
        if not len(x):
            continue
        a = x[((x - c[k]) ** 2).sum(axis=1).argmax()]
        b = x[((x - a) ** 2).sum(axis=1).argmax()]
        more.append(c[k] + (b - a) / 4.0)
        c[k] = c[k] - (b - a) / 4.0
    return _pattern_search(problem, np.vstack([c, *more]))


def _improved_by_swaps(problem: Problem, c: Floats) -> Floats:
    """Centres after swaps: the one whose removal costs least is placed beside the one with the largest excess.

    Ends when `_FAILURES` swaps in a row do not lower the largest excess.
    """
    costs = distances_between(problem.points, c) + problem.region.signed(c)
    failed: list[tuple[int, int]] = []
    for _ in range(_SWAPS if len(c) > 2 else 0):
        owners = costs.argmin(axis=1)
        least, second = np.partition(costs, 1, axis=1)[:, :2].T
        largest = int(owners[least.argmax()])
        cost_of_removal = np.array([second[owners == k].max(initial=0.0) for k in range(len(c))])
        cost_of_removal[[largest, *(spare for other, spare in failed if other == largest)]] = np.inf
        spare = int(cost_of_removal.argmin())
        trial, half = c.copy(), (problem.points[least.argmax()] - c[largest]) / 2.0
        trial[spare], trial[largest] = c[largest] + half, c[largest] - half
        trial = _pattern_search(problem, trial)
        distances = distances_between(problem.points, trial) + problem.region.signed(trial)
        if distances.min(axis=1).max() < least.max() - 1e-5:
            c, costs, failed = trial, distances, []
        else:
            failed.append((largest, spare))
            if len(failed) == min(_FAILURES, len(c) - 1):
                break
    return c


def _pattern_search(problem: Problem, c: Floats) -> Floats:
    """Centres moved by shorter and shorter steps while that makes the excess of their points less."""
    region, x, step = problem.region, problem.points, 2.0 * problem.region.h
    along = np.ascontiguousarray(x.T)
    s, s_trials = region.signed(c), np.zeros((len(c), len(_DIRECTIONS)))
    lengths = distances_between(c, x)
    stale = np.ones(len(c), dtype=bool)
    for _ in range(_ROUNDS):
        trials = c[:, None] + step * _DIRECTIONS
        s_trials[stale] = region.signed(trials[stale].reshape(-1, 3)).reshape(-1, len(_DIRECTIONS))
        stale[:] = False
        costs = lengths + s[:, None]
        owners = costs.argmin(axis=0)
        least = costs[owners, np.arange(len(x))]
        most = np.full(len(c), -np.inf)
        np.maximum.at(most, owners, least)
        near = np.flatnonzero(
            least > most[owners] - 2.0 * step
        )  # no other can be the farthest after the step
        near = near[np.argsort(owners[near], kind="stable")]
        starts = np.flatnonzero(np.diff(owners[near], prepend=-1))
        k = owners[near[starts]]
        e = np.sqrt(
            np.maximum.reduceat(
                _squared_distances_by_owner(along[:, near], trials, owners[near]), starts, axis=1
            )
        )
        e += s_trials[k].T
        best = e.argmin(axis=0)
        better = e[best, np.arange(len(k))] < most[k] - 1e-5
        k, best = k[better], best[better]
        c[k], s[k], stale[k] = trials[k, best], s_trials[k, best], True
        if stale.any():
            lengths[stale] = distances_between(c[stale], x)
        else:
            step /= 2.0
            stale[:] = True
            if step < region.h / 8.0:
                break
    return c


def _squared_distances_by_owner(points: Floats, trials: Floats, owners: Array) -> Floats:
    """Squared distances of points, shape (3, n), from the trials of their owners, shape (directions, n) [m^2]."""
    total = (points[0] - trials[..., 0].T[:, owners]) ** 2
    for axis in (1, 2):
        total += (points[axis] - trials[..., axis].T[:, owners]) ** 2
    return total


def covered(problem: Problem, c: Floats) -> tuple[Floats, Floats]:
    """Radii with which spheres cover everything for sure.

    A triangle whose corners are in a sphere is in it; each piece of the surface goes to the sphere whose excess it
    makes least. Then cavities between the spheres, which are not connected to the outside, are filled.

    Args:
        problem: What to cover.
        c: Centres, shape (k, 3) [m].

    Returns:
        Centres and radii of the spheres that are needed, shapes (n, 3), (n,) [m].
    """
    s = problem.region.signed(c)
    corners = [np.ascontiguousarray(problem.pieces[:, k].T) for k in range(3)]
    farthest = np.zeros((len(c), len(problem.pieces)))
    for corner in corners:
        np.maximum(farthest, squared_distances(c, corner), out=farthest)
    r = _grown(np.zeros(len(c)), np.sqrt(farthest, out=farthest), s)
    for _ in range(3):
        cavities = _cavities(problem, c, r)
        if not len(cavities):
            break
        r = _grown(r, np.sqrt(squared_distances(c, np.ascontiguousarray(cavities.T))), s)
    used = r > 0.0
    return c[used], r[used] * (1.0 + 1e-12) + 1e-12


def _grown(r: Floats, lengths: Floats, s: Floats) -> Floats:
    """Radii not less than r with which each column of distances is within the sphere that it makes stick out least."""
    owners = (np.maximum(lengths, r[:, None]) + s[:, None]).argmin(axis=0)
    r = r.copy()
    np.maximum.at(r, owners, lengths[owners, np.arange(lengths.shape[1])])
    return r


def _cavities(problem: Problem, c: Floats, r: Floats) -> Floats:
    """Centres of cells outside all spheres that are not connected to the outside."""
    from scipy import ndimage

    region = problem.region
    axes = [region.origin[k] + (np.arange(n) + 0.5) * region.h for k, n in enumerate(region.inside.shape)]
    free = np.ones(region.inside.shape, dtype=bool)
    for centre, radius in zip(c, r, strict=True):
        x, y, z = ((axis - centre[k]) ** 2 for k, axis in enumerate(axes))
        free &= x[:, None, None] + y[:, None] + z > radius**2
    labels, count = ndimage.label(free)  # type: ignore[misc]
    if count < 2:
        return np.zeros((0, 3))
    boundary = np.ones_like(region.inside)
    boundary[1:-1, 1:-1, 1:-1] = False
    return region.centres((labels > 0) & ~np.isin(labels, np.unique(labels[boundary])))
