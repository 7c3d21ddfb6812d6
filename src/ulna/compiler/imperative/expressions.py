"""Reads expressions of Python source into the typed tree."""

from __future__ import annotations

import ast
import math
from collections.abc import Callable
from typing import Any

from ulna.compiler.imperative import tree as t
from ulna.compiler.imperative.conversions import converted, converted_explicitly, literal, operate
from ulna.compiler.imperative.indexing import IndexReader
from ulna.compiler.imperative.operations import FUNCTIONS, broadcast, lane_numbers
from ulna.compiler.imperative.source import Definition
from ulna.compiler.imperative.types import (
    BOOL,
    INT,
    NUMBERS,
    ArrayType,
    Lanes,
    Number,
    element_of,
)  # fmt: skip
from ulna.compiler.imperative.values import MOST_LANES


class ExpressionReader(IndexReader):
    """Reads expressions in a scope."""

    def _call(self, node: ast.Call) -> t.Expression:
        function = self.object_named(node.func)
        if isinstance(function, Definition):
            instance, arguments = self.procedure_call(node, function)
            if len(instance.results) != 1:
                self.fail(node, f"{function.__name__} returns {len(instance.results)} values, not one")
            return t.Call(instance, arguments, instance.results[0], node.lineno)
        if node.keywords:
            self.fail(node, "keyword arguments cannot be compiled here", "Pass them by position.")
        special = _SPECIAL.get(function) if _is_hashable(function) else None
        if special is not None:
            reader, least, most = special
            if not least <= len(node.args) <= most:
                counts = f"{least}" if least == most else f"{least} or {most}"
                self.fail(
                    node,
                    f"{ast.unparse(node.func)}(...) takes {counts} argument{'s' * (most > 1)}, not {len(node.args)}",
                )
            return reader(self, node)
        if _is_hashable(function) and function in NUMBERS:
            if len(node.args) != 1:
                self.fail(node, f"{ast.unparse(node.func)}(...) takes one argument")
            return converted_explicitly(self.read(node.args[0]), NUMBERS[function], node.lineno)
        if not _is_hashable(function) or function not in FUNCTIONS:
            known = sorted({f.__name__ for f in (*FUNCTIONS, *_SPECIAL)})
            self.fail(
                node, f"`{ast.unparse(node.func)}` is not in the language", f"It has {', '.join(known)}."
            )
        return self._operation(FUNCTIONS[function], [self.read(a) for a in node.args], node.lineno)

    def _operation(self, name: str, values: list[t.Expression], line: int) -> t.Expression:
        if name in ("minimum", "maximum") and len(values) > 2:  # min(a, b, c)
            return operate(name, (self._operation(name, values[:-1], line), values[-1]), line)
        return operate(name, values, line)

    def procedure_call(
        self, node: ast.Call, definition: Definition
    ) -> tuple[t.Instance, tuple[t.Expression, ...]]:
        """The instance that a call refers to, and its arguments in the types of the instance's parameters.

        Args:
            node: The call.
            definition: The procedure.

        Returns:
            The instance, and an argument for each of its parameters.

        Raises:
            ProcedureError: If arguments are missing, too many, or of other types.
        """
        arguments_in_order = self._arguments_in_order(node, definition)
        instance = self.scope.instance_of(definition, arguments_in_order)
        names = dict(zip(definition.parameters, arguments_in_order, strict=True))
        arguments = []
        for name, kind in instance.parameters:
            value = converted(names[name], kind)
            if value is None:
                self.fail(node, f"`{name}` of {definition.__name__} takes {kind}, not {names[name].type}")
            arguments.append(value)
        return instance, tuple(arguments)

    def _arguments_in_order(self, node: ast.Call, definition: Definition) -> list[t.Expression]:
        """The arguments in the order of the parameters, those passed by name included."""
        values = {k: self.read(a) for k, a in zip(definition.parameters, node.args, strict=False)}
        for keyword in node.keywords:
            if keyword.arg is None:
                self.fail(node, "**arguments cannot be compiled", "Pass them one by one.")
            if keyword.arg not in definition.parameters:
                names = ", ".join(definition.parameters)
                self.fail(node, f"{definition.__name__} has no parameter `{keyword.arg}`", f"It has {names}.")
            if keyword.arg in values:
                self.fail(node, f"`{keyword.arg}` is passed twice to {definition.__name__}")
            values[keyword.arg] = self.read(keyword.value)
        missing = [name for name in definition.parameters if name not in values]
        if missing or len(node.args) > len(definition.parameters):
            count = len(node.args) + len(node.keywords)
            self.fail(
                node, f"{definition.__name__} takes {len(definition.parameters)} arguments "
                f"({', '.join(definition.parameters)}), not {count}",
            )  # fmt: skip
        return [values[name] for name in definition.parameters]

    def _len(self, node: ast.Call) -> t.Expression:
        array = self.read(node.args[0])
        if not isinstance(array.type, ArrayType):
            self.fail(node, f"len(...) takes an array, not {array.type}")
        return self._extent(node, array, 0)

    def _floor(self, node: ast.Call) -> t.Expression:
        value = operate("floor", [self.read(a) for a in node.args], node.lineno)
        return converted_explicitly(value, INT, node.lineno)

    def _broadcast(self, node: ast.Call) -> t.Expression:
        value, count = self.read(node.args[0]), self._lane_count(node, node.args[1])
        element = element_of(value.type)
        if not isinstance(value.type, Number) or element is None:
            self.fail(node, f"broadcast takes a number, not {value.type}")
        if count == 1:
            return value
        return t.Broadcast(value, Lanes(element, count), node.lineno)

    def _lane_numbers(self, node: ast.Call) -> t.Expression:
        count = self._lane_count(node, node.args[0])
        element = NUMBERS.get(self.object_named(node.args[1])) if len(node.args) > 1 else INT
        if element is None or element == BOOL:
            self.fail(node, "lane_numbers takes int, f32 or f64 as its second argument")
        if count == 1:
            return converted_explicitly(literal(0, node.lineno), element, node.lineno)
        return t.Operation("lane_numbers", (), Lanes(element, count), node.lineno)

    def _lane_count(self, node: ast.Call, argument: ast.expr) -> int:
        """A constant number of lanes."""
        count = self.constant(argument, "a number of lanes")
        if not 1 <= count <= MOST_LANES or count & (count - 1):
            self.fail(node, f"a number of lanes must be a power of two from 1 to {MOST_LANES}, not {count}")
        return count


_SPECIAL: dict[Any, tuple[Callable[[ExpressionReader, ast.Call], t.Expression], int, int]] = {
    len: (ExpressionReader._len, 1, 1),
    math.floor: (ExpressionReader._floor, 1, 1),
    broadcast: (ExpressionReader._broadcast, 2, 2),
    lane_numbers: (ExpressionReader._lane_numbers, 1, 2),
}
"""What calls other than operations are read by, with the least and the most arguments."""


def _is_hashable(value: Any) -> bool:
    """Whether a value can be looked up in the tables of functions; None is not."""
    return value is not None and value.__hash__ is not None
