"""Inertia: mass, centre of mass, and rotational inertia about it, in one array with views."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, final

import numpy as np

from pinocchio._containers.arguments import ArgumentError
from pinocchio._containers.arrays import matrix, real, text, vector
from pinocchio._containers.files import register
from pinocchio._containers.keywords import by_name, reads_names
from pinocchio._spatial.bound_functions import BoundFunctions
from pinocchio._spatial.motion_force import Force, Motion, skew
from pinocchio._spatial.se3 import SE3
from pinocchio._spatial.small_kernels import FORCES, INERTIAS, small_kernel
from pinocchio._spatial.symmetric3 import Symmetric3
from ulna import spatial
from ulna.errors import InputError, excerpt
from ulna.numeric import less, where
from ulna.typing import Array, Floats

if TYPE_CHECKING:
    from pinocchio._spatial.pseudo_inertia import LogCholeskyParameters, PseudoInertia


_new = object.__new__


@final
class InvalidInertia(InputError, RuntimeError):
    """A matrix is no inertia; Pinocchio raises a RuntimeError."""

    @classmethod
    def of(cls, inertia: Any) -> InvalidInertia:
        """The error for a matrix."""
        rows = excerpt(repr(np.asarray(inertia).tolist()))
        return cls(
            f"The inertia is {rows}; expected a symmetric matrix without negative moments on its diagonal, about the "
            "centre of mass."
        )


@final
class Inertia:
    """`Inertia(mass, lever, inertia about the centre of mass)`; kg, m, kg m^2. `lever` is a view."""

    __slots__ = ("_p",)

    @reads_names("mass lever inertia", "clone")
    def __init__(self, *parts: Any, **named: Any) -> None:
        if len(parts) == 1 and type(parts[0]) is Inertia and not named:
            self._p = parts[0]._p.copy()
            return
        numbers = NotImplemented if named or len(parts) != 3 else _ARRAY_FUNCTIONS["parts"](*parts)
        if numbers is NotImplemented:
            self._set(*parts, **named)
        else:
            self._p = numbers

    @by_name("mass lever inertia", "clone")
    def _set(self, *parts: Any) -> None:
        """Sets a new instance to what it is made of."""
        self._p = np.zeros(13)  # mass, lever, inertia row by row
        if len(parts) == 3:
            self._p[0] = real(parts[0], "mass")
            self.lever, self.inertia = parts[1], parts[2]
            if _ARRAY_FUNCTIONS["parts"](0.0, self._p[1:4], self._p[4:].reshape(3, 3)) is NotImplemented:
                raise InvalidInertia.of(parts[2])
        elif len(parts) == 1:
            self._assign(parts[0])
        elif parts:
            raise ArgumentError(
                f"Inertia was given {len(parts)} arguments; expected mass, lever and inertia."
            )

    def __array__(self, dtype: Any = None, copy: Any = None) -> Floats:
        return np.array(self.matrix(), dtype=dtype)

    @classmethod
    def _of(cls, storage: Floats) -> Inertia:
        self = _new(cls)
        self._p = storage
        return self

    def _assign(self, other: Any) -> None:
        if isinstance(other, Inertia):
            self._p[:] = other._p
        else:  # the 6x6 matrix
            block = matrix(other, (6, 6), "inertia")
            mass = block[0, 0]
            lever = np.array([block[5, 1], block[3, 2], block[4, 0]]) / (mass or 1.0)
            self._p[0], self.lever = mass, lever
            self.inertia = block[3:, 3:] + mass * skew(lever) @ skew(lever)

    def _value(self) -> spatial.Inertia:
        return spatial.Inertia(float(self._p[0]), self._p[1:4], self._p[4:].reshape(3, 3))

    @staticmethod
    def _from(value: spatial.Inertia) -> Inertia:
        return Inertia._of(np.concatenate([[value.mass], value.com, np.ravel(value.inertia)]))

    @staticmethod
    def _centred(mass: float, x: float, y: float, z: float) -> Inertia:
        """A body about its centre, with these squared radii of gyration [m^2]."""
        p = np.zeros(13)
        p[0], p[4], p[8], p[12] = mass, mass * x, mass * y, mass * z
        return Inertia._of(p)

    @staticmethod
    def Zero() -> Inertia:
        """The inertia of nothing."""
        return Inertia()

    @staticmethod
    def Identity() -> Inertia:
        """1 kg at the origin with unit moments."""
        return Inertia(1.0, np.zeros(3), np.eye(3))

    @staticmethod
    def Random() -> Inertia:
        """That of a body that can exist, drawn at random."""
        return BODIES["random"]()

    @staticmethod
    def FromSphere(mass: float, radius: float) -> Inertia:
        """A solid sphere.

        Returns:
            The inertia about its centre.
        """
        squared = 0.4 * real(radius, "radius") ** 2
        return Inertia._centred(real(mass, "mass"), squared, squared, squared)

    @staticmethod
    def FromEllipsoid(mass: float, length_x: float, length_y: float, length_z: float) -> Inertia:
        """A solid ellipsoid.

        Args:
            length_x: Half axis along x [m].
            length_y: Half axis along y [m].
            length_z: Half axis along z [m].

        Returns:
            The inertia about its centre.
        """
        a, b, c = (
            length**2 / 5 for length in _lengths(length_x=length_x, length_y=length_y, length_z=length_z)
        )
        return Inertia._centred(real(mass, "mass"), b + c, a + c, a + b)

    @staticmethod
    def FromCylinder(mass: float, radius: float, length: float) -> Inertia:
        """A solid cylinder along z.

        Args:
            length: Length [m].

        Returns:
            The inertia about its centre.
        """
        return Inertia._from(spatial.Inertia.from_cylinder(mass, radius, length))

    @staticmethod
    def FromBox(mass: float, length_x: float, length_y: float, length_z: float) -> Inertia:
        """A solid box.

        Args:
            length_x: Side along x [m].
            length_y: Side along y [m].
            length_z: Side along z [m].

        Returns:
            The inertia about its centre.
        """
        a, b, c = (
            length**2 / 12 for length in _lengths(length_x=length_x, length_y=length_y, length_z=length_z)
        )
        return Inertia._centred(real(mass, "mass"), b + c, a + c, a + b)

    @staticmethod
    def FromCapsule(mass: float, radius: float, height: float) -> Inertia:
        """A solid capsule along z: a cylinder with half spheres at its ends.

        Args:
            height: Height of the cylinder [m].

        Returns:
            The inertia about its centre.
        """
        return Inertia._from(spatial.Inertia.from_capsule(mass, radius, height))

    @staticmethod
    def FromDynamicParameters(dynamic_parameters: Any) -> Inertia:
        """From m, m c, Ixx, Ixy, Iyy, Ixz, Iyz, Izz about the origin."""
        parameters = vector(dynamic_parameters, 10, "dynamic_parameters")
        return Inertia._of(small_kernel("inertia of parameters")(parameters))

    @staticmethod
    def FromPseudoInertia(pseudo_inertia: Any) -> Inertia:
        """From a PseudoInertia, or its 4x4 matrix."""
        from pinocchio._spatial.pseudo_inertia import PseudoInertia

        return PseudoInertia(pseudo_inertia).toInertia()

    @staticmethod
    def FromLogCholeskyParameters(log_cholesky_parameters: Any) -> Inertia:
        """From LogCholeskyParameters, or the ten numbers."""
        from pinocchio._spatial.pseudo_inertia import LogCholeskyParameters

        return LogCholeskyParameters(log_cholesky_parameters).toInertia()

    @property
    def mass(self) -> float:
        """Mass [kg]."""
        return float(self._p[0])

    @mass.setter
    def mass(self, value: float) -> None:
        self._p[0] = value if type(value) is float else real(value, "mass")

    @property
    def lever(self) -> Floats:
        """Centre of mass (3,) [m], a view; assigning copies into it."""
        return self._p[1:4]

    @lever.setter
    def lever(self, value: Any) -> None:
        self._p[1:4] = vector(value, 3, "lever")

    @property
    def inertia(self) -> Floats:
        """Rotational inertia (3, 3) about the centre of mass [kg m^2], a copy; assign to change it."""
        return self._p[4:].reshape(3, 3).copy()

    @inertia.setter
    def inertia(self, value: Any) -> None:
        block = value.matrix() if isinstance(value, Symmetric3) else matrix(value, (3, 3), "inertia")
        self._p[4:] = block.ravel()

    def matrix(self) -> Floats:
        """The 6x6 inertia about the origin."""
        return small_kernel("inertia matrix")(self._p)

    @property
    def np(self) -> Floats:
        """The 6x6 inertia about the origin."""
        return self.matrix()

    def inverse(self) -> Floats:
        """The inverse of the 6x6 inertia."""
        return small_kernel("inertia inverse")(self._p)

    def toDynamicParameters(self) -> Floats:
        """m, m c, Ixx, Ixy, Iyy, Ixz, Iyz, Izz about the origin."""
        return small_kernel("inertia parameters")(self._p)

    def toPseudoInertia(self) -> PseudoInertia:
        """The pseudo-inertia."""
        from pinocchio._spatial.pseudo_inertia import PseudoInertia

        return PseudoInertia.FromInertia(self)

    def toLogCholeskyParameters(self) -> LogCholeskyParameters:
        """The log-Cholesky parameters; of bodies with volume alone."""
        from pinocchio._spatial.pseudo_inertia import LogCholeskyParameters

        return LogCholeskyParameters.FromInertia(self)

    def se3Action(self, M: SE3) -> Inertia:
        """It, carried along by M."""
        return self._moved(M)

    def se3ActionInverse(self, M: SE3) -> Inertia:
        """It, carried along by the inverse of M."""
        return self._moved_back(M)

    def _moved(self, M: SE3) -> Inertia:
        return BODIES["moved"](M._m, self._p)

    def _moved_back(self, M: SE3) -> Inertia:
        return BODIES["moved back"](M._m, self._p)

    def vtiv(self, v: Motion) -> float:
        """Twice the kinetic energy at a velocity [J]."""
        return float(small_kernel("inertia energy")(self._p, v._v))

    def vxi(self, v: Motion) -> Floats:
        """The 6x6 matrix v x* I."""
        return small_kernel("inertia v x I")(self._p, v._v)

    def ivx(self, v: Motion) -> Floats:
        """The 6x6 matrix I v x."""
        return small_kernel("inertia I v x")(self._p, v._v)

    def vxiv(self, v: Motion) -> Force:
        """The force v x* I v."""
        return FORCES_OF_BODIES["rate"](self._p, v._v)

    def variation(self, v: Motion) -> Floats:
        """The 6x6 rate of the inertia of a body that moves with v."""
        return small_kernel("inertia rate")(self._p, v._v)

    def setZero(self) -> None:
        """Makes it that of nothing."""
        self._p.fill(0.0)

    def setIdentity(self) -> None:
        """Makes it 1 kg at the origin with unit moments."""
        self._assign(Inertia.Identity())

    def setRandom(self) -> None:
        """Draws it anew; see `Random`."""
        self._p[:] = Inertia.Random()._p

    def isZero(self, prec: float = 1e-12) -> bool:
        """Whether all its numbers are at most `prec`."""
        return bool(np.abs(self._p).max() <= prec)

    def isApprox(self, other: Inertia, prec: float = 1e-12) -> bool:
        """Whether mass, lever and inertia agree.

        Args:
            other: Another inertia.
            prec: Largest difference, relative to the norm where that is above 1 [-].

        Returns:
            Whether they do.
        """
        values, gap = self._p, self._p - other._p
        return math.sqrt(gap @ gap) <= prec * max(1.0, math.sqrt(values @ values))

    def copy(self) -> Inertia:
        """A copy."""
        return Inertia._of(self._p.copy())

    __copy__ = cast = copy

    def __deepcopy__(self, memo: Any) -> Inertia:
        return self.copy()

    def __reduce__(self) -> Any:
        return Inertia, (self.mass, self.lever.copy(), self.inertia)

    def __add__(self, other: Any) -> Inertia:
        if not isinstance(other, Inertia):
            return NotImplemented
        return BODIES["sum"](self._p, other._p)

    def __iadd__(self, other: Inertia) -> Inertia:
        return self._changed_by("sum", "+=", other)

    def __isub__(self, other: Inertia) -> Inertia:
        return self._changed_by("difference", "-=", other)

    def _changed_by(self, function: str, sign: str, other: Any) -> Inertia:
        """It, after a sum or a difference with another one, which it takes over."""
        if not isinstance(other, Inertia):
            raise ArgumentError(
                f"An Inertia {sign} was given {excerpt(repr(other))}; expected another Inertia."
            )
        self._p[:] = BODIES[function](self._p, other._p)._p
        return self

    def __sub__(self, other: Any) -> Inertia:
        return BODIES["difference"](self._p, other._p) if isinstance(other, Inertia) else NotImplemented

    def __mul__(self, motion: Any) -> Any:
        if not isinstance(motion, Motion):
            if isinstance(motion, (np.ndarray, np.number)) and motion.shape != (6,):
                return NotImplemented  # NumPy takes the inertia for its matrix
            return self.matrix() @ vector(motion, 6, "motion")
        return FORCES_OF_BODIES["momentum"](self._p, motion._v)

    def __eq__(self, other: object) -> bool:
        return self._p.tolist() == other._p.tolist() if isinstance(other, Inertia) else NotImplemented

    __hash__ = object.__hash__

    def __str__(self) -> str:
        p = self._p
        return f"  m = {float(p[0]):.6g}\n  c = {text(p[1:4])}\n  I = \n{text(p[4:].reshape(3, 3))}"

    __repr__ = __str__


def _lengths(**lengths: Any) -> tuple[float, ...]:
    """Lengths as numbers of Python, whose squares do not overflow."""
    return tuple(real(value, name) for name, value in lengths.items())


def _is_inertia(I: Array) -> Any:
    """1 for a symmetric matrix (3, 3) without negative entries on its diagonal, as Pinocchio checks it; else 0."""
    apart = sum((I[i, j] - I[j, i]) * (I[i, j] - I[j, i]) for i, j in ((0, 1), (0, 2), (1, 2)))
    size = sum(x * x for x in I.reshape(9))
    valid = where(less(2.0 * apart, 1e-24 * size + 1e-300), 1.0, 0.0)
    for k in range(3):
        valid = where(less(I[k, k], 0.0), 0.0, valid)
    return valid


BODIES = BoundFunctions(INERTIAS, holder=Inertia)
FORCES_OF_BODIES = BoundFunctions(FORCES, holder=Force)


def _parts_and_validity(mass: Any, lever: Array, I: Array) -> tuple[Array, Any]:
    return np.concatenate([[mass], lever, I.reshape(9)]), _is_inertia(I)


_ARRAY_FUNCTIONS = BoundFunctions({"parts": (_parts_and_validity, (), (3,), (3, 3))}, exact=True)
register(Inertia)
