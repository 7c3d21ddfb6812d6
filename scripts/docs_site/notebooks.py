"""A page as a Jupyter notebook: text, code, and the outputs and pictures that the code made."""

from __future__ import annotations

import base64
import re
from collections.abc import Sequence
from pathlib import Path

import nbformat
from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook, new_output

from docs_site.execution import Output
from docs_site.pages import blocks, links

TYPES = {".png": "image/png", ".gif": "image/gif", ".jpg": "image/jpeg"}
_DIRECTIVE = re.compile(r"^:::+\{([\w-]+)\}[ \t]*(.*)$", re.MULTILINE)
_END = re.compile(r"^:::+[ \t]*$", re.MULTILINE)
_OPTION = re.compile(r"^:[\w-]+:.*\n", re.MULTILINE)


def notebook(text: str, outputs: Sequence[Output], folder: Path) -> str:
    """The notebook of a page.

    Args:
        text: The text of the page.
        outputs: What its blocks did; empty where they did not run.
        folder: The folder with the files that they wrote.

    Returns:
        The notebook as JSON.
    """
    cells, done = [], 0
    found = blocks(text)
    for number, block in enumerate(found):
        start = text.rindex("```python\n", 0, block.end)
        cells.append(_text_cell(text[done:start]))
        cells.append(new_code_cell(block.code.rstrip()))
        if number < len(outputs):
            cells[-1].outputs = _outputs(outputs[number], folder)
        if _is_folded(text[:start]):
            cells[-1].metadata["jupyter"] = {"source_hidden": True, "outputs_hidden": True}
        done = block.end
    cells.append(_text_cell(text[done:]))
    book = new_notebook(cells=[cell for cell in cells if cell.source.strip()])
    for number, cell in enumerate(book.cells):
        cell.id = f"cell-{number}"  # the same notebook from the same page
    book.metadata["kernelspec"] = {"name": "python3", "display_name": "Python 3", "language": "python"}
    nbformat.validate(book)
    return nbformat.writes(book)


def _is_folded(before: str) -> bool:
    """Whether what follows a text is in a dropdown: a solution, which the notebook folds, too."""
    opened = [found.start() for found in _DIRECTIVE.finditer(before) if found[1] == "dropdown"]
    return bool(opened) and not _END.search(before, opened[-1])


def _text_cell(text: str):
    """A cell of text: directives as headings, and without the pictures, which stand below the code that makes them."""
    for link in reversed(links(text)):
        if link.is_picture and link.path:
            text = text[: link.start] + f"*{link.text}*" + text[link.end :]
        elif link.path:
            text = text[: link.start] + link.text + text[link.end :]
    text = _OPTION.sub("", text)
    text = _DIRECTIVE.sub(lambda found: f"**{found[2] or found[1].capitalize()}**\n", text)
    return new_markdown_cell(_END.sub("", text).strip())


def _outputs(output: Output, folder: Path) -> list:
    """What a block printed and the pictures that it wrote, as outputs of its cell."""
    shown = [new_output("stream", name="stdout", text=output.text)] if output.text else []
    for name in output.files:
        if kind := TYPES.get(Path(name).suffix):
            data = base64.b64encode((folder / name).read_bytes()).decode()
            shown.append(new_output("display_data", data={kind: data}))
    return shown
