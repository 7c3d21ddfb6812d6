"""Constraints as kernels take them: their kinds as a key, their placements as arrays."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from pinocchio._constraints.factorization import FactorKernels, kernels_for
from pinocchio._data.states import FieldStates
from pinocchio._model.building import KinematicTree
from pinocchio._model.compiled_model import CompiledModel
from pinocchio._spatial.small_kernels import as_motion, pose
from ulna import algorithms, spatial
from ulna.algorithms.constraints.frame_errors import constraint_twists
from ulna.algorithms.constraints.kkt_factors import moved_by
from ulna.algorithms.multibody.batch_shapes import batch_zeros
from ulna.model import Model as CoreModel
from ulna.model.constraint import End, FramePair
from ulna.numeric import cross, less, where
from ulna.typing import Array, Floats


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


def stored_jacobian_kernel(compiled: CompiledModel, shapes: Any) -> Any:
    """The same, a function of J, of the q that J is of, of the q that counts, and of the placements.

    Where both q are the same, the columns of the joints are those of J.

    Returns:
        The kernel.
    """

    def build(core: CoreModel) -> Any:
        parents = [0, *(joint.parent + 1 for joint in core.joints)]
        entries = [range(joint.idx_v, joint.idx_v + joint.kind.nv) for joint in core.joints]

        def run(J: Array, of_columns: Array, q: Array, *places: Array) -> Array:
            gap = of_columns - q
            columns = where(less(gap @ gap, 1e-300), J, algorithms.joint_jacobians(core, q))
            poses = [spatial.SE3.identity(), *algorithms.joint_poses(core, q)]
            rows = []
            for (size, local, *joints), ends in zip(shapes, places, strict=True):
                frames = [poses[joint] @ pose(end) for joint, end in zip(joints, ends, strict=True)]
                part: Array = batch_zeros((size, core.nv), J[0])
                for sign, joint, frame in zip((1.0, -1.0), joints, frames, strict=True):
                    point = frames[0].translation if size == 6 else frame.translation
                    moving = joint
                    while moving:
                        for k in entries[moving - 1]:
                            s = as_motion(columns[:, k])
                            moved = spatial.Motion(s.linear + cross(s.angular, point), s.angular)
                            part[:, k] = part[:, k] + sign * moved.vector()[:size]
                        moving = parents[moving]
                R = frames[0].rotation.T
                turned = np.concatenate([R @ part[first : first + 3] for first in range(0, size, 3)])
                rows.append(turned if local else part)
            return np.concatenate(rows)

        return run

    nv, nq = compiled.source.nv, compiled.source.nq
    sizes: dict[str, Any] = {"J": (6, nv), "of_columns": (nq,), "q": (nq,)}
    return compiled.compile(("constraint jacobian of columns", shapes), build, **sizes, **sizes_of(shapes))


def has_columns_of(model: KinematicTree, data: FieldStates, q: Floats | None) -> bool:
    """Whether J holds the columns of separate joints at a configuration.

    Args:
        data: Its data.
        q: Configuration (nq,) [rad or m]; None for none.

    Returns:
        The truth value.
    """
    is_known = "jacobians" in data._known_states and model.nvExtended == model.nv
    return is_known and np.array_equal(data._arrays["jacobians q"], np.asarray(q))


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
