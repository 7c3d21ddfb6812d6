"""Which quantities can be computed by loops over tables, and how: their recursions for a model and options."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from ulna import algorithms
from ulna.algorithms.constraints.proximal_settings import Proximal
from ulna.model import Model
from ulna.model.constraint import frame_pairs
from ulna.model.variable import with_parameters
from ulna.quantities.forces import friction_law
from ulna.quantities.quantity import Quantity, frame_of
from ulna.recursions import derivative_matrices, frame_columns, regressors, whole_body
from ulna.recursions._procedures import articulated, composite, inverse_mass, newton_euler
from ulna.recursions._procedures.frame_table import Frames
from ulna.recursions._procedures.placements import new_placements
from ulna.recursions.composition import (
    AnyRecursion,
    CoupledAccelerations,
    Couplings,
    DerivativesOfAccelerations,
    InverseOfMassMatrix,
    SolvedAccelerations,
    WithFriction,
)
from ulna.recursions.constrained import (
    READERS,
    ConstrainedAccelerations,
    ConstraintFrames,
    ConstraintQuantity,
    Delassus,
    Impulses,
    Response,
)
from ulna.recursions.frame_motions import jacobian_of, motion_of, poses_of
from ulna.recursions.frame_rows import loaded_frames
from ulna.recursions.in_stages import in_stages
from ulna.recursions.recursion import Recursion
from ulna.recursions.tree_table import (
    INT,
    TreeTable,
    UnknownKind,
    free_columns,
    has_mimics,
    tree_table,
)

Options = Mapping[str, Any]
_COLUMNS_AT_ONCE = 8
"""A multiple of the lanes of all processors."""

_FEW = 4
"""Mimic joints are solved one by one where there are this many entries of v for each; else the mass matrix is."""


def recursion_of(model: Model, quantity: Quantity, options: Options) -> AnyRecursion | None:
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


def _torques(model: Model, plain: Any, loaded: Any, sizes: Sequence[str], options: Options) -> Recursion:
    """Torques of all joints, without friction."""
    tree, frames = tree_table(model), loaded_frames(model, options)
    rows = len(tree.parents)

    def storage(lanes: int) -> Sequence[Any]:
        moves = newton_euler.new_motions(rows, lanes)
        places = new_placements(rows, lanes, frames is not None)
        return (tree, places, moves) if frames is None else (tree, places, moves, frames)

    inputs = _inputs(model, sizes, frames)
    return Recursion(plain if frames is None else loaded, storage, inputs, ((model.nv,),), rows)


def _inputs(model: Model, sizes: Sequence[str], frames: Frames | None) -> tuple[tuple[int, ...], ...]:
    """The shapes of inputs, those of wrenches last."""
    shapes = tuple((getattr(model, size),) for size in sizes)
    return shapes if frames is None else (*shapes, (len(frames.rows), 6))


def _dynamics(plain: Any, loaded: Any, *sizes: str) -> Callable[[Model, Options], AnyRecursion | None]:
    """Torques of all joints, with external forces and friction where they are asked for."""

    def make(model: Model, options: Options) -> AnyRecursion | None:
        return _with_friction(model, options, False, _torques(model, plain, loaded, sizes, options))

    return make


def _with_friction(
    model: Model, options: Options, is_forward: bool, made: AnyRecursion
) -> AnyRecursion | None:
    """The same with the friction that is asked for; None for a law that is traced."""
    law = friction_law(model, options.get("friction", False))
    if law is None:
        return made
    return None if law.is_traced else WithFriction(made, law, is_forward)


def _fk(model: Model, options: Options) -> Recursion | None:
    frame = options["frame"]
    if frame == "all" or isinstance(frame, tuple):
        frames = [model.frame(name) for name in (model.frame_names if frame == "all" else frame)]
        return poses_of(model, frames, (len(frames), 4, 4)) if frames else None
    return poses_of(model, [frame_of(model, frame)], (4, 4))


def _link_poses(model: Model, options: Options) -> Recursion | None:
    frames = [model.frame(name) for name in model.link_names]
    return poses_of(model, frames, (len(frames), 4, 4))


def _jacobian(model: Model, options: Options) -> Recursion:
    return jacobian_of(model, frame_of(model, options["frame"]), options["reference"])


def _motion_of_frame(order: int) -> Callable[[Model, Options], Recursion]:
    """The velocity of one frame, or its acceleration."""

    def make(model: Model, options: Options) -> Recursion:
        frame = frame_of(model, options["frame"])
        return motion_of(model, frame, options["reference"], order, options.get("classical", False))

    return make


def _articulated(tree: TreeTable, lanes: int) -> articulated.Articulated:
    rows, columns = len(tree.parents), len(tree.entries)
    shapes = (rows, 27, lanes), (columns, 6, lanes), (columns, lanes), (columns, lanes)
    return articulated.Articulated(*map(np.zeros, shapes))


def _forward_dynamics(model: Model, options: Options) -> AnyRecursion | None:
    tree = tree_table(model)
    made = _coupled(model, options) if has_mimics(model, tree) else _accelerations(model, options, tree)
    return _with_friction(model, options, True, made)


def _coupled(model: Model, options: Options) -> CoupledAccelerations | SolvedAccelerations:
    """Forward dynamics where joints mimic others."""
    tree, solved = tree_table(model), _solved(model, options)
    couplings = Couplings.of(tree.entries)
    if len(couplings.followers) * _FEW > model.nv or len(couplings.sources) != model.nv:
        return solved
    armature = np.zeros(len(tree.entries))
    armature[couplings.sources] = tree.armature
    free = free_columns(tree)._replace(armature=armature)
    response = _accelerations(model, {}, free._replace(gravity=np.zeros(3)))
    sizes = "nq", "nv", "nv"
    torques = _torques(
        model, newton_euler.inverse_dynamics, newton_euler.loaded_inverse_dynamics, sizes, options
    )
    return CoupledAccelerations(_accelerations(model, options, free), response, couplings, torques, solved)


def _solved(model: Model, options: Options) -> SolvedAccelerations:
    """Forward dynamics by the mass matrix."""
    sizes = "nq", "nv"
    bias = _torques(model, newton_euler.bias_forces, newton_euler.loaded_bias_forces, sizes, options)
    return SolvedAccelerations(bias, _mass_matrix(model, {}))


def _accelerations(model: Model, options: Options, tree: TreeTable) -> Recursion:
    """Forward dynamics by articulated bodies, each column of the table with an entry of velocity of its own."""
    frames, count = loaded_frames(model, options), len(tree.entries)
    rows = len(tree.parents)

    def storage(lanes: int) -> Sequence[Any]:
        places = new_placements(rows, lanes, frames is not None)
        plain = tree, places, newton_euler.new_motions(rows, lanes), _articulated(tree, lanes)
        return plain if frames is None else (*plain, frames)

    inputs = ((model.nq,), (count,), (count,)) + (() if frames is None else ((len(frames.rows), 6),))
    procedure = articulated.forward_dynamics if frames is None else articulated.loaded_forward_dynamics
    return Recursion(procedure, storage, inputs, ((count,),), rows)


def _forward_dynamics_derivatives(model: Model, options: Options) -> AnyRecursion | None:
    fixed = {"forces": options["forces"], "reference": "local"}
    accelerations = _forward_dynamics(model, fixed)
    derivatives = derivative_matrices.RECURSIONS["inverse_dynamics_derivatives"](model, options)
    if accelerations is None:
        return None
    if options["forces"]:
        return DerivativesOfAccelerations(accelerations, derivatives, _inverse_mass_matrix(model, {}))
    torques = algorithms.stages_of_inverse_dynamics_derivatives
    derivatives = in_stages(model, "inverse_dynamics_derivatives", torques, derivatives)
    loops = DerivativesOfAccelerations(accelerations, derivatives, _inverse_mass_matrix(model, {}))
    if not algorithms.is_serial(model):
        return loops
    stages: Any = algorithms.stages_of_forward_dynamics_derivatives
    return in_stages(model, "forward_dynamics_derivatives", stages, loops)


def _response(model: Model, options: Options) -> Response:
    """What constraints are solved by."""
    weightless = with_parameters(model, {"gravity": np.zeros(3)})
    accelerations = _forward_dynamics(weightless, {"forces": ()})
    assert accelerations is not None  # there is no friction
    return Response(accelerations, options.get("solver", Proximal()))


def _constrained_dynamics(model: Model, options: Options) -> ConstrainedAccelerations | None:
    free = _forward_dynamics(model, options)
    if free is None:
        return None
    pairs = ConstraintFrames(model, frame_pairs(model, options["constraints"]))
    has_wrenches, is_stabilised = bool(options["forces"]), options["stabilised"]
    return ConstrainedAccelerations(pairs, free, _response(model, options), has_wrenches, is_stabilised)


def _impulse_dynamics(model: Model, options: Options) -> Impulses:
    pairs = ConstraintFrames(model, frame_pairs(model, options["constraints"]))
    return Impulses(pairs, _response(model, options), options["elastic"])


def _delassus_matrix(model: Model, options: Options) -> Delassus:
    pairs = ConstraintFrames(model, frame_pairs(model, options["constraints"]))
    return Delassus(pairs, _response(model, options))


def _of_state(name: str) -> Callable[[Model, Options], ConstraintQuantity]:
    """What follows from the frames of constraints alone."""

    def make(model: Model, options: Options) -> ConstraintQuantity:
        frames = frame_pairs(model, options["constraints"])
        pairs, (has_velocity, read) = ConstraintFrames(model, frames), READERS[name]
        shape = (pairs.rows, model.nv) if name == "constraint_jacobian" else (pairs.rows,)
        shown = jacobian_of(model, frames[0].first, "local_world_aligned")
        return ConstraintQuantity(pairs, shape, shown, has_velocity, read)

    return make


def _inverse_mass_matrix(model: Model, options: Options) -> AnyRecursion:
    tree = tree_table(model)
    if has_mimics(model, tree):
        return InverseOfMassMatrix(_mass_matrix(model, {}))
    slots, count = _slots(tree.parents)

    def storage(lanes: int) -> Sequence[Any]:
        work = _articulated(tree, 1)
        width = -(-model.nv // _COLUMNS_AT_ONCE) * _COLUMNS_AT_ONCE
        units = inverse_mass.Units(
            np.zeros((6, width)),
            np.zeros((count, 6, width)),
            slots,
            np.zeros((model.nv, width)),
            np.zeros((model.nv, 6)),
            np.zeros((len(tree.parents) + 1, 10)),
        )
        return tree, new_placements(len(tree.parents), 1, True), work, units

    shapes = ((model.nq,),), ((model.nv, model.nv),)
    rows = len(tree.parents)
    loops = Recursion(inverse_mass.inverse_mass_matrix, storage, *shapes, rows, is_matrix=True)
    return in_stages(model, "inverse_mass_matrix", algorithms.stages_of_inverse_mass_matrix, loops)


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


def _mass_matrix(model: Model, options: Options) -> Recursion:
    tree = tree_table(model)
    rows, columns = len(tree.parents), len(tree.entries)

    def storage(lanes: int) -> Sequence[Any]:
        size = columns if has_mimics(model, tree) else 0
        work = np.zeros((rows, 10)), np.zeros((6, columns)), np.zeros((size, size))
        return tree, new_placements(rows, 1, False), composite.Composite(*work)

    shapes = ((model.nq,),), ((model.nv, model.nv),)
    return Recursion(composite.mass_matrix, storage, *shapes, rows, is_matrix=True)


_RECURSIONS: dict[str, Callable[[Model, Options], AnyRecursion | None]] = {
    "fk": _fk,
    "link_poses": _link_poses,
    "jacobian": _jacobian,
    "frame_velocity": _motion_of_frame(1),
    "frame_acceleration": _motion_of_frame(2),
    "inverse_dynamics": _dynamics(
        newton_euler.inverse_dynamics, newton_euler.loaded_inverse_dynamics, "nq", "nv", "nv"
    ),
    "bias_forces": _dynamics(newton_euler.bias_forces, newton_euler.loaded_bias_forces, "nq", "nv"),
    "gravity_forces": _dynamics(newton_euler.gravity_forces, None, "nq"),
    "static_torque": _dynamics(newton_euler.gravity_forces, newton_euler.loaded_gravity_forces, "nq"),
    "mass_matrix": _mass_matrix,
    "forward_dynamics": _forward_dynamics,
    "inverse_mass_matrix": _inverse_mass_matrix,
    "forward_dynamics_derivatives": _forward_dynamics_derivatives,
    "constrained_dynamics": _constrained_dynamics,
    "impulse_dynamics": _impulse_dynamics,
    "delassus_matrix": _delassus_matrix,
    **{name: _of_state(name) for name in READERS},
    **whole_body.RECURSIONS,
    **derivative_matrices.RECURSIONS,
    **frame_columns.RECURSIONS,
    **regressors.RECURSIONS,
}
"""By the names of quantities."""
