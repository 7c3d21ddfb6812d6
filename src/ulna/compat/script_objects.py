"""What the expressions of a script are objects of, as far as its text and the annotations of libraries say.

A class of a library that is called makes an instance of it; functions, methods and properties return what their
annotations say. A name that is bound several times may hold each of the objects.
"""

from __future__ import annotations

import ast
import inspect
import typing
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, final

from ulna.compat.script_names import Scope


@final
@dataclass(frozen=True)
class KnownObject:
    """An object that is known.

    Attributes:
        value: A module, class or function of a library, or the class of an instance.
        is_instance: Whether it is an instance of `value`.
        owner: The class of the instance that a method is bound to.
    """

    value: Any
    is_instance: bool = False
    owner: Any = None


_CONTAINERS = (list, tuple, dict, set, object)

Objects = tuple[KnownObject, ...] | None
"""What an expression may be: objects of libraries, () for what belongs to no library, or None where it is not known."""

_OF_PYTHON = (ast.Constant, ast.JoinedStr, ast.Compare, ast.Lambda)
_COMPOSED = (
    ast.List, ast.Tuple, ast.Dict, ast.Set, ast.BinOp, ast.BoolOp, ast.UnaryOp, ast.Subscript, ast.Starred,
    ast.IfExp, ast.Slice,
)  # fmt: skip
"""Expressions of no library if none of their parts is."""


@final
class ObjectsOf:
    """Finds what expressions are.

    Args:
        load: Returns the object of a dotted name of a library; None for names of others. It raises AttributeError
            or ImportError for what is not offered.
    """

    def __init__(self, load: Callable[[str], Any]) -> None:
        self._load = load
        self._pending: set[int] = set()

    def __call__(self, node: ast.expr, scope: Scope) -> Objects:
        """What an expression may be.

        Args:
            node: The expression.
            scope: Its scope.

        Returns:
            The objects, or None where they are not known.
        """
        if isinstance(node, _OF_PYTHON):
            return ()
        if id(node) in self._pending:
            return None  # defined by itself
        self._pending.add(id(node))
        try:
            return self._of(node, scope)
        finally:
            self._pending.discard(id(node))

    def _of(self, node: ast.expr, scope: Scope) -> Objects:
        if isinstance(node, ast.Name):
            return self._of_name(node.id, scope)
        if isinstance(node, ast.Attribute):
            base = self(node.value, scope)
            return None if base is None else _joined([_attribute(one, node.attr) for one in base])
        if isinstance(node, ast.Call):
            called = self(node.func, scope)
            return None if called is None else _joined([_result(one) for one in called])
        if isinstance(node, _COMPOSED):
            parts = [self(part, scope) for part in ast.iter_child_nodes(node) if isinstance(part, ast.expr)]
            return () if all(part == () for part in parts) else None
        return None

    def _of_name(self, name: str, scope: Scope) -> Objects:
        owner_and_bindings = scope.find(name)
        if owner_and_bindings is None:
            return ()
        owner, bindings = owner_and_bindings
        return _joined([self._of_binding(binding, owner) for binding in bindings])

    def _of_binding(self, binding: ast.expr | str | None, scope: Scope) -> Objects:
        if binding is None:
            return None
        if not isinstance(binding, str):
            return self(binding, scope)
        try:
            value = self._load(binding)
        except (AttributeError, ImportError):
            return None
        return () if value is None else (KnownObject(value),)


def _joined(parts: list[Objects]) -> Objects:
    """All objects that an expression may be; None where any of them is not known."""
    if any(part is None for part in parts):
        return None
    return tuple(dict.fromkeys(one for part in parts for one in part or ()))


def _attribute(known: KnownObject, name: str) -> Objects:
    """What an attribute of an object is."""
    if not known.is_instance:
        try:
            value = getattr(known.value, name)
        except Exception:
            return None
        return (KnownObject(value),) if inspect.ismodule(value) or callable(value) else ()
    static = inspect.getattr_static(known.value, name, None)
    if inspect.isfunction(static):
        return (KnownObject(static, owner=known.value),)
    if isinstance(static, property) and static.fget is not None:
        return _annotated(static.fget, known.value)
    return None


def _result(known: KnownObject) -> Objects:
    """What calling an object returns."""
    if known.is_instance:
        return None
    if inspect.isclass(known.value):
        return (KnownObject(known.value, is_instance=True),)
    return _annotated(known.value, known.owner)


def _annotated(function: Any, owner: Any) -> Objects:
    """What a function returns, by its annotation."""
    try:
        annotation = typing.get_type_hints(inspect.unwrap(function)).get("return", Any)
    except Exception:
        return None
    if annotation is typing.Self:
        return None if owner is None else (KnownObject(owner, is_instance=True),)
    kind = typing.get_origin(annotation) or annotation
    if annotation is Any or not inspect.isclass(kind):
        return () if annotation is None else None
    if kind.__module__.split(".", maxsplit=1)[0] in ("builtins", "numpy"):
        return None if kind in _CONTAINERS else ()
    return (KnownObject(kind, is_instance=True),)
