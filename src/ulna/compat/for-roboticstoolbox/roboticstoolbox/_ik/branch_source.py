"""Source code of the closed form of an arm, in Python, C or C++, without any library.

The function of one branch is the graph that the kernel of `ulna.ik.branch_kernel` is compiled from, a line for each
operation; the function that is asked for calls it for each branch and keeps what reaches the pose.
"""

from __future__ import annotations

import builtins
import keyword
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, final

import numpy as np

from roboticstoolbox._common.errors import UnknownOption
from roboticstoolbox._ik import branch_templates as templates
from ulna.compiler import compile
from ulna.compiler.language.function import Function
from ulna.compiler.language.interpreter import evaluate
from ulna.compiler.language.ops import TABLE, Op
from ulna.errors import InputError
from ulna.ik.analytic.candidates import ClosedForm
from ulna.ik.analytic.geometry import EXACT

_FIELD = re.compile("@([a-z]+)@")
_WORD = re.compile(r"(?<![@\w])[A-Za-z_]\w*")
_RESERVED_WORDS = """
auto bool case catch char class const constexpr delete double enum extern false float friend goto inline int long main
namespace new null operator private protected public register short signed sizeof static struct switch template this
throw true typedef typename union unsigned using virtual void volatile sin cos tan asin acos atan2 sqrt floor fmod fabs
log exp pow hypot
"""

_COMMON = {
    Op.NEG: "-({0})", Op.ADD: "{0} + {1}", Op.SUB: "{0} - ({1})", Op.MUL: "{0} * {1}",
    Op.LT: "{0} < {1}", Op.LE: "{0} <= {1}", Op.EQ: "{0} == {1}",
}  # fmt: skip
_NAMED = (
    Op.SQRT, Op.SIN, Op.COS, Op.TAN, Op.ASIN, Op.ACOS, Op.EXP, Op.LOG, Op.FLOOR, Op.ATAN2, Op.MIN, Op.MAX,
)  # fmt: skip


@final
@dataclass(frozen=True)
class _Language:
    """How a language writes the lines of a branch, and what stands around them.

    Attributes:
        template: The whole source, with the fields that `_filled` knows.
        comment: What begins a line of the head.
        line: A line, of its type (double or int), name and expression.
        operations: Expressions of operations, where they are not those of all languages.
        result: The line that returns number `i` of the results.
        truth: How truth values are written.
        pose: Entry `i` of the pose.
        special: How infinite constants and nan are written.
    """

    template: str
    comment: str
    line: str
    operations: dict[Op, str]
    result: str
    truth: tuple[str, str]
    pose: Callable[[int], str]
    special: dict[str, str]


_PYTHON = _Language(
    templates.PYTHON,
    "# ",
    "    {name} = {value}",
    {
        **_COMMON, Op.DIV: "_divided({0}, {1})", Op.ABS: "abs({0})", Op.AND: "{0} and {1}", Op.OR: "{0} or {1}",
        Op.NOT: "not {0}", Op.SELECT: "{1} if {0} else {2}",
        **{op: f"_{op.name.lower()}({{0}}{', {1}' if op in (Op.ATAN2, Op.MIN, Op.MAX) else ''})" for op in _NAMED},
    },
    "{value},",
    ("False", "True"),
    lambda i: f"T[{i // 4}][{i % 4}]",
    {"inf": "math.inf", "-inf": "-math.inf", "nan": "math.nan"},
)  # fmt: skip
_C = _Language(
    templates.C,
    " * ",
    "    const {type} {name} = {value};",
    {
        **_COMMON, Op.DIV: "{0} / {1}", Op.ABS: "fabs({0})", Op.AND: "{0} && {1}", Op.OR: "{0} || {1}", Op.NOT: "!{0}",
        Op.SELECT: "{0} ? {1} : {2}",
        **{op: f"{op.name.lower()}({{0}}{', {1}' if op is Op.ATAN2 else ''})" for op in _NAMED},
        Op.MIN: "{0} < {1} ? {0} : {1}", Op.MAX: "{0} > {1} ? {0} : {1}",
    },
    "out[{i}] = {value};",
    ("0", "1"),
    lambda i: f"T[{i}]",
    {"inf": "INFINITY", "-inf": "-INFINITY", "nan": "NAN"},
)  # fmt: skip
_LANGUAGES = {
    "python": _PYTHON,
    "c": _C,
    "c++": _Language(templates.CPP, " * ", _C.line, _C.operations, _C.result, _C.truth, _C.pose, _C.special),
}


