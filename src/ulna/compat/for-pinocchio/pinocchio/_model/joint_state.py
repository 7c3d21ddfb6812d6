"""The state of one joint as native code: its placement, motion subspace, velocity and bias, by a table of its steps.

| symbol | meaning | shape | unit |
|---|---|---|---|
| M | placement of the moving frame in the fixed frame | (4, 4) | [m] |
| S | motion subspace, in the moving frame | (6, nv) | [1], [m/rad] |
| c | bias (dS/dt) v | (6,) | [m/s^2, rad/s^2] |

A joint is a chain of steps with constant subspaces S_i: c is the sum of V_i x (S_i v_i), where V_i is the velocity of
step i (Featherstone, Rigid Body Dynamics Algorithms, 2008, eq. 5.8). One procedure serves all kinds of joints.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any, NamedTuple, final

import numpy as np

from ulna.compiler.procedures import Array1, Array2, f64, procedure
from ulna.model import JointKind
from ulna.recursions._procedures.placements import Placements, new_placements, place_in_world
from ulna.recursions._procedures.vectors import cross, put, twist_into, twist_out
from ulna.recursions.tree_table import INT, TreeTable, fixed_row, kind_code
from ulna.spatial import SE3
from ulna.system import forks
from ulna.typing import Floats

_V, _C, _S = 16, 22, 28
"""Where a state has velocity, bias and subspace; M lies before them, the joint's q and v behind them."""


class JointTree(NamedTuple):
    """A kind of joint for the procedure, and where that computes.

    Attributes:
        steps: The steps, the fixed frame first.
        places: Their placements.
        q: Configuration of the joint (nq, 1).
    """

    steps: TreeTable
    places: Placements
    q: Array2[f64]


@procedure
def _place(joint, q, first_q, out, behind):
    """The placement, and the joint's entries of q."""
    for k in range(len(joint.q)):
        joint.q[k, 0] = q[first_q + k]
        out[behind + k] = q[first_q + k]
    place_in_world(joint.steps, joint.places, joint.q, 1)
    last = len(joint.steps.parents) - 1
    for i in range(3):
        for j in range(3):
            out[4 * i + j] = joint.places.T[last, 3 * i + j, 0]
        out[4 * i + 3] = joint.places.T[last, 9 + i, 0]


@procedure
def _column(tree, T, i, k, column):
    """Column k of the subspace, of step i, in the moving frame."""
    last = len(tree.parents) - 1
    lx, ly, lz = tree.S[k, 0], tree.S[k, 1], tree.S[k, 2]
    rx, ry, rz = tree.S[k, 3], tree.S[k, 4], tree.S[k, 5]
    if i != last:
        lx, ly, lz, rx, ry, rz = twist_out(T, i, lx, ly, lz, rx, ry, rz, 1)
        put(column, 0, 0, lx, ly, lz, 1)
        put(column, 0, 3, rx, ry, rz, 1)
        lx, ly, lz, rx, ry, rz = twist_into(T, last, column, 0, 1)
    put(column, 0, 0, lx, ly, lz, 1)
    put(column, 0, 3, rx, ry, rz, 1)


@procedure
def _add_bias(out, motion):
    """Adds V x (S_i v_i), the second row of `motion`, to the bias."""
    wx, wy, wz = out[_V + 3], out[_V + 4], out[_V + 5]
    x, y, z = cross(wx, wy, wz, motion[1, 0, 0], motion[1, 1, 0], motion[1, 2, 0])
    a, b, c = cross(out[_V], out[_V + 1], out[_V + 2], motion[1, 3, 0], motion[1, 4, 0], motion[1, 5, 0])
    out[_C] += x + a
    out[_C + 1] += y + b
    out[_C + 2] += z + c
    x, y, z = cross(wx, wy, wz, motion[1, 3, 0], motion[1, 4, 0], motion[1, 5, 0])
    out[_C + 3] += x
    out[_C + 4] += y
    out[_C + 5] += z


@procedure
def _move(tree, T, v, first_v, has_v, out):
    """The subspace and, with a velocity, that of the moving frame and the bias."""
    nv = len(tree.armature)
    motion = np.zeros((2, 6, 1), f64)  # a column, and the velocity of a step
    for k in range(6 * nv):
        out[_S + k] = 0.0
    if has_v == 1:
        for k in range(_V, _S):
            out[k] = 0.0
    for i in range(1, len(tree.parents)):
        for j in range(6):
            motion[1, j, 0] = 0.0
        for k in range(tree.columns[i], tree.columns[i + 1]):
            _column(tree, T, i, k, motion)
            entry = tree.entries[k]
            for j in range(6):
                out[_S + j * nv + entry] += motion[0, j, 0]
            if has_v == 1:
                for j in range(6):
                    motion[1, j, 0] += motion[0, j, 0] * v[first_v + entry]
        if has_v == 1:
            for j in range(6):
                out[_V + j] += motion[1, j, 0]
            if i > 1:
                _add_bias(out, motion)


