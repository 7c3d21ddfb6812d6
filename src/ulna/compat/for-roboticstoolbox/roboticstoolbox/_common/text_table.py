"""Robots as tables of text, in the toolbox's form."""

from __future__ import annotations

from collections.abc import Sequence

from roboticstoolbox._common.errors import UnknownOption

_THIN = "─│┌┬┐├┼┤└┴┘"
_BORDERS = {
    "thin": _THIN,
    "thick": "━┃┏┳┓┣╋┫┗┻┛",
    "double": "═║╔╦╗╠╬╣╚╩╝",
    "round": "─│╭┬╮├┼┤╰┴╯",
    "ascii": "-|+++++++++",
}


def bordered(text: str, border: str) -> str:
    """A table with another border.

    Args:
        text: The table.
        border: "thin", "thick", "double", "round" or "ascii".

    Returns:
        The text of the table.

    Raises:
        UnknownOption: There is no such border.
    """
    if border not in _BORDERS:
        raise UnknownOption("border", border, _BORDERS)
    return text.translate(str.maketrans(_THIN, _BORDERS[border]))


def grid(
    header: Sequence[str], rows: Sequence[Sequence[str]], right: Sequence[bool], ragged: bool = False
) -> str:
    """Rows under a header in box-drawing characters.

    `ragged` columns are shifted so that their longest entry stands at the left under a title at the left.

    Args:
        header: Titles of the columns; empty for no line of titles.
        rows: Rows of cells.
        right: For each column whether cells stand at the right.
        ragged: Whether columns are shifted as above.

    Returns:
        The text of the table.
    """
    widths = [max(len(r[i]) for r in ([header, *rows] if header else rows)) for i in range(len(rows[0]))]

    def line(a: str, b: str, c: str) -> str:
        return a + b.join("─" * (w + 2) for w in widths) + c

    def middle(text: str, width: int) -> str:
        pad = width - len(text)
        return " " * (pad // 2) + text + " " * (pad - pad // 2)

    def body(cells: Sequence[str]) -> str:
        out = (c.rjust(w) if r else c.ljust(w) for c, w, r in zip(cells, widths, right, strict=True))
        return "│ " + " │ ".join(out) + " │"

    top = [line("┌", "┬", "┐")]
    if header:
        titles = (c.ljust(w) if ragged else middle(c, w) for c, w in zip(header, widths, strict=True))
        top += ["│ " + " │ ".join(titles) + " │", line("├", "┼", "┤")]
    return "\n".join([*top, *map(body, rows), line("└", "┴", "┘")]) + "\n"
