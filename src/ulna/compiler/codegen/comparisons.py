"""Minimum and maximum by comparisons, for processors without instructions for them."""

from __future__ import annotations

from typing import Protocol

from ulna.compiler.codegen.ir_text import Lanes


class LaneInstructions(Protocol):
    """What instructions of all lanes are appended to."""

    layout: Lanes

    def fresh(self, hint: str = "t") -> str:
        """A name that is not in use."""
        ...

    def write(self, *instructions: str) -> None:
        """Appends instructions."""
        ...


def extreme(to: LaneInstructions, relation: str, a: str, b: str) -> str:
    """The lesser or greater of two numbers by comparisons, NaN where one is; without a sign of zero.

    Args:
        to: Where instructions are appended.
        relation: "olt" for the lesser, "ogt" for the greater.
        a: The name of a number in all lanes.
        b: The name of a number in all lanes.

    Returns:
        The right side of the instruction that makes the result.
    """
    layout = to.layout
    takes, one, isnan, total = (to.fresh("extreme") for _ in range(4))
    to.write(
        f"{takes} = fcmp {relation} {layout.real} {a}, {b}",
        f"{one} = select {layout.truth} {takes}, {layout.real} {a}, {layout.real} {b}",
        f"{isnan} = fcmp uno {layout.real} {a}, {b}",
        f"{total} = fadd {layout.real} {a}, {b}",
    )
    return f"select {layout.truth} {isnan}, {layout.real} {total}, {layout.real} {one}"


def least_by_comparisons(to: LaneInstructions, value: str) -> str:
    """The smallest number of all lanes, in all lanes, without NaN; each step compares with lanes further on.

    Args:
        to: Where instructions are appended.
        value: The name of a number in each lane.

    Returns:
        The name of the result.
    """
    layout, n = to.layout, to.layout.lanes
    distance = n // 2
    while distance:
        order = ", ".join(f"i32 {(k + distance) % n}" for k in range(n))
        other, less, isnan, takes, least = (to.fresh("least") for _ in range(5))
        to.write(
            f"{other} = shufflevector {layout.real} {value}, {layout.real} poison, <{n} x i32> <{order}>",
            f"{less} = fcmp olt {layout.real} {other}, {value}",
            f"{isnan} = fcmp uno {layout.real} {value}, {value}",
            f"{takes} = or {layout.truth} {less}, {isnan}",
            f"{least} = select {layout.truth} {takes}, {layout.real} {other}, {layout.real} {value}",
        )
        value, distance = least, distance // 2
    return value
