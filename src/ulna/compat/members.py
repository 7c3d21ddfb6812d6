"""Members of classes of libraries: which there are, and which refuse to do anything."""

from __future__ import annotations

import ast
import inspect
import textwrap
from functools import cache
from typing import Any


def offered_member(kind: type, name: str) -> tuple[bool, str]:
    """Whether instances of a class have a member that does something, and what to use instead.

    A member is known by the class, by an assignment to `self` in its methods, or by an instance, where one can be
    made without arguments.

    Args:
        kind: The class.
        name: The member.

    Returns:
        Whether it is offered, and a hint if it is not.
    """
    static = inspect.getattr_static(kind, name, None)
    if static is not None:
        refusal = refused(static)
        return refusal is None, refusal or ""
    if name in _assigned(kind):
        return True, ""
    try:
        getattr(_instance(kind), name)
    except AttributeError as error:
        return False, str(error)
    except Exception:
        return True, ""  # it is there, and needs more than this to be read
    return True, ""


def missing_keywords(function: Any, keywords: list[str]) -> list[str]:
    """The keywords that a function has no parameter for.

    Args:
        function: A function or a class.
        keywords: Keywords of a call.

    Returns:
        Those without a parameter; none where the function takes any, or its parameters are not known.
    """
    names = _keywords_of_class(function) if inspect.isclass(function) else _keywords_of(function)
    return [] if names is None else [keyword for keyword in keywords if keyword not in names]


def _keywords_of(function: Any) -> set[str] | None:
    """The keywords that a function takes; None where it takes any, or its parameters are not known."""
    try:
        parameters = inspect.signature(function).parameters.values()
    except (TypeError, ValueError):
        return None
    if any(p.kind is p.VAR_KEYWORD for p in parameters):
        return None
    return {p.name for p in parameters if p.kind in (p.POSITIONAL_OR_KEYWORD, p.KEYWORD_ONLY)}


def _keywords_of_class(kind: type) -> set[str] | None:
    """The keywords that a class takes: its own, and those of base classes to which its `__init__` passes all others."""
    names: set[str] = set()
    for base in kind.__mro__:
        init = vars(base).get("__init__")
        if init is None:
            continue
        if not inspect.isfunction(init):
            break
        more = next(
            (p.name for p in inspect.signature(init).parameters.values() if p.kind is p.VAR_KEYWORD), None
        )
        if more is None:
            keywords = _keywords_of(init)
            return None if keywords is None else names | keywords
        if not _passes_on(init, more):
            return None
        names |= {p.name for p in inspect.signature(init).parameters.values() if p.name != more}
    return _keywords_of(kind) if not names else None


def _passes_on(init: Any, more: str) -> bool:
    """Whether all that an `__init__` does with its other keywords is to pass them to that of the base class."""
    try:
        tree = ast.parse(textwrap.dedent(inspect.getsource(init)))
    except (OSError, SyntaxError, TypeError):
        return False
    uses = sum(isinstance(node, ast.Name) and node.id == more for node in ast.walk(tree))
    passed = [
        node
        for node in ast.walk(tree)
        if isinstance(node, ast.Call)
        and ast.unparse(node.func) == "super().__init__"
        and any(one.arg is None and ast.unparse(one.value) == more for one in node.keywords)
    ]
    return len(passed) == 1 and uses == 1


def refused(function: Any) -> str | None:
    """The message of a function that does nothing but raise NotImplementedError; None for others."""
    if not inspect.isfunction(function):
        return None
    try:
        definition = ast.parse(textwrap.dedent(inspect.getsource(function))).body[0]
    except (OSError, SyntaxError, TypeError):
        return None
    body = getattr(definition, "body", [])
    steps = [one for one in body if not (isinstance(one, ast.Expr) and isinstance(one.value, ast.Constant))]
    if len(steps) != 1 or not isinstance(steps[0], ast.Raise) or not isinstance(steps[0].exc, ast.Call):
        return None
    raised = steps[0].exc
    if not isinstance(raised.func, ast.Name) or raised.func.id != "NotImplementedError":
        return None
    texts = [one.value for one in raised.args if isinstance(one, ast.Constant)]
    return str(texts[0]) if texts else ""


@cache
def _assigned(kind: type) -> frozenset[str]:
    """Names that methods of a class and of its bases assign to `self`, or that the classes declare."""
    names: set[str] = set()
    for base in kind.__mro__[:-1]:
        names |= set(vars(base).get("__annotations__", ()))
        try:
            tree = ast.parse(textwrap.dedent(inspect.getsource(base)))
        except (OSError, SyntaxError, TypeError):
            continue
        for node in ast.walk(tree):
            if isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store):
                names |= (
                    {node.attr} if isinstance(node.value, ast.Name) and node.value.id == "self" else set()
                )
    return frozenset(names)


@cache
def _instance(kind: type) -> Any:
    """An instance of a class, made without arguments if that can be done."""
    try:
        return kind()
    except Exception:
        return object.__new__(kind) if kind.__new__ is object.__new__ else kind