@procedure
def joint_state(
    joint: JointTree, q: Array1[f64], v: Array1[f64], out: Array1[f64], first_q: int, first_v: int, has_v: int
) -> int:
    """Fills the state of a joint; velocity, bias and the joint's v with `has_v` only.

    Args:
        joint: The joint.
        q: Configuration of the joint, or of its model (n,) [rad or m].
        v: Velocity likewise (m,) [rad/s or m/s].
        out: The state; see `state_size`.
        first_q: Where the joint's entries of q begin.
        first_v: Where those of v begin.
        has_v: 1 with a velocity, else 0.

    Returns:
        1: there is an answer.
    """
    nv = len(joint.steps.armature)
    behind = _S + 6 * nv
    _place(joint, q, first_q, out, behind)
    _move(joint.steps, joint.places.T, v, first_v, has_v, out)
    if has_v == 1:
        for k in range(nv):
            out[behind + len(joint.q) + k] = v[first_v + k]
    return 1


Sizes = tuple[int, int, int]
"""The columns of S, and the entries of q and of v that a state holds."""


def state_size(sizes: Sizes) -> int:
    """How many numbers a state has."""
    columns, nq, nv = sizes
    return _S + 6 * columns + nq + nv


def parts_of_state(state: Floats, sizes: Sizes) -> tuple[Floats, ...]:
    """Views of a state: M (4, 4), velocity (6,), bias (6,), S (6, columns), q (nq,) and v (nv,).

    Args:
        state: The state (n,).
        sizes: Its sizes.

    Returns:
        The views, of the shapes (4, 4), (6,), (6,), (6, columns), (nq,) and (nv,).
    """
    columns, nq, _ = sizes
    behind = _S + 6 * columns
    return (
        state[:_V].reshape(4, 4),
        state[_V:_C],
        state[_C:_S],
        state[_S:behind].reshape(6, columns),
        state[behind : behind + nq],
        state[behind + nq :],
    )


@lru_cache(maxsize=256)
def joint_tree(kind: JointKind, ratio: float = 1.0, offset: float = 0.0) -> JointTree:
    """The table of a kind of joint, which calls of the procedure share.

    Args:
        kind: The kind.
        ratio: Of a mimic joint, by how many times q it moves [-].
        offset: Of a mimic joint, what is added [rad or m].

    Returns:
        The table.
    """
    rows: list[Any] = [np.zeros(38)]
    codes, starts, begins, columns, entries = [0], [0], [0, 0], [], []
    for part in kind.elementary_joints(SE3.identity()):
        rows.append(fixed_row(part.kind, part.placement, ratio * part.ratio, offset))
        codes.append(kind_code(part.kind))
        starts.append(part.start_q)
        for k, column in enumerate(part.kind.motion_subspace(part.kind.neutral())):
            columns.append(ratio * part.ratio * column.vector())
            entries.append(part.start_v + k)
        begins.append(len(columns))
    count = len(rows)
    parents, codes_, starts_, begins_, entries_ = (
        np.array(x, INT) for x in ([0, *range(count - 1)], codes, starts, begins, entries)
    )
    tree = TreeTable(
        parents, codes_, starts_, begins_, entries_, np.zeros(count, INT), np.array(rows, float),
        np.array(columns, float).reshape(-1, 6), np.zeros((count, 10)), np.zeros(kind.nv), np.zeros(3),
    )  # fmt: skip
    return JointTree(tree, new_placements(count, 1, True), np.zeros((kind.nq, 1)))


@final
class _OneAtATime:
    """Computes states of one kind of joint, for one thread at a time.

    Args:
        kind: The kind.
        ratio: See `joint_tree`.
        offset: See `joint_tree`.
    """

    def __init__(self, kind: JointKind, ratio: float, offset: float) -> None:
        self._sizes = kind.nv, kind.nq, kind.nv
        self._lock, self._q, self._v = forks.lock(forks.KERNEL), np.zeros(kind.nq), np.zeros(kind.nv)
        self._out = np.zeros(state_size(self._sizes))
        # Calls from Python release the global interpreter lock, so the shared table would be written by two threads.
        tree = joint_tree.__wrapped__(kind, ratio, offset)
        self._runs = [
            joint_state.bind(tree, self._q, self._v, self._out, 0, 0, has_v, are_arrays_private=True)
            for has_v in (0, 1)
        ]

    def fill(self, state: Floats, q: Floats, v: Floats | None) -> None:
        """Fills a state.

        Args:
            state: The state (n,).
            q: Configuration of the joint (nq,) [rad or m].
            v: Velocity of the joint (nv,) [rad/s or m/s]; None leaves what belongs to it.
        """
        with self._lock:
            self._out[:], self._q[:] = state, q
            if v is not None:
                self._v[:] = v
            self._runs[v is not None].unguarded()
            state[:] = self._out


@lru_cache(maxsize=256)
def filler(kind: JointKind, ratio: float = 1.0, offset: float = 0.0) -> _OneAtATime:
    """What fills states of a kind of joint.

    Args:
        kind: The kind.
        ratio: See `joint_tree` [-].
        offset: See `joint_tree` [rad or m].

    Returns:
        The object.
    """
    return _OneAtATime(kind, ratio, offset)
