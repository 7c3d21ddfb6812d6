"""What stands before the root element of an XML document: declarations, the document type; and the root's name."""

from __future__ import annotations

import re
from dataclasses import dataclass

from ulna.errors import excerpt

_NAME = re.compile(rb"<([A-Za-z_][\w.:-]*)")
_DECLARATION = re.compile(rb"<\?xml(?=[\s?])")
_VALID = re.compile(
    rb"<\?xml\s+version\s*=\s*(?:\"1\.\d+\"|'1\.\d+')"
    rb"(?:\s+encoding\s*=\s*(?:\"[\w.:-]+\"|'[\w.:-]+'))?"
    rb"(?:\s+standalone\s*=\s*(?:\"(?:yes|no)\"|'(?:yes|no)'))?\s*\?>"
)
_VERSION = re.compile(rb"\bversion\s*=\s*[\"']?([^\"'\s?]*)")
_ENCODING = re.compile(rb"\bencoding\s*=\s*[\"']?([\w.:-]+)")
_NOT_A_LINE_BREAK = re.compile(rb"[^\r\n]")
_BYTE_ORDER_MARK = b"\xef\xbb\xbf"


@dataclass(frozen=True)
class Prolog:
    """What stands before the root element. The time to read it grows with its length, whatever it holds.

    Attributes:
        root: the name of the root element; "" where there is none.
        declarations: first and last position of each XML declaration `<?xml ... ?>`.
        document_type: the text from `<!DOCTYPE` on; empty where there is none.
    """

    root: str
    declarations: tuple[tuple[int, int], ...] = ()
    document_type: bytes = b""


def prolog_of(data: bytes) -> Prolog:
    """The prolog of a document in an encoding that contains ASCII."""
    declarations: list[tuple[int, int]] = []
    doctype = -1
    at = data.find(b"<")
    while at >= 0:
        if data.startswith(b"<!--", at):
            end = data.find(b"-->", at + 4)
        elif data.startswith(b"<?", at):
            end = data.find(b"?>", at + 2)
            if end >= 0 and _DECLARATION.match(data, at):
                declarations.append((at, end + 2))
        else:
            if data.startswith(b"<!DOCTYPE", at) and doctype < 0:
                doctype = at
            end = at
            name = _NAME.match(data, at)
            if name is not None:
                kind = data[doctype:at] if doctype >= 0 else b""
                return Prolog(name[1].decode("utf-8", errors="replace"), tuple(declarations), kind)
        if end < 0:
            break  # a comment or an instruction that never ends
        at = data.find(b"<", end + 1)
    return Prolog("", tuple(declarations), data[doctype:] if doctype >= 0 else b"")


def with_plain_declaration(data: bytes) -> tuple[bytes, str]:
    """The document with one XML declaration of version 1.0, at its beginning, and a word on what was odd before.

    Other readers of robot files accept a declaration after blanks, a second one, and any version; the standard does
    not. Lines keep their numbers. The word is empty, and the document the same, where nothing was odd.
    """
    declarations = prolog_of(data).declarations
    start = len(_BYTE_ORDER_MARK) if data.startswith(_BYTE_ORDER_MARK) else 0
    if not declarations or (
        len(declarations) == 1 and declarations[0][0] == start and _VALID.fullmatch(data, *declarations[0])
    ):
        return data, ""
    first = data[slice(*declarations[0])]
    encoding = _ENCODING.search(first)
    named = b' encoding="' + encoding[1] + b'"' if encoding else b""
    blank = bytearray(data[start:])
    for begin, end in declarations:
        blank[begin - start : end - start] = _NOT_A_LINE_BREAK.sub(b" ", data[begin:end])
    return data[:start] + b'<?xml version="1.0"' + named + b"?>" + bytes(blank), _oddity(
        declarations, start, first
    )


def _oddity(declarations: tuple[tuple[int, int], ...], start: int, first: bytes) -> str:
    version = _VERSION.search(first)
    if declarations[0][0] != start:
        return "the XML declaration does not begin the file"
    if len(declarations) > 1:
        return f"the file has {len(declarations)} XML declarations"
    if version is None or not re.fullmatch(rb"1\.\d+", version[1]):
        number = version[1].decode("utf-8", errors="replace") if version else ""
        return f"the XML declaration has the version {excerpt(number)!r}, and there is none but 1.0 and 1.1"
    return f"the XML declaration {excerpt(first.decode('utf-8', errors='replace'))} is not written as one"
