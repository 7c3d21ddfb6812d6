"""Public functions made of the records of algorithms: a call of the bound kernel, and the general case behind it.

    @algorithm(fills=("nle",), kernel=_bias, returns=(0,))
    def nonLinearEffects(model: Model, data: Data, q: Any, v: Any) -> Floats:
        "What it computes."

declares the function, its record and its documentation at once; the body is the documentation alone.
"""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable
from typing import Any, TypeVar

from pinocchio._data.algorithm import PARAMETER_NAMES, Algorithm
from pinocchio._data.binding import run
from pinocchio._spatial.motion_force import checked_forces

Function = TypeVar("Function", bound=Callable[..., Any])
_LETTERS = {name: letter for letter, name in PARAMETER_NAMES.items()}


def algorithm(
    fills: tuple[str, ...],
    kernel: Callable[..., Any],
    *,
    default_state: tuple[str, str] | None = None,
    forces: Algorithm | None = None,
    returns_field: str = "",
    **record: Any,
) -> Callable[[Function], Function]:
    """Makes a public function of its signature (model, data, q, v, a or tau, fext) and of the record of its algorithm.

    Args:
        fills: See `Algorithm`.
        kernel: See `Algorithm`.
        default_state: For a q that may be left out: the attribute of Data with the state to take then, and the call
            that stores it.
        forces: The record of the algorithm under forces on the joints, for functions that take `fext`.
        returns_field: A field of Data to return, in place of outputs.
        record: Other attributes of `Algorithm`.
    """

    def decorate(function: Function) -> Function:
        names = [name for name in inspect.signature(function).parameters if name in _LETTERS]
        inputs = "".join(_LETTERS[name] for name in names)
        name = function.__name__
        made = Algorithm(name, inputs, fills, kernel, title=name, **record)

        def general(model: Any, data: Any, *args: Any) -> Any:
            state, rest = args[: len(inputs)], args[len(inputs) :]
            if default_state is not None and state[0] is None:
                stored = data.require(getattr(data, default_state[0]), default_state[1])
                state = (stored,) if len(inputs) == 1 else tuple(x.copy() for x in stored)
            if forces is not None and rest[0] is not None:
                result = run(model, data, forces, *state, *checked_forces(rest[0], model.njoints))
            else:
                result = run(model, data, made, *state)
            return getattr(data, returns_field) if returns_field else result

        functools.update_wrapper(general, function)
        return fast_path(made, forces=forces, returns_field=returns_field)(general)  # type: ignore[return-value]

    return decorate


def fast_path(
    *records: Algorithm, forces: Algorithm | None = None, returns_field: str = ""
) -> Callable[[Function], Function]:
    """Calls the bound kernel of an algorithm first, and the decorated function where it does not apply.

    Args:
        records: Algorithms, each with one input more; the one is called whose inputs are not None.
        forces: The algorithm to call where `fext` is not None.
        returns_field: A field of Data to return, in place of outputs.
    """

    def decorate(function: Function) -> Function:
        parameters = inspect.signature(function).parameters
        name = function.__name__
        source = "\n".join(_source(name, parameters, records, forces, returns_field))
        scope: dict[str, Any] = {"general": function}
        exec(compile(source, f"<fast path of {name}>", "exec"), scope)
        return functools.update_wrapper(scope[name], function)  # type: ignore[return-value]

    return decorate


def _source(
    function: str, parameters: Any, records: tuple[Algorithm, ...], forces: Any, returns_field: str
) -> list[str]:
    """The lines of the function: a call of the bound kernel, and of `general` where that does not apply."""
    names = list(parameters)
    inputs = [[PARAMETER_NAMES[letter] for letter in record.inputs] for record in records]
    ignored = {"model", "data", "fext" if forces else "", "compute_subtree_coms", *inputs[-1]}
    conditions = ["data._model is model", *(f"{name} is None" for name in names if name not in ignored)]
    calls = [f"data._bound.{r.name}({', '.join(args)})" for r, args in zip(records, inputs, strict=True)]
    lines = [f"        result = {calls[0]}"]
    for call, longer in zip(calls[1:], inputs[1:], strict=True):
        lines = [f"        if {longer[-1]} is not None:", f"            result = {call}", "        else:"] + [
            f"    {line}" for line in lines
        ]
    if forces:
        arguments = ", ".join([*inputs[-1], "*[f._v for f in fext]"])
        lines = [
            *("        if fext is None:", f"    {lines[0]}", "        else:", "            try:"),
            f"                result = data._bound.{forces.name}({arguments})",
            *("            except (AttributeError, TypeError):", "                result = NotImplemented"),
        ]
    defaults = {name: "" if p.default is p.empty else f"={p.default!r}" for name, p in parameters.items()}
    return [
        f"def {function}({', '.join(name + defaults[name] for name in names)}):",
        f"    if {' and '.join(conditions)}:",
        *lines,
        "        if result is not NotImplemented:",
        f"            return {f'data.{returns_field}' if returns_field else 'result'}",
        f"    return general({', '.join(names)})",
    ]
