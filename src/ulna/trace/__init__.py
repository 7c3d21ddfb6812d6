"""The former name of `ulna.compiler`, kept so that existing programs run."""

from ulna.compiler import Function as Function
from ulna.compiler import Port as Port
from ulna.compiler import compile as compile
from ulna.compiler import element_of as element_of
from ulna.compiler import trace as trace

__all__ = ["Function", "Port", "compile", "element_of", "trace"]
