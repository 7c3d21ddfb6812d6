"""The names of a script, scope by scope: which expressions they are bound to."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from typing import final

Binding = ast.expr | str | None
"""An expression, the dotted name of what is imported, or None where the text does not show it."""

_SCOPES = (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda, ast.ClassDef)


@final
class Scope:
    """A module, class or function, and the names that it binds.

    Attributes:
        outer: The scope around it; None for the module.
        names: What each name is bound to, every time.
    """

    def __init__(self, outer: Scope | None) -> None:
        self.outer = outer
        self.names: dict[str, list[Binding]] = {}

    def bind(self, name: str, binding: Binding) -> None:
        """Adds a binding of a name.

        Args:
            name: The name.
            binding: What it is bound to.
        """
        self.names.setdefault(name, []).append(binding)

    def find(self, name: str) -> tuple[Scope, list[Binding]] | None:
        """The innermost scope that binds a name, and its bindings; None for names of Python itself."""
        scope: Scope | None = self
        while scope is not None:
            if name in scope.names:
                return scope, scope.names[name]
            scope = scope.outer
        return None


def expressions(tree: ast.Module) -> Iterator[tuple[ast.expr, Scope]]:
    """All attributes and calls of a script, each with its scope.

    Args:
        tree: The script.

    Yields:
        An attribute or a call, and its scope.
    """
    uses: list[tuple[ast.expr, Scope]] = []
    _walk(tree, Scope(None), uses)
    yield from uses


def _walk(node: ast.AST, scope: Scope, uses: list[tuple[ast.expr, Scope]]) -> None:
    for child in ast.iter_child_nodes(node):
        inner = scope
        _bind(child, scope)
        if isinstance(child, _SCOPES):
            inner = Scope(scope)
            for argument in ast.walk(child.args) if not isinstance(child, ast.ClassDef) else ():
                if isinstance(argument, ast.arg):
                    inner.bind(argument.arg, _instance_of(argument.annotation))
        if isinstance(child, (ast.Attribute, ast.Call)):
            uses.append((child, scope))
        _walk(child, inner, uses)


def _instance_of(annotation: ast.expr | None) -> ast.expr | None:
    """A call of the class that an annotation names, which stands for an instance of it."""
    if isinstance(annotation, (ast.Name, ast.Attribute)):
        return ast.Call(annotation, [], [])
    return None


def _bind(node: ast.AST, scope: Scope) -> None:
    """Adds the names that a statement or an expression binds."""
    if isinstance(node, (ast.Import, ast.ImportFrom)):
        for alias in node.names:
            _bind_import(node, alias, scope)
    elif isinstance(node, ast.Assign):
        for target in node.targets:
            _bind_target(target, node.value, scope)
    elif isinstance(node, ast.AnnAssign):
        _bind_target(node.target, node.value or _instance_of(node.annotation), scope)
    elif isinstance(node, ast.NamedExpr):
        _bind_target(node.target, node.value, scope)
    elif isinstance(node, (ast.AugAssign, ast.For, ast.AsyncFor, ast.comprehension)):
        _bind_target(node.target, None, scope)
    elif isinstance(node, ast.withitem) and node.optional_vars is not None:
        _bind_target(node.optional_vars, None, scope)
    elif isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
        scope.bind(node.name, None)
    elif isinstance(node, ast.ExceptHandler) and node.name:
        scope.bind(node.name, "builtins.Exception")


def _bind_import(node: ast.Import | ast.ImportFrom, alias: ast.alias, scope: Scope) -> None:
    if isinstance(node, ast.ImportFrom):
        scope.bind(alias.asname or alias.name, f"{node.module or '.'}.{alias.name}")
    elif alias.asname:
        scope.bind(alias.asname, alias.name)
    else:
        root = alias.name.split(".")[0]
        scope.bind(root, root)


def _bind_target(target: ast.expr, value: ast.expr | None, scope: Scope) -> None:
    if isinstance(target, ast.Name):
        scope.bind(target.id, value)
        return
    for part in ast.walk(target):
        if isinstance(part, ast.Name) and isinstance(part.ctx, ast.Store):
            scope.bind(part.id, None)
