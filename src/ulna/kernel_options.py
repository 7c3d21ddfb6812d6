"""What kernels are made of for a model: quantities with all their options, shapes and documentation of arguments."""

from __future__ import annotations

import re
import sys
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ulna import model as models
from ulna.algorithms import Friction, Proximal
from ulna.algorithms.multibody.references import check_reference
from ulna.checks.values import flag, short_repr
from ulna.errors import InputError, UnknownName
from ulna.model import Model
from ulna.quantities import QUANTITIES, Quantity
from ulna.quantities.documentation import ARRAYS, Size, with_batch
from ulna.quantities.part import frozen

if TYPE_CHECKING:
    from ulna.compiler import Function
    from ulna.recursions.looped_function import LoopedFunction

_SEARCHES = ("ik", "ik_all", "ik_classic", "ik_free", "distance", "collides", "first_contact")

DEVICES = ("cpu", "cuda")
"""What kernels are compiled for."""


def choose(name: str, options: Mapping[str, Any]) -> tuple[Quantity, dict[str, Any]]:
    """The quantity of that name, and all its options: those that were passed, and the default values of the others.

    Args:
        name: The name of a quantity.
        options: Options by name.

    Returns:
        The quantity, and its options.

    Raises:
        UnknownName: If there is no such quantity or option.
        InputError: If an option cannot have such a value.
    """
    quantity = QUANTITIES.get(name) if isinstance(name, str) else None
    if quantity is None:
        search = (
            f"robot.{name} is a method that searches; no kernel stands for it."
            if isinstance(name, str) and name in _SEARCHES
            else ""
        )
        raise UnknownName("kernel", name, QUANTITIES, search)
    for key in options:
        if key not in quantity.options:
            raise UnknownName(f"option of kernel {name!r}", key, quantity.options)
    chosen = {key: frozen(options.get(key, default)) for key, default in quantity.options.items()}
    for key, value in chosen.items():
        _check_option(key, value)
    return quantity, chosen


def for_precision(options: Mapping[str, Any], dtype: str) -> dict[str, Any]:
    """Options, with those that the type to compute in needs.

    Args:
        options: Options of a quantity, by name.
        dtype: The type to compute in, "float64" or "float32".

    Returns:
        The options: in single precision, forces of constraints are refined.
    """
    solver = options.get("solver")
    if dtype == "float64" or not isinstance(solver, Proximal) or solver.refine:
        return dict(options)
    return {**options, "solver": replace(solver, refine=True)}


def _check_option(key: str, value: Any) -> None:
    """Refuses what the option of a quantity cannot be, whatever its other values are."""
    if key == "reference":
        check_reference(value)
    expected = {
        "frame": "the name of a frame, or None for the tool",
        "forces": "names of frames and their wrenches, such as {'tool': [0, 0, -10, 0, 0, 0]}",
        "friction": "True for that of the model, False for none, or a Friction",
        "classical": "True or False",
        "damping": "a number of zero or more",
        "subtree": "the name of a joint, or None for the whole robot",
        "axes": "'all', 'trans', 'rot', or six truth values",
    }
    if not _may_be(key, value):
        raise InputError(f"`{key}` is {short_repr(value)}; expected {expected.get(key, 'a name')}.")


def _may_be(key: str, value: Any) -> bool:
    try:
        hash(value)
    except TypeError:  # an array in a tuple, a dictionary
        return False
    if key == "frame":
        return value is None or isinstance(value, (str, tuple))
    if key == "friction":
        return isinstance(value, (bool, np.bool_, Friction))
    if key == "classical":
        return isinstance(value, (bool, np.bool_, int)) and bool(value in (0, 1))
    if key == "damping":
        is_number = isinstance(value, (int, float, np.number)) and not isinstance(value, (bool, complex))
        return is_number and bool(0.0 <= value <= sys.float_info.max)
    return True


def shapes_of(model: Model, quantity: Quantity, chosen: Mapping[str, Any]) -> dict[str, Any]:
    """The shapes of a quantity's arguments.

    Args:
        model: The robot.
        quantity: The quantity.
        chosen: All its options.

    Returns:
        Shapes of one sample, by name of the argument.
    """
    return {key: shape_of(model, size) for key, size in quantity.arguments(chosen)}


def doc_of(model: Model, quantity: Quantity, chosen: Mapping[str, Any]) -> str:
    """The documentation of a kernel.

    Args:
        model: The robot.
        quantity: The quantity that it computes.
        chosen: All its options.

    Returns:
        What it computes, what it returns, for which robot and options.
    """
    names = named_options(model, quantity, chosen)
    about = "".join(f" {key.capitalize()}: {value}." for key, value in names.items())
    return f"{quantity.summary} Returns {with_batch(quantity.result)}. Robot: {model.name}.{about}"


def shape_of(model: Model, size: Size) -> tuple[int, ...]:
    """The shape of one sample of an array.

    Args:
        model: The robot.
        size: The same with names of sizes of the model, such as "nq".

    Returns:
        The shape.
    """
    sizes = (size,) if isinstance(size, str) else size
    return tuple(getattr(model, n) if isinstance(n, str) else n for n in sizes)