def closed_form_source(robot: Any, language: str, name: str) -> str:
    """The source of a function from a pose to all configurations that reach it.

    Args:
        robot: The robot.
        language: "python", "c" or "c++".
        name: Name of the function.

    Returns:
        The source.

    Raises:
        UnknownOption: Another language.
        InputError: `name` is no name, or the arm has no closed form.
    """
    if language not in _LANGUAGES:
        raise UnknownOption("language", language, _LANGUAGES)
    _check_name(name)
    kernel = robot._chain(None, None).unlimited.arm.branch_kernel()
    source: ClosedForm = kernel._source
    if source.geometry.deviation > EXACT or source.free is not None:
        raise InputError(f"{robot.name!r} has no exact closed form: {source.method}. Use `solve`.")
    written = _LANGUAGES[language]
    fields = {
        "name": name,
        "head": "\n".join(f"{written.comment}{line}".rstrip() for line in _head(robot, source.method)),
        "count": str(len(source.numbers)),
        "joints": str(robot.n),
        "numbers": str(source.numbers.shape[1]),
        "branches": _rows(source.numbers, "python" if language == "python" else "c"),
        "turns": _rows(
            np.array([robot.revolutejoints], dtype=int), "python" if language == "python" else "c"
        )[1:-1],
        "body": "\n".join(_lines(_branch(source, robot.n), written)),
    }
    return _filled(written.template, fields)


def _check_name(name: str) -> None:
    """Refuses names that the source itself uses, in any of the languages, and words of the languages."""
    templates_of_all = (language.template for language in _LANGUAGES.values())
    used = {word for template in templates_of_all for word in _WORD.findall(template)}.union(
        _RESERVED_WORDS.split()
    )
    is_word = keyword.iskeyword(name) or hasattr(builtins, name)
    if not (name.isascii() and name.isidentifier()) or name in used or is_word:
        raise InputError(
            f"`name` is {name!r}; expected letters, digits and _, no word of Python, C or C++, and none that the "
            "source itself uses, such as 'ikine'."
        )


def _filled(template: str, fields: dict[str, str]) -> str:
    """The template with its fields, all at once: what a field holds is not searched for others."""
    return _FIELD.sub(lambda match: fields[match[1]], template)


def _head(robot: Any, method: str) -> Iterator[str]:
    """The lines of the comment at the top; names come from files of others, and nothing in them may end it."""
    title = f"Inverse kinematics of {robot.name}, generated by Ulna: {method}."
    notes = "Angles in rad, lengths in m; limits of joints are not used."
    for line in (*title.splitlines(), notes, *str(robot).splitlines()):
        yield line.replace("*/", "* /")


def _rows(values: Any, language: str) -> str:
    text = repr(np.asarray(values).tolist())
    return text if language == "python" else text.replace("[", "{").replace("]", "}")


def _branch(source: ClosedForm, n: int) -> Function:
    """The function of a pose and of the numbers of a branch to q, distance and angle."""
    base, free_value, zeros = source.base(np.zeros(n)), np.zeros(1), np.zeros(n)

    def branch(T: Any, numbers: Any) -> Any:
        return source.kernel.function(T, base, free_value, numbers, zeros, zeros)

    return compile(branch, T=(4, 4), numbers=(source.numbers.shape[1],)).function


def _lines(function: Function, written: _Language) -> list[str]:
    """A line for each operation, and then the results; the last one is about limits, which are not used."""
    lines: list[str] = []

    def constant(value: Any) -> str:
        if isinstance(value, bool):
            return written.truth[value]
        return written.special.get(repr(float(value)), f"{float(value)!r}")

    def operation(op: int, arguments: Sequence[str]) -> str:
        name, kind = f"x{len(lines)}", "int" if TABLE[op].is_condition else "double"
        value = _expression(Op(op), arguments, written)
        lines.append(written.line.format(type=kind, name=name, value=value))
        return name

    def reject(*_: Any) -> Any:
        raise InputError("The closed form has a loop, which source code is not written for.")

    inputs = [*map(written.pose, range(16)), *(f"branch[{k}]" for k in range(function.inputs[1].size))]
    values = evaluate(
        function.graph,
        inputs,
        function.results[:-1],
        operation=operation,
        loop=reject,
        lane=reject,
        constant=constant,
    )
    return [*lines, *_results(values, written)]


def _expression(op: Op, arguments: Sequence[str], written: _Language) -> str:
    if op not in written.operations:
        raise InputError(f"The closed form has an operation {op.name} that source code is not written for.")
    return written.operations[op].format(*arguments)


def _results(values: Sequence[str], written: _Language) -> Iterator[str]:
    if written is _PYTHON:
        yield f"    return [{', '.join(values)}]"
        return
    yield from (f"    {written.result.format(i=i, value=value)}" for i, value in enumerate(values))
