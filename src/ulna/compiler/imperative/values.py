"""Reads names, numbers and operators of Python source into the typed tree."""

from __future__ import annotations

import ast
from collections.abc import Callable, Sequence
from typing import Any, NoReturn

import numpy as np

from ulna.compiler.imperative import tree as t
from ulna.compiler.imperative.conversions import Mismatch, literal, operate
from ulna.compiler.imperative.source import Definition, Source
from ulna.compiler.imperative.types import (
    BOOL,
    INT,
    NUMBERS,
    Lanes,
    Number,
    RecordType,
    Type,
    element_of,
)  # fmt: skip

MOST_LANES = 64
"""Lanes that one value may have."""

BINARY: dict[type, str] = {
    ast.Add: "add", ast.Sub: "sub", ast.Mult: "mul", ast.Div: "div", ast.FloorDiv: "floordiv", ast.Mod: "mod",
    ast.LShift: "shl", ast.RShift: "shr", ast.BitAnd: "and", ast.BitOr: "or", ast.BitXor: "xor",
}  # fmt: skip
_COMPARE: dict[type, str] = {
    ast.Lt: "lt", ast.LtE: "le", ast.Gt: "gt", ast.GtE: "ge", ast.Eq: "eq", ast.NotEq: "ne",
}  # fmt: skip


class Scope:
    """What names mean while a procedure is read.

    Attributes:
        source: The source.
        constants: Parameters that are constants of this instance.
        types: Parameters and variables so far, with their types.
        assigned: Variables that have a value wherever the reader is.
        instance_of: Makes the instance of another procedure for the arguments of a call.
        names: All that are assigned to somewhere in the procedure, and its parameters.
        outside: What names of modules stood for, by module and dotted name.

    Args:
        source: The source.
        constants: Parameters that are constants of this instance.
        types: The other parameters, with their types.
        instance_of: Makes the instance of another procedure for the arguments of a call.
        names: All that are assigned to somewhere in the procedure, and its parameters.
        outside: Where what names of modules stand for is put down, by module and dotted name.
    """

    def __init__(
        self,
        source: Source,
        constants: dict[str, t.Constant],
        types: dict[str, Type],
        instance_of: Callable[[Definition, Sequence[t.Expression]], t.Instance],
        names: frozenset[str],
        outside: dict[tuple[str, str], Any],
    ) -> None:
        self.source, self.constants, self.types = source, constants, types
        self.assigned = set(types)
        self.instance_of, self.names, self.outside = instance_of, names, outside