def check_device(device: str, checked: bool) -> None:
    """Refuses an unknown device, and checks on one that has none.

    Args:
        device: "cpu" or "cuda".
        checked: Whether nan and inf in the inputs are to be refused.

    Raises:
        UnknownName: For another device.
        InputError: If `checked` is no truth value, or asked for on a GPU.
    """
    if not isinstance(device, str) or device not in DEVICES:
        raise UnknownName("device", device, DEVICES)
    flag("checked", checked)
    if device == "cuda" and checked:
        raise InputError(
            "`checked` is True; expected False with device='cuda', since a GPU does not report what is wrong. "
            "Check the arrays before the call."
        )


def parameter_names(model: Model, parameters: str | Sequence[str]) -> tuple[str, ...]:
    """The names of the parameters, each once.

    Args:
        model: The robot.
        parameters: One name, or several.

    Returns:
        The names.

    Raises:
        UnknownName: If there is no such parameter.
        InputError: If one is named twice.
    """
    names = (parameters,) if isinstance(parameters, str) else tuple(parameters)
    for name in names:
        models.parameters(model, name)  # raises for an unknown one
        if names.count(name) > 1:
            raise InputError(f"`parameters` names {name!r} {names.count(name)} times; expected once.")
    return names


def unit_vector_entries(model: Model, quantity: Quantity) -> tuple[tuple[int, tuple[int, ...]], ...]:
    """Where configurations among the arguments hold unit vectors; nowhere for `normalize`, which normalises them.

    Args:
        model: The robot.
        quantity: The quantity.

    Returns:
        For each quaternion, or cosine and sine, the number of the argument, and the entries of it.
    """
    if quantity.name == "normalize":
        return ()
    inputs = [number for number, array in enumerate(quantity.arrays) if ARRAYS[array].size == "nq"]
    return tuple((number, entries) for number in inputs for entries in model.unit_vectors)


def shapes_for(model: Model, names: Sequence[str], known: Mapping[str, Any]) -> dict[str, Any]:
    """Shapes of the arguments of a user's function: those of q, q0, q1, v, a, tau, qd and qdd are the model's.

    Args:
        model: The robot.
        names: The names of the arguments.
        known: Shapes by name; they count also where they are known.

    Returns:
        The shape of each argument.

    Raises:
        UnknownName: If a shape is not known, or one is given for another name.
    """
    sizes = {name: ARRAYS[name].size for name in ("q", "q0", "q1", "v", "a", "tau")} | {
        "qd": "nv",
        "qdd": "nv",
    }
    for name in known:
        if name not in names:
            raise UnknownName("argument of the function", name, names)
    shapes = {}
    for name in names:
        if name not in known and name not in sizes:
            fix = f"Give the shape of other arguments: compile(f, robot, {name}=(3,))."
            raise UnknownName("argument of known shape", name, sizes, fix)
        shapes[name] = known[name] if name in known else shape_of(model, sizes[name])
    return shapes


def labels(
    model: Model, traced: Function | LoopedFunction, quantity: Quantity | None = None
) -> dict[str | int, Sequence[str]]:
    """What the entries of configurations and velocities among the inputs and outputs of a function are called.

    Args:
        model: The robot.
        traced: The function.
        quantity: Which quantity it computes; None for another function, of whose outputs nothing is known.

    Returns:
        The names of the coordinates, by name of the input and number of the output; none for other outputs.
    """
    names = {"nq": model.position_names, "nv": model.velocity_names}
    sizes = {name: argument.size for name, argument in ARRAYS.items()} | {"qd": "nv", "qdd": "nv"}
    known = {port.name: names.get(sizes.get(port.name)) for port in traced.inputs}  # type: ignore[arg-type]
    shapes = {port.name: port.shape for port in traced.inputs}
    out: dict[str | int, Sequence[str]] = {
        name: row for name, row in known.items() if row is not None and shapes[name] == (len(row),)
    }
    if quantity is not None:
        results = re.findall(r"\(([^)]*)\)", re.sub(r"\[[^\]]*\]", "", quantity.result))
        out |= {k: names.get(result.removesuffix(","), ()) for k, result in enumerate(results)}
    return out


def named_options(model: Model, quantity: Quantity, options: Mapping[str, Any]) -> dict[str, str]:
    """Which frame, reference and other names a kernel has been made for.

    Args:
        model: The robot.
        quantity: The quantity.
        options: Its options; those that are missing have their default values.

    Returns:
        The names by option; the tool's where a frame is None.
    """
    chosen = {**quantity.options, **options}
    names = {key: value for key, value in chosen.items() if isinstance(value, str)}
    frame = chosen.get("frame", "")
    if frame is None:
        return {"frame": model.tool, **names}
    return names if isinstance(frame, str) else {"frame": ", ".join(map(str, frame)), **names}
