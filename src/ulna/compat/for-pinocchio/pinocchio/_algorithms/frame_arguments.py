"""Joints, frames and reference frames as arguments, and calls that are repeated with the same ones."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple, TypeVar

from pinocchio._containers.arguments import OMITTED, ArgumentError
from pinocchio._containers.arrays import index
from pinocchio._containers.enums import ReferenceFrame
from pinocchio._containers.keywords import general_case, overloads
from pinocchio._model.model import Model
from pinocchio._spatial.se3 import SE3
from pinocchio._spatial.small_kernels import pose
from ulna import spatial
from ulna.compiler.runtime.repeated_calls import memory, repeated_calls
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
    if not isinstance(placement, SE3):
        raise ArgumentError(f"The placement is {placement!r}; expected an SE3.")
    return index(joint_id, model.njoints, "joint", "model.getJointId(name) returns one."), placement


def repeated_call(kind: str, has_default: bool = True) -> Callable[[Function], Function]:
    """Repeats a call with the same arguments by one native call, and leaves all others to the function.

    Args:
        kind: The third of the key in `data._bound_at`, after the index and the reference frame.
        has_default: Whether the reference frame may be left out.

    Returns:
        The decorator.
    """

    def decorate(function: Any) -> Any:
        name = function.__name__
        place, reference, *rest = list(inspect.signature(function).parameters)[2:]
        names = [place, reference, *rest]
        defaults = dict.fromkeys(names, "omitted") if rest else {reference: "LOCAL"} if has_default else {}
        source = _TEMPLATE.format(
            name=name,
            parameters=", ".join(f"{x}={defaults[x]}" if x in defaults else x for x in names),
            others=" or ".join(f"{other} is not omitted" for other in rest) or "False",
            call=", ".join(names),
            place=place,
            reference=f"LOCAL if {reference} is omitted else {reference}"
            if rest and has_default
            else reference,
            kind=kind,
            reference_given=reference,
            placed_reference=f"LOCAL if {rest[0]} is omitted else {rest[0]}" if rest else "None",
            no_more=f"{rest[1]} is omitted" if rest else "False",
        )
        noted = memory(4, weakly=2)
        scope: dict[str, Any] = {
            "general": general_case(function),
            "omitted": OMITTED,
            "LOCAL": LOCAL,
            "noted": noted,
        }
        exec(compile(source, f"<repeated call of {name}>", "exec"), scope)
        made: Any = functools.update_wrapper(scope[name], function)
        made.arguments_checked = True
        return repeated_calls(noted)(made)

    return decorate


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


_TEMPLATE = """
def {name}(model, data, {parameters}):
    if {others}:
        try:
            reference = {placed_reference}
            step, bound_reference = data._bound_at[{place}, reference, "placed {kind}"]
            if bound_reference is reference and data._model is model and {no_more}:
                result = step({reference_given}._m)
                if result is not NotImplemented:
                    return result
        except (KeyError, TypeError, AttributeError):  # not bound yet, or no placement on a joint
            pass
        return general(model, data, {call})
    reference = {reference}
    try:
        step, bound_reference = data._bound_at[{place}, reference, {kind!r}]
    except (KeyError, TypeError, AttributeError):
        pass
    else:
        if bound_reference is reference and data._model is model:  # 0 == WORLD, but a plain number raises
            result = step()
            if result is not NotImplemented:
                if {reference_given} is omitted:
                    noted(step, 0, model, data, {place})
                else:
                    noted(step, 0, model, data, {place}, reference)
                return result
    return general(model, data, {call})
"""
