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

from pinocchio._containers.arguments import OMITTED, given
from pinocchio._containers.keywords import general_case, overloads, with_names
from pinocchio._data.algorithm import PARAMETER_NAMES, Algorithm
from pinocchio._data.binding import run
from pinocchio._spatial.motion_force import checked_forces
from ulna.compiler.runtime.repeated_calls import CallCache, call_cache, repeated_calls

Function = TypeVar("Function", bound=Callable[..., Any])
_LETTERS = {name: letter for letter, name in PARAMETER_NAMES.items()}


def algorithm(
    fills: tuple[str, ...],
    kernel: Callable[..., Any],
    *,
    default_state: tuple[str, str] | None = None,
    of_fields: Callable[[Any, Any, CallCache], Any] | None = None,
    forces: Algorithm | None = None,
    returns_field: str = "",
    returns_number: bool = False,
    calls: tuple[str, ...] = (),
    **record: Any,
) -> Callable[[Function], Function]:
    """Makes a public function of its signature (model, data, q, v, a or tau, fext) and of the record of its algorithm.

    Args:
        fills, kernel: See `Algorithm`.
        default_state: For a q that may be left out: the attribute of Data with the state to take then, and the call
            that stores it.
        of_fields: What runs in place of the algorithm when q is left out, on what the Data holds, where it applies. It
            may add a kernel to the cache of calls with the same Model and Data, its last argument.
        forces: The record of the algorithm under forces on the joints, for functions that take `fext`.
        returns_field: A field of Data to return, in place of outputs.
        returns_number: Whether the output that is returned is one number.
        calls: The ways to call it, where its signature is not the only one; see `overloads`.
        **record: Other attributes of `Algorithm`.

    Returns:
        The decorator.
    """

    def decorate(function: Function) -> Function:
        inputs = "".join(_LETTERS.get(name, "") for name in inspect.signature(function).parameters)
        made = Algorithm(function.__name__, inputs, fills, kernel, title=function.__name__, **record)
        repeated = call_cache(2, weak=2)

        def general(model: Any, data: Any, *args: Any) -> Any:
            state, rest = args[: len(inputs)], args[len(inputs) :]
            if default_state is not None and state[0] is None:
                stored = data._require(getattr(data, default_state[0]), default_state[1])
                result = of_fields(model, data, repeated) if of_fields is not None else NotImplemented
                if result is not NotImplemented:
                    return getattr(data, returns_field) if returns_field else result
                state = (stored,) if len(inputs) == 1 else tuple(x.copy() for x in stored)
            if forces is None or rest[0] is None:
                result = run(model, data, made, *state)
            else:
                result = run(model, data, forces, *state, *checked_forces(rest[0], model.njoints))
            result = float(result) if returns_number else result
            return getattr(data, returns_field) if returns_field else result

        functools.update_wrapper(general, function)
        body = overloads(*calls)(with_names(general)) if calls else _without_none(general)
        returned = {"returns_field": returns_field, "returns_number": returns_number}
        return fast_path(made, forces=forces, calls=repeated, **returned)(body)  # type: ignore[return-value]

    return decorate


def _without_none(function: Any) -> Any:
    """The same for calls with a value for every parameter, OMITTED for those left out; None raises."""
    names, title = [*inspect.signature(function).parameters][2:], function.__name__

    @functools.wraps(function)
    def called(model: Any, data: Any, *args: Any) -> Any:
        return function(model, data, *given(title, **dict(zip(names, args, strict=True))))

    return called


def fast_path(
    *records: Algorithm,
    forces: Algorithm | None = None,
    alternative: tuple[str, Any, Algorithm] | None = None,
    returns_field: str = "",
    returns_number: bool = False,
    calls: CallCache | None = None,
    other_calls: CallCache | None = None,
) -> Callable[[Function], Function]:
    """Calls the bound kernel of an algorithm first; where that fails, the decorated function with arguments checked.

    Args:
        *records: Algorithms, each with one input more; the one is called whose inputs are not None.
        forces: The algorithm to call where `fext` is not None.
        alternative: The name of a parameter, a value of it, and the algorithm to call where it has this value (and
            there are no forces).
        returns_field: A field of Data to return, in place of outputs.
        returns_number: Whether the output that is returned is one number.
        calls: The cache of calls with the same model and data; None for a new one.
        other_calls: The cache of calls that name the parameter after the inputs, which stand between its keys.

    Returns:
        The decorator.
    """
    calls = calls or call_cache(2, weak=2)
    caches = [calls] if other_calls is None else [calls, other_calls]

    def decorate(function: Function) -> Function:
        parameters = inspect.signature(function).parameters
        name = function.__name__
        returned = (
            f"data.{returns_field}" if returns_field else "float(result)" if returns_number else "result"
        )
        source = "\n".join(_source(name, parameters, records, forces, alternative, returned))
        scope: dict[str, Any] = {
            "general": general_case(function),
            "alternative": (alternative or "  ")[1],
            "omitted": OMITTED,
            "calls": calls,
            "other_calls": other_calls,
        }
        defaults = {key: parameter.default for key, parameter in parameters.items()}
        scope |= {f"default_{k}": OMITTED if x is None else x for k, x in defaults.items()}
        exec(compile(source, f"<fast path of {name}>", "exec"), scope)
        made: Any = functools.update_wrapper(scope[name], function)
        made.arguments_checked = True
        return repeated_calls(*caches)(made)

    return decorate


