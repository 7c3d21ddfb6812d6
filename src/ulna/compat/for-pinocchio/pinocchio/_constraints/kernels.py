"""Constraints as kernels take them: their kinds as a key, their placements as arrays."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from pinocchio._constraints.factorization import FactorKernels, kernels_for
from pinocchio._model.compiled_model import CompiledModel
from ulna import algorithms, spatial
from ulna.algorithms.constraints.frame_errors import constraint_twists
from ulna.algorithms.constraints.kkt_factors import moved_by
from ulna.model import Model as CoreModel
from ulna.model.constraint import End, FramePair
from ulna.typing import Array


def core_constraints(shapes: Sequence[tuple[int, bool, int, int]], places: Array) -> list[FramePair]:
    """The constraints for Ulna; a frame of the world has its joint -1.

    Args:
        places: Both placements of each constraint, (c, 2, 4, 4).

    Returns:
        The constraints for `ulna.algorithms`.
    """
    frame_pairs = []
    for k, (size, local, *joints) in enumerate(shapes):
        first, second = (
            End(joint - 1, spatial.SE3(places[k, end, :3, :3], places[k, end, :3, 3]))
            for end, joint in enumerate(joints)
        )
        frame_pairs.append(FramePair(first, second, size, local))  # type: ignore[arg-type]
    return frame_pairs


def jacobian_kernel(compiled: CompiledModel, shapes: Any, nq: int) -> Any:
    """The compiled Jacobian (m, nv) of constraints, a function of q and the placements (2, 4, 4) of each.

    Args:
        nq: Number of entries of a configuration.

    Returns:
        The kernel.
    """

    def build(core: CoreModel) -> Any:
        def run(q: Array, *places: Array) -> Array:
            return algorithms.constraint_jacobian(core, q, core_constraints(shapes, np.stack(places)))

        return run

    return compiled.compile(("constraint jacobian", shapes), build, q=(nq,), **sizes_of(shapes))


def factor_kernels(compiled: CompiledModel, shapes: Any) -> FactorKernels:
    """The kernels for the factors of the mass matrix and of constraints.

    Returns:
        The kernels, compiled once.
    """
    kernels = compiled.cache.get(("factors", shapes))
    if kernels is None:
        core = compiled.model
        moved = [np.tile(moved_by(core, [j - 1 for j in joints]), (size, 1)) for size, _, *joints in shapes]
        rows = np.vstack([np.zeros((0, core.nv)), *moved])
        kernels = compiled.cache["factors", shapes] = kernels_for(compiled, rows)
    return kernels


def flat(wanted: Array, shapes: Any) -> Array:
    """The rows that constraints have, out of six for each.

    Args:
        wanted: Values (c, 6) for c constraints.
        shapes: For each constraint its number of rows, first.

    Returns:
        Values (m,).
    """
    return np.concatenate([wanted[k, : shape[0]] for k, shape in enumerate(shapes)])


def right_side(
    core: CoreModel, shapes: Any, q: Array, v: Array, placements: Array, gains: Array, desired: Array
) -> tuple[Array, Array]:
    """The Jacobian J of constraints, and g, where accelerations a that keep them have J a + g = 0.

    Args:
        core: Ulna's model.
        shapes: For each constraint its rows, whether they are local, and its two joints.
        placements: Both placements of each constraint, (c, 2, 4, 4).
        gains: kp [1/s^2] and kd [1/s] of each constraint, (c, 2).
        desired: What accelerations are to be, (c, 6) [m/s^2, rad/s^2].

    Returns:
        Jacobian (m, nv), and g (m,).
    """
    owner = [k for k, shape in enumerate(shapes) for _ in range(shape[0])]
    twists = constraint_twists(core, q, v, core_constraints(shapes, placements))
    pull = gains[owner, 1] * twists.velocity + gains[owner, 0] * twists.error
    return twists.J, twists.bias + pull - flat(desired, shapes)


def sizes_of(shapes: Any) -> dict[str, Any]:
    """The placements of each constraint as inputs of a kernel."""
    return {f"place{k}": (2, 4, 4) for k in range(len(shapes))}
