"""The face of Pinocchio over Ulna: its names, its argument shapes, its mutable Data; the mathematics is Ulna's."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from pinocchio import explog as explog
from pinocchio import rpy as rpy
from pinocchio import utils as utils
from pinocchio._anchors import *
from pinocchio._arrays import StdVec as StdVec
from pinocchio._cones import *
from pinocchio._configurations import *
from pinocchio._constraint_cholesky import *
from pinocchio._constraint_derivatives import *
from pinocchio._constraint_dynamics import *
from pinocchio._constraint_jacobians import *
from pinocchio._constraint_pair import *
from pinocchio._constraints import *
from pinocchio._contact_inverse import *
from pinocchio._data import Data as Data
from pinocchio._delassus import *
from pinocchio._derivatives import *
from pinocchio._dynamics import *
from pinocchio._energies import *
from pinocchio._enums import *
from pinocchio._frame import Frame as Frame
from pinocchio._inertia import Inertia as Inertia
from pinocchio._jacobian_dynamics import *
from pinocchio._jacobians import *
from pinocchio._joint_constraints import *
from pinocchio._joints import *
from pinocchio._kinematics import *
from pinocchio._late import LATE, MODULES, late
from pinocchio._masses import *
from pinocchio._model import Model as Model
from pinocchio._motion_derivatives import *
from pinocchio._proximal import *
from pinocchio._reduce import *
from pinocchio._regressors import *
from pinocchio._rotations import AngleAxis as AngleAxis
from pinocchio._rotations import Quaternion as Quaternion
from pinocchio._se3 import SE3 as SE3
from pinocchio._se3 import SE3ToXYZQUAT as SE3ToXYZQUAT
from pinocchio._se3 import SE3ToXYZQUATtuple as SE3ToXYZQUATtuple
from pinocchio._se3 import XYZQUATToSE3 as XYZQUATToSE3
from pinocchio._solvers import *
from pinocchio._symmetric import Symmetric3 as Symmetric3
from pinocchio._urdf import buildModelFromUrdf as buildModelFromUrdf
from pinocchio._urdf import buildModelFromXML as buildModelFromXML
from pinocchio._vectors import Force as Force
from pinocchio._vectors import Motion as Motion
from pinocchio._vectors import classicAcceleration as classicAcceleration
from pinocchio._vectors import seed as seed
from pinocchio._vectors import skew as skew
from pinocchio._vectors import skewSquare as skewSquare
from pinocchio._vectors import unSkew as unSkew
from pinocchio._words import refusal, stands_in_an_import
from pinocchio.explog import *

PINOCCHIO_MAJOR_VERSION, PINOCCHIO_MINOR_VERSION, PINOCCHIO_PATCH_VERSION = 4, 1, 0
WITH_CPPAD = WITH_SDFORMAT = WITH_OPENMP = False
WITH_URDFDOM = WITH_COLLISION = WITH_HPP_FCL = WITH_HPP_FCL_BINDINGS = True
XAxis, YAxis, ZAxis = np.eye(3)
__version__ = "4.1.0"
"""The version of Pinocchio whose names and behaviour this face follows."""

if TYPE_CHECKING:  # a checker shall see what is misspelt
    from pinocchio._typed import *
else:

    def __getattr__(name: str) -> Any:
        if name in LATE or name in MODULES:
            return late(name)
        text = f"module 'pinocchio' (Ulna's face) has no {name!r}. {refusal(name, __dir__())}"
        if not name.startswith("_") and stands_in_an_import():
            raise ImportError(text, name="pinocchio")
        raise AttributeError(text, name=name, obj=None)

    def __dir__() -> list[str]:
        return sorted({*globals(), *LATE, *MODULES})


def checkVersionAtLeast(major: int, minor: int, patch: int) -> bool:
    """Whether the version that this face follows is at least that one."""
    return (major, minor, patch) <= (
        PINOCCHIO_MAJOR_VERSION,
        PINOCCHIO_MINOR_VERSION,
        PINOCCHIO_PATCH_VERSION,
    )


def printVersion(delimiter: str = ".") -> str:
    """The version that this face follows."""
    return delimiter.join(__version__.split("."))
