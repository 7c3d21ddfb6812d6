"""A small notation for writing functions in textual LLVM IR, over scalars or SIMD lanes alike."""

from __future__ import annotations

from collections.abc import Callable
from typing import final

from ulna.compiler.codegen.arithmetic import COMPLETE, Arithmetic
from ulna.compiler.codegen.instructions import Instructions
from ulna.compiler.codegen.ir_text import Lanes


def _arithmetic(opcode: str, result: str) -> Callable[[Body, str | float, str | float], str]:
    """The method of `Body` that appends an instruction of two floating-point operands."""

    def append(self: Body, a: str | float, b: str | float) -> str:
        return self.emit(f"{opcode} {self.lanes.real} {self._float(a)}, {self._float(b)}")

    append.__doc__ = (
        f"The {result} of values in all lanes, given by their names, or numbers; returns its name."
    )
    return append


@final
class Body(Instructions):
    """The lines of one function body; each method appends an instruction and returns its name.

    No instruction carries a fast-math flag: error-free transformations would not survive them.

    Args:
        lanes: The type of the values.
        prefix: What the names of values begin with.
        arithmetic: What the processor computes in one instruction.
    """

    def __init__(self, lanes: Lanes, prefix: str = "t", arithmetic: Arithmetic = COMPLETE) -> None:
        super().__init__()
        self.lanes = lanes
        self.prefix = prefix
        self.is_fused = arithmetic.fused_multiply_add
        self.declarations: dict[str, None] = {}
        self._count = 0

    def emit(self, instruction: str) -> str:
        """Append `%n = instruction`."""
        self._count += 1
        return self.let(f"{self.prefix}{self._count - 1}", instruction)

    def _float(self, value: str | float) -> str:
        return value if isinstance(value, str) else self.lanes.constant(value)

    def _integer(self, value: str | int) -> str:
        return value if isinstance(value, str) else self.lanes.integer_constant(value)

    add = _arithmetic("fadd", "sum a + b")
    sub = _arithmetic("fsub", "difference a - b")
    mul = _arithmetic("fmul", "product a * b")
    div = _arithmetic("fdiv", "quotient a / b")

    def neg(self, a: str) -> str:
        """-a."""
        return self.emit(f"fneg {self.lanes.real} {a}")

    def call(self, intrinsic: str, *arguments: str | float) -> str:
        """The floating-point intrinsic `llvm.<intrinsic>` in all lanes.

        Args:
            intrinsic: Name without `llvm.` and suffix, such as "sqrt".
            *arguments: Names of values in all lanes, or numbers.

        Returns:
            The name of the result.
        """
        real = self.lanes.real
        name = f"@llvm.{intrinsic}.{self.lanes.suffix}"
        self.declarations[f"declare {real} {name}({', '.join([real] * len(arguments))})"] = None
        return self.emit(f"call {real} {name}({', '.join(f'{real} {self._float(a)}' for a in arguments)})")

    def fma(self, a: str | float, b: str | float, c: str | float) -> str:
        """The sum a * b + c, rounded once, or twice where the processor has no such instruction.

        Args:
            a: The name of a value in all lanes, or a number.
            b: The name of a value in all lanes, or a number.
            c: The name of a value in all lanes, or a number.

        Returns:
            The name of the result.
        """
        return self.call("fma", a, b, c) if self.is_fused else self.add(self.mul(a, b), c)

    def cancelling_fma(self, a: str, b: str, c: str) -> str:
        """The sum a * b + c where c nearly cancels the product, whose rounding error matters therefore.

        Without the instruction, for doubles, the error comes from halves of the factors (Dekker 1971).

        Args:
            a: The name of a value in all lanes.
            b: The name of a value in all lanes.
            c: The name of a value in all lanes.

        Returns:
            The name of the result.
        """
        if self.is_fused:
            return self.call("fma", a, b, c)
        product = self.mul(a, b)
        a_high, a_low = self._halves(a)
        b_high, b_low = self._halves(b)
        error = self.sub(self.mul(a_high, b_high), product)
        error = self.add(error, self.mul(a_high, b_low))
        error = self.add(error, self.mul(a_low, b_high))
        error = self.add(error, self.mul(a_low, b_low))
        return self.add(self.add(product, c), error)

    def _halves(self, a: str) -> tuple[str, str]:
        """The upper half of a double's significand, by a mask so that nothing overflows, and the rest."""
        high = self.from_bits(self.integer_op("and", self.to_bits(a), -(1 << 27)))
        return high, self.sub(a, high)

    def fabs(self, a: str) -> str:
        """|a|."""
        return self.call("fabs", a)

    def compare(self, predicate: str, a: str | float, b: str | float) -> str:
        """Fcmp with the given predicate.

        Args:
            predicate: A predicate of LLVM's `fcmp`, such as "ogt".
            a: The name of a value in all lanes, or a number.
            b: The name of a value in all lanes, or a number.

        Returns:
            The name of the truth values.
        """
        return self.emit(f"fcmp {predicate} {self.lanes.real} {self._float(a)}, {self._float(b)}")

    def integer_op(self, opcode: str, a: str | int, b: str | int) -> str:
        """An integer instruction, such as `and`, `shl`, `icmp eq`.

        Args:
            opcode: The instruction, such as "and", "shl", "icmp eq".
            a: The name of an integer value in all lanes, or an integer.
            b: The name of an integer value in all lanes, or an integer.

        Returns:
            The name of the result.
        """
        return self.emit(f"{opcode} {self.lanes.integer} {self._integer(a)}, {self._integer(b)}")

    def select(self, condition: str, a: str | float, b: str | float) -> str:
        """A where condition, else b (floating point).

        Args:
            condition: The name of the truth values.
            a: The name of a value in all lanes, or a number.
            b: The name of a value in all lanes, or a number.

        Returns:
            The name of the result.
        """
        lanes = self.lanes
        return self.emit(
            f"select {lanes.truth} {condition}, {lanes.real} {self._float(a)}, {lanes.real} {self._float(b)}"
        )

    def to_bits(self, a: str) -> str:
        """The bits of a float, as an integer."""
        return self.emit(f"bitcast {self.lanes.real} {a} to {self.lanes.integer}")

    def from_bits(self, a: str) -> str:
        """The float with the bits of an integer."""
        return self.emit(f"bitcast {self.lanes.integer} {a} to {self.lanes.real}")

    def flip_sign(self, a: str, sign: str) -> str:
        """The float a, negated where the top bit of the integer `sign` is set.

        Args:
            a: The name of the floats.
            sign: The name of integers of the same width.

        Returns:
            The name of the result.
        """
        top = self.integer_op("and", sign, -(2 ** (self.lanes.bits - 1)))
        return self.from_bits(self.integer_op("xor", self.to_bits(a), top))

    def any_lane(self, condition: str) -> str:
        """An i1: whether the condition holds in any lane."""
        if self.lanes.lanes == 1:
            return condition
        word = f"i{self.lanes.lanes}"
        packed = self.emit(f"bitcast {self.lanes.truth} {condition} to {word}")
        return self.emit(f"icmp ne {word} {packed}, 0")

    def polynomial(self, z: str, z2: str, coefficients: tuple[float, ...]) -> str:
        """c0 + c1 z + c2 z^2 + ... by pairs, which halves the latency of Horner's form; z2 is z*z.

        Args:
            z: The name of the variable.
            z2: The name of its square.
            coefficients: c0, c1, c2, ...

        Returns:
            The name of the value of the polynomial.
        """
        evens, odds = coefficients[0::2], coefficients[1::2]
        pairs: list[str | float] = [self.fma(b, z, a) for a, b in zip(evens, odds, strict=False)]
        pairs += evens[len(odds) :]
        total = pairs[-1]
        for pair in reversed(pairs[:-1]):
            total = self.fma(total, z2, pair)
        return total if isinstance(total, str) else self._float(total)
