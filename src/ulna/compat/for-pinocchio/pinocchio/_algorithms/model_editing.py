"""Models made of models: with joints locked, with another one appended, with a joint that mimics."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, final

from pinocchio._algorithms.reduced_model import Moved, reduced_model
from pinocchio._containers.arguments import ArgumentError
from pinocchio._containers.arrays import index
from pinocchio._containers.keywords import by_name
from pinocchio._model.model import Model
from pinocchio._spatial.se3 import SE3
from ulna import algorithms
from ulna.errors import InputError

__all__ = [
    "appendModel",
    "buildReducedModel",
    "findCommonAncestor",
    "transformJointIntoMimic",
]

_LIMITS = ("lowerEffortLimit", "upperEffortLimit", "lowerVelocityLimit", "upperVelocityLimit")
_LIMITS += ("lowerPositionLimit", "upperPositionLimit", "positionLimitMargin")
_LIMITS += ("lowerDryFrictionLimit", "upperDryFrictionLimit", "damping")


@by_name(
    "model list_of_joints_to_lock reference_configuration",
    "model geom_model list_of_joints_to_lock reference_configuration",
    "model list_of_geom_models list_of_joints_to_lock reference_configuration",
)
def buildReducedModel(model: Model, *rest: Any) -> Any:
    """The model with some joints locked.

    Args:
        model: The model.
        rest: A geometry model or a list of them, if wanted; the indices of the joints to lock; a configuration (nq,).

    Returns:
        The model, or (model, geometry model), or (model, list of geometry models).
    """
    *geometries, locked, reference = rest
    several = bool(geometries) and isinstance(geometries[0], (list, tuple))
    geometry_models = list(geometries[0]) if several else geometries
    out, moved = reduced_model(model, [index(i, model.njoints, "joint", _NAMES) for i in locked], reference)
    if not geometry_models:
        return out
    reduced = [_moved_geometry(g, moved) for g in geometry_models]
    return (out, reduced) if several else (out, reduced[0])


_NAMES = "model.getJointId(name) returns one."


def add_like(
    out: Model, model: Model, i: int, parent: int, placement: SE3, name: str, new_of: Mapping[int, int]
) -> int:
    """Adds to `out` a joint like joint i of `model`, with its limits, inertia and armature.

    Args:
        out: The model that is changed.
        model: The model of the joint.
        i: Index of the joint there.
        parent: Index of the parent joint in `out`.
        placement: Pose of the joint in the frame of its parent.
        name: Name of the new joint.
        new_of: Indices in `out` of joints of `model`.

    Returns:
        Index of the new joint.
    """
    joint = model.joints[i].copy()
    rows = {
        True: slice(joint.idx_q, joint.idx_q + joint.nq),
        False: slice(joint.idx_v, joint.idx_v + joint.nv),
    }
    if joint.mimic is not None:
        leader = new_of[joint.mimic[0]]
        joint.mimic = (leader, *joint.mimic[1:])
        joint._keep(idx_q=out.joints[leader].idx_q, idx_v=out.joints[leader].idx_v)
    new = out.addJoint(parent, joint, placement, name)
    made = out.joints[new]
    for key, values in model._arrays.items():
        if joint.nv:
            per_q = "osition" in key
            at = slice(made.idx_q, made.idx_q + made.nq) if per_q else slice(made.idx_v, made.idx_v + made.nv)
            out._arrays[key][at] = values[rows[per_q]]
    out._inertias[new]._assign(model.inertias[i])
    return new


def _moved_geometry(geometry: Any, moved: Moved) -> Any:
    out = geometry.copy()
    for shape in out.geometryObjects:
        joint = index(shape.parentJoint, len(moved), "joint", "The geometries are those of another robot.")
        carrier, M = moved[joint]
        shape.parentJoint = carrier
        if M is not None:
            shape.placement = M * shape.placement
    return out


@by_name("modelA modelB frame_in_modelA aMb", "modelA modelB geomModelA geomModelB frame_in_modelA aMb")
def appendModel(modelA: Model, modelB: Model, *rest: Any) -> Any:
    """Model B put on a frame of model A.

    Args:
        modelA: The first model; its gravity is kept.
        modelB: The model to append. Its names must not be those of A.
        rest: Two geometry models, if wanted; the index of the frame of A; the placement of B's world in it.

    Returns:
        The model, or (model, geometry model).

    Raises:
        ArgumentError: Arguments are too many, too few, or of other types.
    """
    if len(rest) not in (2, 4) or not isinstance(rest[-1], SE3):
        raise ArgumentError(
            f"appendModel was given {len(rest)} arguments after the models; expected two geometry models or none, the "
            "index of a frame, and a placement SE3."
        )
    *geometries, frame_id, aMb = rest
    if not all(hasattr(g, "geometryObjects") for g in geometries):
        raise ArgumentError(f"appendModel was given {geometries!r}; expected two geometry models.")
    at = index(frame_id, modelA.nframes, "frame", "model.getFrameId(name) returns one.")
    carrier = modelA.frames[at].parentJoint
    base = modelA.frames[at].placement * aMb
    out = Model()
    out._gravity = modelA.gravity.copy()
    supports = modelA.supports
    ours = [i for i in range(1, modelA.njoints) if i <= carrier or carrier in supports[i]]
    after = [i for i in range(1, modelA.njoints) if i not in ours]
    first, second = Part(out, modelA, SE3()), Part(out, modelB, base)
    order = first.add([0, *ours])
    second.joints[0], second.frames[0] = first.joints[carrier], first.frames[at]
    order += second.add(range(modelB.njoints)) + first.add(after)
    for part in (first, second):
        part.tie_frames()
        part.place()
    out._keep(nbodies=out.njoints + 2)
    out._frames_changed()
    if not geometries:
        return out
    return out, _joined_geometries(dict(zip((first, second), geometries, strict=True)), order)


@final
class Part:
    """A model whose joints and frames another one takes up.

    Attributes:
        base: Where its universe is in the frame of the joint that carries it.
        joints: The new index of each joint that was taken up.
        frames: The same of frames.
    """

    def __init__(self, out: Model, model: Model, base: SE3) -> None:
        self.out, self.model, self.base = out, model, base
        self.joints, self.frames = {0: 0}, {0: 0}

    def add(self, joints: Iterable[int]) -> list[tuple[Part, int]]:
        """Takes up joints, each with its frames; returns them."""
        added: list[tuple[Part, int]] = [(self, i) for i in joints]
        out, model = self.out, self.model
        for _, i in added:
            parent = model.parents[i]
            place = self.base * model.jointPlacements[i] if parent == 0 else model.jointPlacements[i]
            if i:
                self.joints[i] = add_like(
                    out, model, i, self.joints[parent], place, model.names[i], self.joints
                )
            else:
                out._inertias[self.joints[0]] += model.inertias[0].se3Action(self.base)
            for k, frame in enumerate(model.frames):
                if k and frame.parentJoint == i:
                    copied = frame.copy()
                    copied.parentJoint, copied.parentFrame = self.joints[i], 0
                    copied.placement = self.base * frame.placement if i == 0 else frame.placement
                    self.frames[k] = out.addFrame(copied, False)
        return added

    def tie_frames(self) -> None:
        """Sets the parents of its frames, once all exist; those of joints have the new universe as parent."""
        for k, new in self.frames.items():
            frame = self.model.frames[k]
            if k and (frame.parentFrame or frame.parentJoint == 0):
                self.out.frames[new].parentFrame = self.frames[frame.parentFrame]

    def place(self) -> None:
        """Adds its named configurations; what else the model has is neutral there, or as set by another part."""
        out = self.out
        for name, posture in self.model.referenceConfigurations.items():
            if name not in out.referenceConfigurations:
                out.referenceConfigurations[name] = algorithms.neutral(out._compiled_structure().model)
            q = out.referenceConfigurations[name]
            for old, new in self.joints.items():
                if old:
                    source, made = self.model.joints[old], out.joints[new]
                    q[made.idx_q : made.idx_q + made.nq] = posture[source.idx_q : source.idx_q + source.nq]


def _joined_geometries(models: dict[Part, Any], order: list[tuple[Part, int]]) -> Any:
    """The geometries of two models, in the order in which a model took up their joints.

    Their pairs are kept, and joined by all between them.
    """
    from pinocchio._geometry.geometry_collection import CollisionPair

    whole = type(next(iter(models.values())))()
    places: dict[Part, dict[int, int]] = {part: {} for part in models}
    for part, joint in order:
        for i, shape in enumerate(models[part].geometryObjects):
            if shape.parentJoint == joint:
                added = shape.copy()
                added.placement = part.base * added.placement if joint == 0 else added.placement
                added.parentJoint = part.joints[joint]
                added.parentFrame = part.frames.get(added.parentFrame, added.parentFrame)
                places[part][i] = whole.ngeoms
                whole.addGeometryObject(added)
    pairs = [
        (places[part][i], places[part][j]) for part, model in models.items() for i, j in model.collisionPairs
    ]
    carriers = [shape.parentJoint for shape in whole.geometryObjects]
    ours, theirs = ([place[i] for i in sorted(place)] for place in places.values())
    between = [(i, j) for i in ours for j in theirs if carriers[i] != carriers[j]]
    for i, j in [*pairs, *between]:
        whole.collisionPairs.append(CollisionPair(i, j))
    return whole


def transformJointIntoMimic(
    input_model: Model, index_mimicked: int, index_mimicking: int, scaling: float, offset: float
) -> Model:
    """The model with one joint following another: q = scaling * q_followed + offset.

    Args:
        input_model: The model, which stays as it is.
        index_mimicked: Index of the joint that is followed.
        index_mimicking: Index of the joint that follows.
        scaling: Factor [-].
        offset: Offset [rad or m].

    Returns:
        The new model.

    Raises:
        InputError: The joint that is followed comes after the other one.
    """
    out = input_model.copy()
    for i in (index_mimicked, index_mimicking):
        index(i, out.njoints, "joint", _NAMES)
    if not index_mimicked < index_mimicking:
        raise InputError(
            f"transformJointIntoMimic: joint {index_mimicking} cannot follow joint {index_mimicked}; expected the one "
            "that is followed to come first."
        )
    out._make_mimic(int(index_mimicked), int(index_mimicking), float(scaling), float(offset))
    return out


def findCommonAncestor(model: Model, joint1_id: int, joint2_id: int) -> tuple[int, int, int]:
    """The last common ancestor of two joints, and where it is in both of their supports.

    Args:
        joint1_id: Index of a joint.
        joint2_id: Index of another joint.

    Returns:
        Index of the joint, and its places in both supports.
    """
    first, second = (model.supports[index(i, model.njoints, "joint", _NAMES)] for i in (joint1_id, joint2_id))
    shared = sum(1 for a, b in zip(first, second, strict=False) if a == b)
    return first[shared - 1], shared - 1, shared - 1
