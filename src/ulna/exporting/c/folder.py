"""The files of the target "c"."""

from __future__ import annotations

from pathlib import Path

from ulna.errors import InputError
from ulna.exporting.c.header import comment, header, real_of
from ulna.exporting.c.source import definition
from ulna.exporting.c.support import support_header
from ulna.exporting.record import Export


def write(export: Export, folder: Path) -> None:
    """Writes header, sources, test program and CMakeLists.txt.

    Args:
        export: What is to be written.
        folder: An empty folder.

    Raises:
        InputError: If there are searches.
    """
    if export.searches:
        raise InputError("The target 'c' does not have 'ik' yet.")
    name, real = export.name, real_of(export)
    files = {f"{name}.h": header(export, []), f"{name}_support.h": support_header(name, real)}
    for f in export.functions:
        files[f"{name}_{f.name}.c"] = "\n".join(
            [
                comment(
                    [
                        f"{f.summary or f.name} {f.function.operations} operations. Written by Ulna; do not edit."
                    ]
                ),
                f'#include "{name}.h"',
                f'#include "{name}_support.h"',
                "",
                definition(f.function, f"{name}_{f.name}", real, name),
            ]
        )
    for file, text in files.items():
        (folder / file).write_text(text, encoding="utf-8", newline="\n")
