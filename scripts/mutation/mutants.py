"""Mutants of a Python source: every small change of its meaning that a test should notice, one at a time."""

from __future__ import annotations

import ast
import copy
from collections.abc import Callable
from typing import Any, TypeGuard

from mutation.mutant import Mutant

_COMPARISONS: dict[type[ast.cmpop], tuple[type[ast.cmpop], ...]] = {
    ast.Lt: (ast.LtE, ast.GtE),
    ast.LtE: (ast.Lt, ast.Gt),
    ast.Gt: (ast.GtE, ast.LtE),
    ast.GtE: (ast.Gt, ast.Lt),
    ast.Eq: (ast.NotEq,),
    ast.NotEq: (ast.Eq,),
    ast.Is: (ast.IsNot,),
    ast.IsNot: (ast.Is,),
    ast.In: (ast.NotIn,),
    ast.NotIn: (ast.In,),
}
_ARITHMETIC: dict[type[ast.operator], type[ast.operator]] = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
    ast.FloorDiv: ast.Div,
    ast.Mod: ast.FloorDiv,
    ast.Pow: ast.Mult,
    ast.BitAnd: ast.BitOr,
    ast.BitOr: ast.BitAnd,
    ast.LShift: ast.RShift,
    ast.RShift: ast.LShift,
}
# The order of the arguments of these functions is of no account.
_SYMMETRIC = {
    "max",
    "min",
    "maximum",
    "minimum",
    "hypot",
    "gcd",
    "add",
    "multiply",
    "isclose",
    "allclose",
    "logical_and",
}
# Settings that change memory, time, the caller's line or a check of what is certain, but no result.
_NEUTRAL = {
    "stacklevel",
    "slots",
    "strict",
    "maxsize",
    "timeout",
    "daemon",
    "buffering",
    "encoding",
    "errors",
}
# What these calls are given is for people only.
_PROSE = {"warn", "print", "debug", "info", "TypeVar", "NewType", "ParamSpec", "NamedTuple"}
_PROSE_NAMES = ("__all__", "__slots__", "__doc__", "__match_args__", "__module__", "__name__", "__qualname__")


def mutants(source: bytes, path: str) -> list[Mutant]:
    """All mutants of a source, in its order. Each is valid Python and differs from the source in its syntax tree."""
    found = _Finder(source, path)
    found.visit(ast.parse(source))
    return sorted(found.mutants, key=lambda mutant: (mutant.start, mutant.end, mutant.kind, mutant.after))