def _source(
    function: str,
    parameters: Any,
    records: tuple[Algorithm, ...],
    forces: Algorithm | None,
    alternative: tuple[str, Any, Algorithm] | None,
    returned: str,
) -> list[str]:
    """The lines of the function: a call of the bound kernel, and of `general` where that does not apply."""
    names = list(parameters)
    inputs = [[PARAMETER_NAMES[letter] for letter in record.inputs] for record in records]
    chosen = alternative[0] if alternative else ""
    ignored = {"model", "data", "fext" if forces else "", chosen, *inputs[-1]}
    conditions = [
        "data._model is model",
        *(_usual(name, p.default) for name, p in parameters.items() if name not in ignored),
    ]
    calls = [f"data._bound.{r.name}({', '.join(args)})" for r, args in zip(records, inputs, strict=True)]
    plain = [_call_lines(*x, returned) for x in zip(records, calls, strict=True)]
    lines = plain[0]
    for call, longer in zip(plain[1:], inputs[1:], strict=True):
        lines = [f"if {longer[-1]} is not omitted:", *_indented(call), "else:", *_indented(lines)]
    if forces:
        lines = _with_forces(lines, forces, inputs[-1])
    if alternative:
        lines = _with_alternative(lines, alternative[2], chosen, inputs[-1], "fext" if forces else "")
    lines += ["if result is not NotImplemented:", f"    return {returned}"]
    defaults = {name: "" if p.default is p.empty else f"=default_{name}" for name, p in parameters.items()}
    return [
        f"def {function}({', '.join(name + defaults[name] for name in names)}):",
        "    try:",
        f"        if {' and '.join(conditions)}:",
        *_indented(lines, 3),
        "    except AttributeError:  # of what is no model or no data",
        "        pass",
        f"    return general({', '.join(names)})",
    ]


def _with_forces(lines: list[str], forces: Algorithm, inputs: list[str]) -> list[str]:
    """The lines, and before them a call of the algorithm under forces where `fext` is given."""
    arguments = ", ".join([*inputs, "*[f._v for f in fext]"])
    return [
        *("if fext is omitted:", *_indented(lines), "else:", "    try:"),
        f"        result = data._bound.{forces.name}({arguments})",
        *("    except (AttributeError, TypeError):", "        result = NotImplemented"),
    ]


def _with_alternative(
    lines: list[str], other: Algorithm, chosen: str, inputs: list[str], left_out: str
) -> list[str]:
    """The lines, and in their place a call of another algorithm where a parameter has its other value.

    Calls that name the parameter, after the inputs, are added to a cache of their own.
    """
    kernel = f"data._bound.{other.name}"
    condition = f"{chosen} is alternative" + (f" and {left_out} is omitted" if left_out else "")
    return [
        *(f"if {chosen} is default_{chosen}:", *_indented(lines), f"elif {condition}:"),
        f"    result = {kernel}({', '.join(inputs)})",
        *("    if result is not NotImplemented:",),
        f"        other_calls.add({kernel}, {len(inputs)}, model, data, {chosen})",
        *("else:", "    result = NotImplemented"),
    ]


def _call_lines(record: Algorithm, call: str, returned: str) -> list[str]:
    """The lines that call a bound kernel, and add it to the cache of calls with the same model and data."""
    if returned != "result":  # the result of the kernel is not what is returned
        return [f"result = {call}"]
    kernel = call.partition("(")[0]
    add = f"    calls.add({kernel}, {len(record.inputs)}, model, data)"
    return [f"result = {call}", "if result is not NotImplemented:", add]


def _indented(lines: list[str], levels: int = 1) -> list[str]:
    return [f"{'    ' * levels}{line}" for line in lines]


def _usual(name: str, default: Any) -> str:
    """Whether an argument besides the state leaves the result as it is."""
    if default is True or default is False:  # of `compute_subtree_coms`, which leaves it whatever it says
        return f"({name} is True or {name} is False)"
    return f"{name} is default_{name}"
