"""What calls need to know of a procedure that was read before: its types and the hash of its IR, kept on disk.

Only procedures of modules that a package holds, with no variables of an enclosing function, are kept: what they do is
decided by files. The key holds the procedure, its constants, and names, sizes and times of the files of the compiler.
The record says the same of the folders from whose files the procedure was read, and the numbers of modules that it
names; it counts only while these are as they were.
"""

from __future__ import annotations

import functools
import json
import os
import sys
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

from ulna import disk_cache
from ulna.compiler.imperative.types import ArrayType, KernelType, Lanes, Number, RecordType, Type
from ulna.data_classes import dataclass

_COMPILER = Path(__file__).parents[1]


@dataclass(frozen=True)
class Compiled:
    """A procedure, as calls need it.

    Attributes:
        parameters: Names and types.
        results: The types of what it returns.
        writes: The parameters whose arrays it may write to.
        files: The file of each instance, for errors.
        numbers: Module, name and value of the numbers of modules that were read.
        digest: The hash of its LLVM IR, under which its machine code is kept.
    """

    parameters: tuple[tuple[str, Type], ...]
    results: tuple[Number | Lanes, ...]
    writes: frozenset[str]
    files: tuple[str, ...]
    numbers: tuple[tuple[str, str, float], ...]
    digest: str


def key_of(function: Any, *options: Any) -> str | None:
    """The key of a procedure on disk.

    Args:
        function: The Python function.
        *options: What else decides its code.

    Returns:
        The key; None for a function whose code its package's files do not decide.
    """
    if not is_from_package(function):
        return None
    code = function.__code__
    name = f"{function.__module__}.{function.__qualname__}:{code.co_firstlineno}"
    return disk_cache.key("procedure 2", name, code.co_code, repr(options), sys.version, _compiler_state())


def is_from_package(function: Callable[..., Any]) -> bool:
    """Whether a function is what a file of a package says, and nothing else decides what it does."""
    module = sys.modules.get(function.__module__)
    is_packaged = bool(getattr(module, "__package__", ""))
    is_of_file = function.__code__.co_filename == getattr(module, "__file__", "")
    return is_packaged and is_of_file and not function.__closure__ and "<locals>" not in function.__qualname__


def read(key: str) -> Compiled | None:
    """A procedure that was kept.

    Args:
        key: Its key.

    Returns:
        The procedure; None where there is none, or a file that it was read from has changed.
    """
    content = disk_cache.read(key)
    if content is None:
        return None
    record = json.loads(content)
    if any(_state(folder) != state for folder, state in record["folders"].items()):
        return None
    numbers = tuple((module, name, value) for module, name, value in record["numbers"])
    if any(vars(sys.modules.get(module, sys)).get(name) != value for module, name, value in numbers):
        return None
    return Compiled(
        tuple((name, _type(t)) for name, t in record["parameters"]),
        tuple(_type(t) for t in record["results"]),
        frozenset(record["writes"]), tuple(record["files"]), numbers, record["digest"],
    )  # fmt: skip


def write(key: str, compiled: Compiled) -> None:
    """Keeps a procedure.

    Args:
        key: Its key.
        compiled: The procedure.
    """
    folders = {os.path.dirname(file) for file in compiled.files}
    record = {
        "folders": {folder: _state(folder) for folder in folders},
        "parameters": [[name, _text(t)] for name, t in compiled.parameters],
        "results": [_text(t) for t in compiled.results],
        "writes": sorted(compiled.writes), "files": compiled.files, "numbers": compiled.numbers,
        "digest": compiled.digest,
    }  # fmt: skip
    disk_cache.write(key, json.dumps(record).encode())


def numbers_of(functions: Iterable[Callable[..., Any]]) -> tuple[tuple[str, str, float], ...]:
    """The numbers of modules that functions name, which a change elsewhere may change.

    Args:
        functions: Python functions that were read.

    Returns:
        Module, name and value of each.
    """
    return tuple(
        sorted(
            (function.__module__, name, value)
            for function in functions
            for name in function.__code__.co_names
            if isinstance(value := function.__globals__.get(name), bool | int | float)
        )
    )


def _state(*folders: Path | str) -> str:
    """Names, sizes and times of the Python files of folders, as one text."""
    states = []
    try:
        for folder in folders:
            with os.scandir(folder) as entries:
                files = [entry for entry in entries if entry.name.endswith(".py")]
            for name, status in sorted((entry.name, entry.stat()) for entry in files):
                states.append((name, status.st_size, status.st_mtime_ns))
    except OSError:
        return ""
    return disk_cache.key(repr(states))


@functools.cache
def _compiler_state() -> str:
    return _state(*sorted(folder for folder, *_ in os.walk(_COMPILER)))


def _text(type_: Type) -> Any:
    """A type as JSON has it."""
    match type_:
        case Number(name=name):
            return name
        case Lanes(element=element, count=count):
            return {"lanes": [element.name, count]}
        case ArrayType(element=element, rank=rank):
            return {"array": [element.name, rank]}
        case RecordType(name=name, fields=fields):
            return {"record": [name, [[field, _text(kind)] for field, kind in fields]]}
    return {"kernel": type_.ports}


def _type(text: Any) -> Any:
    """The type of which `_text` made JSON."""
    if isinstance(text, str):
        return Number(text)  # type: ignore[arg-type]
    ((kind, value),) = text.items()
    makers: Mapping[str, Any] = {
        "lanes": lambda v: Lanes(Number(v[0]), v[1]),
        "array": lambda v: ArrayType(Number(v[0]), v[1]),
        "record": lambda v: RecordType(v[0], tuple((name, _type(field)) for name, field in v[1])),
        "kernel": KernelType,
    }
    return makers[kind](value)
