"""What calls need to know of a procedure that was read before: its types and the hash of its IR, kept on disk.

Only procedures of modules that a package holds, with no variables of an enclosing function, are kept: what they do is
decided by files. The key holds the procedure, its constants, and names, sizes and times of the files of the compiler.
The record says the same of the folders from whose files the procedure was read, and what the names of modules stood for
that it uses: numbers, functions, procedures and types. It counts only while these are as they were.
"""

from __future__ import annotations

import builtins
import functools
import json
import os
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ulna import disk_cache
from ulna.compiler.imperative.source import Definition
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
        names: Module, dotted name and text of what names of modules stood for; see `texts_of`.
        digest: The hash of its LLVM IR, under which its machine code is kept.
    """

    parameters: tuple[tuple[str, Type], ...]
    results: tuple[Number | Lanes, ...]
    writes: frozenset[str]
    files: tuple[str, ...]
    names: tuple[tuple[str, str, str], ...]
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
    return disk_cache.key("procedure 3", name, code.co_code, repr(options), sys.version, _compiler_state())


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
    names = tuple((module, name, text) for module, name, text in record["names"])
    if any(_text_of(_stands_for(module, name)) != text for module, name, text in names):
        return None
    return Compiled(
        tuple((name, _type(t)) for name, t in record["parameters"]),
        tuple(_type(t) for t in record["results"]),
        frozenset(record["writes"]), tuple(record["files"]), names, record["digest"],
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
        "writes": sorted(compiled.writes), "files": compiled.files, "names": compiled.names,
        "digest": compiled.digest,
    }  # fmt: skip
    disk_cache.write(key, json.dumps(record).encode())


def texts_of(outside: Mapping[tuple[str, str], Any]) -> tuple[tuple[str, str, str], ...]:
    """What names of modules stood for when a procedure was read, which a change elsewhere may change.

    Args:
        outside: The objects, by module and dotted name.

    Returns:
        Module, dotted name, and a text that is another for another number, function, procedure or record.
    """
    return tuple(sorted((module, name, _text_of(value)) for (module, name), value in outside.items()))


def _text_of(value: Any) -> str:
    if isinstance(value, bool | int | float | np.generic):
        return f"{type(value).__name__} {value!r}"
    options = ""
    if isinstance(value, Definition):
        value, options = value.function, f"{value.contract} {sorted(value.constants)}"
    elif hasattr(value, "_fields"):
        options = repr(vars(value).get("__annotations__"))
    name = getattr(value, "__qualname__", None) or getattr(value, "__name__", type(value).__name__)
    return f"{getattr(value, '__module__', '')} {name} {options}"


def _stands_for(module: str, name: str) -> Any:
    """What a dotted name of a module stands for; None where it stands for nothing."""
    first, *others = name.split(".")
    names = vars(sys.modules[module]) if module in sys.modules else {}
    value = names.get(first, vars(builtins).get(first))
    for other in others:
        value = getattr(value, other, None)
    return value


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
