"""Reads assignments, and the storage that a procedure makes, into the typed tree."""

from __future__ import annotations

import ast
from typing import Any

import numpy as np

from ulna.compiler.imperative import tree as t
from ulna.compiler.imperative.conversions import converted, operate
from ulna.compiler.imperative.effects import parts
from ulna.compiler.imperative.expressions import ExpressionReader
from ulna.compiler.imperative.source import Definition
from ulna.compiler.imperative.types import (
    NUMBERS,
    ArrayType,
    element_of,
)  # fmt: skip
from ulna.compiler.imperative.values import BINARY, Scope

LARGEST_LOCAL = 1 << 18
"""Bytes that the arrays of one procedure may take together; they lie on the stack."""


class AssignmentReader(ExpressionReader):
    """Reads the assignments of one procedure."""

    def __init__(self, scope: Scope) -> None:
        super().__init__(scope)
        self._loops = 0  # how many loops are around
        self._bytes = 0  # that arrays made so far take

    def _assign(self, node: ast.Assign) -> tuple[tuple[t.Statement, ...], bool]:
        if len(node.targets) != 1:
            self.fail(node, "a = b = value cannot be compiled", "Write two assignments.")
        (target,) = node.targets
        if isinstance(target, ast.Tuple):
            return self._unpack(node, target), False
        if isinstance(target, ast.Name) and isinstance(node.value, ast.Call):
            function = self.object_named(node.value.func)
            if function in (np.empty, np.zeros):
                return (self._new_array(node, target.id, node.value, function is np.zeros),), False
        return (self._store(node, target, self.read(node.value)),), False

    def _annassign(self, node: ast.AnnAssign) -> tuple[tuple[t.Statement, ...], bool]:
        kind = NUMBERS.get(self.object_named(node.annotation))
        if node.value is None or kind is None or not isinstance(node.target, ast.Name):
            self.fail(node, "an annotated assignment is `name: int = value`, or with bool, float, f32, f64")
        value = converted(self.read(node.value), kind)
        if value is None:
            self.fail(node, f"`{node.target.id}` is {kind}", f"Convert the value: {kind}(...).")
        return (self._store(node, node.target, value),), False

    def _augassign(self, node: ast.AugAssign) -> tuple[tuple[t.Statement, ...], bool]:
        if type(node.op) not in BINARY:
            self.fail(node, f"the operator {type(node.op).__name__} cannot be compiled")
        before = self.read(ast.copy_location(_as_load(node.target), node))
        after = self.read(node.value)
        if _has(before, t.Call):
            self.fail(
                node, "a call in the target of an augmented assignment would run twice",
                "Assign the index to a variable first.",
            )  # fmt: skip
        if _has(after, t.Call) and any(_has(part, t.Element | t.Slice) for part in parts(before)):
            self.fail(
                node, "the call may change the array in which the index of the target lies",
                "Assign the index to a variable first.",
            )  # fmt: skip
        value = operate(BINARY[type(node.op)], (before, after), node.lineno)
        return (self._store(node, node.target, value),), False

    def _store(self, node: ast.stmt, target: ast.expr, value: t.Expression) -> t.Statement:
        if isinstance(target, ast.Name):
            return t.Assign(target.id, self._variable(node, target.id, value), node.lineno)
        if isinstance(target, ast.Subscript):
            place = self.read(_as_load(target))
            if not isinstance(place, t.Element | t.Slice):
                self.fail(node, f"{place.type} cannot be assigned to", "Assign its elements in a loop.")
            same = converted(value, place.type)
            if same is None:
                self.fail(node, f"the place holds {place.type}, not {value.type}", "Convert: f32(x), int(x).")
            return t.Store(place, same, node.lineno)
        self.fail(node, f"{ast.unparse(target)} cannot be assigned to")

    def _variable(self, node: ast.stmt, name: str, value: t.Expression) -> t.Expression:
        """Assigns a value to a variable; the first one decides its type."""
        scope = self.scope
        if name in scope.constants:
            self.fail(node, f"`{name}` is a constant here", "Use another name.")
        kind = scope.types.get(name)
        if kind is None:
            if element_of(value.type) is None:
                self.fail(
                    node,
                    f"a variable holds numbers or lanes, not {value.type}",
                    "Pass the array to a procedure.",
                )
            scope.types[name] = kind = value.type
        same = converted(value, kind)
        if same is None:
            self.fail(
                node, f"`{name}` holds {kind} since its first assignment, not {value.type}",
                "Convert the value, or use another name.",
            )  # fmt: skip
        scope.assigned.add(name)
        return same

    def _unpack(self, node: ast.Assign, target: ast.Tuple) -> tuple[t.Statement, ...]:
        names = [e.id for e in target.elts if isinstance(e, ast.Name)]
        if len(names) != len(target.elts):
            self.fail(node, "several values are assigned to names only")
        if isinstance(node.value, ast.Call):
            function = self.object_named(node.value.func)
            if isinstance(function, Definition):
                return self._unpack_call(node, names, node.value, function)
        if not isinstance(node.value, ast.Tuple) or len(node.value.elts) != len(names):
            self.fail(node, f"{len(names)} values are expected on the right")
        # all values before all names: `a, b = b, a`
        read = [self.read(v) for v in node.value.elts]
        values = [self._variable(node, n, v) for n, v in zip(names, read, strict=True)]
        for name, value in zip(names, values, strict=True):
            self.scope.types[f"{name}.new"] = value.type
        first = (t.Assign(f"{n}.new", v, node.lineno) for n, v in zip(names, values, strict=True))
        second = (
            t.Assign(n, t.Local(f"{n}.new", v.type, node.lineno), node.lineno)
            for n, v in zip(names, values, strict=True)
        )
        return (*first, *second)

    def _unpack_call(
        self, node: ast.Assign, names: list[str], call: ast.Call, definition: Definition
    ) -> tuple[t.Statement, ...]:
        instance, arguments = self.procedure_call(call, definition)
        if len(instance.results) != len(names):
            self.fail(node, f"{definition.__name__} returns {len(instance.results)} values, not {len(names)}")
        for name, kind in zip(names, instance.results, strict=True):
            if self.scope.types.get(name, kind) != kind or name in self.scope.constants:
                self.fail(node, f"`{name}` holds {self.scope.types.get(name)}, not {kind}")
            self.scope.types[name] = kind
            self.scope.assigned.add(name)
        return (t.CallStatement(instance, arguments, tuple(names), node.lineno),)

    def _new_array(self, node: ast.Assign, name: str, call: ast.Call, is_zero: bool) -> t.Statement:
        if len(call.args) != 2 or call.keywords:
            self.fail(node, "an array is made by np.empty(shape, element) or np.zeros(shape, element)")
        shape = call.args[0].elts if isinstance(call.args[0], ast.Tuple) else [call.args[0]]
        sizes = tuple(self.constant(s, "an axis of an array made here") for s in shape)
        element = NUMBERS.get(self.object_named(call.args[1]))
        if element is None or element.name == "bool":
            self.fail(node, "the elements of an array are f32, f64 or int")
        if name in self.scope.types or self._loops:
            self.fail(node, f"the array `{name}` is made once, outside of loops", "Make it at the beginning.")
        if not 1 <= len(sizes) <= 3 or min(sizes) < 1:
            self.fail(node, f"an array made here has one to three axes of at least one element, not {sizes}")
        self._bytes += int(np.prod(sizes, dtype=object)) * element.dtype.itemsize
        if self._bytes > LARGEST_LOCAL:
            self.fail(
                node, f"the arrays made here take {self._bytes:,} bytes of the stack; {LARGEST_LOCAL:,} is the limit",
                "Pass an array from Python.",
            )  # fmt: skip
        kind = ArrayType(element, len(sizes))
        self.scope.types[name] = kind
        self.scope.assigned.add(name)
        return t.NewArray(name, sizes, kind, is_zero, node.lineno)


def _has(e: t.Expression, kind: Any) -> bool:
    """Whether an expression of a kind is among the parts of an expression, or is the expression itself."""
    return isinstance(e, kind) or any(_has(part, kind) for part in parts(e))


def _as_load(target: ast.expr) -> ast.expr:
    """The expression that reads what an assignment writes."""
    copy = ast.parse(ast.unparse(target), mode="eval").body
    for part in ast.walk(copy):
        ast.copy_location(part, target)
    return copy
