"""Configurations as users write them, arrays or numbers by joint name, converted to q."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ulna.checks.arrays import real_array
from ulna.checks.labels import in_order
from ulna.checks.masked import check_not_masked
from ulna.errors import InputError, ModelError, UnknownName, excerpt
from ulna.model.model import Model
from ulna.typing import Floats


def position(model: Model, q: Any, what: str = "q", base: Floats | None = None) -> Floats:
    """The position of a model, from an array, a name, or numbers by joint name.

    Args:
        model: The model.
        q: The position, shape (nq,) [rad, m]; or numbers by joint name, where those left out stand as in `base` and
            mimic joints may be listed but follow their source; or the name of a configuration.
        what: What it is called in messages.
        base: Where the joints left out stand, shape (nq,) [rad, m]; None for neutral.

    Returns:
        A new array, shape (nq,) [rad, m].

    Raises:
        UnknownName: no joint or configuration of that name moves.
        ModelError: wrong shape, nan or inf, or a quaternion, or cosine and sine, far from unit length.
        InputError: a quaternion is zero.
    """
    if isinstance(q, str):
        return np.array(model.configurations[q])
    if isinstance(q, Mapping):
        start = model.neutral if base is None else base
        out = local_position(model.nq, start, "base", _each(model.position_names))
        for name, value in q.items():
            if name not in model.joint_names:
                raise UnknownName("movable joint", name, model.joint_names, f"It is in {what}.")
            joint = model.joint(name)
            local = local_position(joint.kind.nq, value, f"joint {name!r} in {what}")
            if joint.mimic is None:
                out[joint.idx_q : joint.idx_q + joint.nq] = local
    else:
        out = local_position(
            model.nq, in_order(what, q, model.position_names), what, _each(model.position_names)
        )
    for joint in model.joints:
        if joint.mimic is None and joint.kind.has_quaternion:
            part = slice(joint.idx_q, joint.idx_q + joint.nq)
            with np.errstate(invalid="ignore", divide="ignore"):  # of length 0: nan, which is refused below
                unit = joint.kind.normalize(out[part])
            units = [k for k, c in enumerate(joint.kind.coordinates) if c.unit == ""]
            if not np.abs(unit - out[part])[units].max() <= 1e-3:
                subject = "quaternion" if len(units) == 4 else "(cosine, sine)"
                raise ModelError(
                    f"The {subject} of joint {joint.name!r} in {what} is not of unit length, but of "
                    f"{np.linalg.norm(out[part][units]):.6g}. Divide it by its length."
                )
            out[part] = unit
    return out


def local_position(count: int, value: Any, what: str, each: str = "") -> Floats:
    """The position of one joint.

    Args:
        count: How many numbers it has.
        value: What was passed.
        what: What it is, for the message.
        each: What the numbers are, for the message.

    Returns:
        A new array, shape (count,) [rad, m].

    Raises:
        ModelError: they are not so many finite, real numbers.
    """
    check_not_masked(what, value)
    try:
        out = np.array(real_array(what, value))
    except InputError:
        raise ModelError(f"The {what} is {excerpt(repr(value))}; expected {count} numbers.") from None
    if out.ndim == 0 and count == 1:
        out = out.reshape(1)
    if out.shape != (count,):
        hint = f", {each}" if each else ""
        raise ModelError(f"The {what} has shape {out.shape}; expected ({count},){hint}.")
    if not np.isfinite(out).all():
        raise ModelError(f"The {what} holds nan or inf; expected finite numbers.")
    return out


def _each(names: tuple[str, ...]) -> str:
    shown = ", ".join(names[:8]) + (", ..." if len(names) > 8 else "")
    return f"one number for each of {shown}" if names else ""
