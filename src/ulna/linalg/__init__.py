"""Small dense linear algebra on floats, symbols and traced scalars alike."""

from ulna.linalg.orthogonal import orthogonalise as orthogonalise
from ulna.linalg.orthogonal import pseudoinverse as pseudoinverse
from ulna.linalg.orthogonal import volume as volume
from ulna.linalg.orthogonal import volume_of as volume_of
from ulna.linalg.systems import cholesky as cholesky
from ulna.linalg.systems import determinant as determinant
from ulna.linalg.systems import inverse as inverse
from ulna.linalg.systems import ldl as ldl
from ulna.linalg.systems import reciprocal_above as reciprocal_above
from ulna.linalg.systems import solve as solve
from ulna.linalg.systems import solve_damped as solve_damped
from ulna.linalg.systems import solve_spd as solve_spd