class _Finder(ast.NodeVisitor):
    """Walks a syntax tree and notes the mutants of its nodes; what is prose, a type or of no effect is not visited."""

    def __init__(self, source: bytes, path: str) -> None:
        self.source, self.path = source, path
        self.mutants: list[Mutant] = []
        self._starts = [0]
        self._lines = source.splitlines(keepends=True)
        for line in self._lines:
            self._starts.append(self._starts[-1] + len(line))
        self._function: tuple[int, int] | None = None
        self._signature: tuple[int, int] | None = None

    def _note(self, node: Any, kind: str, after: str) -> None:
        start = self._starts[node.lineno - 1] + node.col_offset
        end = self._starts[node.end_lineno - 1] + node.end_col_offset
        before = self.source[start:end].decode()
        text = self._lines[node.lineno - 1]
        number = self._lines[: node.lineno - 1].count(text)
        place = f"{text.decode().strip()} @ {node.col_offset} #{number}"
        where = (node.lineno, node.end_lineno, place, start, end)
        self.mutants.append(Mutant(self.path, *where, kind, before, after, self._function, self._signature))

    def _note_changed(self, node: ast.expr, kind: str, change: Callable[[Any], None]) -> None:
        """Notes the mutant that `change` makes of a copy of an expression."""
        changed = copy.deepcopy(node)
        change(changed)
        self._note(node, kind, f"({ast.unparse(changed)})")

    # Functions, classes and what is left out in them

    def visit_FunctionDef(self, node: ast.FunctionDef | ast.AsyncFunctionDef) -> None:
        if any("overload" in ast.unparse(decorator) for decorator in node.decorator_list):
            return
        outer = self._function, self._signature
        whole = (node.body[0].lineno, node.body[-1].end_lineno or node.lineno)
        self._signature = whole
        for value in [*node.decorator_list, *node.args.defaults, *filter(None, node.args.kw_defaults)]:
            self.visit(value)
        self._function, self._signature = whole, None
        self._visit_body(node.body)
        self._function, self._signature = outer

    visit_AsyncFunctionDef = visit_FunctionDef

    def visit_ClassDef(self, node: ast.ClassDef) -> None:
        outer, self._function = self._function, None
        for value in [*node.decorator_list, *(keyword.value for keyword in node.keywords)]:
            self.visit(value)
        self._visit_body(node.body)
        self._function = outer

    def visit_Module(self, node: ast.Module) -> None:
        self._visit_body(node.body)

    def _visit_body(self, body: list[ast.stmt]) -> None:
        for statement in body:
            text = isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant)
            if not text:  # a docstring, or `...`
                self.visit(statement)

    def visit_If(self, node: ast.If) -> None:
        if "TYPE_CHECKING" in ast.unparse(node.test):
            return
        self._condition(node.test)
        self.generic_visit(node)

    def visit_While(self, node: ast.While) -> None:
        if not isinstance(node.test, ast.Constant):
            self._condition(node.test)
            self.visit(node.test)
        self._visit_body(node.body)

    def visit_IfExp(self, node: ast.IfExp) -> None:
        self._condition(node.test)
        self.generic_visit(node)

    def _condition(self, test: ast.expr) -> None:
        if not isinstance(test, ast.Compare | ast.UnaryOp):  # these are negated as such
            self._note(test, "condition", f"(not ({ast.unparse(test)}))")

    def visit_AnnAssign(self, node: ast.AnnAssign) -> None:
        if node.value is not None and not _is_prose_target(node.target):
            self.visit(node.value)

    def visit_Assign(self, node: ast.Assign) -> None:
        if any(_is_prose_target(target) for target in node.targets):
            return
        if (
            all(isinstance(target, ast.Attribute | ast.Subscript) for target in node.targets)
            and self._function
        ):
            self._note(node, "statement", "pass")
        self.generic_visit(node)

    def visit_JoinedStr(self, node: ast.JoinedStr) -> None:
        """Texts with values: what they say is for people, and Python 3.11 does not know the places of their parts."""

    def visit_Assert(self, node: ast.Assert) -> None:
        """What cannot fail."""

    def visit_Import(self, node: ast.Import) -> None:
        """A missing import stops every test; it tells nothing."""

    visit_ImportFrom = visit_Import

    # Mutants

    def visit_Compare(self, node: ast.Compare) -> None:
        for index, operator in enumerate(node.ops):
            for other in _COMPARISONS[type(operator)]:
                self._note_changed(
                    node, "comparison", lambda new, i=index, o=other: new.ops.__setitem__(i, o())
                )
        self.visit(node.left)
        for operator, value in zip(node.ops, node.comparators, strict=True):
            if isinstance(operator, ast.In | ast.NotIn) and _is_letters(value):
                self._note(value, "text", repr(value.value[:-1]))  # one letter more is never asked for
            else:
                self.visit(value)

    def visit_BoolOp(self, node: ast.BoolOp) -> None:
        other = ast.Or() if isinstance(node.op, ast.And) else ast.And()
        self._note_changed(node, "and/or", lambda new: setattr(new, "op", other))
        self.generic_visit(node)

    def visit_UnaryOp(self, node: ast.UnaryOp) -> None:
        if isinstance(node.op, ast.Not | ast.USub):
            self._note(node, "negation", f"({ast.unparse(node.operand)})")
        self.generic_visit(node)

    def visit_BinOp(self, node: ast.BinOp) -> None:
        other = _ARITHMETIC.get(type(node.op))
        if other is not None and not _is_text(node.left) and not _is_text(node.right):
            self._note_changed(node, "arithmetic", lambda new: setattr(new, "op", other()))
        if isinstance(node.op, ast.MatMult) and ast.dump(node.left) != ast.dump(node.right):
            self._note_changed(node, "swapped", _swap_operands)
        self.generic_visit(node)

    def visit_AugAssign(self, node: ast.AugAssign) -> None:
        self._note(node, "statement", "pass")
        self.visit(node.value)

    def visit_Constant(self, node: ast.Constant) -> None:
        value = node.value
        if isinstance(value, bool):
            self._note(node, "constant", repr(not value))
        elif isinstance(value, int | float):
            for other in (value + 1, value - 1):
                self._note(node, "constant", repr(other) if other >= 0 else f"({other!r})")
        elif isinstance(value, str) and value and not any(c.isspace() for c in value):
            self._note(node, "text", repr(value + "_"))

    def visit_Return(self, node: ast.Return) -> None:
        if node.value is None or (isinstance(node.value, ast.Constant) and node.value.value is None):
            return
        same = (
            isinstance(node.value, ast.Constant) and node.value.value is False
        )  # as None to all who ask for truth
        if not same and not (isinstance(node.value, ast.Name) and node.value.id == "NotImplemented"):
            self._note(node.value, "return", "None")
        self.visit(node.value)

    def visit_Raise(self, node: ast.Raise) -> None:
        """A refusal left out; its message is for people, the values in it are looked at in the f-strings' tests."""
        if not any(name in ast.unparse(node) for name in ("NotImplementedError", "AssertionError")):
            self._note(node, "statement", "pass")

    def visit_Break(self, node: ast.Break | ast.Continue) -> None:
        self._note(node, "statement", "pass")

    visit_Continue = visit_Break

    def visit_Expr(self, node: ast.Expr) -> None:
        if isinstance(node.value, ast.Call) and not ast.unparse(node.value.func).endswith("sleep"):
            self._note(node, "statement", "pass")
        self.generic_visit(node)

    def visit_Call(self, node: ast.Call) -> None:
        name = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
        if name in _PROSE or name.endswith(("Error", "Warning")):
            return
        if name == "cast":
            node = ast.Call(node.func, node.args[1:], node.keywords)
        elif name not in _SYMMETRIC and not any(isinstance(a, ast.Starred) for a in node.args):
            for index, (first, second) in enumerate(zip(node.args, node.args[1:], strict=False)):
                if ast.dump(first) != ast.dump(second):
                    self._note_changed(node, "swapped", lambda new, i=index: _swap_arguments(new, i))
        self.visit(node.func)
        if name == "reshape":  # any number below zero is the size that is left
            node = ast.Call(node.func, [a for a in node.args if ast.unparse(a) != "-1"], node.keywords)
        for value in [*node.args, *(k.value for k in node.keywords if k.arg not in _NEUTRAL)]:
            self.visit(value)


def _swap_operands(node: ast.BinOp) -> None:
    node.left, node.right = node.right, node.left


def _swap_arguments(node: ast.Call, index: int) -> None:
    node.args[index : index + 2] = node.args[index : index + 2][::-1]


def _is_letters(node: ast.expr) -> TypeGuard[ast.Constant]:
    """Whether a node is a text of several letters, as the kinds of a NumPy type: `kind in "iuf"`."""
    value = getattr(node, "value", None)
    return (
        isinstance(node, ast.Constant) and isinstance(value, str) and 1 < len(value) < 8 and value.isalnum()
    )


def _is_text(node: ast.expr) -> bool:
    return isinstance(node, ast.JoinedStr) or (isinstance(node, ast.Constant) and isinstance(node.value, str))


def _is_prose_target(node: ast.expr) -> bool:
    return isinstance(node, ast.Name) and node.id in _PROSE_NAMES
