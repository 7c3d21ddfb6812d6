"""Checks of the number of arguments of functions for other libraries."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ulna.compiler import Function
from ulna.compiler.language.ports import wrong_count
from ulna.errors import InputError


def check_count(f: Function, arguments: Sequence[Any], named: Sequence[str] = ()) -> None:
    """Refuses another number of arguments than a function has.

    Args:
        f: The function.
        arguments: The arguments.
        named: Names of the arguments that were passed by name; none may be.

    Raises:
        TypeError: If their number differs.
        InputError: If there are named ones.
    """
    names = [p.name for p in f.inputs]
    if named:
        raise InputError(
            f"{f.name}({', '.join(names)}) got `{named[0]}` by name; expected arguments by position."
        )
    if len(arguments) != len(f.inputs):
        raise wrong_count(f.name, names, arguments)
