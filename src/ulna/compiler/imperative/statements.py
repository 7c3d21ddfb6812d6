"""Reads the statements of a procedure into the typed tree."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from ulna.compiler.imperative import tree as t
from ulna.compiler.imperative.assignments import AssignmentReader
from ulna.compiler.imperative.conversions import Mismatch, converted, literal
from ulna.compiler.imperative.source import Definition, source_of
from ulna.compiler.imperative.types import (
    INT,
    ArrayType,
    KernelType,
    Lanes,
    Number,
    Type,
)  # fmt: skip
from ulna.compiler.imperative.values import Scope


class ProcedureReader(AssignmentReader):
    """Reads the statements of one instance.

    Args:
        definition: The procedure.
        types: The types of its parameters that are no constants.
        constants: Its parameters that are constants of this instance.
        instance_of: Makes the instance of another procedure for the arguments of a call.
        outside: Where what names of modules stand for is put down, by module and dotted name.
    """

    def __init__(
        self,
        definition: Definition,
        types: Mapping[str, Type],
        constants: Mapping[str, t.Constant],
        instance_of: Callable[[Definition, Sequence[t.Expression]], t.Instance],
        outside: dict[tuple[str, str], Any],
    ) -> None:
        source = source_of(definition.function)
        ordered = {name: types[name] for name in definition.parameters if name in types}
        everything = source.stored | {*definition.parameters}
        super().__init__(Scope(source, dict(constants), dict(ordered), instance_of, everything, outside))
        self._parameters = tuple(ordered.items())
        self._results: tuple[Number | Lanes, ...] | None = None
        self._contract = definition.contract

    def instance(self, name: str) -> t.Instance:
        """The instance, under a name."""
        source, scope = self.scope.source, self.scope
        body, ends = self.block(source.tree.body)
        if self._results and not ends:
            source.fail(source.tree.lineno, "not every path returns a value", "End with `return`.")
        locals_ = tuple((k, v) for k, v in scope.types.items() if k not in dict(self._parameters))
        written = {n for s in _statements(body) for n in _names_assigned(s)}
        variables = (*locals_, *((k, v) for k, v in self._parameters if k in written))
        results = self._results or ()
        return t.Instance(name, self._parameters, variables, results, body, source.file, self._contract)

    def block(self, nodes: Iterable[ast.stmt]) -> tuple[tuple[t.Statement, ...], bool]:
        """The statements, and whether control never falls through their end; unreachable ones are left out."""
        statements: list[t.Statement] = []
        for node in nodes:
            read, ends = self.statement(node)
            statements += read
            if ends:
                return tuple(statements), True
        return tuple(statements), False

    def statement(self, node: ast.stmt) -> tuple[tuple[t.Statement, ...], bool]:
        """What a statement becomes, and whether control never falls through it."""
        reader = getattr(self, f"_{type(node).__name__.lower()}", None)
        if reader is None:
            self.fail(node, f"`{type(node).__name__.lower()}` statements cannot be compiled")
        try:
            return reader(node)
        except Mismatch as error:
            self.fail(node, error.text, error.fix)

    def _pass(self, node: ast.Pass) -> tuple[tuple[t.Statement, ...], bool]:
        return (), False

    def _expr(self, node: ast.Expr) -> tuple[tuple[t.Statement, ...], bool]:
        if isinstance(node.value, ast.Constant) and isinstance(node.value.value, str):
            return (), False  # a docstring
        if not isinstance(node.value, ast.Call):
            self.fail(node, "an expression that is not used does nothing")
        function = self.object_named(node.value.func)
        if isinstance(function, Definition):
            instance, arguments = self.procedure_call(node.value, function)
            return (t.CallStatement(instance, arguments, (), node.lineno),), False
        if (isinstance(node.value.func, ast.Name) and node.value.func.id in self.scope.types) or (
            isinstance(node.value.func, ast.Attribute) and function is None
        ):
            kernel = self.read(node.value.func)
        else:
            self.fail(node, "the result of this call is not used")
        return (self._kernel_call(node, node.value, kernel),), False

    def _kernel_call(self, node: ast.Expr, call: ast.Call, kernel: t.Expression) -> t.Statement:
        if not isinstance(kernel.type, KernelType):
            self.fail(node, f"{kernel.type} cannot be called")
        arrays = tuple(self.read(a) for a in call.args)
        if len(arrays) != kernel.type.ports or not all(isinstance(a.type, ArrayType) for a in arrays):
            self.fail(node, f"a kernel takes {kernel.type.ports} arrays: its inputs and its outputs")
        return t.KernelCall(kernel, arrays, kernel.type, node.lineno)

    # control flow ---------------------------------------------------------------------------------------

    def _if(self, node: ast.If) -> tuple[tuple[t.Statement, ...], bool]:
        condition = self.condition(node.test)
        if isinstance(condition, t.Constant):
            return self.block(node.body if condition.value else node.orelse)
        before = set(self.scope.assigned)
        body, body_ends = self.block(node.body)
        after_body, self.scope.assigned = self.scope.assigned, set(before)
        otherwise, otherwise_ends = self.block(node.orelse)
        if body_ends:
            pass
        elif otherwise_ends:
            self.scope.assigned = after_body
        else:
            self.scope.assigned &= after_body
        return (t.If(condition, body, otherwise, node.lineno),), body_ends and otherwise_ends

    def _while(self, node: ast.While) -> tuple[tuple[t.Statement, ...], bool]:
        if node.orelse:
            self.fail(node, "`else` of a loop cannot be compiled")
        condition = self.condition(node.test)
        if isinstance(condition, t.Constant) and not condition.value:
            return (), False
        body, breaks = self._loop_body(node.body)
        endless = isinstance(condition, t.Constant) and not breaks
        return (t.While(condition, body, node.lineno),), endless

    def _for(self, node: ast.For) -> tuple[tuple[t.Statement, ...], bool]:
        call = node.iter
        if (
            node.orelse
            or not isinstance(node.target, ast.Name)
            or not isinstance(call, ast.Call)
            or self.object_named(call.func) is not range
            or not 1 <= len(call.args) <= 3
        ):
            self.fail(node, "a loop is `for name in range(...)`, without `else`")
        values = [self.integer(a, "a bound of range") for a in call.args]
        zero = literal(0, node.lineno)
        start, stop = (zero, values[0]) if len(values) == 1 else (values[0], values[1])
        step = values[2] if len(values) == 3 else literal(1, node.lineno)
        if not isinstance(step, t.Constant) or step.value == 0:
            self.fail(node, "the step of range is a constant other than 0")
        before = set(self.scope.assigned)
        self._variable(node, node.target.id, t.Local(node.target.id, INT, node.lineno))
        body, _ = self._loop_body(node.body)
        self.scope.assigned = before
        return (t.For(node.target.id, start, stop, int(step.value), body, node.lineno),), False

    def _loop_body(self, nodes: Sequence[ast.stmt]) -> tuple[tuple[t.Statement, ...], bool]:
        before = set(self.scope.assigned)
        self._loops += 1
        body, _ = self.block(nodes)
        self._loops -= 1
        self.scope.assigned = before
        return body, any(isinstance(s, t.Break) for s in _statements(body, into_loops=False))

    def _break(self, node: ast.Break) -> tuple[tuple[t.Statement, ...], bool]:
        return (t.Break(node.lineno),), True

    def _continue(self, node: ast.Continue) -> tuple[tuple[t.Statement, ...], bool]:
        return (t.Continue(node.lineno),), True

    def _return(self, node: ast.Return) -> tuple[tuple[t.Statement, ...], bool]:
        nodes = (
            []
            if node.value is None
            else node.value.elts
            if isinstance(node.value, ast.Tuple)
            else [node.value]
        )
        values = [self.read(v) for v in nodes]
        for value in values:
            if not isinstance(value.type, Number | Lanes):
                self.fail(node, f"a procedure returns numbers or lanes, not {value.type}")
        if self._results is None:
            self._results = tuple(v.type for v in values if isinstance(v.type, Number | Lanes))
        if len(values) != len(self._results):
            self.fail(node, f"{len(values)} values are returned here, {len(self._results)} elsewhere")
        same = [converted(v, kind) for v, kind in zip(values, self._results, strict=True)]
        for value, kind, result in zip(values, self._results, same, strict=True):
            if result is None:
                self.fail(node, f"{value.type} is returned here, {kind} elsewhere", "Convert it.")
        return (t.Return(tuple(v for v in same if v is not None), node.lineno),), True


def _statements(body: Iterable[t.Statement], into_loops: bool = True) -> Iterable[t.Statement]:
    for statement in body:
        yield statement
        if isinstance(statement, t.If):
            yield from _statements((*statement.body, *statement.otherwise), into_loops)
        elif isinstance(statement, t.While | t.For) and into_loops:
            yield from _statements(statement.body)


def _names_assigned(statement: t.Statement) -> tuple[str, ...]:
    if isinstance(statement, t.Assign | t.For):
        return (statement.name,)
    return statement.names if isinstance(statement, t.CallStatement) else ()
