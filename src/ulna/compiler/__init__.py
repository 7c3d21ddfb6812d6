"""The tracing compiler: Python functions of arrays become graphs, and graphs become machine code.

Each file is imported when one of its names is first used: who looks at a model does not wait for it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ulna.system.deferred_names import deferred_names

if TYPE_CHECKING:
    from ulna.compiler.language.function import Function as Function
    from ulna.compiler.language.function import trace as trace
    from ulna.compiler.language.methods.packing import Pattern as Pattern
    from ulna.compiler.language.ports import Port as Port
    from ulna.compiler.runtime.kernel import KernelBase as KernelBase
    from ulna.compiler.runtime.kernel import compile as compile
    from ulna.compiler.runtime.kernel import element_of as element_of

_FILES = {
    "Function": "language.function",
    "KernelBase": "runtime.kernel",
    "Pattern": "language.methods.packing",
    "Port": "language.ports",
    "compile": "runtime.kernel",
    "element_of": "runtime.kernel",
    "trace": "language.function",
}
"""The file of each public name."""

__all__ = ["Function", "KernelBase", "Pattern", "Port", "compile", "element_of", "trace"]

__getattr__ = deferred_names(__name__, _FILES)
