"""Joints, frames and reference frames as arguments, and calls that are repeated with the same ones."""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple, TypeVar

import numpy as np

from pinocchio._containers.arguments import OMITTED, ArgumentError, checked
from pinocchio._containers.arrays import index
from pinocchio._containers.enums import ReferenceFrame
from pinocchio._containers.keywords import general_case, overloads
from pinocchio._model.model import Model
from pinocchio._spatial.se3 import SE3, as_placement
from pinocchio._spatial.small_kernels import pose
from ulna import spatial
from ulna.compiler.runtime.repeated_calls import CallCache, call_cache, repeated_calls
from ulna.model import Frame
from ulna.typing import Array, Floats

LOCAL = ReferenceFrame.LOCAL
Function = TypeVar("Function", bound=Callable[..., Any])


class Place(NamedTuple):
    """Where a frame is: a frame of the model, the frame of a joint, or at a placement on one, an input of kernels."""

    frame_id: int | None = None
    joint: int = 0
    placement: SE3 | None = None

    @property
    def key(self) -> Any:
        """What kernels for it are kept under: not its placement."""
        if self.frame_id is not None:
            return self.frame_id
        return ("joint" if self.placement is None else "placed", self.joint)

    @property
    def inputs(self) -> tuple[Floats, ...]:
        """What kernels for it take before all else: the placement (4, 4), or nothing."""
        return () if self.placement is None else (self.placement._m,)

    @property
    def holders(self) -> tuple[SE3, ...]:
        """The object that holds the placement, or nothing: what kernels take that are bound to a Data."""
        return () if self.placement is None else (self.placement,)

    def on_joint(self, model: Model) -> tuple[int, Floats | None]:
        """The joint that carries the frame, and the placement (4, 4) of the frame there; None for that of the joint."""
        if self.frame_id is not None:
            frame = model.frames[self.frame_id]
            return frame.parentJoint, frame.placement._m
        return self.joint, None if self.placement is None else self.placement._m

    @property
    def shapes(self) -> dict[str, Any]:
        """The shapes of these inputs."""
        return {} if self.placement is None else {"placed": (4, 4)}

    def split(self, frames: Sequence[Frame], inputs: Sequence[Array]) -> tuple[Frame, Sequence[Array]]:
        """Ulna's frame, and the inputs of a kernel that are not its own.

        Args:
            frames: The frames of the model.
            inputs: All inputs of the kernel, (4, 4) the first where there is a placement.

        Returns:
            The frame, and the inputs of the state (nq,) and (nv,).
        """
        if self.frame_id is not None:
            return frames[self.frame_id], inputs
        if self.placement is None:
            return _on_joint(self.joint, spatial.SE3.identity()), inputs
        return _on_joint(self.joint, pose(inputs[0])), inputs[1:]


def _on_joint(joint: int, placement: spatial.SE3) -> Frame:
    return Frame("", joint - 1, placement, "user", "", spatial.SE3.identity())


def at_joint(joint: int) -> Frame:
    """The frame of a joint, for Ulna."""
    return _on_joint(joint, spatial.SE3.identity())


def at_frame(model: Model, frame_id: Any) -> int:
    """The index of a frame, checked.

    Args:
        frame_id: Index of a frame.

    Returns:
        The index.
    """
    return index(frame_id, model.nframes, "frame", "model.getFrameId(name) returns one.")


def key_of(value: Any) -> Any:
    """The key under which something is bound at an index: True and 1.0, which equal 1, are none of its keys.

    Args:
        value: What was passed as an index.

    Returns:
        The index as an int, or something that no index equals.
    """
    kind = type(value)
    return value if kind is int else int(value) if issubclass(kind, np.integer) else (kind, value)


def place_of(model: Model, frame_id: Any, joint_id: Any, placement: SE3 | None) -> Place:
    """The place that an index of a frame is, or a placement on a joint.

    Args:
        frame_id: Index of a frame, or None.
        joint_id: Index of a joint, or None.
        placement: Pose of the frame in the frame of that joint, an SE3; None for a frame of the model.

    Returns:
        The place.

    Raises:
        ArgumentError: The placement is no SE3.
    """
    if placement is None:
        return Place(at_frame(model, frame_id))
    joint, placement = at_placement(model, joint_id, placement)
    return Place(None, joint, placement)


def at_placement(model: Model, joint_id: Any, placement: Any) -> tuple[int, SE3]:
    """The index of a joint, and a placement in its frame.

    Args:
        joint_id: Index of a joint.
        placement: Pose of a frame in the frame of that joint, an SE3.

    Returns:
        The index, and the placement.

    Raises:
        ArgumentError: The placement is no SE3.
    """
    placement = as_placement(placement)
    if not isinstance(placement, SE3):
        raise ArgumentError(f"The placement is {placement!r}; expected an SE3.")
    return index(joint_id, model.njoints, "joint", "model.getJointId(name) returns one."), placement


