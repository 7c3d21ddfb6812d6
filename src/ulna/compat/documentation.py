"""Docstrings completed by what arguments of the same name mean in all functions of a package."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Mapping, Sequence
from types import FunctionType
from typing import Any, TypeVar

Described = TypeVar("Described", bound=Callable[..., Any])

_SECTION = re.compile(r"^[A-Z]\w[\w ]*:\n(?= )", re.MULTILINE)
_ENTRY = re.compile(r"^    (\*{0,2}\w+(?:, \*{0,2}\w+)*):", re.MULTILINE)


def with_arguments(doc: str, names: Sequence[str], texts: Mapping[str, str]) -> str:
    """A docstring whose section `Args:` has all arguments, in their order.

    Args:
        doc: The docstring without indentation; the entries it has stay.
        names: The names of the arguments.
        texts: What to write of those without an entry; "return" for a docstring without a section `Returns:`.

    Returns:
        The docstring.
    """
    doc = _with_returns(doc, texts["return"]) if "return" in texts else doc
    titles = [*_SECTION.finditer(doc)]
    start = end = titles[0].start() if titles else len(doc)
    if titles and titles[0][0] == "Args:\n":
        end = titles[1].start() if len(titles) > 1 else len(doc)
    parts = _ENTRY.split(doc[start:end].partition("\n")[2])
    written = {
        group: f"    {group}:{text.rstrip()}" for group, text in zip(parts[1::2], parts[2::2], strict=True)
    }
    group_of = {name.strip(): group for group in written for name in group.split(",")}
    lines = {}
    for name in names:
        if name in group_of:
            lines[group_of[name]] = written[group_of[name]]
        elif name in texts:
            lines[name] = f"    {name}: {texts[name]}"
    lines |= written  # the others, such as **more
    if not lines:
        return doc
    section = "\n".join(["Args:", *lines.values()])
    return "\n\n".join(part for part in (doc[:start].rstrip(), section, doc[end:].strip()) if part)


def _with_returns(doc: str, text: str) -> str:
    """A docstring with a section `Returns:`, which stands before `Raises:`."""
    if re.search(r"^Returns:$", doc, re.MULTILINE):
        return doc
    before, title, errors = doc.rstrip().partition("\n\nRaises:\n")
    return f"{before}\n\nReturns:\n    {text}{title}{errors}"


def documented(texts: Mapping[str, str]) -> Callable[[Described], Described]:
    """A decorator that completes the docstring of a function, or of the functions of a class.

    Args:
        texts: What arguments mean, by their names; "return" for what functions return that say nothing of it.

    Returns:
        The decorator.
    """

    def decorate(described: Described) -> Described:
        is_class = inspect.isclass(described)
        for member in vars(described).values() if is_class else (described,):
            function = getattr(member, "__func__", member)
            names = argument_names(inspect.unwrap(function)) if isinstance(function, FunctionType) else []
            if len(names) > 1 and function.__doc__ and not texts.keys().isdisjoint([*names, "return"]):
                function.__doc__ = with_arguments(inspect.cleandoc(function.__doc__), names, texts)
        return described

    return decorate


def argument_names(function: Callable[..., Any]) -> list[str]:
    """The names of the arguments of a function that is no wrapper, without `self` and `cls`."""
    code: Any = function.__code__  # type: ignore[attr-defined]
    count = code.co_argcount + code.co_kwonlyargcount
    return [name for name in code.co_varnames[:count] if name not in ("self", "cls")]
