"""Procedures: restricted Python with loops, branches, arrays and lanes, compiled to machine code.

`procedure` is the decorator, `lanes_kernel` compiles a traced function for procedures to call, and the rest are the
types and functions of the language. See docs/compiler.md.
"""

from ulna.compiler.imperative.operations import (
    all_of,
    any_of,
    broadcast,
    count_of,
    first_of,
    greatest_of,
    lane_numbers,
    least_of,
    sum_of,
)
from ulna.compiler.imperative.types import Array1, Array2, Array3, Kernel, f32, f64
from ulna.compiler.runtime.aligned import aligned
from ulna.compiler.runtime.lanes_kernel import lanes_kernel
from ulna.compiler.runtime.procedure import Procedure, procedure

__all__ = [
    "Array1", "Array2", "Array3", "Kernel", "Procedure", "aligned", "all_of", "any_of", "broadcast", "count_of", "f32",
    "f64", "first_of", "greatest_of", "lane_numbers", "lanes_kernel", "least_of", "procedure", "sum_of",
]  # fmt: skip