class ValueReader:
    """Reads expressions in a scope: those without arrays and calls."""

    def __init__(self, scope: Scope) -> None:
        self.scope = scope

    def fail(self, node: ast.AST, text: str, fix: str = "") -> NoReturn:
        """Refuses a node.

        Args:
            node: The node.
            text: What is wrong.
            fix: What to write instead.
        """
        self.scope.source.fail(getattr(node, "lineno", 0), text, fix)

    def read(self, node: ast.expr) -> t.Expression:
        """The expression that a node stands for.

        Raises:
            ProcedureError: If it cannot be compiled; the message shows its line.
        """
        reader = getattr(self, f"_{type(node).__name__.lower()}", None)
        if reader is None:
            self.fail(node, f"{type(node).__name__} expressions cannot be compiled")
        try:
            return reader(node)
        except Mismatch as error:
            self.fail(node, error.text, error.fix)

    def condition(self, node: ast.expr) -> t.Expression:
        """The value of a condition, a bool."""
        value = self.read(node)
        if value.type != BOOL:
            fix = "Reduce the mask: any_of(...) or all_of(...)." if isinstance(value.type, Lanes) else ""
            self.fail(node, f"a condition must be a bool, not {value.type}", fix or "Compare it: x != 0.")
        return value

    def integer(self, node: ast.expr, what: str) -> t.Expression:
        """A single integer.

        Args:
            node: The expression.
            what: What it is for, in the message.

        Returns:
            The value.

        Raises:
            ProcedureError: If it is no integer.
        """
        value = self.read(node)
        if value.type != INT:
            self.fail(node, f"{what} must be an integer, not {value.type}", "Convert it: int(x).")
        return value

    def constant(self, node: ast.expr, what: str) -> int:
        """An integer known when the code is compiled.

        Args:
            node: The expression.
            what: What it is for, in the message.

        Returns:
            The integer.

        Raises:
            ProcedureError: If it is not constant.
        """
        value = self.read(node)
        if value.type != INT:
            self.fail(node, f"{what} must be an integer constant, not {value.type}")
        if not isinstance(value, t.Constant):
            self.fail(node, f"{what} must be an integer constant; this is a variable")
        return int(value.value)

    def object_named(self, node: ast.expr) -> Any:
        """The Python object that a name or a dotted name stands for outside of the procedure; None where none."""
        value = self._object(node)
        if value is not None:
            self.scope.outside[self.scope.source.function.__module__, ast.unparse(node)] = value
        return value

    def _object(self, node: ast.expr) -> Any:
        if isinstance(node, ast.Name) and node.id not in self.scope.names:
            try:
                return self.scope.source.value_of(node.id)
            except (KeyError, ValueError):
                return None
        if isinstance(node, ast.Attribute):
            owner = self._object(node.value)
            return getattr(owner, node.attr, None) if owner is not None else None
        return None

    # leaves ---------------------------------------------------------------------------------------------

    def _constant(self, node: ast.Constant) -> t.Expression:
        if not isinstance(node.value, bool | int | float):
            self.fail(node, f"a {type(node.value).__name__} cannot be compiled")
        return literal(node.value, node.lineno)

    def _name(self, node: ast.Name) -> t.Expression:
        scope = self.scope
        if node.id in scope.constants:
            return scope.constants[node.id]
        if node.id in scope.types:
            if node.id not in scope.assigned:
                self.fail(
                    node, f"`{node.id}` may have no value here", "Assign to it before the branch or loop."
                )
            return t.Local(node.id, scope.types[node.id], node.lineno)
        if node.id in scope.names:
            self.fail(node, f"`{node.id}` has no value yet")
        return self._outside(node, node.id)

    def _outside(self, node: ast.expr, name: str) -> t.Expression:
        value = self.object_named(node)
        if isinstance(value, bool | int | float) and not isinstance(value, np.generic):
            return literal(value, node.lineno)
        if isinstance(value, np.generic) and type(value) in NUMBERS:
            return t.Constant(value.item(), NUMBERS[type(value)], node.lineno, is_literal=False)
        if value is None:
            self.fail(node, f"`{name}` is not defined, or is None")
        self.fail(
            node,
            f"`{name}` is a {type(value).__name__}; a procedure can use only numbers, procedures and functions of the "
            "language from outside",
            "Pass it as a parameter.",
        )

    def _attribute(self, node: ast.Attribute) -> t.Expression:
        if self.object_named(node) is not None:
            return self._outside(node, ast.unparse(node))
        owner = self.read(node.value)
        if isinstance(owner.type, RecordType):
            fields = dict(owner.type.fields)
            if node.attr not in fields:
                self.fail(node, f"{owner.type} has no field `{node.attr}`; it has {', '.join(fields)}")
            return t.Field(owner, node.attr, fields[node.attr], node.lineno)
        self.fail(
            node, f"{owner.type} has no attribute `{node.attr}`", "Arrays have `shape[k]` and `len(a)`."
        )

    # operators ------------------------------------------------------------------------------------------

    def _binop(self, node: ast.BinOp) -> t.Expression:
        if isinstance(node.op, ast.Pow):
            exponent = node.right.value if isinstance(node.right, ast.Constant) else None
            if not isinstance(exponent, int | float) or exponent != 2:
                self.fail(node, "powers other than ** 2 cannot be compiled", "Multiply, or use exp and log.")
            if any(isinstance(part, ast.Call) for part in ast.walk(node.left)):
                self.fail(node, "the square of a call would run it twice", "Assign it first.")
            base = self.read(node.left)
            if isinstance(exponent, float) and element_of(base.type) == INT:
                base = operate("mul", (base, literal(1.0, node.lineno)), node.lineno)
            return operate("mul", (base, base), node.lineno)
        if type(node.op) not in BINARY:
            self.fail(node, f"the operator {type(node.op).__name__} cannot be compiled")
        return operate(BINARY[type(node.op)], (self.read(node.left), self.read(node.right)), node.lineno)

    def _unaryop(self, node: ast.UnaryOp) -> t.Expression:
        value = self.read(node.operand)
        if isinstance(node.op, ast.UAdd):
            return value
        if isinstance(node.op, ast.USub):
            return operate("neg", (value,), node.lineno)
        if isinstance(node.op, ast.Not):
            value = self.condition(node.operand)
            if isinstance(value, t.Constant):
                return literal(not value.value, node.lineno)
        return operate("not", (value,), node.lineno)

    def _boolop(self, node: ast.BoolOp) -> t.Expression:
        conditions = [self.condition(value) for value in node.values]
        return _short_circuit(conditions, isinstance(node.op, ast.And), node.lineno)

    def _compare(self, node: ast.Compare) -> t.Expression:
        values = [self.read(v) for v in (node.left, *node.comparators)]
        if any(isinstance(part, ast.Call) for middle in node.comparators[:-1] for part in ast.walk(middle)):
            self.fail(
                node, "a call in the middle of a chained comparison would run twice", "Assign it first."
            )
        results = []
        for k, op in enumerate(node.ops):
            if type(op) not in _COMPARE:
                self.fail(node, f"the comparison {type(op).__name__} cannot be compiled")
            results.append(operate(_COMPARE[type(op)], values[k : k + 2], node.lineno))
        if all(result.type == BOOL for result in results):
            return _short_circuit(results, True, node.lineno)
        result = results[0]
        for other in results[1:]:  # a mask has the results of all comparisons
            result = operate("and", (result, other), node.lineno)
        return result

    def _ifexp(self, node: ast.IfExp) -> t.Expression:
        condition = self.condition(node.test)
        if isinstance(condition, t.Constant):
            return self.read(node.body if condition.value else node.orelse)
        chosen = operate("where", (condition, self.read(node.body), self.read(node.orelse)), node.lineno)
        assert isinstance(chosen, t.Operation)
        assert isinstance(chosen.type, Number | Lanes)
        _, if_true, if_false = chosen.arguments
        return t.Choice(condition, if_true, if_false, chosen.type, node.lineno)


def _short_circuit(conditions: Sequence[t.Expression], is_and: bool, line: int) -> t.Expression:
    """`and` or `or` of conditions: those after the one that decides are not evaluated."""
    *others, last = conditions
    for value in reversed(others):
        if isinstance(value, t.Constant):
            last = last if bool(value.value) == is_and else value
            continue
        short = literal(not is_and, line)
        if_true, if_false = (last, short) if is_and else (short, last)
        last = t.Choice(value, if_true, if_false, BOOL, line)
    return last
