"""Joints, frames and reference frames as arguments, and calls that are repeated with the same ones."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable
from typing import Any, TypeVar

from pinocchio._containers.arrays import index
from pinocchio._containers.enums import ReferenceFrame, reference_of
from pinocchio._model.model import Model
from pinocchio._spatial.motion_force import Motion
from pinocchio._spatial.se3 import SE3
from ulna import spatial
from ulna.algorithms.multibody.references import Reference
from ulna.model import Frame

LOCAL = ReferenceFrame.LOCAL
Function = TypeVar("Function", bound=Callable[..., Any])


def at_joint(joint: int) -> Frame:
    """The frame of a joint, for Ulna."""
    return Frame("", joint - 1, spatial.SE3.identity(), "user", "", spatial.SE3.identity())


def at_frame(model: Model, place: Any) -> tuple[Any, Any]:
    """A key and Ulna's frame of an index of a frame, or of (index of a joint, placement)."""
    if len(place) == 1:
        return index(place[0], model.nframes, "frame", "model.getFrameId(name) returns one."), None
    joint, M = place
    joint = index(joint, model.njoints, "joint", "model.getJointId(name) returns one.")
    fixed_frame = Frame("", joint - 1, M._pose(), "user", "", spatial.SE3.identity())
    return (joint, M._m.tobytes()), fixed_frame


def split(rest: tuple[Any, ...], rf: Any) -> tuple[tuple[Any, ...], Reference]:
    """(index) or (joint, placement), and the reference, out of what stands before and by name."""
    if len(rest) > 1 and isinstance(rest[-1], ReferenceFrame):
        rest, rf = rest[:-1], rest[-1]
    elif len(rest) > 1 and not isinstance(rest[-1], SE3):
        reference_of(rest[-1])
    return rest, reference_of(LOCAL if rf is None else rf)


def repeated_call(kind: str, motion: bool = False) -> Callable[[Function], Function]:
    """Repeats a call with the same arguments by one native call, and leaves all others to the function.

    Args:
        kind: The third of the key in `data._bound_at`, after the index and the reference frame.
        motion: Whether the result is a Motion.
    """

    def decorate(function: Any) -> Any:
        name, any_order = function.__name__, hasattr(function, "orders")
        names = list(inspect.signature(function).parameters)[2:]
        place, reference, *rest = names
        if any_order:
            place, reference = "place", "known_as"  # so that all arguments by name are in `named`
            parameters, others = f"{place}=None, {reference}=None, *rest, **named", ["rest or named"]
            call = f"*(x for x in ({place}, {reference}) if x is not None), *rest, **named"
        else:
            default = "None" if rest else "LOCAL"
            parameters = ", ".join([place, f"{reference}={default}", *(f"{other}=None" for other in rest)])
            others, call = [f"{other} is not None" for other in rest], ", ".join(names)
        key = "LOCAL if REFERENCE is None else REFERENCE" if any_order or rest else "REFERENCE"
        source = _TEMPLATE.format(
            name=name,
            parameters=parameters,
            others=" or ".join(others) or "False",
            call=call,
            place=place,
            reference=key.replace("REFERENCE", reference),
            kind=kind,
            returned=_AS_MOTION if motion else "return result",
        )
        scope: dict[str, Any] = {"general": function, "LOCAL": LOCAL, "new": object.__new__, "Motion": Motion}
        exec(compile(source, f"<repeated call of {name}>", "exec"), scope)
        return functools.update_wrapper(scope[name], function)

    return decorate


_TEMPLATE = """
def {name}(model, data, {parameters}):
    if {others}:
        return general(model, data, {call})
    reference = {reference}
    try:
        step, bound_reference = data._bound_at[{place}, reference, {kind!r}]
    except (KeyError, TypeError):
        pass
    else:
        if bound_reference is reference and data._model is model:  # 0 == WORLD, but a plain number raises
            result = step()
            if result is not NotImplemented:
                {returned}
    return general(model, data, {place}, reference)
"""
_AS_MOTION = "motion = new(Motion); motion._v = result; return motion"
