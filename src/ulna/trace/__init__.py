"""The tracing compiler: Python functions of arrays become graphs, and graphs become machine code."""

from ulna.trace.function import Function as Function
from ulna.trace.function import Port as Port
from ulna.trace.function import trace as trace
from ulna.trace.kernel import compile as compile
from ulna.trace.kernel import element_of as element_of

__all__ = ["Function", "Port", "compile", "element_of", "trace"]
