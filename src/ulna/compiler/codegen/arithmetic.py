"""What a processor computes in one instruction, and so which form of the elementary functions is written for it."""

from __future__ import annotations

from typing import final

from ulna.data_classes import dataclass


@final
@dataclass(frozen=True)
class Arithmetic:
    """The instructions of a processor that code relies on where it has them.

    Attributes:
        fused_multiply_add: Whether a product and a sum may become one instruction that rounds once.
        wide_integers: Whether the product of two 64-bit integers has 128 bits.
        minimum_number: Whether the lesser of two numbers, where one may be NaN, is an instruction.
        minimum: Whether LLVM has code for the lesser and the greater of two numbers, which are NaN where one is.
        double_precision: Whether it computes with float64, which else a library does.
    """

    fused_multiply_add: bool = True
    wide_integers: bool = True
    minimum_number: bool = True
    minimum: bool = True
    double_precision: bool = True


COMPLETE = Arithmetic()
"""A processor that has all of them, such as the one that Ulna runs on."""
