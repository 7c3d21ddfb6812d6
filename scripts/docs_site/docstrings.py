"""Docstrings as reStructuredText: they are written as plain text with code in single back quotes."""

from __future__ import annotations

import inspect
import re
from typing import Any

from docs_site.names import target

_CODE = re.compile(r"(``[^`]+``|`[^`]+`)")
_SECTION = re.compile(r"(Args|Returns|Raises|Yields|Attributes|Examples?|Note):")
_FIELD = re.compile(r"Alias for field number \d+")
"""What Python says of a field of a named tuple; its name and type stand above it."""
_ATTRIBUTES: dict[str, list[str]] = {}
"""Docstrings of attributes, from before Napoleon reads them."""
_SPECIAL = re.compile(r"([*|]|(?<=\w)_(?=\W|$))")


def inline(line: str) -> str:
    """A line as reStructuredText: code in double back quotes, or linked, other special characters escaped.

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
        text += _code(part.strip("`")) + ("\\ " if after.isalnum() else "")
    return text


def _code(code: str) -> str:
    """Code within a line; a name that the reference describes is a link."""
    name = target(code)
    return f"``{code}``" if name is None else f":py:obj:`{code} <{name}>`"


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
_NDARRAY = re.compile(
    r"~?(?:numpy\.)?ndarray\[tuple\[~?(?:typing\.)?Any, \.\.\.\], ~?(?:numpy\.)?dtype\[~?(?:[\w.]+\.)?(\w+)\]\]"
)
"""What `ulna.typing` calls an array, as Sphinx writes it."""
_ARRAYS = {"Any": "Array", "float64": "Floats"}


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
    return signature and _named(signature), returns and _named(returns)


def _named(text: str) -> str:
    """A signature with arrays by their names, and "..." for defaults that are made anew, which Sphinx can read."""
    text = _NDARRAY.sub(lambda m: _ARRAYS.get(m[1], m[0]), _ARRAY_LIKE.sub("ArrayLike", text))
    return text.replace("<factory>", "...")


def skip_former_names(app: Any, what: str, name: str, obj: Any, skip: bool, options: Any) -> bool | None:
    """Sphinx's event: names of earlier versions, which still work, are not listed.

    Args:
        app, what, name, obj, skip, options: What Sphinx passes; only `name` and `obj` are needed.

    Returns:
        True for a name of an earlier version; None leaves the decision to Sphinx.
    """
    is_second_name = inspect.isfunction(obj) and obj.__name__ not in (name, "<lambda>")
    return True if is_second_name or (getattr(obj, "__doc__", None) or "").startswith("Old name") else None
