"""Docstrings as reStructuredText: they are written as plain text with code in single back quotes."""

from __future__ import annotations

import re
from typing import Any

_CODE = re.compile(r"(``[^`]+``|`[^`]+`)")
_SECTION = re.compile(r"(Args|Returns|Raises|Yields|Attributes|Examples?|Note):")
_FIELD = re.compile(r"Alias for field number \d+")
"""What Python says of a field of a named tuple; its name and type stand above it."""
_ATTRIBUTES: dict[str, list[str]] = {}
"""Docstrings of attributes, from before Napoleon reads them."""
_SPECIAL = re.compile(r"([*|]|(?<=\w)_(?=\W|$))")


def inline(line: str) -> str:
    """A line as reStructuredText: code in double back quotes, other special characters escaped.

    Args:
        line: The line.

    Returns:
        The line as reStructuredText.
    """
    parts = _CODE.split(line)
    text = ""
    for number, part in enumerate(parts):
        if number % 2 == 0:
            text += _SPECIAL.sub(r"\\\1", part)
            continue
        before, after = text[-1:], parts[number + 1][:1]
        text += "\\ " if before.isalnum() else ""
        text += f"``{part.strip('`')}``" + ("\\ " if after.isalnum() else "")
    return text


def process(app: Any, what: str, name: str, obj: Any, options: Any, lines: list[str]) -> None:
    """Sphinx's event: rewrites the lines of a docstring in place, before sections such as `Args:` are read.

    Args:
        app, what, name, obj, options: What Sphinx passes; only `what` and `name` are needed.
        lines: The lines of the docstring.
    """
    new: list[str] = []
    is_code = in_section = False
    for line in lines:
        text = line.strip()
        in_section = in_section or bool(_SECTION.fullmatch(line))
        if text and (
            not (new and new[-1]) or text.startswith(">>>")
        ):  # a paragraph, or an example below its title
            is_code = text.startswith(">>>") or (not in_section and line.startswith("    "))
            if is_code and not text.startswith(">>>") and not _was_code(new):
                new += ["::", ""]
        new.append(line if is_code else inline(line))
    if _FIELD.fullmatch("".join(lines)):
        new = []
    lines[:] = new
    if what in ("attribute", "property"):
        _ATTRIBUTES[name] = new


def _was_code(lines: list[str]) -> bool:
    """Whether the paragraph before is an indented block, which goes on."""
    return any(line.startswith("    ") for line in lines[-2:])


def keep_attributes(app: Any, what: str, name: str, obj: Any, options: Any, lines: list[str]) -> None:
    """Sphinx's event, after Napoleon: "A name: text" in the docstring of an attribute is no type.

    Args:
        app, what, name, obj, options: What Sphinx passes.
        lines: The lines of the docstring.
    """
    if name in _ATTRIBUTES:
        lines[:] = [*_ATTRIBUTES.pop(name), ""]


_NUMPY = r"~?numpy\._typing\.[\w.]*"
_ARRAY_LIKE = re.compile(rf"{_NUMPY}_Buffer \| .*?{_NUMPY}_NestedSequence\[complex \| bytes \| str\]")
"""What NumPy's ArrayLike stands for, as Sphinx writes it."""


def name_arrays(
    app: Any, what: str, name: str, obj: Any, options: Any, signature: str | None, returns: str | None
) -> tuple[str | None, str | None]:
    """Sphinx's hook for signatures: arrays by their names where an annotation is no text and was evaluated.

    Args:
        app, what, name, obj, options: What Sphinx passes; not used.
        signature: The arguments.
        returns: The annotation of the result.

    Returns:
        Both with shorter names.
    """
    named = [text and _ARRAY_LIKE.sub("ArrayLike", text) for text in (signature, returns)]
    return named[0], named[1]
