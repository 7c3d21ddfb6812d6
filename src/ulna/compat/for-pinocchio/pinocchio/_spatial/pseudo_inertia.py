"""PseudoInertia and LogCholeskyParameters: two more ways to write the inertia of a body, for identification."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Any, final

import numpy as np

from pinocchio._containers.arguments import ArgumentError
from pinocchio._containers.arrays import matrix, real, text, vector
from pinocchio._containers.files import registered
from pinocchio._containers.keywords import by_name
from pinocchio._spatial.bound_functions import BoundFunctions, Row, called_directly
from pinocchio._spatial.small_kernels import body, finite, inertia_of_parameters
from ulna.identification.physical import (
    from_log_cholesky,
    jacobian_of_factor,
    log_cholesky,
    log_cholesky_jacobian,
    parameters_of,
    pseudo_inertia,
    pseudo_inertia_of,
    pseudo_inertia_of_factor,
)
from ulna.typing import Array, Floats


def _parameters_of(inertia: Any) -> Floats:
    """The dynamic parameters (10,) of an Inertia.

    Raises:
        ArgumentError: It is none.
    """
    if not hasattr(inertia, "toDynamicParameters"):
        raise ArgumentError(f"`inertia` is {inertia!r}; expected a pinocchio.Inertia.")
    return inertia.toDynamicParameters()


class _BodyParameters:
    """Parameters of a body that are equivalent to an Inertia, stored in one array."""

    __slots__ = ()
    _p: Floats

    def __init__(self, *parts: Any) -> None:
        raise NotImplementedError

    def toDynamicParameters(self) -> Floats:
        """m, m c, Ixx, Ixy, Iyy, Ixz, Iyz, Izz about the origin."""
        raise NotImplementedError

    def toInertia(self) -> Any:
        """The inertia."""
        return registered("Inertia").FromDynamicParameters(self.toDynamicParameters())

    def copy(self) -> Any:
        """A copy."""
        out = object.__new__(type(self))
        out._p = self._p.copy()
        return out

    __copy__ = cast = copy

    def __deepcopy__(self, memo: Any) -> Any:
        return self.copy()

    def __reduce__(self) -> Any:
        return type(self), (self._p.copy(),)

    def __eq__(self, other: object) -> bool:
        return self._p.tolist() == other._p.tolist() if isinstance(other, type(self)) else NotImplemented

    __hash__ = object.__hash__


@final
class PseudoInertia(_BodyParameters):
    """`PseudoInertia(mass, h, sigma)`: kg, mass times centre of mass [kg m], second moments [kg m^2]; or its matrix."""

    __slots__ = ("_p",)

    @by_name("mass h sigma", "clone")
    def __init__(self, *parts: Any) -> None:
        if len(parts) == 1:
            one = parts[0]
            self._p = np.array(
                one._p if isinstance(one, PseudoInertia) else matrix(one, (4, 4), "pseudo_inertia")
            )
            return
        if len(parts) != 3:
            raise ArgumentError(
                f"PseudoInertia was given {len(parts)} arguments; expected mass, h and sigma."
            )
        mass, h, sigma = parts
        self._p = np.zeros((4, 4))
        self.mass, self.h, self.sigma = mass, h, sigma

    @property
    def mass(self) -> float:
        """Mass [kg]."""
        return float(self._p[3, 3])

    @mass.setter
    def mass(self, value: float) -> None:
        self._p[3, 3] = real(value, "mass")

    @property
    def h(self) -> Floats:
        """Mass times centre of mass (3,) [kg m]; assign to change it."""
        return self._p[:3, 3].copy()

    @h.setter
    def h(self, value: Any) -> None:
        self._p[:3, 3] = self._p[3, :3] = vector(value, 3, "h")

    @property
    def sigma(self) -> Floats:
        """Second moments of mass about the origin (3, 3) [kg m^2], a view; assigning copies into it."""
        return self._p[:3, :3]

    @sigma.setter
    def sigma(self, value: Any) -> None:
        self._p[:3, :3] = matrix(value, (3, 3), "sigma")

    @staticmethod
    def FromMatrix(pseudo_inertia_matrix: Any) -> PseudoInertia:
        """From the 4x4 matrix [[sigma, h], [h^T, m]]."""
        return PseudoInertia(pseudo_inertia_matrix)

    @staticmethod
    def FromDynamicParameters(dynamic_parameters: Any) -> PseudoInertia:
        """From m, m c, Ixx, Ixy, Iyy, Ixz, Iyz, Izz about the origin."""
        return PseudoInertia(pseudo_inertia(vector(dynamic_parameters, 10, "dynamic_parameters")))

    @staticmethod
    def FromInertia(inertia: Any) -> PseudoInertia:
        """From an Inertia."""
        return PseudoInertia.FromDynamicParameters(_parameters_of(inertia))

    def __array__(self, dtype: Any = None, copy: Any = None) -> Floats:
        return np.array(self._p, dtype=dtype)

    def toMatrix(self) -> Floats:
        """The 4x4 matrix, a copy."""
        return self._p.copy()

    def toDynamicParameters(self) -> Floats:
        """m, m c, Ixx, Ixy, Iyy, Ixz, Iyz, Izz about the origin."""
        return parameters_of(self._p)

    def toLogCholeskyParameters(self) -> LogCholeskyParameters:
        """The log-Cholesky parameters; of bodies with volume alone."""
        return LogCholeskyParameters.FromInertia(self.toInertia())

    def __str__(self) -> str:
        return f"  m = {self.mass:.6g}\n  h = {text(self.h)}\n  sigma = \n{text(self.sigma)}"

    __repr__ = __str__


@final
class LogCholeskyParameters(_BodyParameters):
    """Ten numbers without bounds, alpha d1 d2 d3 s12 s23 s13 t1 t2 t3; every choice is a body that can exist."""

    __slots__ = ("_p",)

    @by_name("log_cholesky_parameters", "clone")
    def __init__(self, log_cholesky_parameters: Any) -> None:
        one = log_cholesky_parameters
        entries = (
            one._p if isinstance(one, LogCholeskyParameters) else vector(one, 10, "log_cholesky_parameters")
        )
        self._p = np.array(entries)

    @property
    def parameters(self) -> Floats:
        """The ten numbers, a view; assigning copies into it."""
        return self._p

    @parameters.setter
    def parameters(self, value: Any) -> None:
        self._p[:] = vector(value, 10, "parameters")

    @staticmethod
    def FromInertia(inertia: Any) -> LogCholeskyParameters:
        """Those of an Inertia. InputError where the body cannot exist, or is flat."""
        return LogCholeskyParameters(log_cholesky(_parameters_of(inertia)))

    def __array__(self, dtype: Any = None, copy: Any = None) -> Floats:
        return np.array(self._p, dtype=dtype)

    def toDynamicParameters(self) -> Floats:
        """m, m c, Ixx, Ixy, Iyy, Ixz, Iyz, Izz about the origin."""
        return from_log_cholesky(self._p)

    def toPseudoInertia(self) -> PseudoInertia:
        """The pseudo-inertia."""
        return PseudoInertia.FromDynamicParameters(self.toDynamicParameters())

    def calculateJacobian(self) -> Floats:
        """The derivative (10, 10) of the dynamic parameters by these."""
        return log_cholesky_jacobian(self._p)

    def __str__(self) -> str:
        names = ("alpha", "d1", "d2", "d3", "s12", "s23", "s13", "t1", "t2", "t3")
        return "\n".join(f"  {name}: {value:.6g}" for name, value in zip(names, self._p, strict=True))

    __repr__ = __str__


def _where_finite(function: Callable[[Array], Array]) -> Callable[[Array], tuple[Array, Any]]:
    """A function, and whether its argument is finite: the message about what is not comes from the methods."""
    return lambda x: (function(x), finite(x))


def _of_pseudo_inertia(P: Array) -> Array:
    return inertia_of_parameters(parameters_of(P))


_MADE = BoundFunctions(
    {
        "pseudo parameters": (parameters_of, (4, 4)),
        "pseudo inertia": (_of_pseudo_inertia, (4, 4)),
        "pseudo of body": (_where_finite(lambda p: pseudo_inertia_of(body(p).parameters())), (13,)),
        "pseudo of parameters": (_where_finite(pseudo_inertia_of), (10,)),
        "parameters": (_where_finite(lambda t: parameters_of(pseudo_inertia_of_factor(t))), (10,)),
        "body": (_where_finite(lambda t: _of_pseudo_inertia(pseudo_inertia_of_factor(t))), (10,)),
        "pseudo": (_where_finite(pseudo_inertia_of_factor), (10,)),
        "jacobian": (_where_finite(jacobian_of_factor), (10,)),
    }
)


def _direct(kind: Any, name: str, row: Row) -> None:
    """Has a method called without running Python where its arguments are of a row's types."""
    member = inspect.getattr_static(kind, name)
    if isinstance(member, staticmethod):
        setattr(kind, name, staticmethod(called_directly(member.__func__, row)))
    else:
        setattr(kind, name, called_directly(member, row, is_method=True))


_Inertia = registered("Inertia")
for _kind, _name, _function, _holder in (
    (PseudoInertia, "toDynamicParameters", "pseudo parameters", None),
    (PseudoInertia, "toInertia", "pseudo inertia", _Inertia),
    (LogCholeskyParameters, "toDynamicParameters", "parameters", None),
    (LogCholeskyParameters, "toInertia", "body", _Inertia),
    (LogCholeskyParameters, "toPseudoInertia", "pseudo", PseudoInertia),
    (LogCholeskyParameters, "calculateJacobian", "jacobian", None),
):
    _direct(_kind, _name, _MADE.row(_function, _kind, holder=_holder))
_of_body = _MADE.row("pseudo of body", _Inertia, holder=PseudoInertia)
_direct(PseudoInertia, "FromInertia", _of_body)
_direct(_Inertia, "toPseudoInertia", _of_body)
_of_parameters = _MADE.row("pseudo of parameters", np.ndarray, holder=PseudoInertia)
_direct(PseudoInertia, "FromDynamicParameters", _of_parameters)
