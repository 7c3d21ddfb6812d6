"""Poses from text: chains of elementary transforms such as "Rx(q1) Tz(2 * a)", evaluated at numbers."""

from __future__ import annotations

import ast
import math
import operator
import re
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from roboticstoolbox._common.errors import UnknownOption, WrongType
from roboticstoolbox._common.numbers import numbers
from roboticstoolbox._common.poses import to_planar
from roboticstoolbox._common.symbols import has_symbols, is_symbol
from ulna.errors import FormatError, InputError, excerpt
from ulna.formats.ets import ET
from ulna.typing import Floats

_OPERATORS: dict[type, Callable[..., Any]] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv, ast.Mod: operator.mod, ast.Pow: operator.pow,
    ast.UAdd: operator.pos, ast.USub: operator.neg,
}  # fmt: skip


def _function(name: str) -> Callable[[Any], Any]:
    """A function of numbers or of symbols."""

    def apply(x: Any) -> Any:
        if not is_symbol(x):
            return getattr(np, name)(x)
        import sympy

        return getattr(sympy, name)(x)

    return apply


_KNOWN = {"pi": math.pi, **{name: _function(name) for name in ("sin", "cos", "tan", "sqrt")}}
_TURNS_AND_SHIFTS = {"Rx": ET.rx, "Ry": ET.ry, "Rz": ET.rz, "Tx": ET.tx, "Ty": ET.ty, "Tz": ET.tz}
_IN_THE_PLANE = {"R": ET.rz, "Rz": ET.rz, "Tx": ET.tx, "Ty": ET.ty}


class TrChainToken(NamedTuple):
    """One transform of a chain.

    Attributes:
        op: Which: "Rx" to "Tz", or "R" in the plane.
        arg: The text between its brackets.
        index: Number of the joint in it, from 1; 0 where there is none.
    """

    op: str
    arg: str
    index: int  # type: ignore[assignment]


def trchain(
    chain: str | Sequence[TrChainToken],
    q: Any = None,
    unit: str = "rad",
    *,
    qvar: str = "q",
    variables: Mapping[str, Any] | None = None,
    return_tokens: bool = False,
) -> Any:
    """The pose at the end of a chain of Rx, Ry, Rz, Tx, Ty, Tz, (4, 4).

    Args:
        chain: Text, or tokens that an earlier call returned.
        q: Joint coordinates, which the text calls q1, q2 and so on.
        unit: Of angles, "rad" or "deg".
        qvar: What the text calls them instead of "q".
        variables: Further names in the text: numbers, or functions to call.
        return_tokens: Whether to return the tokens, too, to save parsing the text again.

    Returns:
        The pose (4, 4); with `return_tokens` a tuple with the tokens.

    Raises:
        FormatError: The text is no chain, or an expression in it is none.
        UnknownOption: It names what is not known.
        InputError: An argument is not what it should be.
    """
    T, tokens = _evaluated(chain, q, unit, qvar, variables or {}, _TURNS_AND_SHIFTS)
    return (T, tokens) if return_tokens else T


def trchain2(
    chain: str | Sequence[TrChainToken],
    q: Any = None,
    unit: str = "rad",
    *,
    qvar: str = "q",
    variables: Mapping[str, Any] | None = None,
    return_tokens: bool = False,
) -> Any:
    """The pose in the plane at the end of a chain of R, Tx, Ty; see `trchain`.

    Args:
        chain: Text, or tokens that an earlier call returned.
        q: Joint coordinates, which the text calls q1, q2 and so on [rad or m].
        unit: Of angles, "rad" or "deg".
        qvar: Name of the joint coordinates in the text.
        variables: Further names in the text: numbers, or functions to call.
        return_tokens: Whether to return the tokens, too.

    Returns:
        The pose (3, 3); with `return_tokens` a tuple with the tokens.
    """
    T, tokens = _evaluated(chain, q, unit, qvar, variables or {}, _IN_THE_PLANE)
    return (to_planar(T), tokens) if return_tokens else to_planar(T)


