"""Checks an MJCF file before MuJoCo reads it: its text, the files that it includes, and those that it names."""

from __future__ import annotations

import os
from collections.abc import Iterator
from typing import Any

from ulna.errors import FormatError
from ulna.files import special_kind
from ulna.formats.markup import lenient_tree, read_file, reject_document_type
from ulna.formats.prolog import prolog_of

MOST_INCLUDES = 1000
"""Files that include more others than this are refused."""


def check_sources(text: str, file: str | None) -> str:
    """Check that an MJCF document may be read: it is UTF-8 without entities, and names regular files.

    Args:
        text: the document, where there is no file.
        file: Its file; None for a text.

    Returns:
        The text.

    Raises:
        FormatError: the file, or one that it includes, is missing, too large, not UTF-8, or declares entities; or one
            of the files that it names is a pipe, a socket or a device.
    """
    folder = os.path.dirname(os.path.abspath(file)) if file else os.getcwd()
    main_text = _checked_text(text if file is None else read_file(file), file)
    waiting = [(main_text, file)]
    visited = set() if file is None else {os.path.realpath(file)}
    while waiting:
        content, name = waiting.pop()
        root = lenient_tree(content.encode())
        if root is None:
            continue
        _reject_special_files(root, name, folder)
        for included in _included(root, name, folder):
            place = os.path.realpath(included)
            if place not in visited:
                visited.add(place)
                waiting.append((_checked_text(read_file(included), included), included))
            if len(visited) > MOST_INCLUDES:
                raise FormatError(f"it includes more than {MOST_INCLUDES} files.", file=file)
    return main_text


def _checked_text(data: bytes | str, file: str | None) -> str:
    try:
        content = data.encode("utf-8") if isinstance(data, str) else data
        text = content.decode("utf-8")
    except UnicodeEncodeError as error:
        raise _not_utf8(str(data).count("\n", 0, error.start) + 1, file) from None
    except UnicodeDecodeError as error:
        raise _not_utf8(error.object.count(b"\n", 0, error.start) + 1, file) from None
    doctype = prolog_of(content).document_type
    if b"<!ENTITY" in doctype:
        reject_document_type("entities", file)
    head = doctype.partition(b"[")[0].partition(b">")[0]
    if b"SYSTEM" in head or b"PUBLIC" in head:
        reject_document_type("an external DTD", file)
    return text


def _not_utf8(line: int, file: str | None) -> FormatError:
    return FormatError("the text is not UTF-8.", file=file, line=line, fix="Save the file as UTF-8.")


def _included(root: Any, file: str | None, folder: str) -> Iterator[str]:
    """The files that a document includes and that are there; MuJoCo itself complains about the others."""
    directory = os.path.dirname(os.path.abspath(file)) if file else folder
    for element in root.iter("include"):
        name = element.get("file") or ""
        places = dict.fromkeys(os.path.join(place, name) for place in (folder, directory))
        yield from (place for place in places if name and os.path.isfile(place))


def _reject_special_files(root: Any, file: str | None, folder: str) -> None:
    """Refuse the names of pipes, sockets and devices, wherever MuJoCo might look for them."""
    directory = os.path.dirname(os.path.abspath(file)) if file else folder
    compilers = list(root.iter("compiler"))
    directories = ("meshdir", "texturedir", "assetdir")
    named = (element.get(d) for element in compilers for d in directories)
    places = dict.fromkeys(["", *(name for name in named if name)])
    for element in root.iter("*"):
        for attribute, name in element.attrib.items():
            if not str(attribute).startswith("file") or not name:
                continue
            for place in places:
                for start in dict.fromkeys((folder, directory)):
                    kind = special_kind(os.path.join(start, place, name))
                    if kind:
                        raise FormatError(
                            f"the file {name!r} is {kind}, and only regular files are read.",
                            file=file,
                            line=element.sourceline,
                            element=f"<{element.tag}>",
                        )
