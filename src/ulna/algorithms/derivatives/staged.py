"""Matrices of dynamics and their derivatives as stages in one frame, for one sample.

The symbols, the frame and the source are those of columns_in_one_frame.py. What is computed is that of
inverse_dynamics.py, forward_dynamics.py, centroidal.py and dynamics/coriolis.py, which remain the definitions:
`tests/laws/test_staged_laws.py` compares.

| symbol | meaning | shape | unit |
|---|---|---|---|
| h_0 | torques without joint accelerations | (nv) | [N m, N] |
| L, d | factors of the mass matrix, L^T diag(d) L | | |
| dA, dF | what joint accelerations add to the accelerations, and to the forces of all bodies from a step outward | | |
| c_G, m | centre of mass in the common frame; mass | (3), () | [m], [kg] |
| R | rotation from the common frame to the world | (3, 3) | |
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ulna.algorithms.derivatives.columns_in_one_frame import (
    OneFrame,
    about,
    caused_motions,
    numbers,
    subtree,
    suits_one_frame,
)
from ulna.algorithms.derivatives.serial_chains import accelerate, articulate, invert, is_serial, solve
from ulna.algorithms.derivatives.staged_floating_base import centroidal_matrix_of_floating_base
from ulna.algorithms.dynamics.center_of_mass import total_mass
from ulna.algorithms.dynamics.coriolis import MovingBodies
from ulna.algorithms.dynamics.mass_matrix_factors import solution_by_rows
from ulna.algorithms.dynamics.staged_chains import centroidal_matrix_of_chain
from ulna.algorithms.multibody.chain_walks import motion
from ulna.compiler.forms.columns import ColumnForm, row_places
from ulna.compiler.forms.stages import StagedForm
from ulna.compiler.language.function import trace
from ulna.model import Model
from ulna.numeric import cross, dot
from ulna.spatial import Force
from ulna.typing import Array

_WALKED_FROM = 12
"""Velocities of serial chains from which on M is not factored, since its condition grows with their number.

