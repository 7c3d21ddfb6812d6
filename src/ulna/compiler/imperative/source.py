"""The source of a procedure: its syntax tree, the names it refers to, and errors that show its lines."""

from __future__ import annotations

import ast
import builtins
import inspect
import linecache
import textwrap
from collections.abc import Callable, Mapping
from functools import lru_cache
from typing import Any, NoReturn

from ulna.data_classes import dataclass
from ulna.errors import ProcedureError


class Definition:
    """A Python function that was made a procedure.

    Args:
        function: The function.
        contract: Whether its products and sums may be fused, wherever it is called.
        constants: Values of parameters that are compiled in.

    Attributes:
        function: The function.
        contract: The same.
        constants: The same; a procedure that calls this one gives its own values, compiled in where they are constants.
        parameters: The names of its parameters.
    """

    def __init__(
        self,
        function: Callable[..., Any],
        contract: bool = False,
        constants: Mapping[str, bool | int | float] | None = None,
    ) -> None:
        self.function, self.contract, self.constants = function, contract, dict(constants or {})
        self.parameters = tuple(inspect.signature(function).parameters)
        self.__name__ = getattr(function, "__name__", "procedure")


@dataclass(frozen=True)
class Source:
    """The source of a Python function.

    Attributes:
        function: The function.
        tree: Its definition; line numbers are those of the file.
        file: The file.
        lines: The lines of the definition.
        first: The number of the first one.
        stored: The names that it assigns to.
    """

    function: Callable[..., Any]
    tree: ast.FunctionDef
    file: str
    lines: tuple[str, ...]
    first: int
    stored: frozenset[str]

    def fail(self, line: int, text: str, fix: str = "") -> NoReturn:
        """Refuses what stands in a line.

        Args:
            line: Its number in the file.
            text: What is wrong.
            fix: What to write instead.

        Raises:
            ProcedureError: Always.
        """
        index = line - self.first
        code = self.lines[index].strip() if 0 <= index < len(self.lines) else ""
        raise ProcedureError(self.function.__name__, self.file, line, code, text, fix)

    def value_of(self, name: str) -> Any:
        """What a name stands for outside of the function.

        Args:
            name: The name.

        Returns:
            The object, from the function's closure, its module, or Python's own names.

        Raises:
            KeyError: If there is none.
        """
        code, cells = self.function.__code__, self.function.__closure__ or ()
        closure = dict(zip(code.co_freevars, cells, strict=True))
        if name in closure:
            return closure[name].cell_contents
        if name in self.function.__globals__:
            return self.function.__globals__[name]
        return vars(builtins)[name]


@lru_cache(maxsize=1024)
def source_of(function: Callable[..., Any]) -> Source:
    """The source of a Python function.

    Raises:
        ProcedureError: If it cannot be read, or is no plain function with `def`.
    """
    name = getattr(function, "__name__", repr(function))
    try:
        file = inspect.getsourcefile(function) or "<unknown>"
        node = _in_file(file, function)
        if node is not None:
            return _source(function, node, file, linecache.getlines(file))
        lines, first = inspect.getsourcelines(function)
    except (OSError, TypeError):
        raise ProcedureError(
            name,
            "<unknown>",
            0,
            "",
            "its source cannot be read",
            "Define it in a file or in a notebook's cell.",
        ) from None
    try:
        node = ast.parse(textwrap.dedent("".join(lines))).body[0]
    except SyntaxError:
        node = None
    if not isinstance(node, ast.FunctionDef):
        raise ProcedureError(name, file, first, "", "a procedure is a function made with `def`")
    ast.increment_lineno(node, first - 1)
    return Source(function, node, file, tuple(line.rstrip("\n") for line in lines), first, _stored(function))


def _in_file(file: str, function: Any) -> ast.FunctionDef | None:
    """The definition of a function in its file, which is parsed once for all; None where it is not found there."""
    code = getattr(function, "__code__", None)
    lines = linecache.getlines(file)
    if code is None or not lines:
        return None
    node = _definitions("".join(lines)).get(code.co_firstlineno)
    return node if node is not None and node.name == code.co_name else None


@lru_cache(maxsize=16)
def _definitions(text: str) -> dict[int, ast.FunctionDef]:
    """The functions of a file, by the number of their first line, decorators included."""
    try:
        tree = ast.parse(text)
    except SyntaxError:
        return {}
    by_line, waiting = {}, list[Any](tree.body)
    while waiting:
        node = waiting.pop()
        waiting += (
            [*getattr(node, "body", ()), *getattr(node, "orelse", ())] if isinstance(node, ast.stmt) else ()
        )
        if isinstance(node, ast.FunctionDef):
            by_line[min([node.lineno, *(d.lineno for d in node.decorator_list)])] = node
    return by_line


def _source(function: Callable[..., Any], node: ast.FunctionDef, file: str, lines: list[str]) -> Source:
    first = function.__code__.co_firstlineno
    text = textwrap.dedent("".join(lines[first - 1 : node.end_lineno])).splitlines()
    return Source(function, node, file, tuple(text), first, _stored(function))


def _stored(function: Any) -> frozenset[str]:
    """The names that a function assigns to, and its parameters."""
    return frozenset((*function.__code__.co_varnames, *function.__code__.co_cellvars))
