"""The tracing compiler: Python functions of arrays become graphs, and graphs become machine code."""

from ulna.compiler.language.function import Function as Function
from ulna.compiler.language.function import trace as trace
from ulna.compiler.language.ports import Port as Port
from ulna.compiler.runtime.kernel import KernelBase as KernelBase
from ulna.compiler.runtime.kernel import compile as compile
from ulna.compiler.runtime.kernel import element_of as element_of

__all__ = ["Function", "KernelBase", "Port", "compile", "element_of", "trace"]