Of fewer, solutions by its factors take a half to two thirds of the time of walks along the chain."""


def stages_of_inverse_dynamics_derivatives(model: Model, forces: Sequence[str] = ()) -> StagedForm | None:
    """The derivatives of the torques of inverse dynamics with respect to q, v and a.

    Args:
        model: The robot.
        forces: Names of frames with external forces, written and fixed in their axes.

    Returns:
        The form; None for robots that need another one.
    """
    if not suits_one_frame(model):
        return None
    inputs = {"q": (model.nq,), "v": (model.nv,), "a": (model.nv,), **_wrenches(forces)}
    frame = OneFrame("inverse_dynamics_derivatives", model, **inputs)
    if forces or not frame.dynamics_in_segments("a"):
        frame.kinematics()
        frame.accelerations("a")
        frame.subtrees(external=frame.external_forces(forces))
    frame.columns()
    frame.torque_derivatives("by_q", "by_v", "M")
    zeros = {"by_q": frame.unrelated(by_q=True)}
    return frame.stages.form("by_q", "by_v", "M", zeros=zeros, symmetric=("M",))


def stages_of_forward_dynamics_derivatives(
    model: Model, forces: Sequence[str] = ()
) -> ColumnForm | StagedForm | None:
    """The derivatives of the joint accelerations with respect to q, v and tau.

    Args:
        model: The robot; every motion must move some mass or have armature.
        forces: Names of frames with external forces, written and fixed in their axes.

    Returns:
        The form; None for robots that need another one.
    """
    if not suits_one_frame(model):
        return None
    n = model.nv
    inputs = {"q": (model.nq,), "v": (n,), "tau": (n,), **_wrenches(forces)}
    frame = OneFrame("forward_dynamics_derivatives", model, **inputs)
    stages = frame.stages
    if forces or not frame.dynamics_in_segments():
        frame.kinematics()
        frame.accelerations()
        frame.subtrees(external=frame.external_forces(forces))

    def responses(s: Array, sums: Array, mass: Array) -> tuple[Array, Array]:
        whole = subtree(mass, sums)
        return numbers(whole.body.apply(motion(s))), np.array([dot(s, sums[21:])], dtype=object)

    stages.lanes(responses, ("s", "sums", "mass"), ("r", "h_0"))
    if is_serial(model) and n >= _WALKED_FROM:
        return _derivatives_of_serial_chains(frame)
    frame.factors()
    solve = solution_by_rows(frame.paths)

    def accelerations(tau: Array, h_0: Array, factors: Array) -> Array:
        return solve(factors, tau - h_0[0])

    stages.straight(accelerations, ("tau", "h_0", "factors"), ("a",))
    frame.add_accelerations()
    frame.columns(forces="dF")
    frame.torque_derivatives("by_q", "by_v")
    size = row_places(frame.paths)[1]

    def column(table: Array, column: Array) -> Array:
        return solve(np.concatenate([table[:size], -table[size:]]), column)

    body = trace(column, name="forward_dynamics_derivatives_column", table=(size + n,), column=(n,))
    head = stages.form("factors", "by_q", "by_v", zeros={"by_q": frame.unrelated(by_q=True)})
    return ColumnForm(head, body, (None, None, -1.0), (n, n), serves_batches=True, inverts=True)


def _wrenches(forces: Sequence[str]) -> dict[str, tuple[int, ...]]:
    """The input that has a row for each external force."""
    return {"f_ext": (len(forces), 6)} if forces else {}


def _derivatives_of_serial_chains(frame: OneFrame) -> StagedForm:
    """The rest of the derivatives of forward dynamics, by walks along the chain."""
    articulate(frame)
    accelerate(frame)
    frame.add_accelerations()
    frame.columns(forces="dF")
    frame.torque_derivatives("tau_q", "tau_v")
    solve(frame, "tau_q", "by_q")
    solve(frame, "tau_v", "by_v")
    invert(frame, "by_tau")
    zeros = {"by_q": np.tile(frame.moves_all_evenly, (frame.model.nv, 1))}
    return frame.stages.form("by_q", "by_v", "by_tau", zeros=zeros, symmetric=("by_tau",))


def stages_of_coriolis_matrix(model: Model) -> StagedForm | None:
    """The Coriolis matrix of the Christoffel symbols.

    Args:
        model: The robot.

    Returns:
        The form; None for robots that need another one.
    """
    if not suits_one_frame(model):
        return None
    frame = OneFrame("coriolis_matrix", model, q=(model.nq,), v=(model.nv,))
    frame.kinematics()
    frame.subtrees(with_forces=False)
    coriolis_columns(frame, "C")
    return frame.stages.form("C")


def coriolis_columns(frame: OneFrame, name: str) -> None:
    """The Coriolis matrix, and what columns it is made of: r, t, y and rates.

    Args:
        frame: The stages, with twists and `sums`.
        name: What the matrix is called.
    """

    def of_column(s: Array, V: Array, sums: Array, mass: Array) -> tuple[Array, ...]:
        whole, column, rate = subtree(mass, sums), motion(s), motion(V).cross(motion(s))
        moving = MovingBodies(whole.body, whole.h, whole.D)
        half, turn = moving.halves(column)
        y = Force(cross(column.angular, whole.h.linear), half + turn) + whole.body.apply(rate)
        t = cross(whole.h.linear, column.linear) + half - turn
        return numbers(whole.body.apply(column)), t, numbers(y), numbers(rate)

    frame.stages.lanes(of_column, ("s", "V", "sums", "mass"), ("r", "t", "y", "rates"))

    def below(s: Array, y: Array) -> tuple[Any, ...]:
        return (dot(y, s),)

    def above(r: Array, t: Array, s: Array, rates: Array) -> tuple[Any, ...]:
        return (dot(r, rates) + dot(t, s[3:]),)

    frame.matrices((below, ("s",), ("y",)), (above, ("r", "t"), ("s", "rates")), {name: None})


def stages_of_centroidal_matrix(model: Model) -> StagedForm | None:
    """The centroidal momentum matrix.

    Args:
        model: The robot; without mass it has no such form.

    Returns:
        The form; None for robots that need another one.
    """
    if not suits_one_frame(model) or not total_mass(model):
        return None
    of_chain = centroidal_matrix_of_chain(model)
    if of_chain is not None:
        return of_chain
    of_floating_base = centroidal_matrix_of_floating_base(model)
    if of_floating_base is not None:
        return of_floating_base
    frame = OneFrame("centroidal_matrix", model, q=(model.nq,))
    frame.poses()
    frame.composite_moments()
    frame.center_of_mass(1.0 / total_mass(model))

    def of_column(s: Array, sums: Array, mass: Array, c_G: Array, R: Array) -> Array:
        body = subtree(mass, np.concatenate([sums, np.zeros(18)])).body
        return about(body.apply(motion(s)), c_G, R.reshape(3, 3))

    frame.stages.lanes(of_column, ("s", "sums", "mass", "c_G", "R"), ("A",))
    return frame.stages.form("A")


def stages_of_mass_matrix(model: Model) -> StagedForm | None:
    """The mass matrix.

    Args:
        model: The robot.

    Returns:
        The form; None for robots that need another one.
    """
    if not suits_one_frame(model):
        return None
    frame = OneFrame("mass_matrix", model, q=(model.nq,))
    frame.moments(are_sums=True)
    frame.responses()
    frame.mass_matrix("M")
    return frame.stages.form("M", symmetric=("M",))


def stages_of_centroidal_derivatives(model: Model) -> StagedForm | None:
    """The derivatives of the centroidal momentum with respect to q, and of its rate with respect to q, v and a.

    Args:
        model: The robot; without mass it has no such form.

    Returns:
        The form; None for robots that need another one.
    """
    if not suits_one_frame(model) or not total_mass(model):
        return None
    frame = OneFrame("centroidal_derivatives", model, q=(model.nq,), v=(model.nv,), a=(model.nv,))
    share = 1.0 / total_mass(model)
    frame.kinematics()
    frame.center_of_mass(share)
    frame.accelerations("a", gravity=False)
    frame.subtrees()
    roots = [step.indices[0] for step in frame.tree if step.parent < 0]

    def momentum_and_rate(sums: Array) -> Array:
        h, F = (np.sum([sums[row : row + 3, k] for k in roots], axis=0) for row in (9, 21))
        return np.concatenate([h * share, F * share])

    frame.stages.straight(momentum_and_rate, ("sums",), ("drift",))

    reads = ("s", "psi", "V", "dU", "A", "dC", "sums", "mass", "drift", "c_G", "R")
    names = ("dh_dq", "dF_dq", "dF_dv", "dF_da")
    frame.stages.lanes(_centroidal_column, reads, names)
    linear = np.zeros((6, model.nv), dtype=bool)
    linear[:3] = frame.moves_all_evenly
    return frame.stages.form(*names, zeros={"dh_dq": linear, "dF_dq": linear})


def _centroidal_column(
    s: Array,
    psi: Array,
    V: Array,
    dU: Array,
    A: Array,
    dC: Array,
    sums: Array,
    mass: Array,
    drift: Array,
    c_G: Array,
    R: Array,
) -> tuple[Array, ...]:
    """Derivatives of momentum and rate with respect to a column's coordinate, about the centre of mass, world axes."""
    whole, (column, caused, chi) = subtree(mass, sums), caused_motions(s, psi, V, dU, A, dC)
    r = whole.body.apply(column)
    dh = whole.body.apply(caused) + column.cross(whole.h)
    dF = whole.coriolis(caused) + whole.body.apply(chi) + column.cross(whole.F)
    rest = whole.body.apply(motion(dU).cross(column))
    rest = rest + Force(np.zeros(3), whole.coriolis_transposed(column))
    dF_dv = dh + dh + rest
    dh = Force(dh.linear, dh.angular - cross(r.linear, drift[:3]))
    dF = Force(dF.linear, dF.angular - cross(r.linear, drift[3:]))
    return tuple(about(x, c_G, R.reshape(3, 3)) for x in (dh, dF, dF_dv, r))
