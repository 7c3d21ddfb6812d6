"""The inverse mass matrix of serial chains, and what it multiplies, by walks along the chain.

The symbols, the frame and the source of the stages are those of columns_in_one_frame.py.

| symbol | meaning | shape | unit |
|---|---|---|---|
| G | articulated inertia of all bodies from a step outward | (6, 6) | |
| U, d | G s, and s . U plus armature; `gains` are -U / d, `pivots` 1 / d | Force, () | |
| W | acceleration of a body for a force on it | (6, 6) | |
| B | acceleration of the body of a column for a unit torque on that column | Motion | |

Seen from one frame, a column k of the inverse begins with B at its own joint, and goes outward: the joint acceleration
of a column j after it is -U . A / d, and adds s times that to A. B is -W U / d of the body before, plus s times the
entry on the diagonal. This needs no walk inward for each column, and 12 products and sums for each entry.

Source: Featherstone 2008, chapter 7; Rodriguez, Jain & Kreutz-Delgado 1992, Spatial operator algebra for multibody
system dynamics (the recursion of W, "operational space compliance").
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.algorithms.derivatives.columns_in_one_frame import OneFrame, subtree, suits_one_frame
from ulna.algorithms.multibody.tree import steps
from ulna.compiler.forms.stages import StagedForm
from ulna.model import Model
from ulna.numeric import where
from ulna.typing import Array

_PLACES = {(i, j): k for k, (i, j) in enumerate((i, j) for i in range(6) for j in range(i, 6))}
"""Where the entries on and above the diagonal of a symmetric matrix lie in 21 numbers."""


def is_serial(model: Model) -> bool:
    """Whether a robot is one chain without branches that suits stages in one frame.

    Args:
        model: The robot.

    Returns:
        Whether every joint moves on from the one before.
    """
    return suits_one_frame(model) and all(step.parent == k - 1 for k, step in enumerate(steps(model)))


def stages_of_inverse_mass_matrix(model: Model) -> StagedForm | None:
    """The inverse of the mass matrix of a serial chain.

    Args:
        model: The robot; every motion must move some mass or have armature.

    Returns:
        The form; None for other robots.
    """
    if not is_serial(model):
        return None
    frame = OneFrame("inverse_mass_matrix", model, q=(model.nq,))
    frame.moments()
    articulate(frame)
    invert(frame, "inverse")
    return frame.stages.form("inverse", symmetric=("inverse",))


def articulate(frame: OneFrame) -> None:
    """The gains and pivots of every column, from s and the moments of single bodies.

    G lacks the last elimination, whose U and gains are handed on beside it, and which is done to U and d alone: so
    products with G do not wait for the quotient before.

    Args:
        frame: The stages of a serial chain.
    """
    frame.stages.constant("armature", [[float(x) for x in frame.model.armature]])

    def eliminate(state: Array, s: Array, own: Array, bodies: Array, armature: Array) -> tuple[Array, ...]:
        body = subtree(bodies[:1], np.concatenate([own, np.zeros(18)])).body
        G, U_after, gains_after = _matrix(state[:21]) + body.matrix(), state[21:27], state[27:]
        U_rigid, moved = _times(G, s), _dot(gains_after, s)
        U = U_rigid + U_after * moved
        pivot = 1.0 / (_dot(s, U_rigid) + armature[0] + _dot(U_after, s) * moved)
        gains = U * -pivot
        following = np.concatenate([_numbers(G + np.outer(gains_after, U_after)), U, gains])
        return following, gains, np.array([pivot], dtype=object)

    frame.stages.walk(eliminate, 33, ("s", "own", "bodies", "armature"), ("gains", "pivots"), is_inward=True)


def invert(frame: OneFrame, inverse: str) -> None:
    """The inverse mass matrix, from s, gains and pivots.

    Args:
        frame: The stages of a serial chain.
        inverse: What the matrix is called.
    """

    def respond(state: Array, s: Array, gains: Array, pivots: Array) -> tuple[Array, ...]:
        W = _matrix(state)
        before = _times(W, gains)
        entry = pivots[0] + _dot(gains, before)
        B = before + s * entry
        rest = np.outer(before, s)
        return _numbers(W + rest + rest.T + np.outer(s * entry, s)), B, np.array([entry], dtype=object)

    def outward(state: Array, s: Array, gains: Array, B: Array, entries: Array, ahead: Array) -> Any:
        is_begin = ahead[0] == 0.0
        entry = where(is_begin, entries[0], _dot(gains, state))
        following = state + s * entry
        A = np.array([where(is_begin, b, x) for b, x in zip(B, following, strict=True)], dtype=object)
        return A, np.array([entry], dtype=object)

    frame.stages.walk(respond, 21, ("s", "gains", "pivots"), ("B", "entries"))
    frame.stages.sweep([(outward, ("s", "gains", "B", "entries"), False)], 6, inverse)


def solve(frame: OneFrame, source: str, result: str) -> None:
    """Minus the inverse mass matrix times a matrix, by a walk inward and one outward for each of its columns.

    Args:
        frame: The stages of a serial chain, with s, gains and pivots.
        source: What the matrix is called.
        result: What the product is called.
    """

    def inward(state: Array, s: Array, gains: Array, entry: Array) -> tuple[Array, Array]:
        return _inward(state, s, gains, -entry[0])

    outward = (_outward, ("s", "gains", "pivots"), False)
    frame.stages.sweep([(inward, ("s", "gains"), True), outward], 6, result, source)


def accelerate(frame: OneFrame) -> None:
    """The joint accelerations `a` from `tau`, `h_0`, s, gains and pivots.

    Args:
        frame: The stages of a serial chain.
    """

    def inward(state: Array, s: Array, gains: Array, torque: Array) -> tuple[Array, Array]:
        return _inward(state, s, gains, torque[0])

    stages = frame.stages
    stages.straight(lambda tau, h_0: (tau - h_0[0])[None], ("tau", "h_0"), ("torque",))
    stages.walk(inward, 6, ("s", "gains", "torque"), ("rest",), is_inward=True)
    stages.walk(_outward, 6, ("s", "gains", "pivots", "rest"), ("joints",))
    stages.straight(lambda joints: joints[0], ("joints",), ("a",))


def _inward(force: Array, s: Array, gains: Array, torque: Any) -> tuple[Array, Array]:
    """The force on the body before a column, and what of the torque is left to move it."""
    rest = torque - _dot(s, force)
    return force - gains * rest, np.array([rest], dtype=object)


def _outward(state: Array, s: Array, gains: Array, pivots: Array, entry: Array) -> tuple[Array, Array]:
    """The acceleration of the body after a column, and that of the column, from the one before."""
    a = entry[0] * pivots[0] + _dot(gains, state)
    return state + s * a, np.array([a], dtype=object)


def _matrix(numbers: Array) -> Array:
    """A symmetric matrix, (6, 6), of 21 numbers."""
    out = np.empty((6, 6), dtype=object)
    for (i, j), k in _PLACES.items():
        out[i, j] = out[j, i] = numbers[k]
    return out


def _numbers(matrix: Array) -> Array:
    """The 21 numbers on and above the diagonal."""
    return np.array([matrix[place] for place in _PLACES], dtype=object)


def _dot(x: Array, y: Array) -> Any:
    """The product of six numbers with six, as two sums that do not wait for each other."""
    first, second = ([a * b for a, b in zip(x[k : k + 3], y[k : k + 3], strict=True)] for k in (0, 3))
    return (first[0] + first[1] + first[2]) + (second[0] + second[1] + second[2])


def _times(matrix: Array, x: Array) -> Array:
    """A matrix times six numbers."""
    return np.array([_dot(row, x) for row in matrix], dtype=object)
