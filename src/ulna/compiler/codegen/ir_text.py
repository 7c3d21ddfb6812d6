"""Types, lanes and functions in textual LLVM IR."""

from __future__ import annotations

import struct
from math import isnan
from typing import Literal, final

from ulna.data_classes import dataclass

DType = Literal["double", "float"]
BYTES = {"double": 8, "float": 4}


@final
@dataclass(frozen=True)
class IRFunction:
    """One function in textual LLVM IR.

    Attributes:
        name: the function's name without the leading `@`.
        text: its definition, to be written once in a module.
        declarations: what the definition needs at module level (`declare` lines, constants, helpers);
            several functions may need the same ones, and each is to be written once in a module.

    """

    name: str
    text: str
    declarations: tuple[str, ...]


def bits_of(value: float, dtype: DType) -> int:
    """The bits of the float nearest to `value`, as an integer.

    Args:
        value: The number; rounded to single precision for "float".
        dtype: "double" or "float".

    Returns:
        The bits as a signed integer of 64 or 32 bits.
    """
    if dtype == "double":
        return struct.unpack("<q", struct.pack("<d", value))[0]
    return struct.unpack("<i", struct.pack("<f", value))[0]


@final
@dataclass(frozen=True)
class Lanes:
    """The types of `lanes` values of one floating-point format: a scalar when `lanes` is 1, else a vector."""

    lanes: int
    dtype: DType

    def __post_init__(self) -> None:
        if self.lanes < 1 or self.dtype not in ("double", "float"):
            raise ValueError(
                f"lanes={self.lanes!r}, dtype={self.dtype!r}: lanes >= 1 of double or float expected"
            )

    @property
    def bits(self) -> int:
        """The width of one value [bit]."""
        return 64 if self.dtype == "double" else 32

    @property
    def suffix(self) -> str:
        """As LLVM spells the type in intrinsic names: f64, v8f64, f32, v16f32."""
        return ("" if self.lanes == 1 else f"v{self.lanes}") + f"f{self.bits}"

    def of(self, element: str) -> str:
        """The type of `lanes` elements."""
        return element if self.lanes == 1 else f"<{self.lanes} x {element}>"

    @property
    def real(self) -> str:
        """The floating-point type."""
        return self.of(self.dtype)

    @property
    def integer(self) -> str:
        """The integer type of the same width."""
        return self.of(f"i{self.bits}")

    @property
    def truth(self) -> str:
        """The type of a comparison."""
        return self.of("i1")

    @property
    def pair(self) -> str:
        """The type of a function that returns two values."""
        return f"{{ {self.real}, {self.real} }}"

    def constant(self, value: float) -> str:
        """The floating-point literal; `value` must be representable in the format.

        Raises:
            ValueError: for a value that the format would round.

        """
        if (
            self.dtype == "float"
            and not isnan(value)
            and value != struct.unpack("<f", struct.pack("<f", value))[0]
        ):
            raise ValueError(f"{value!r} is not a float32")
        literal = f"0x{struct.unpack('<Q', struct.pack('<d', value))[0]:016X}"
        return literal if self.lanes == 1 else f"splat ({self.dtype} {literal})"

    def numbers(self) -> str:
        """The literal of each lane's own number: 0, 1, 2, ..."""
        if self.lanes == 1:
            return "0.0"
        return "<" + ", ".join(f"{self.dtype} {float(k)}" for k in range(self.lanes)) + ">"

    def integer_constant(self, value: int) -> str:
        """The integer literal."""
        return str(value) if self.lanes == 1 else f"splat (i{self.bits} {value})"


def truth(layout: Lanes, value: bool) -> str:
    """The literal of a truth value in all lanes.

    Args:
        layout: The lanes.
        value: The truth value.

    Returns:
        The literal.
    """
    word = "true" if value else "false"
    return word if layout.lanes == 1 else f"splat (i1 {word})"


def local_array(name: str, kind: str, count: int, space: int) -> list[str]:
    """Instructions that make a local array; where it lies in a memory apart, with a general address.

    Args:
        name: The name of its address, without its sign.
        kind: LLVM type of the items.
        count: How many there are.
        space: The address space of local arrays.

    Returns:
        The lines.
    """
    if space == 0:
        return [f"  %{name} = alloca {kind}, i64 {count}"]
    return [
        f"  %{name}.local = alloca {kind}, i64 {count}, addrspace({space})",
        f"  %{name} = addrspacecast ptr addrspace({space}) %{name}.local to ptr",
    ]
