"""What to export: from names of quantities, compiled functions and options to records."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from ulna import kernels
from ulna import model as models
from ulna.checks.values import short_repr
from ulna.compiler import Function, KernelBase
from ulna.errors import InputError, UnknownName
from ulna.exporting.record import Argument, ExportedFunction, ExportedSearch
from ulna.ik.arguments import default_start, named_goals, problem_of, shift_of
from ulna.kernel_options import for_precision
from ulna.model import Model
from ulna.quantities import QUANTITIES
from ulna.quantities.documentation import ARRAYS, cited

SEARCH_OPTIONS = ("frame", "mask", "joints", "seed")
"""Options of the search "ik", as of `robot.ik`."""

SAMPLES = 8
"""Number of test samples for which results are stored."""

_SYMBOLS = {
    "fk": "T",
    "jacobian": "J",
    "jacobian_dot": "J_dot",
    "inverse_dynamics": "tau",
    "forward_dynamics": "a",
    "mass_matrix": "M",
    "inverse_mass_matrix": "M_inverse",
    "coriolis_matrix": "C",
    "bias_forces": "h",
    "gravity_forces": "g",
}
"""The letters that results usually have; the others are called "out"."""

_OTHERS = {
    "f_ext": (
        "N, N m",
        "Wrenches on the frames of `forces`, in their order, expressed in the option `reference`",
    ),
    "gravity": ("m/s^2", "Gravitational acceleration in world axes, such as (0, 0, -9.81)"),
    "armature": ("kg or kg m^2", "Armature: rotor inertia reflected to the joints"),
    "damping": ("N s/m or N m s/rad", "Viscous friction coefficients of the joints"),
    "friction": ("N or N m", "Coulomb friction forces or torques of the joints"),
    "inertia": (
        "",
        "Dynamic parameters of the bodies, ten each; see parameters in the documentation of Ulna",
    ),
}
"""Units and meaning of arguments that options add."""

Entry = tuple[str, Any, Mapping[str, Any]]
"""A name, a quantity's name or a function, and the options of this one alone."""


def entries(chosen: Any) -> list[Entry]:
    """The functions that are asked for, each with a name.

    Args:
        chosen: The argument `kernels` of `export`.

    Returns:
        Name, quantity or function, and options of each.

    Raises:
        InputError: If there is none, one is something else, or two have the same name.
    """
    if isinstance(chosen, str) or _traced(chosen) is not None:
        chosen = [chosen]
    if isinstance(chosen, Mapping):
        pairs = [(name, *_split_options(item)) for name, item in chosen.items()]
    elif isinstance(chosen, Iterable):
        pairs = [("", *_split_options(item)) for item in chosen]
    else:
        raise InputError(f"`kernels` is {short_repr(chosen)}; {_EXPECTED}.")
    if not pairs:
        raise InputError(f"`kernels` is empty; {_EXPECTED}.")
    made = [(name or _name_of(item), item, options) for name, item, options in pairs]
    for name, item, _ in made:
        check_identifier("name of a kernel", name, f"kernels={{'my_name': {short_repr(item)}}}")
    names = [name for name, _, _ in made]
    double = next((name for name in names if names.count(name) > 1), None)
    if double is not None:
        raise InputError(
            f"Two kernels have the name {double!r}. A dictionary chooses other names: "
            f'kernels={{"{double}": "{double}", "{double}_2": ("{double}", {{"frame": "..."}})}}.'
        )
    return made


_EXPECTED = (
    'expected names such as "fk", compiled functions, pairs ("fk", {"frame": "panda_hand"}), or a dictionary of '
    "such by name"
)


def check_identifier(what: str, name: Any, fix: str = "") -> None:
    """Refuses a name that is not an ASCII identifier of at most 61 characters; keywords are not checked.

    Args:
        what: What it names.
        name: The name.
        fix: What to write instead.

    Raises:
        InputError: If it is none.
    """
    if not isinstance(name, str) or re.fullmatch(r"[A-Za-z][A-Za-z0-9_]{0,60}", name) is None:
        advice = f" For example {fix}." if fix else ""
        raise InputError(
            f"The {what} is {short_repr(name)}; expected a letter, then letters, digits and underscores.{advice}"
        )


