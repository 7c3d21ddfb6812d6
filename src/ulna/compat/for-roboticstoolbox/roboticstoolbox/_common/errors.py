"""Errors of Ulna that are, at the same time, of the class that the Toolbox raises in their place."""

from __future__ import annotations

from ulna.errors import InputError, UnknownName


class UnknownOption(UnknownName, ValueError):
    """An argument that names one of several choices names none of them."""


class WrongType(InputError, TypeError):
    """An argument has a type that cannot be used."""


class WrongIndex(InputError, IndexError):
    """There is nothing at that index."""
