"""Chains brought into other forms: neighbours exchanged, merged or written about other axes, joints fixed.

A quarter turn R carries a transform B about another axis across it: R B = (R B R^-1) R.
"""

from __future__ import annotations

import math
from typing import Any, Self

import numpy as np

from roboticstoolbox._common.errors import WrongIndex
from roboticstoolbox._common.numbers import number
from roboticstoolbox._common.symbols import has_symbols, is_nothing, is_symbol, quarter_turns
from ulna.errors import InputError

_LETTERS = "xyz"


def axis_image(about: str, quarters: int, axis: str) -> tuple[str, int]:
    """The axis, and the direction along it, onto which quarter turns about another axis carry an axis.

    Args:
        about: Axis of the turns, "x", "y" or "z".
        quarters: Number of quarter turns.
        axis: The axis that is turned.

    Returns:
        The axis that it becomes, and 1 or -1.
    """
    if about == axis:
        return axis, 1
    i, j = _LETTERS.index(about), _LETTERS.index(axis)
    following = (j - i) % 3 == 1  # whether the turn carries `axis` onto the third axis, not its opposite
    third, steps = _LETTERS[3 - i - j], quarters % 4
    if steps % 2 == 0:
        return axis, 1 - steps
    return third, (1 if following else -1) * (2 - steps)


def carried_across(et: Any, about: str, quarters: int) -> Any:
    """R B R^-1 of a transform B and quarter turns R about an axis.

    Args:
        et: The transform B.
        about: Axis of the turns, "x", "y" or "z".
        quarters: Number of quarter turns.

    Returns:
        The transform R B R^-1.
    """
    letter, sign = axis_image(about, quarters, et.ax)
    out = et._copy()
    out._kind = et.kind[0] + letter
    if sign > 0:
        return out
    if et.isjoint:
        out._flip, out._offset, out._joint_name = not et.isflip, -et.offset, None
    else:
        out._param = -et.param
    return out


class Rewriting:
    """Changes of form of a chain."""

    data: list[Any]
    n: int
    _auto_jindex: bool
    _et: Any

    def _neighbours(self, i: int) -> tuple[Any, Any]:
        if not 0 <= i < len(self.data) - 1:
            raise WrongIndex(
                f"`i` is {i}; the chain has {len(self.data)} transforms, so expected 0 to {len(self.data) - 2}."
            )
        return self.data[i], self.data[i + 1]

    def swap(self, i: int) -> None:
        """Exchanges the transforms at `i` and `i + 1`.

        They commute (about or along one axis, or both shifts), or one of them is a constant quarter turn, across
        which the other one is carried onto another axis.

        Raises:
            InputError: They cannot be exchanged.
            WrongIndex: There are no two transforms at `i`.
        """
        a, b = self._neighbours(i)
        turns = [self._quarter_turns(et) for et in (a, b)]
        if _commute(a, b):
            pair = [b, a]
        elif turns[0] is not None and turns[1] is None and b.iselementary:
            pair = [carried_across(b, a.ax, turns[0]), a]
        elif turns[1] is not None and turns[0] is None and a.iselementary:
            pair = [b, carried_across(a, b.ax, -turns[1])]
        else:
            raise InputError(
                f"{a} and {b} do not commute, and not exactly one of them is a constant quarter turn, so they "
                "cannot be swapped."
            )
        self.data[i : i + 2] = pair

    @staticmethod
    def _quarter_turns(et: Any) -> int | None:
        turns = et.isrotation and not et.isjoint and et.ax is not None
        return quarter_turns(et.param) if turns else None

    def swapped(self, i: int) -> Self:
        """A copy on which `swap` was called."""
        return self._modified_copy("swap", i)

    def merge(self, i: int) -> None:
        """Makes one of the transforms at `i` and `i + 1`, which are about or along the same axis.

        A constant becomes the offset of a joint; two constants that cancel are removed.

        Raises:
            InputError: They are not of one kind, are both joints, or are whole poses.
            WrongIndex: There are no two transforms at `i`.
        """
        a, b = self._neighbours(i)
        if a.kind != b.kind:
            raise InputError(f"{a} and {b} are not of one kind, so they cannot be merged.")
        if not a.iselementary or (a.isjoint and b.isjoint):
            raise InputError(f"{a} and {b} are two joints, or whole poses, so they cannot be merged.")
        one = (a if a.isjoint or not b.isjoint else b)._copy()
        if a.isjoint or b.isjoint:
            one.offset = one.offset + (b.param if a.isjoint else a.param)
            self.data[i : i + 2] = [one]
        elif is_nothing(a.param + b.param, a.isrotation):
            del self.data[i : i + 2]
        else:
            one.param = a.param + b.param
            self.data[i : i + 2] = [one]

    def merged(self, i: int) -> Self:
        """A copy on which `merge` was called."""
        return self._modified_copy("merge", i)

    def _replace(self, i: int, axis: str) -> None:
        if axis not in ("x", "y", "z"):
            raise InputError(f"`axis` is {axis!r}; expected 'x', 'y' or 'z'.")
        if not 0 <= i < len(self.data):
            raise WrongIndex(f"`i` is {i}; the chain has {len(self.data)} transforms.")
        et = self.data[i]
        if not et.iselementary:
            raise InputError(f"{et} is a whole pose, which has no axis to be replaced.")
        if et.ax == axis:
            return
        about = next(letter for letter in _LETTERS if letter not in (et.ax, axis))
        k = 1 if axis_image(about, 1, axis) == (et.ax, 1) else -1
        quarter: Any = math.pi / 2
        if is_symbol(et.param) or is_symbol(et.offset):
            import sympy

            quarter = sympy.pi / 2
        turn, back = (self._et(f"R{about}", sign * quarter) for sign in (k, -k))
        self.data[i : i + 1] = [turn, carried_across(et, about, -k), back]

    def fixjoint(self, j: int, value: float, unit: str = "rad") -> Self:
        """The chain with its `j`th joint fixed at a value.

        Args:
            j: Which of its joints, from 0 along the chain.
            value: Its coordinate [rad or m].
            unit: Of the value, "rad" or "deg"; a sliding joint takes no degrees.

        Returns:
            The new chain.

        Raises:
            InputError: There is no such joint, or the unit is none for it.
        """
        if isinstance(j, bool) or not isinstance(j, int | np.integer) or not 0 <= j < self.n:
            raise InputError(f"`j` is {j!r}; the chain has {self.n} joints, so expected 0 to {self.n - 1}.")
        if unit not in ("rad", "deg"):
            raise InputError(f"`unit` is {unit!r}; expected 'rad' or 'deg'.")
        value = value if has_symbols(value) else number("value", value)
        out, count = [], -1
        for original in self.data:
            et = original._copy()
            out.append(et)
            if not et.isjoint:
                continue
            count += 1
            if count != j:
                et._joint_name, et._jindex = None, None if self._auto_jindex else et.jindex
                continue
            if unit == "deg" and not et.isrotation:
                raise InputError(f"unit='deg' is for joints that turn; {et} slides.")
            constant = math.radians(value) if unit == "deg" else value
            out[-1] = self._et(et.kind, (-constant if et.isflip else constant) + et.offset)
        return type(self)(out)  # type: ignore[call-arg]

    def _modified_copy(self, what: str, *arguments: Any) -> Self:
        out = type(self)(self.data)  # type: ignore[call-arg]
        getattr(out, what)(*arguments)
        return out


def _commute(a: Any, b: Any) -> bool:
    if not (a.iselementary and b.iselementary):
        return False
    return a.kind == b.kind or (a.istranslation and b.istranslation) or (a.ax is not None and a.ax == b.ax)