def repeated_call(kind: str, has_default: bool = True) -> Callable[[Function], Function]:
    """Has calls answered by the kernels in `data._bound_at`, and all others by the function.

    Args:
        kind: The third of the key in `data._bound_at`, after the index and the reference frame; "placed ..." there
            where a placement on a joint is given.
        has_default: Whether the reference frame may be left out.

    Returns:
        The decorator, for functions of (model, data, index, reference frame), and those that `at_frame_or_joint` or
        `at_frame_or_joint_by_default_local` has decorated.
    """
    default = LOCAL if has_default else None

    def decorate(function: Any) -> Any:
        takes_placement = len(getattr(function, "orders", [()])) == 2
        return (_at_frame_or_joint if takes_placement else _at_index)(function, kind, default)

    return decorate


def repeated_call_at_placement(kind: str) -> Callable[[Function], Function]:
    """The same for functions of (model, data, joint, placement, reference frame).

    Args:
        kind: The third of the key in `data._bound_at`, after the index and the reference frame.

    Returns:
        The decorator.
    """

    def decorate(function: Any) -> Any:
        general, calls = checked(function), call_cache(4, weak=2, kernel_argument=3)

        @functools.wraps(function)
        def called(model: Any, data: Any, joint_id: Any, placement: Any, reference_frame: Any) -> Any:
            rest = joint_id, reference_frame, placement
            result = _call_bound(calls, kind, None, model, data, *rest)
            if result is not NotImplemented:
                return result
            return general(model, data, joint_id, placement, reference_frame)

        called.arguments_checked = True  # type: ignore[attr-defined]
        return repeated_calls(calls)(called)

    return decorate


def _at_index(function: Any, kind: str, default: Any) -> Any:
    general, calls = checked(function), call_cache(4, weak=2)

    @functools.wraps(function)
    def called(model: Any, data: Any, joint_id: Any, reference_frame: Any = OMITTED) -> Any:
        result = _call_bound(calls, kind, default, model, data, joint_id, reference_frame)
        if result is not NotImplemented:
            return result
        if reference_frame is OMITTED:
            return general(model, data, joint_id)
        return general(model, data, joint_id, reference_frame)

    if default is None:  # so that messages of Python count the reference frame among the needed arguments
        called.__defaults__ = None  # type: ignore[attr-defined]
    called.arguments_checked = True  # type: ignore[attr-defined]
    return repeated_calls(calls)(called)


def _at_frame_or_joint(function: Any, kind: str, default: Any) -> Any:
    general, placed_kind = general_case(function), f"placed {kind}"
    calls, placed_calls = call_cache(4, weak=2), call_cache(4, weak=2, kernel_argument=3)

    @functools.wraps(function)
    def called(
        model: Any,
        data: Any,
        frame_id: Any = OMITTED,
        placement: Any = OMITTED,
        reference_frame: Any = OMITTED,
        joint_id: Any = OMITTED,
    ) -> Any:
        result = NotImplemented
        if joint_id is OMITTED:
            if type(placement) is SE3:  # by position, `frame_id` is the joint
                rest = frame_id, reference_frame, placement
                result = _call_bound(placed_calls, placed_kind, default, model, data, *rest)
            elif reference_frame is OMITTED:  # by position, `placement` is the reference frame
                result = _call_bound(calls, kind, default, model, data, frame_id, placement)
        if result is not NotImplemented:
            return result
        return general(model, data, frame_id, placement, reference_frame, joint_id)

    return repeated_calls(calls, placed_calls)(called)


def _call_bound(
    calls: CallCache, kind: str, default: Any, model: Any, data: Any, index: Any, reference: Any, *inputs: Any
) -> Any:
    """The result of the kernel that is bound for an index and a reference frame, which is added to the cache.

    Args:
        calls: The cache.
        kind: The third of the key in `data._bound_at`.
        default: The reference frame if `reference` is OMITTED.
        model, data, index, reference: The keys of the call.
        *inputs: What the kernel is called with.

    Returns:
        The result; NotImplemented where no kernel is bound, or it does not apply.
    """
    frame = default if reference is OMITTED else reference
    try:
        step, bound_frame = data._bound_at[key_of(index), frame, kind]
        if bound_frame is not frame or data._model is not model:  # 0 == WORLD, but a plain number raises
            return NotImplemented
        result = step(*inputs)
    except (KeyError, TypeError, AttributeError):  # not bound yet, or arguments of other types
        return NotImplemented
    if result is not NotImplemented:
        keys = (model, data, index) if reference is OMITTED else (model, data, index, reference)
        calls.add(step, len(inputs), *keys)
    return result


at_frame_or_joint = overloads(
    "model data frame_id:int reference_frame:ReferenceFrame",
    "model data joint_id:int placement:SE3 reference_frame:ReferenceFrame",
)
"""For functions of a frame, or of a placement on a joint."""
at_frame_or_joint_by_default_local = overloads(
    "model data frame_id:int reference_frame:ReferenceFrame?",
    "model data joint_id:int placement:SE3 reference_frame:ReferenceFrame?",
)
"""The same, where the reference frame may be left out."""
