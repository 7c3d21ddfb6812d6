"""The source of a procedure: its syntax tree, the names it refers to, and errors that show its lines."""

from __future__ import annotations

import ast
import builtins
import inspect
import textwrap
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, NoReturn

from ulna.errors import ProcedureError


class Definition:
    """A Python function that was made a procedure.

    Attributes:
        function: The function.
        parameters: The names of its parameters.
    """

    def __init__(self, function: Callable[..., Any]) -> None:
        self.function = function
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
    """

    function: Callable[..., Any]
    tree: ast.FunctionDef
    file: str
    lines: tuple[str, ...]
    first: int

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
        lines, first = inspect.getsourcelines(function)
        file = inspect.getsourcefile(function) or "<unknown>"
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
    return Source(function, node, file, tuple(line.rstrip("\n") for line in lines), first)
