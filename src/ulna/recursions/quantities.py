"""Which quantities can be computed by loops over tables, and how: their recursions for a model and options."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from ulna.model import Frame, Model
from ulna.quantities.quantity import Quantity, frame_of
from ulna.recursions import pairs, whole_body
from ulna.recursions._procedures import articulated, composite, inverse_mass, newton_euler
from ulna.recursions._procedures import frames as of_frames
from ulna.recursions._procedures.placements import new_placements
from ulna.recursions.composition import DerivativesOfAccelerations
from ulna.recursions.recursion import Recursion
from ulna.recursions.tree_table import (
    INT,
    TreeTable,
    UnknownKind,
    has_mimics,
    matrices_as_rows,
    step_rows,
    tree_table,
)

Options = Mapping[str, Any]


def recursion_of(
    model: Model, quantity: Quantity, options: Options
) -> Recursion | DerivativesOfAccelerations | None:
    """The recursion that computes a quantity.

    Args:
        model: The robot.
        quantity: The quantity.
        options: All of its options.

    Returns:
        The recursion; None where there is none for the quantity, its options or a joint of the model.
    """
    make = _RECURSIONS.get(quantity.name)
    try:
        return make(model, options) if make is not None else None
    except UnknownKind:
        return None


def _dynamics(procedure: Any, *sizes: str) -> Callable[[Model, Options], Recursion | None]:
    """Torques of all joints, without external forces and friction."""

    def make(model: Model, options: Options) -> Recursion | None:
        if options.get("forces") or options.get("friction", False) is not False:
            return None
        tree = tree_table(model)
        rows = len(tree.parents)

        def storage(lanes: int) -> Sequence[Any]:
            return tree, new_placements(rows, lanes, False), newton_euler.new_motions(rows, lanes)

        inputs = tuple((getattr(model, size),) for size in sizes)
        return Recursion(procedure, storage, inputs, ((model.nv,),), rows)

    return make


def _carriers(model: Model, frames: Sequence[Frame]) -> tuple[TreeTable, Mapping[int, int]]:
    """The table of the joints that carry frames, and the rows of joints."""
    needed: set[int] = set()
    for first in {frame.joint for frame in frames}:
        joint = first
        while joint >= 0 and joint not in needed:
            needed.add(joint)
            joint = model.joints[joint].parent
    joints = None if len(needed) == len(model.joints) else tuple(sorted(needed))
    return tree_table(model, joints), step_rows(model, joints)


def _frames(frames: Sequence[Frame], rows: Mapping[int, int], reference: str = "world") -> of_frames.Frames:
    return of_frames.Frames(
        np.array([rows[frame.joint] for frame in frames], INT),
        matrices_as_rows([frame.placement for frame in frames]),
        np.array([of_frames.REFERENCES.index(reference)], INT),
    )


def _pose_recursion(model: Model, frames: Sequence[Frame], shape: tuple[int, ...]) -> Recursion:
    tree, rows = _carriers(model, frames)

    def storage(lanes: int) -> Sequence[Any]:
        return tree, new_placements(len(tree.parents), lanes, True), _frames(frames, rows)

    return Recursion(of_frames.frame_poses, storage, ((model.nq,),), (shape,), len(tree.parents))


def _fk(model: Model, options: Options) -> Recursion | None:
    frame = options["frame"]
    if frame == "all" or isinstance(frame, tuple):
        frames = [model.frame(name) for name in (model.frame_names if frame == "all" else frame)]
        return _pose_recursion(model, frames, (len(frames), 4, 4)) if frames else None
    return _pose_recursion(model, [frame_of(model, frame)], (4, 4))


def _link_poses(model: Model, options: Options) -> Recursion | None:
    frames = [model.frame(name) for name in model.link_names]
    return _pose_recursion(model, frames, (len(frames), 4, 4))


def _jacobian(model: Model, options: Options) -> Recursion | None:
    frame = frame_of(model, options["frame"])
    tree, rows = _carriers(model, [frame])

    def storage(lanes: int) -> Sequence[Any]:
        places = new_placements(len(tree.parents), lanes, True)
        return tree, places, _frames([frame], rows, options["reference"])

    return Recursion(of_frames.frame_jacobian, storage, ((model.nq,),), ((6, model.nv),), len(tree.parents))


def _frame_velocity(model: Model, options: Options) -> Recursion | None:
    frame = frame_of(model, options["frame"])
    tree, rows = _carriers(model, [frame])

    def storage(lanes: int) -> Sequence[Any]:
        count = len(tree.parents)
        places = new_placements(count, lanes, True)
        return (
            tree,
            places,
            newton_euler.new_motions(count, lanes),
            _frames([frame], rows, options["reference"]),
        )

    inputs = ((model.nq,), (model.nv,))
    return Recursion(of_frames.frame_velocity, storage, inputs, ((6,),), len(tree.parents))


def _articulated(tree: TreeTable, lanes: int) -> articulated.Articulated:
    rows, columns = len(tree.parents), len(tree.entries)
    shapes = (rows, 27, lanes), (columns, 6, lanes), (columns, lanes), (columns, lanes)
    return articulated.Articulated(*map(np.zeros, shapes))


def _forward_dynamics(model: Model, options: Options) -> Recursion | None:
    tree = tree_table(model)
    rows = len(tree.parents)
    if options["forces"] or options["friction"] is not False or has_mimics(model, tree):
        return None

    def storage(lanes: int) -> Sequence[Any]:
        places = new_placements(rows, lanes, False)
        return tree, places, newton_euler.new_motions(rows, lanes), _articulated(tree, lanes)

    inputs = (model.nq,), (model.nv,), (model.nv,)
    return Recursion(articulated.forward_dynamics, storage, inputs, ((model.nv,),), rows)


def _forward_dynamics_derivatives(model: Model, options: Options) -> DerivativesOfAccelerations | None:
    if options["forces"] or has_mimics(model, tree_table(model)):
        return None
    accelerations = _forward_dynamics(model, {"forces": (), "friction": False})
    derivatives = pairs.RECURSIONS["inverse_dynamics_derivatives"](model, options)
    inverse = _inverse_mass_matrix(model, {})
    if accelerations is None or derivatives is None or inverse is None:
        return None
    return DerivativesOfAccelerations(accelerations, derivatives, inverse)


def _inverse_mass_matrix(model: Model, options: Options) -> Recursion | None:
    tree = tree_table(model)
    if has_mimics(model, tree):
        return None
    slots, count = _slots(tree.parents)

    def storage(lanes: int) -> Sequence[Any]:
        work = _articulated(tree, 1)
        units = inverse_mass.Units(np.zeros((6, model.nv)), np.zeros((count, 6, model.nv)), slots)
        return tree, new_placements(len(tree.parents), 1, False), work, units

    shapes = ((model.nq,),), ((model.nv, model.nv),)
    rows = len(tree.parents)
    return Recursion(inverse_mass.inverse_mass_matrix, storage, *shapes, rows, is_matrix=True)


def _slots(parents: Any) -> tuple[Any, int]:
    """Where each step keeps what its children need: the last child takes the place of its parent."""
    last = {parent: row for row, parent in enumerate(parents.tolist()) if row}
    slots, idle, count = np.zeros(len(parents), INT), [], 0
    for row, parent in enumerate(parents.tolist()):
        if row and parent and last[parent] == row:
            slots[row] = slots[parent]
        elif row:
            if not idle:
                idle, count = [count], count + 1
            slots[row] = idle.pop()
        if row and row not in last:
            idle.append(int(slots[row]))
    return slots, max(count, 1)


def _mass_matrix(model: Model, options: Options) -> Recursion | None:
    tree = tree_table(model)
    rows, columns = len(tree.parents), len(tree.entries)

    def storage(lanes: int) -> Sequence[Any]:
        size = columns if has_mimics(model, tree) else 0
        work = np.zeros((rows, 10)), np.zeros((6, columns)), np.zeros((size, size))
        return tree, new_placements(rows, 1, False), composite.Composite(*work)

    shapes = ((model.nq,),), ((model.nv, model.nv),)
    return Recursion(composite.mass_matrix, storage, *shapes, rows, is_matrix=True)


_RECURSIONS: dict[str, Callable[[Model, Options], Recursion | DerivativesOfAccelerations | None]] = {
    "fk": _fk,
    "link_poses": _link_poses,
    "jacobian": _jacobian,
    "frame_velocity": _frame_velocity,
    "inverse_dynamics": _dynamics(newton_euler.inverse_dynamics, "nq", "nv", "nv"),
    "bias_forces": _dynamics(newton_euler.bias_forces, "nq", "nv"),
    "gravity_forces": _dynamics(newton_euler.gravity_forces, "nq"),
    "mass_matrix": _mass_matrix,
    "forward_dynamics": _forward_dynamics,
    "inverse_mass_matrix": _inverse_mass_matrix,
    "forward_dynamics_derivatives": _forward_dynamics_derivatives,
    **whole_body.RECURSIONS,
    **pairs.RECURSIONS,
}
"""By the names of quantities."""
