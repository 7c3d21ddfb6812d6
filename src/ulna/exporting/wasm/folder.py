"""The files of the target "wasm"."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import final

from ulna.errors import InputError
from ulna.exporting.record import Export
from ulna.exporting.wasm.code import module, places, traced
from ulna.exporting.wasm.declarations import declarations
from ulna.exporting.wasm.description import description
from ulna.exporting.wasm.test_program import test_program
from ulna.ik.search import DESCENT

_TAKEN = ("description", "memory", "then")  # an object with `then` is taken for a promise


@final
@dataclass(frozen=True)
class WebModule:
    """Functions for web pages and node.

    Attributes:
        binary: The WebAssembly module.
        javascript: The JavaScript module around it, with `load` and `loadSync`.
        types: Its types, the text of a .d.ts file.
    """

    binary: bytes
    javascript: str
    types: str


def web_module(export: Export) -> WebModule:
    """Compiles what is exported to WebAssembly.

    Args:
        export: What is exported.

    Returns:
        The WebAssembly module and the JavaScript module around it.

    Raises:
        InputError: If a function has a name that is taken, or a search is to be computed in float32.
        TooLargeError: If a function is larger than browsers accept.
    """
    functions = traced(export)
    for name in _TAKEN:
        if name in functions:
            raise InputError(
                f"The name of a kernel is {name!r}, which the JavaScript module uses itself; choose another name: "
                f"kernels={{'my_{name}': ...}}."
            )
    offsets, data_size = places(functions, export.dtype.itemsize)
    made = module(export, functions, data_size)
    content = description(export, functions, offsets)
    text = files("ulna.exporting.wasm").joinpath("runtime.js").read_text(encoding="utf-8")
    values = {
        # Safe inside a <script> of a page, whatever the robot's file says.
        "DESCRIPTION": json.dumps(content, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c"),
        "FREE": str(made.free),
        "NUMBERS": "Float32Array" if export.dtype.name == "float32" else "Float64Array",
        "DESCENT": str(DESCENT),
        "NAME": export.name,
    }
    text = re.sub(f"__({'|'.join(values)})__", lambda match: values[match[1]], text)
    return WebModule(made.binary, text, declarations(content))


def write(export: Export, folder: Path) -> None:
    """Writes the WebAssembly module, the JavaScript module, its types, and a test with recorded values.

    Args:
        export: What is to be written.
        folder: An empty folder.
    """
    made = web_module(export)
    (folder / f"{export.name}.wasm").write_bytes(made.binary)
    for suffix, text in ((".js", made.javascript), (".d.ts", made.types)):
        (folder / f"{export.name}{suffix}").write_text(text, encoding="utf-8", newline="\n")
    if export.options["test"]:
        text = test_program(export)
        (folder / f"test_{export.name}.mjs").write_text(text, encoding="utf-8", newline="\n")
    package = {"type": "module", "main": f"./{export.name}.js", "types": f"./{export.name}.d.ts"}
    (folder / "package.json").write_text(json.dumps(package, indent=2) + "\n", encoding="utf-8")
