"""Errors of Ulna that are, at the same time, of the class that the Toolbox raises in their place."""

from __future__ import annotations

from numpy.linalg import LinAlgError

from ulna.errors import FormatError, InputError, ShapeError, UnknownName


class UnknownOption(UnknownName, ValueError):
    """An argument that names one of several choices names none of them."""


class WrongType(InputError, TypeError):
    """An argument has a type that cannot be used."""


class WrongIndex(InputError, IndexError):
    """There is nothing at that index."""


class WrongShape(ShapeError, TypeError):
    """An array has the wrong shape, or what was passed is no array of numbers."""


class SingularInertia(InputError, LinAlgError):
    """The inertia matrix has no inverse, so torques determine no accelerations."""


class MissingFile(FormatError, FileNotFoundError):
    """There is no such file."""


class UnknownKey(UnknownName, KeyError, ValueError):
    """There is nothing of that name: a link of a robot, a setting, a solver."""

    __str__ = Exception.__str__  # that of KeyError prints the message in quotes
