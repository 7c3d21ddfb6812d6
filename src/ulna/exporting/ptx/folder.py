"""The files of the target "ptx"."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ulna.compiler import Function
from ulna.compiler.runtime.ptx import ptx
from ulna.exporting.record import Argument, Export, ExportedSearch


def write(export: Export, folder: Path) -> None:
    """Writes the PTX text, a header with the kernels' prototypes, and a description for programs.

    Args:
        export: What is to be written.
        folder: An empty folder.

    Raises:
        CompileError: If LLVM generates no code.
    """
    kernels = _kernels(export)
    functions = [(name, function) for name, (function, _) in kernels.items()]
    architecture = export.options["architecture"]
    (folder / f"{export.name}.ptx").write_text(
        ptx(functions, export.dtype, architecture), encoding="utf-8", newline="\n"
    )
    description = {
        "name": export.name,
        "dtype": export.dtype.name,
        "architecture": architecture,
        "kernels": {name: text for name, (_, text) in kernels.items()},
    }
    (folder / f"{export.name}.json").write_text(json.dumps(description, indent=2) + "\n", encoding="utf-8")
    (folder / f"{export.name}.cuh").write_text(_header(export, kernels), encoding="utf-8", newline="\n")


_Kernels = Mapping[str, tuple[Function, dict[str, Any]]]


def _kernels(export: Export) -> _Kernels:
    """Names of the kernels, with functions and descriptions."""
    kernels: dict[str, tuple[Function, dict[str, Any]]] = {}
    for f in export.functions:
        text = {"summary": f.summary, "choices": dict(f.choices)}
        kernels[f"{export.name}_{f.name}"] = (f.function, text | _described_arguments(f.inputs, f.outputs))
    for s in export.searches:
        function = s.function(1)
        kernels[f"{export.name}_{s.name}"] = (function, _of_search(s, function))
    return kernels


def _of_search(s: ExportedSearch, function: Function) -> dict[str, Any]:
    inputs = [Argument(p.name, p.shape) for p in function.inputs]
    outputs = [Argument(p.name, p.shape) for p in function.outputs]
    frames = len(s.choices["frame"].split(", "))
    summary = (
        "Inverse kinematics. settings: position_tolerance^2 [m^2], (2 sin(rotation_tolerance / 2))^2 [rad^2], 1 to "
        "stay near q0 else 0, greatest number of steps. "
        f"The result: q ({len(s.start)}), 1 if it meets the goals, 0 if not, -1 if a goal is no rotation, steps, "
        f"index of the starting point, errors of position [m] and rotation [rad] of {frames} frames. "
        "Tolerances of 1e-6 m and rad (settings 1e-12) suit float64, of 1e-4 (1e-8) float32."
    )
    starts = {"q0": [float(x) for x in s.start], "shift": [float(x) for x in s.shift]}
    return {"summary": summary, "choices": dict(s.choices), "starts": starts} | _described_arguments(
        inputs, outputs
    )


def _described_arguments(inputs: Any, outputs: Any) -> dict[str, Any]:
    def listed(arguments: Any) -> list[dict[str, Any]]:
        return [{"name": a.name, "shape": list(a.shape), "unit": a.unit, "text": a.text} for a in arguments]

    return {"inputs": listed(inputs), "outputs": listed(outputs)}


_TOP = """// Kernels of {name} for the CUDA driver (cuModuleLoadData, cuModuleGetFunction): a thread for each sample.
// Written by Ulna; do not edit.
//
// Arguments: the number of samples, and for each input and output its address in the GPU's memory and two strides, in
// numbers of {dtype}: from sample to sample, and from number to number inside a sample. An array of structures
// (samples contiguous) has (size, 1); a structure of arrays, whose access is coalesced and fastest, (1, count). An
// input that is the same for all samples has (0, 1). Matrices are in row-major order. Blocks of 128 threads serve well;
// threads beyond the count do nothing.
#pragma once
#include <cstdint>
"""


def _header(export: Export, kernels: _Kernels) -> str:
    """Prototypes, with what each argument is."""
    kind = "float" if export.dtype.name == "float32" else "double"
    lines = [_TOP.format(name=export.name, dtype=kind)]
    for name, (_, text) in kernels.items():
        lines.append(f"// {text['summary']}")
        lines += [f"//   {key}: {value}" for key, value in text["choices"].items()]
        arguments = ["int64_t count"]
        for role, names in (("const ", text["inputs"]), ("", text["outputs"])):
            for port in names:
                shape = " x ".join(map(str, port["shape"])) or "1"
                unit = f" [{port['unit']}]" if port["unit"] else ""
                lines.append(f"//   {port['name']}: {shape}{unit} {port['text']}".rstrip())
                key = port["name"]
                arguments.append(f"{role}{kind}* {key}, int64_t {key}_sample, int64_t {key}_number")
        separator = ",\n    "
        lines.append(f'extern "C" __global__ void {name}(\n    {separator.join(arguments)});\n')
    return "\n".join(lines)