def identifier(text: str) -> str:
    """A text as an identifier: what is no letter, digit or underscore becomes an underscore."""
    plain = re.sub(r"\W+", "_", text, flags=re.ASCII).strip("_") or "robot"
    plain = f"_{plain}" if plain[0].isdigit() else plain
    return (f"robot{plain}" if plain[0] == "_" else plain)[:60]


def records(
    model: Model | None, chosen: Sequence[Entry], options: Mapping[str, Any], dtype: str = "float64"
) -> tuple[tuple[ExportedFunction, ...], tuple[ExportedSearch, ...]]:
    """The functions and searches that are asked for.

    Args:
        model: The robot, or None.
        chosen: What is asked for, from `entries`.
        options: Options of quantities, such as `frame`; each holds for all that know it.
        dtype: The type to compute in, "float64" or "float32".

    Returns:
        Functions and searches.

    Raises:
        UnknownName: For an unknown quantity or option, and from the quantity itself.
        InputError: If a quantity is named without a robot.
    """
    functions, searches = [], []
    for name, item, own_options in chosen:
        traced = _traced(item)
        if traced is not None:
            functions.append(_of_user(name, traced, model))
            continue
        if model is None:
            raise InputError(f"{item!r} is a quantity of a robot; expected a robot as the first argument.")
        known = options_of(item)
        for option in own_options:
            if option not in known:
                raise UnknownName(f"option of kernel {item!r}", option, known)
        mine = {**{key: value for key, value in options.items() if key in known}, **own_options}
        if item == "ik":
            searches.append(_search(name, model, mine))
        else:
            functions.append(_of_quantity(name, model, item, mine, dtype))
    return tuple(functions), tuple(searches)


def options_of(item: Any) -> tuple[str, ...]:
    """The options of a quantity or search; none for a function.

    Args:
        item: A name or a compiled function.

    Returns:
        Their names.

    Raises:
        UnknownName: If there is no such quantity.
    """
    if _traced(item) is not None:
        return ()
    if item == "ik":
        return SEARCH_OPTIONS
    if item not in QUANTITIES:
        raise UnknownName("kernel", item, ("ik", *QUANTITIES))
    return (*QUANTITIES[item].options, "parameters")


def _of_quantity(
    name: str, model: Model, item: str, options: Mapping[str, Any], dtype: str
) -> ExportedFunction:
    quantity = QUANTITIES[item]
    function = kernels.function(model, item, **for_precision({**quantity.options, **options}, dtype))
    summary, source = cited(quantity.summary)
    set_options = {key: _listed(value) for key, value in options.items() if value is not None and value != ()}
    choices = {**set_options, **kernels.named_options(model, quantity, options)}
    if choices.get("frame") == "all":
        choices["frame"] = ", ".join(model.frame_names)
    if source:
        choices["source"] = source
    inputs = tuple(Argument(p.name, p.shape, *_unit_and_text(p.name)) for p in function.inputs)
    unit = quantity.result[quantity.result.find("[") + 1 :].rstrip("]") if "[" in quantity.result else ""
    symbol = _SYMBOLS.get(item, "out") if function.single else ""
    outputs = tuple(Argument(symbol or p.name, p.shape, unit) for p in function.outputs)
    parameters = options.get("parameters", ())
    fixed = (parameters,) if isinstance(parameters, str) else tuple(parameters)
    samples = _samples(function, model, fixed)
    return ExportedFunction(name, function, inputs, outputs, " ".join(summary.split()), choices, samples)


def _listed(value: Any) -> str:
    """A value as text: entries of lists with commas between them."""
    return ", ".join(map(str, value)) if isinstance(value, (list, tuple)) else str(value)


def _unit_and_text(name: str) -> tuple[str, str]:
    return (ARRAYS[name].unit, ARRAYS[name].text) if name in ARRAYS else _OTHERS.get(name, ("", ""))


def _size(name: str) -> str:
    """The size of a robot's array of that name: "nq", "nv", or empty."""
    size = ARRAYS[name].size if name in ARRAYS else ""
    return size if isinstance(size, str) else ""


