"""The files of the target "object"."""

from __future__ import annotations

from pathlib import Path

from ulna.checks.values import short_repr
from ulna.compiler.codegen.ir_text import DType
from ulna.compiler.codegen.module import emit_library
from ulna.compiler.codegen.node_writer import Module
from ulna.compiler.runtime.cross_compile import cross_compile
from ulna.errors import InputError
from ulna.exporting.c.expressions import number
from ulna.exporting.c.header import header
from ulna.exporting.c.search import ATTEMPTS, TOLERANCE, declaration
from ulna.exporting.c.test_program import test_program
from ulna.exporting.objects.processors import Processor, processor
from ulna.exporting.objects.searches import SearchWriter
from ulna.exporting.objects.symbols import undefined_symbols
from ulna.exporting.record import Export


def write(export: Export, folder: Path) -> None:
    """Writes the object file, its header, and a test program with recorded values.

    Args:
        export: What is to be written.
        folder: An empty folder.

    Raises:
        InputError: If an option is not what it should be, or the processor does not have the type of the numbers.
        UnknownName: If the table has no such triple.
        TooLargeError: If a function takes too many operations.
    """
    options = export.options
    for key in ("cpu", "features"):
        if not isinstance(options[key], str):
            raise InputError(f"`{key}` is {short_repr(options[key])}; expected a name of LLVM's.")
    chosen = processor(options["triple"], options["cpu"], options["features"], int(options["lanes"]))
    content = object_file(export, chosen)
    name = export.name
    (folder / f"{name}{chosen.suffix}").write_bytes(content)
    texts = {f"{name}.h": _header(export, chosen, undefined_symbols(content))}
    if options["test"]:
        texts[f"test_{name}.c"] = test_program(export)
    for file, text in texts.items():
        (folder / file).write_text(text, encoding="utf-8", newline="\n")


def object_file(export: Export, chosen: Processor) -> bytes:
    """The functions and searches of an export as an object file.

    Args:
        export: What is exported.
        chosen: The processor.

    Returns:
        The bytes of the file.

    Raises:
        InputError: If the processor does not have the type of the numbers.
    """
    element: DType = "float" if export.dtype.name == "float32" else "double"
    target = chosen.target
    if element == "double" and not target.arithmetic.double_precision:
        raise InputError(f"The processor {target.cpu!r} has no float64; export with dtype=numpy.float32.")
    functions = [(f"{export.name}_{f.name}", f.function) for f in export.functions]
    searches = [(f"{export.name}_{s.name}_search", s.function(target.search_lanes)) for s in export.searches]

    def add(module: Module) -> None:
        for search in export.searches:
            name = f"{export.name}_{search.name}"
            SearchWriter(name, search, target, element).add_to(module)
            del module.definitions[f"{name}_search"]

    ir = emit_library([*functions, *searches], target, element, add)
    has_loops = any(f.has_loops for _, f in [*functions, *searches])
    return cross_compile(ir, target, has_loops, position_independent=chosen.is_relocatable)


def _header(export: Export, chosen: Processor, undefined: tuple[str, ...]) -> str:
    """The header of the target "c", with default options inline: how a structure is returned differs by system."""
    declarations = [_inline_defaults(declaration(export, s), export, s.name) for s in export.searches]
    target = chosen.target
    needs = ", ".join(undefined) if undefined else "nothing"
    about = f"/* Object file for {target.triple} ({target.cpu}). It needs from other libraries: {needs}. */\n"
    return about + header(export, declarations)


def _inline_defaults(text: str, export: Export, search: str) -> str:
    name = f"{export.name}_{search}"
    real = "float" if export.dtype.name == "float32" else "double"
    tolerance = number(TOLERANCE[real], real)
    head = f"{name}_options {name}_defaults(void)"
    values = f"{{{tolerance}, {tolerance}, {ATTEMPTS}}}"
    body = f"static inline {head}\n{{\n    const {name}_options options = {values};\n    return options;\n}}"
    assert f"{head};" in text
    return text.replace(f"{head};", body)
