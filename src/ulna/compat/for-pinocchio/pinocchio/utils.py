"""Small helpers of the tutorials: today's spelling and the historic one."""

from __future__ import annotations

from typing import Any

import numpy as np

from pinocchio._containers.arrays import StdVec
from pinocchio._containers.typed_lists import typed_list
from pinocchio._spatial.motion_force import skew
from pinocchio._spatial.random_numbers import generator
from pinocchio._spatial.se3 import SE3ToXYZQUAT as se3ToXYZQUAT
from pinocchio._spatial.se3 import SE3ToXYZQUATtuple as se3ToXYZQUATtuple
from pinocchio._spatial.se3 import XYZQUATToSE3 as XYZQUATToSe3
from pinocchio.rpy import matrixToRpy, rotate, rpyToMatrix
from ulna.typing import Floats

npl = np.linalg


def eye(n: int) -> Floats:
    """The identity matrix."""
    return np.eye(n)


def zero(n: Any) -> Floats:
    """A vector of zeros, or a matrix for a shape such as [6, 4]."""
    return np.zeros(n)


def rand(n: Any) -> Floats:
    """A random vector, or a matrix for a shape such as [6, 4]; entries from [0, 1)."""
    return generator().random(n)


def cross(a: Any, b: Any) -> Floats:
    """The cross product of two 3-vectors.

    Args:
        a: Vector, (3,).
        b: Vector, (3,).

    Returns:
        Vector (3,).
    """
    return np.cross(np.ravel(a), np.ravel(b))


def isapprox(a: Any, b: Any, epsilon: float = 1e-6) -> bool:
    """Whether two arrays, SE3, Motions or numbers are nearly equal.

    Args:
        a: The first.
        b: The second.
        epsilon: Tolerance relative to the second, besides 1e-8 [-].

    Returns:
        Whether they are.
    """
    first, second = (np.asarray(getattr(x, "np", x), dtype=float) for x in (a, b))
    return bool(np.allclose(first, second, epsilon))


def mprint(M: Any, name: str = "ans", eps: float = 1e-15) -> None:
    """Prints a matrix as Matlab does, six columns at a time.

    Args:
        M: Matrix (m, n), or an SE3.
        name: Name to print.
        eps: Entries below it are printed as 0 [any].
    """
    array = np.atleast_2d(np.asarray(getattr(M, "homogeneous", M), dtype=float))
    sizes = np.abs(array[array != 0.0])
    wide = sizes.size > 0 and (sizes.min() < 1e-5 or sizes.max() > 1e6 or sizes.max() / sizes.min() > 1e3)
    print(f"{name}  = \n")
    for first in range(0, array.shape[1], 6):
        block = array[:, first : first + 6]
        print(f"Columns {first} through {first + block.shape[1] - 1}\n")
        for row in block:
            print("  " + "".join(_word(x, eps, wide) for x in row))
        print()


def _word(x: float, eps: float, wide: bool) -> str:
    if abs(x) <= eps:
        return " 0" + " " * 9
    return (f"{x: 10.3e}" if wide else f"{x: 1.5f}") + "   "


def npToTTuple(M: Any) -> tuple[tuple[float, ...], ...]:
    """A matrix as a tuple of tuples."""
    return tuple(tuple(float(x) for x in row) for row in np.asarray(M))


def npToTuple(M: Any) -> Any:
    """A vector as a tuple; a matrix as a tuple of tuples."""
    array = np.asarray(M)
    if array.ndim == 1 or 1 in array.shape:
        return tuple(float(x) for x in array.ravel())
    return npToTTuple(array)


def fromListToVectorOfString(items: Any) -> StdVec[str]:
    """A `StdVec_StdString` of texts."""
    return typed_list("StdVec_StdString", "str")([*items])


__all__ = [
    "XYZQUATToSe3",
    "cross",
    "eye",
    "fromListToVectorOfString",
    "isapprox",
    "matrixToRpy",
    "mprint",
    "np",
    "npToTTuple",
    "npToTuple",
    "npl",
    "rand",
    "rotate",
    "rpyToMatrix",
    "se3ToXYZQUAT",
    "se3ToXYZQUATtuple",
    "skew",
    "zero",
]
