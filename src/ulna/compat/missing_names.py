"""Errors for names and modules that a compatibility package does not offer."""

from __future__ import annotations

import dis
import sys
from types import FrameType

REFUSAL = "__not_offered__"
"""The attribute of a module without names that says what to use instead."""


def missing_name(module: str, name: str, text: str) -> AttributeError | ImportError:
    """The error for `__getattr__` of a module to raise: of the class that keeps its text.

    `from module import name` replaces the text of an AttributeError, so that it gets an ImportError.

    Args:
        module: Name of the module.
        name: The name that it does not have.
        text: What is missing, and what to use instead.

    Returns:
        The error.
    """
    if not name.startswith("__") and _is_import(sys._getframe(2)):
        return ImportError(text, name=module)
    return AttributeError(text, name=name, obj=None)


def missing_module(module: str) -> ModuleNotFoundError:
    """The error for a module of a library to raise that its compatibility package does not offer.

    Args:
        module: Its name; `__getattr__` of the package says what to use instead.

    Returns:
        The error.
    """
    package, _, name = module.rpartition(".")
    try:
        getattr(sys.modules[package], name)
    except AttributeError as error:
        return ModuleNotFoundError(str(error), name=module)
    raise ValueError(f"{package} offers {name}.")


def _is_import(frame: FrameType) -> bool:
    """Whether the instruction that a frame executes is that of `from module import name`."""
    code = frame.f_code.co_code
    return 0 <= frame.f_lasti < len(code) and dis.opname[code[frame.f_lasti]] == "IMPORT_FROM"
