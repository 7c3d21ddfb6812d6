"""Comments of XML documents, found before a parser reads them.

libxml2 2.9 takes time that grows with the square of the length over comments that contain two hyphens.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

_BEGIN = re.compile(rb"<!--|<!\[CDATA\[|<\?")
_END = {b"<!--": b"-->", b"<![CDATA[": b"]]>", b"<?": b"?>"}


def comments(data: bytes) -> Iterator[tuple[int, int]]:
    """The comments of a document in an encoding that contains ASCII, in time that grows with its length.

    Args:
        data: The document.

    Yields:
        Where a comment begins and where it ends; one that is not closed ends with the document.
    """
    at = 0
    while (begin := _BEGIN.search(data, at)) is not None:
        close = data.find(_END[begin[0]], begin.end())
        at = len(data) if close < 0 else close + len(_END[begin[0]])
        if begin[0] == b"<!--":
            yield begin.start(), at


def line_of_double_hyphen(data: bytes) -> int:
    """The line of the first comment that contains two hyphens, which XML does not allow.

    Args:
        data: The document, in any encoding of which ASCII is a part, or in UTF-16 or UTF-32.

    Returns:
        The number of the line, from 1; 0 where there is none.
    """
    text = data.replace(b"\0", b"") if b"\0" in data[:4] else data
    for start, end in comments(text):
        hyphens = text.find(b"--", start + 4, end)
        if hyphens >= 0 and hyphens != end - 3:
            return text.count(b"\n", 0, hyphens) + 1
    return 0


def without_comments(data: bytes) -> bytes:
    """A document without its comments; its lines keep their numbers.

    Args:
        data: The document, in an encoding that contains ASCII.

    Returns:
        The document.
    """
    parts, at = [], 0
    for start, end in comments(data):
        parts += [data[at:start], b"\n" * data.count(b"\n", start, end)]
        at = end
    return b"".join([*parts, data[at:]])
