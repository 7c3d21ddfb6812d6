"""Paths of HTML files that notebooks display."""

from __future__ import annotations

import html
from pathlib import Path
from typing import TYPE_CHECKING, final

if TYPE_CHECKING:
    _Path = Path
else:
    _Path = type(Path())  # Path itself has no subclasses before Python 3.12

_MAX_FILE_SIZE = 30_000_000
"""The largest file that a notebook displays [bytes]: the notebook stores a copy of it."""


@final
class PageFile(_Path):
    """The path of an HTML file; as the last line of a cell, a notebook displays the file itself.

    The cell holds a copy of the file, since frames with an address stay empty in places: JupyterHub forbids frames of
    files, and Colab does not serve them.
    """

    def _repr_html_(self) -> str | None:
        if self.suffix.lower() not in (".html", ".htm") or not self.is_file():
            return None
        if self.stat().st_size > _MAX_FILE_SIZE:
            return None
        content = html.escape(self.read_text(encoding="utf-8"))
        return f'<iframe srcdoc="{content}" width="100%" height="500" style="border:0"></iframe>'
