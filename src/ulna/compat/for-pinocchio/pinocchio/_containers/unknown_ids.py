"""Indices of names that do not exist: the count of what there is, as in Pinocchio, remembering the name."""

from __future__ import annotations

from collections.abc import Iterable
from typing import final

from ulna.errors import InputError, UnknownName


@final
class UnknownIdError(UnknownName, InputError, IndexError):
    """An index stands for a name that does not exist; the nearest names are offered."""


@final
class UnknownId(int):
    """The index of an unknown name: one above the last, so that `model.getFrameId(name) < model.nframes` is False.

    Attributes:
        kind: What was looked for, such as "frame".
        name: The name that does not exist.
        choices: The names that there are.
        fix: How to avoid the error.
    """

    kind: str
    name: str
    choices: tuple[str, ...]
    fix: str

    @classmethod
    def of(cls, count: int, kind: str, name: str, choices: Iterable[str], fix: str) -> UnknownId:
        """The index of an unknown name among others.

        Args:
            count: How many there are of all types, the index.
            kind: What was looked for, such as "frame".
            name: The name that does not exist.
            choices: The names that there are, of that type.
            fix: How to avoid the error.

        Returns:
            The index.
        """
        out = cls(count)
        out.kind, out.name, out.choices, out.fix = kind, name, tuple(choices), fix
        return out

    def error(self) -> UnknownIdError:
        """The error to raise where the index is used."""
        return UnknownIdError(self.kind, self.name, self.choices, self.fix)


def known(index: int) -> int:
    """An index, if it is not that of an unknown name.

    Args:
        index: What a search for a name returned.

    Returns:
        The same index.

    Raises:
        UnknownIdError: It is one.
    """
    if isinstance(index, UnknownId):
        raise index.error()
    return index