def _evaluated(
    chain: Any, q: Any, unit: str, qvar: str, variables: Mapping[str, Any], makers: Mapping[str, Any]
) -> tuple[Floats, tuple[TrChainToken, ...]]:
    if unit not in ("rad", "deg"):
        raise InputError(f"`unit` is {unit!r}; expected 'rad' or 'deg'.")
    if not (isinstance(qvar, str) and qvar.isidentifier()):
        raise InputError(f"`qvar` is {qvar!r}; expected a name such as 'q'.")
    if not isinstance(variables, Mapping):
        raise WrongType(
            f"`variables` is {excerpt(repr(variables))}; expected a dictionary of numbers and functions."
        )
    listed = chain if hasattr(chain, "__iter__") else [chain]
    tokens = _parsed(chain, qvar) if isinstance(chain, str) else tuple(listed)
    if not all(isinstance(token, TrChainToken) for token in tokens):
        raise WrongType("`chain` is neither text nor a sequence of TrChainToken.")
    joints = np.ravel(q if has_symbols(q) else numbers("q", [] if q is None else q))
    T = np.eye(4)
    for token in tokens:
        if token.op not in makers:
            raise UnknownOption("transform", token.op, makers)
        if token.index > len(joints):
            raise InputError(f"`q` has {len(joints)} numbers; the chain needs {qvar}{token.index}.")
        names = {**_KNOWN, **variables}
        if token.index:
            names[f"{qvar}{token.index}"] = joints[token.index - 1]
        value = _value(token.arg, names)
        if unit == "deg" and token.op[0] == "R":
            value = value * math.pi / 180
        make = makers[token.op]
        T = T @ (make(index=0).transform(value) if is_symbol(value) else make(value).transform()).matrix()
    return T, tokens


def _parsed(text: str, qvar: str) -> tuple[TrChainToken, ...]:
    joint = re.compile(rf"\b{re.escape(qvar)}([1-9][0-9]{{0,5}})\b")
    out, at = [], 0
    while match := re.compile(r"(R.?|T.)\(").search(text, at):
        _check_separator(text[at : match.start()], text)
        depth, at = 1, match.end()
        while depth and at < len(text):
            depth += {"(": 1, ")": -1}.get(text[at], 0)
            at += 1
        if depth:
            raise FormatError(f"the bracket of {match[1]!r} is not closed in {excerpt(repr(text))}")
        arg = text[match.end() : at - 1]
        numbers = joint.findall(arg)
        if len(numbers) > 1:
            raise FormatError(f"{match[1]}({arg}) names {len(numbers)} joints; expected one at most")
        out.append(TrChainToken(match[1], arg, int(numbers[0]) if numbers else 0))
    _check_separator(text[at:], text)
    return tuple(out)


def _check_separator(between: str, text: str) -> None:
    """Raises FormatError where what stands between two transforms is more than spaces and signs that separate."""
    if not re.fullmatch(r"[\s*@,;.]*", between):
        raise FormatError(
            f"{excerpt(repr(between.strip()))} in {excerpt(repr(text))} is no transform; expected as in 'Rx(q1) Tz(2)'"
        )


def _value(text: str, names: Mapping[str, Any]) -> Any:
    """The value of an arithmetic expression, a number or a symbolic one; nothing else is evaluated."""
    quoted = excerpt(repr(text))
    try:
        value = _evaluate(ast.parse(text.strip(), mode="eval").body, names, text)
        if is_symbol(value) and value.free_symbols:
            return value
        value = float(value)
    except FormatError:  # which is a ValueError, too
        raise
    except (SyntaxError, RecursionError, MemoryError):  # too deep for Python's own parser
        raise FormatError(f"{quoted} is no arithmetic expression") from None
    except (ArithmeticError, TypeError, ValueError) as error:
        raise FormatError(f"{quoted} has no value: {error}") from None
    if not math.isfinite(value):
        raise FormatError(f"{quoted} is {value}; expected a finite number")
    return value


def _evaluate(node: ast.AST, names: Mapping[str, Any], text: str) -> Any:
    inner = partial(_evaluate, names=names, text=text)
    match node:
        case ast.Constant(value=int() | float() as number):
            return float(number)  # powers of integers may have any number of digits
        case ast.Name(id=name):
            if name not in names:
                raise UnknownOption("name in a chain", name, names)
            return names[name]
        case ast.BinOp(left=left, op=op, right=right) if type(op) in _OPERATORS:
            return _OPERATORS[type(op)](inner(left), inner(right))
        case ast.UnaryOp(op=op, operand=operand) if type(op) in _OPERATORS:
            return _OPERATORS[type(op)](inner(operand))
        case ast.Call(func=ast.Name(id=name), args=arguments, keywords=[]) if callable(names.get(name)):
            return names[name](*map(inner, arguments))
    raise FormatError(f"{excerpt(repr(text))} is no arithmetic expression of numbers, names and functions")
