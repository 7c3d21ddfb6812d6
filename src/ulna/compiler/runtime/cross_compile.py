"""Code for other processors, generated in a child process: LLVM ends a process in which a back end fails.

The child reads what to compile from its standard input, a line of JSON and then IR, and writes the result to its
standard output.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from typing import Literal

from ulna import disk_cache
from ulna.compiler.codegen.target import Target
from ulna.compiler.runtime.jit import llvm_library, optimised, passes_for
from ulna.errors import CompileError, InputError

Format = Literal["object", "assembly"]
_RECIPE = "cross 3"
_START = "from ulna.compiler.runtime.cross_compile import compile_standard_input; compile_standard_input()"
_TIMEOUT = 1800.0  # s; a guard against a back end that never ends


def cross_compile(
    ir: str, target: Target, has_loops: bool, output: Format = "object", position_independent: bool = True
) -> bytes:
    """The object file, or the assembly text, that IR becomes for another processor; kept in the disk cache.

    Args:
        ir: The text of an LLVM module.
        target: The processor.
        has_loops: Whether it has loops, which all of level 1 is used for.
        output: "object" or "assembly".
        position_independent: Whether the code may lie anywhere, as in shared libraries.

    Returns:
        The bytes of the file.

    Raises:
        InputError: If LLVM does not know the name of the processor or of an extension.
        CompileError: If LLVM does not know the triple, or cannot generate the code.
    """
    order = {
        "triple": target.triple,
        "cpu": target.cpu,
        "features": target.features,
        "abi": target.abi,
        "has_loops": has_loops,
        "output": output,
        "reloc": "pic" if position_independent else "static",
    }
    head = json.dumps(order)
    version = ".".join(map(str, llvm_library().llvm_version_info))
    key = disk_cache.key(ir, head, version, _RECIPE)
    content = disk_cache.read(key)
    if content is None:
        content = _by_child(head, ir, target)
        disk_cache.write(key, content)
    return content


def _by_child(head: str, ir: str, target: Target) -> bytes:
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(p or os.getcwd() for p in sys.path)}
    try:
        child = subprocess.run(
            [sys.executable, "-c", _START],
            input=f"{head}\n{ir}".encode(),
            capture_output=True,
            env=environment,
            timeout=_TIMEOUT,
            check=False,
        )
    except subprocess.TimeoutExpired:
        raise CompileError(f"LLVM did not end within {_TIMEOUT:.0f} s for {target.triple}.") from None
    said = child.stderr.decode("utf-8", "replace").strip().splitlines()
    unknown = next((line for line in said if "is not a recognized" in line), None)
    if unknown is not None:
        raise InputError(
            f"LLVM does not know a name: {unknown}. Its names for {target.triple} are listed by "
            f"`llc -mtriple={target.triple} -mcpu=help`."
        )
    if child.returncode != 0 or not child.stdout:
        reason = said[-1] if said else f"it ended with code {child.returncode}"
        raise CompileError(
            f"LLVM generates no code for the processor {target.triple!r} (cpu {target.cpu!r}, features "
            f"{target.features!r}): {reason}"
        )
    return child.stdout


def compile_standard_input() -> None:
    """What the child does."""
    head, _, ir = sys.stdin.buffer.read().decode().partition("\n")
    order = json.loads(head)
    llvm = llvm_library()
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    try:
        machine = llvm.Target.from_triple(order["triple"]).create_target_machine(
            cpu=order["cpu"],
            features=order["features"],
            opt=2,
            reloc=order["reloc"],
            codemodel="default",
            abiname=order["abi"],
        )
        module = optimised(ir, passes_for(ir, order["has_loops"]), machine)
    except (RuntimeError, CompileError) as error:
        sys.exit(str(error).strip())
    made = (
        machine.emit_object(module) if order["output"] == "object" else machine.emit_assembly(module).encode()
    )
    sys.stdout.buffer.write(made)
    sys.stdout.buffer.flush()
    os._exit(0)  # nothing is left to do, and LLVM needs no tearing down
