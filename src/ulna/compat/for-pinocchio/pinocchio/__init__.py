"""Pinocchio's names, argument shapes and mutable Data on Ulna, which does the mathematics."""

from __future__ import annotations

from typing import TYPE_CHECKING as _TYPE_CHECKING
from typing import Any as _Any

import numpy as _np

from pinocchio import explog as explog
from pinocchio import rpy as rpy
from pinocchio import utils as utils
from pinocchio._algorithms.all_terms import *
from pinocchio._algorithms.center_of_mass import *
from pinocchio._algorithms.configurations import *
from pinocchio._algorithms.dynamics import *
from pinocchio._algorithms.dynamics_derivatives import *
from pinocchio._algorithms.energy import *
from pinocchio._algorithms.frame_motions import *
from pinocchio._algorithms.jacobians import *
from pinocchio._algorithms.kinematics import *
from pinocchio._algorithms.kinematics_derivatives import *
from pinocchio._algorithms.model_editing import *
from pinocchio._algorithms.regressors import *
from pinocchio._constraints.admm import *
from pinocchio._constraints.admm_settings import *
from pinocchio._constraints.anchors import *
from pinocchio._constraints.cholesky import *
from pinocchio._constraints.cones import *
from pinocchio._constraints.constraint_model import *
from pinocchio._constraints.contact_inverse_dynamics import *
from pinocchio._constraints.conversion import *
from pinocchio._constraints.delassus import *
from pinocchio._constraints.delassus_of_cholesky import *
from pinocchio._constraints.dynamics import *
from pinocchio._constraints.dynamics_derivatives import *
from pinocchio._constraints.frame_pair import *
from pinocchio._constraints.gauss_seidel import *
from pinocchio._constraints.gauss_seidel_stats import *
from pinocchio._constraints.jacobian_dynamics import *
from pinocchio._constraints.jacobians import *
from pinocchio._constraints.joint_constraints import *
from pinocchio._constraints.proximal_settings import *
from pinocchio._constraints.rigid_constraint import *
from pinocchio._constraints.rigid_constraint_model import *
from pinocchio._containers.arguments import ArgumentError as _ArgumentError
from pinocchio._containers.arguments import check_methods as _check_methods
from pinocchio._containers.arguments import check_size as _check_size
from pinocchio._containers.arguments import checked_functions as _checked_functions
from pinocchio._containers.arrays import StdVec as StdVec
from pinocchio._containers.documentation import describe_all as _describe_all
from pinocchio._containers.enums import *
from pinocchio._data.data import Data as Data
from pinocchio._model.frame import Frame as Frame
from pinocchio._model.joint_compositions import *
from pinocchio._model.joint_kinds import *
from pinocchio._model.model import Model as Model
from pinocchio._package.coal_poses import watch_coal as _watch_coal
from pinocchio._package.former_modules import register_former_modules as _register_former_modules
from pinocchio._package.lazy_names import lazy_names as _lazy_names
from pinocchio._package.lazy_names import load_lazy_name as _load_lazy_name
from pinocchio._package.unsupported_names import unsupported_name_message as _message
from pinocchio._parsers.urdf import buildModelFromUrdf as buildModelFromUrdf
from pinocchio._parsers.urdf import buildModelFromXML as buildModelFromXML
from pinocchio._spatial.direct_calls import call_small_objects_directly as _call_small_objects_directly
from pinocchio._spatial.inertia import Inertia as Inertia
from pinocchio._spatial.motion_force import Force as Force
from pinocchio._spatial.motion_force import Motion as Motion
from pinocchio._spatial.motion_force import classicAcceleration as classicAcceleration
from pinocchio._spatial.motion_force import skew as skew
from pinocchio._spatial.motion_force import skewSquare as skewSquare
from pinocchio._spatial.motion_force import unSkew as unSkew
from pinocchio._spatial.random_numbers import seed as seed
from pinocchio._spatial.rotations import AngleAxis as AngleAxis
from pinocchio._spatial.rotations import Quaternion as Quaternion
from pinocchio._spatial.se3 import SE3 as SE3
from pinocchio._spatial.se3 import SE3ToXYZQUAT as SE3ToXYZQUAT
from pinocchio._spatial.se3 import SE3ToXYZQUATtuple as SE3ToXYZQUATtuple
from pinocchio._spatial.se3 import XYZQUATToSE3 as XYZQUATToSE3
from pinocchio._spatial.symmetric3 import Symmetric3 as Symmetric3
from pinocchio.explog import *
from ulna.compat.missing_names import missing_name as _missing_name

_register_former_modules()
_watch_coal()
_call_small_objects_directly()
globals().update(_checked_functions(globals()))
_check_methods(list(globals().values()))
_describe_all([*globals().values()])
PINOCCHIO_MAJOR_VERSION, PINOCCHIO_MINOR_VERSION, PINOCCHIO_PATCH_VERSION = 4, 1, 0
WITH_CPPAD = WITH_SDFORMAT = WITH_OPENMP = False
WITH_URDFDOM = WITH_COLLISION = WITH_HPP_FCL = WITH_HPP_FCL_BINDINGS = True
XAxis, YAxis, ZAxis = _np.eye(3)
__version__ = __raw_version__ = "4.1.0"
"""The version of Pinocchio whose names and behaviour this package follows."""

if _TYPE_CHECKING:  # a checker shall see what is misspelt
    from pinocchio._package.lazy_exports import *
else:

    def __getattr__(name: str) -> _Any:
        if name in _lazy_names():
            return globals().setdefault(name, _load_lazy_name(name))
        text = f"module 'pinocchio' (Ulna's) has no {name!r}. {_message(name, __dir__())}"
        raise _missing_name("pinocchio", name, text)

    del annotations

    def __dir__() -> list[str]:
        return sorted({*globals(), *_lazy_names()})


def checkVersionAtLeast(major: int, minor: int, patch: int) -> bool:
    """Whether the version that this package follows is at least that one.

    Args:
        major: First number of the version.
        minor: Second number.
        patch: Third number.

    Returns:
        Whether it is.
    """
    for name, number in {"major": major, "minor": minor, "patch": patch}.items():
        _check_size(number, name, 2**32)
    return (major, minor, patch) <= (
        PINOCCHIO_MAJOR_VERSION,
        PINOCCHIO_MINOR_VERSION,
        PINOCCHIO_PATCH_VERSION,
    )


def printVersion(delimiter: str = ".") -> str:
    """The version that this package follows."""
    if not isinstance(delimiter, str):
        raise _ArgumentError(f"printVersion: `delimiter` is {delimiter!r}; expected text.")
    return delimiter.join(__version__.split("."))