def _of_user(name: str, function: Function, model: Model | None) -> ExportedFunction:
    sizes = {} if model is None else {"nq": (model.nq,), "nv": (model.nv,)}
    inputs = tuple(
        Argument(p.name, p.shape, *_unit_and_text(p.name if p.shape == sizes.get(_size(p.name)) else ""))
        for p in function.inputs
    )
    outputs = tuple(Argument(p.name, p.shape) for p in function.outputs)
    summary = " ".join((function.doc or "").strip().split("\n\n", 1)[0].split())
    if function.lanes > 1:
        raise InputError(
            f"{name} evaluates one sample in {function.lanes} SIMD lanes, which cannot be exported. "
            "Trace it with lanes=1."
        )
    return ExportedFunction(name, function, inputs, outputs, summary, {}, _samples(function, model))


def _search(name: str, model: Model, options: Mapping[str, Any]) -> ExportedSearch:
    frame, joints = options.get("frame"), options.get("joints")
    joints = (joints,) if isinstance(joints, str) else joints
    blank = np.eye(4)
    _, frames, masks = named_goals(blank, frame, options.get("mask"), model.tool)
    problem = problem_of(model, frames, masks, None if joints is None else tuple(joints))
    choices = {"frame": ", ".join(frames)}
    choices.update({key: _listed(options[key]) for key in ("mask", "joints") if options.get(key) is not None})
    start = default_start(problem)
    q = np.tile(start, (SAMPLES, 1))  # joints that may not move stay where the search has them
    q[:, problem.positions] = _configurations(model, SAMPLES)[:, problem.positions]
    poses = [np.stack([kernels.function(model, "fk", frame=f)(x) for f in frames]) for x in q]
    goals = np.stack(poses) if len(frames) > 1 else np.stack(poses)[:, 0]
    shift = shift_of(options.get("seed", 0), problem)
    return ExportedSearch(name, problem, start, shift, choices, goals)


def _configurations(model: Model, count: int) -> Any:
    """Configurations within the limits, (count, nq), the same at every call."""
    rng = np.random.default_rng(7)
    lower, upper = np.maximum(model.lower_position, -2.0), np.minimum(model.upper_position, 2.0)
    lower, upper = np.minimum(lower, model.upper_position), np.maximum(upper, model.lower_position)
    q = lower + (upper - lower) * rng.random((count, model.nq))
    for places in model.unit_vectors:
        x = rng.normal(size=(count, len(places)))
        q[:, list(places)] = x / np.linalg.norm(x, axis=1, keepdims=True)
    return q


def _samples(function: Function, model: Model | None, parameters: Sequence[str] = ()) -> tuple[Any, ...]:
    """Inputs of stored results: configurations and parameters of the robot; others uniformly distributed in [-1, 1]."""
    rng = np.random.default_rng(11)
    samples = []
    for port in function.inputs:
        if model is not None and port.name in ("q", "q0", "q1") and port.shape == (model.nq,):
            samples.append(_configurations(model, SAMPLES))
        elif model is not None and port.name in parameters:
            samples.append(np.stack([models.parameters(model, port.name)] * SAMPLES))
        else:
            samples.append(rng.uniform(-1.0, 1.0, (SAMPLES, *port.shape)))
    return tuple(samples)


def _split_options(item: Any) -> tuple[Any, Mapping[str, Any]]:
    """A quantity or function, and its options."""
    pair = isinstance(item, tuple) and len(item) == 2 and isinstance(item[1], Mapping)
    kernel, options = item if pair else (item, {})
    if not isinstance(kernel, str) and _traced(kernel) is None:
        raise InputError(f"`kernels` has {short_repr(item)}; {_EXPECTED}.")
    return kernel, options


def _traced(item: Any) -> Function | None:
    """The traced function of a compiled one."""
    if isinstance(item, KernelBase):
        return item.function
    return item if isinstance(item, Function) else None


def _name_of(item: Any) -> str:
    traced = _traced(item)
    return identifier(traced.name) if traced is not None else item
