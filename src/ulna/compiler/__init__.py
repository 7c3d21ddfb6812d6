"""The tracing compiler: Python functions of arrays become graphs, and graphs become machine code.

What makes machine code is imported when first used: who looks at a model does not wait for it.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from ulna.compiler.language.function import Function as Function
from ulna.compiler.language.function import trace as trace
from ulna.compiler.language.packing import Pattern as Pattern
from ulna.compiler.language.ports import Port as Port

if TYPE_CHECKING:
    from ulna.compiler.runtime.kernel import KernelBase as KernelBase
    from ulna.compiler.runtime.kernel import compile as compile
    from ulna.compiler.runtime.kernel import element_of as element_of

__all__ = ["Function", "KernelBase", "Pattern", "Port", "compile", "element_of", "trace"]


def __getattr__(name: str) -> Any:
    if name not in ("KernelBase", "compile", "element_of"):
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module("ulna.compiler.runtime.kernel"), name)
