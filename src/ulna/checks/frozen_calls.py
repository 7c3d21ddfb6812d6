"""Calls in a function that would be made once, when it is compiled: of clocks and of random numbers.

They are found in the bytecode, by what its names stand for: that of the function, and of the functions of the user that
it names. What is called by other ways, such as by an attribute of `self`, is not seen.
"""

from __future__ import annotations

import datetime
import dis
import functools
import os
import random
import sys
import time
import warnings
from collections.abc import Callable, Iterator
from types import CodeType, FunctionType, MethodType, ModuleType
from typing import Any

import numpy as np

from ulna.errors import TraceWarning

_CLOCKS = {
    id(getattr(time, f"{name}{suffix}"))
    for name in ("time", "perf_counter", "monotonic", "process_time", "thread_time")
    for suffix in ("", "_ns")
}
_HARMLESS = {"seed", "getstate", "setstate", "get_state", "set_state", "bit_generator", "spawn"}
_TODAY = {"now", "utcnow", "today"}
_FIRST, _NEXT = {"LOAD_GLOBAL", "LOAD_NAME", "LOAD_DEREF"}, {"LOAD_ATTR", "LOAD_METHOD"}
_NOTHING = {"CACHE", "PRECALL", "PUSH_NULL", "NOP"}
_MODULES, _DATES = {"time", "random", "datetime", "numpy.random"}, (datetime.datetime, datetime.date)
_LIBRARIES = (
    os.path.dirname(os.__file__),
    os.path.dirname(os.path.dirname(np.__file__)),
    os.path.dirname(os.path.dirname(__file__)),
)
"""The folders of Python's own modules, of installed packages, and of this one."""
_MOST_FUNCTIONS = 200  # more are not looked at


def warn_of_frozen_calls(f: Any, stacklevel: int = 3) -> None:
    """Warns where a function that is to be compiled calls a clock or draws random numbers.

    Args:
        f: The function.
        stacklevel: As of `warnings.warn`, seen from here.
    """
    found = list(dict.fromkeys(_frozen_calls(f)))
    if found:
        name = getattr(f, "__name__", "f").strip("<>")
        calls = ", ".join(f"{text}()" for text in found)
        warnings.warn(
            f"`{name}` calls {calls}, which happens once, while it is compiled: the value is a constant of the "
            "kernel. Make the value an argument, and pass it with each call.",
            TraceWarning,
            stacklevel=stacklevel,
        )


def _frozen_calls(f: Any) -> Iterator[str]:
    """What is called, as it is written there."""
    waiting, seen = [f], set[int]()
    while waiting and len(seen) < _MOST_FUNCTIONS:
        function = _plain(waiting.pop())
        if not _is_of_user(function) or id(function.__code__) in seen:
            continue
        seen.add(id(function.__code__))
        for text, value, is_bare_call in _named(function.__code__, _environment(function)):
            if _is_frozen(value) or (is_bare_call and value is _of_numpy("default_rng")):
                yield text
            elif _is_of_user(value := _plain(value)):
                waiting.append(value)


def _of_numpy(name: str) -> Any:
    """What `numpy.random` has of that name, if it was imported; doing so takes 10 ms."""
    return getattr(sys.modules.get("numpy.random"), name, None)


def _is_source(value: Any) -> bool:
    """Whether it is a generator of random numbers."""
    kinds = random.Random, _of_numpy("Generator"), _of_numpy("RandomState")
    return isinstance(value, tuple(kind for kind in kinds if kind is not None))


def _is_of_user(value: Any) -> bool:
    """Whether it is a function in Python that is part of no library."""
    return isinstance(value, FunctionType) and not value.__code__.co_filename.startswith(_LIBRARIES)


def _plain(f: Any) -> Any:
    """The function in partial functions and methods."""
    while isinstance(f, (functools.partial, MethodType)):
        f = f.func if isinstance(f, functools.partial) else f.__func__
    return f


def _environment(function: FunctionType) -> Callable[[str], Any]:
    """What the names of a function stand for, but for arguments and local variables; None where that is not known."""
    closed = dict(zip(function.__code__.co_freevars, function.__closure__ or (), strict=True))

    def find(name: str) -> Any:
        if (cell := closed.get(name)) is None:
            return function.__globals__.get(name)
        try:
            return cell.cell_contents
        except ValueError:  # not assigned yet
            return None

    return find


def _named(code: CodeType, find: Callable[[str], Any]) -> Iterator[tuple[str, Any, bool]]:
    """Names, with attributes such as `np.random.rand`, what they stand for, and whether called with no arguments."""
    if any(_is_of_interest(find(name), code) for name in (*code.co_names, *code.co_freevars)):
        text, value = "", None
        for step in dis.get_instructions(code):
            if step.opname in _NOTHING:
                continue
            if text and step.opname in _NEXT:
                text, value = f"{text}.{step.argval}", _attribute(value, step.argval)
                continue
            if text:
                yield text, value, step.opname.startswith("CALL") and step.arg == 0
            text = step.argval if step.opname in _FIRST else ""
            value = find(text)
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _named(constant, find)


def _is_of_interest(value: Any, code: CodeType) -> bool:
    """Whether what is looked for may be this, or an attribute of it: most functions name nothing of the kind."""
    if value is np:
        return "random" in code.co_names
    if isinstance(value, ModuleType):
        return value.__name__ in _MODULES or not (getattr(value, "__file__", None) or "").startswith(
            _LIBRARIES
        )
    known = _is_source(value) or any(value is date for date in _DATES)
    return known or _is_frozen(value) or _is_of_user(_plain(value))


def _attribute(value: Any, name: str) -> Any:
    """An attribute, of those things only whose attributes are no code of the user."""
    if isinstance(value, ModuleType) or _is_source(value) or any(value is date for date in _DATES):
        return getattr(value, name, None)
    return None


def _is_frozen(value: Any) -> bool:
    """Whether it is a function of the time, or one that draws random numbers."""
    owner, name = getattr(value, "__self__", None), getattr(value, "__name__", "")
    if any(owner is date for date in _DATES):
        return name in _TODAY
    return id(value) in _CLOCKS or (_is_source(owner) and name not in _HARMLESS)
