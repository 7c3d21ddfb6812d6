"""The files of the target "c"."""

from __future__ import annotations

from pathlib import Path

from ulna.errors import InputError
from ulna.exporting.c import model, search
from ulna.exporting.c.build import cmake_lists
from ulna.exporting.c.header import comment, header, real_of
from ulna.exporting.c.source import definition
from ulna.exporting.c.support import support_header
from ulna.exporting.c.test_program import test_program
from ulna.exporting.record import Export, ExportedFunction

_STANDARD_HEADERS = frozenset(
    [
        "assert",
        "complex",
        "ctype",
        "errno",
        "fenv",
        "float",
        "inttypes",
        "iso646",
        "limits",
        "locale",
        "math",
        "setjmp",
        "signal",
        "stdalign",
        "stdarg",
        "stdatomic",
        "stdbit",
        "stdbool",
        "stdckdint",
        "stddef",
        "stdint",
        "stdio",
        "stdlib",
        "stdnoreturn",
        "string",
        "strings",
        "tgmath",
        "threads",
        "time",
        "uchar",
        "unistd",
        "wchar",
        "wctype",
    ]
)
"""A file of one of these names hides the header from the sources, which include <math.h>."""


def write(export: Export, folder: Path) -> None:
    """Writes header, sources, test program and CMakeLists.txt.

    Args:
        export: What is to be written.
        folder: An empty folder.

    Raises:
        InputError: If a function has the name of something else that is written.
    """
    _reject_reserved_names(export)
    name = export.name
    sources = {f"{name}_{f.name}.c": _source(export, f) for f in export.functions}
    sources |= {f"{name}_{s.name}.c": search.source(export, s) for s in export.searches}
    constants = ""
    if export.model is not None:
        constants = model.declarations(export, export.model)
        sources[f"{name}_model.c"] = model.source(export, export.model)
    test = f"test_{name}.c" if export.options["test"] else ""
    files = {
        f"{name}.h": header(export, [search.declaration(export, s) for s in export.searches], constants),
        f"{name}_support.h": support_header(name, real_of(export)),
        "CMakeLists.txt": cmake_lists(name, list(sources), test),
        **sources,
    }
    if test:
        files[test] = test_program(export)
    for file, text in files.items():
        (folder / file).write_text(text, encoding="utf-8", newline="\n")


def _reject_reserved_names(export: Export) -> None:
    if export.name in _STANDARD_HEADERS:
        raise InputError(
            f"The names of the files would begin with {export.name!r}: {export.name}.h is a header of C itself. "
            f'Choose another: name="{export.name}_robot".'
        )
    searches = [s.name for s in export.searches]
    taken = {"model", "min", "max", "sincos", "sincos_far", "support", "joint_names", "part"}
    taken |= {
        f"{s}_{word}" for s in searches for word in ("search", "defaults", "options", "report", "are_finite")
    }
    taken |= set() if export.model is None else set(model.constants(export.model))
    for name in (*searches, *(f.name for f in export.functions)):
        if name in taken or name.upper() in ("NQ", "NV", "PART", "H", "SUPPORT_H"):
            raise InputError(
                f"A function has the name {name!r}, which the folder of C uses itself. "
                f'Choose another: kernels={{"my_{name}": ...}}.'
            )


def _source(export: Export, f: ExportedFunction) -> str:
    name = export.name
    about = f"{f.summary or f.name} {f.function.operations} operations. Written by Ulna; do not edit."
    includes = [f'#include "{name}.h"', f'#include "{name}_support.h"', ""]
    return "\n".join(
        [
            comment([about]),
            *includes,
            definition(f.function, f.outputs, f"{name}_{f.name}", real_of(export), name),
        ]
    )
