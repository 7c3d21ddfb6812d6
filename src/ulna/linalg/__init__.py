"""Small dense linear algebra on floats, symbols and traced scalars alike."""

from ulna.linalg.orthogonal import orthogonalise, pseudoinverse, volume, volume_of
from ulna.linalg.systems import (
    cholesky,
    determinant,
    inverse,
    ldl,
    reciprocal_above,
    solve,
    solve_damped,
    solve_spd,
)

__all__ = [
    "cholesky",
    "determinant",
    "inverse",
    "ldl",
    "orthogonalise",
    "pseudoinverse",
    "reciprocal_above",
    "solve",
    "solve_damped",
    "solve_spd",
    "volume",
    "volume_of",
]
