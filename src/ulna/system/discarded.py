"""Methods that return a changed copy warn where it is thrown away: `world.add(...)` as a statement does nothing."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Callable
from functools import wraps
from opcode import opmap
from types import FrameType
from typing import Any, ParamSpec, TypeVar

from ulna.errors import UlnaWarning

_Arguments = ParamSpec("_Arguments")
_Result = TypeVar("_Result")
_UNIT = 2  # bytes of an instruction
_CACHE, _POP_TOP = opmap.get("CACHE"), opmap.get("POP_TOP")


def returns_copy(kind: str) -> Callable[[Callable[_Arguments, _Result]], Callable[_Arguments, _Result]]:
    """Have a method warn where the statement that calls it does nothing with the result.

    Args:
        kind: What it returns a changed copy of, as users call such a variable: "world".

    Returns:
        A decorator: the same method, with the warning.
    """

    def decorate(method: Callable[_Arguments, _Result]) -> Callable[_Arguments, _Result]:
        name = method.__name__

        @wraps(method)
        def call(*args: _Arguments.args, **keywords: _Arguments.kwargs) -> _Result:
            result = method(*args, **keywords)
            if _is_discarded(sys._getframe(1)):
                text = (
                    f"{name} returns a new {kind}, which is thrown away here; the one at hand is as it was. "
                )
                warnings.warn(f"{text}Write `{kind} = {kind}.{name}(...)`.", UlnaWarning, stacklevel=2)
            return result

        return call

    return decorate


def _is_discarded(caller: FrameType) -> bool:
    """Whether the next instruction of a frame throws the result of the call away that it is at."""
    if _CACHE is None or _POP_TOP is None or caller.f_lasti < 0:  # another interpreter, or a later one
        return False
    code: Any = caller.f_code.co_code
    k = caller.f_lasti + _UNIT
    while k < len(code) and code[k] == _CACHE:
        k += _UNIT
    return k < len(code) and code[k] == _POP_TOP
