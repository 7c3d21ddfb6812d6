"""Functions whose spelling differs between floats, traced scalars and symbols."""

from ulna.numeric.arrays import apply as apply
from ulna.numeric.arrays import cross as cross
from ulna.numeric.arrays import dot as dot
from ulna.numeric.arrays import matrix as matrix
from ulna.numeric.arrays import skew as skew
from ulna.numeric.arrays import vector as vector
from ulna.numeric.loops import loop as loop
from ulna.numeric.scalars import arctan2 as arctan2
from ulna.numeric.scalars import by_precision as by_precision
from ulna.numeric.scalars import ceil as ceil
from ulna.numeric.scalars import clip as clip
from ulna.numeric.scalars import cos as cos
from ulna.numeric.scalars import erf as erf
from ulna.numeric.scalars import exp as exp
from ulna.numeric.scalars import is_double as is_double
from ulna.numeric.scalars import is_symbolic as is_symbolic
from ulna.numeric.scalars import less as less
from ulna.numeric.scalars import maximum as maximum
from ulna.numeric.scalars import minimum as minimum
from ulna.numeric.scalars import sin as sin
from ulna.numeric.scalars import sincos as sincos
from ulna.numeric.scalars import sqrt as sqrt
from ulna.numeric.scalars import tanh as tanh
from ulna.numeric.scalars import where as where
