"""Inertia and Symmetric3: mass, centre of mass, and rotational inertia about it, in one array with views."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, final

import numpy as np

from pinocchio._arrays import matrix, text, vector
from pinocchio._vectors import Force, Motion, generator, skew
from ulna import spatial
from ulna.errors import InputError
from ulna.identification.physical import log_cholesky, parameters_of, pseudo_inertia
from ulna.typing import Floats

if TYPE_CHECKING:
    from pinocchio._se3 import SE3


@final
class Inertia:
    """`Inertia(mass, lever, inertia about the centre of mass)`; kg, m, kg m^2. `lever` is a view."""

    __slots__ = ("_p",)

    def __init__(self, *parts: Any) -> None:
        self._p = np.zeros(13)  # mass, lever, inertia row by row
        if len(parts) == 3:
            self._p[0] = float(parts[0])
            self.lever, self.inertia = parts[1], parts[2]
        elif len(parts) == 1:
            self._assign(parts[0])
        elif parts:
            raise InputError(f"Inertia was given {len(parts)} arguments; expected mass, lever and inertia.")

    @classmethod
    def _of(cls, storage: Floats) -> Inertia:
        self = cls.__new__(cls)
        self._p = storage
        return self

    def _assign(self, other: Any) -> None:
        if isinstance(other, Inertia):
            self._p[:] = other._p
        else:  # the 6x6 matrix
            given = matrix(other, (6, 6), "inertia")
            mass = given[0, 0]
            lever = np.array([given[5, 1], given[3, 2], given[4, 0]]) / (mass or 1.0)
            self._p[0], self.lever = mass, lever
            self.inertia = given[3:, 3:] + mass * skew(lever) @ skew(lever)

    def _value(self) -> spatial.Inertia:
        return spatial.Inertia(float(self._p[0]), self._p[1:4], self._p[4:].reshape(3, 3))

    @staticmethod
    def _from(value: spatial.Inertia) -> Inertia:
        return Inertia._of(np.concatenate([[value.mass], value.com, np.ravel(value.inertia)]))

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
        rng = generator()
        size = rng.uniform(0.1, 1.0, 3)
        turn = spatial.SO3.random(rng)
        body = spatial.Inertia.from_box(float(rng.uniform(0.1, 1.0)), size)
        return Inertia._from(spatial.SE3.from_rotation(turn, rng.uniform(-1.0, 1.0, 3)).act(body))

    @staticmethod
    def FromSphere(mass: float, radius: float) -> Inertia:
        """A solid sphere."""
        return Inertia._from(spatial.Inertia.from_sphere(mass, radius))

    @staticmethod
    def FromEllipsoid(mass: float, x: float, y: float, z: float) -> Inertia:
        """A solid ellipsoid with the half axes x, y, z."""
        return Inertia._from(spatial.Inertia.from_ellipsoid(mass, (x, y, z)))

    @staticmethod
    def FromCylinder(mass: float, radius: float, length: float) -> Inertia:
        """A solid cylinder along z."""
        return Inertia._from(spatial.Inertia.from_cylinder(mass, radius, length))

    @staticmethod
    def FromBox(mass: float, x: float, y: float, z: float) -> Inertia:
        """A solid box with the sides x, y, z."""
        return Inertia._from(spatial.Inertia.from_box(mass, (x, y, z)))

    @staticmethod
    def FromCapsule(mass: float, radius: float, height: float) -> Inertia:
        """A solid capsule along z: a cylinder of that height with half spheres."""
        return Inertia._from(spatial.Inertia.from_capsule(mass, radius, height))

    @staticmethod
    def FromDynamicParameters(params: Any) -> Inertia:
        """From m, m c, Ixx, Ixy, Iyy, Ixz, Iyz, Izz about the origin."""
        return Inertia._from(spatial.Inertia.from_parameters(vector(params, 10, "params")))

    @staticmethod
    def FromPseudoInertia(pseudo: Any) -> Inertia:
        """From the 4x4 pseudo-inertia."""
        return Inertia.FromDynamicParameters(parameters_of(matrix(pseudo, (4, 4), "pseudo")))

    @property
    def mass(self) -> float:
        """Mass [kg]."""
        return float(self._p[0])

    @mass.setter
    def mass(self, value: float) -> None:
        self._p[0] = value

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
        given = value.matrix() if isinstance(value, Symmetric3) else matrix(value, (3, 3), "inertia")
        self._p[4:] = given.ravel()

    def matrix(self) -> Floats:
        """The 6x6 inertia about the origin."""
        return self._value().matrix()

    @property
    def np(self) -> Floats:
        """The 6x6 inertia about the origin."""
        return self.matrix()

    def inverse(self) -> Floats:
        """The inverse of the 6x6 inertia."""
        return np.asarray(np.linalg.inv(self.matrix()), dtype=float)

    def toDynamicParameters(self) -> Floats:
        """m, m c, Ixx, Ixy, Iyy, Ixz, Iyz, Izz about the origin."""
        return self._value().parameters()

    def toPseudoInertia(self) -> Floats:
        """The 4x4 pseudo-inertia."""
        return pseudo_inertia(self.toDynamicParameters())

    def toLogCholeskyParameters(self) -> Floats:
        """The ten log-Cholesky parameters."""
        return log_cholesky(self.toDynamicParameters())

    def se3Action(self, M: SE3) -> Inertia:
        """It, carried along by M."""
        return Inertia._from(M._pose().act(self._value()))

    def se3ActionInverse(self, M: SE3) -> Inertia:
        """It, carried along by the inverse of M."""
        return Inertia._from(M._pose().act_inverse(self._value()))

    def vtiv(self, v: Motion) -> float:
        """Twice the kinetic energy at a velocity [J]."""
        return 2.0 * float(self._value().kinetic_energy(v._value()))

    def vxi(self, v: Motion) -> Floats:
        """The 6x6 matrix v x* I."""
        return v.dualAction @ self.matrix()

    def ivx(self, v: Motion) -> Floats:
        """The 6x6 matrix I v x."""
        return self.matrix() @ v.action

    def vxiv(self, v: Motion) -> Force:
        """The force v x* I v."""
        return v.cross(self * v)

    def variation(self, v: Motion) -> Floats:
        """The 6x6 rate of the inertia of a body that moves with v."""
        return self.vxi(v) - self.ivx(v)

    def setZero(self) -> None:
        """Makes it that of nothing."""
        self._p[:] = 0.0

    def setIdentity(self) -> None:
        """Makes it 1 kg at the origin with unit moments."""
        self._assign(Inertia.Identity())

    def setRandom(self) -> None:
        """Draws it anew; see `Random`."""
        self._assign(Inertia.Random())

    def isZero(self, prec: float = 1e-12) -> bool:
        """Whether all its numbers are at most `prec`."""
        return bool(np.abs(self._p).max() <= prec)

    def isApprox(self, other: Inertia, prec: float = 1e-12) -> bool:
        """Whether mass, lever and inertia agree within `prec`."""
        return bool(np.linalg.norm(self._p - other._p) <= prec * max(1.0, float(np.linalg.norm(self._p))))

    def copy(self) -> Inertia:
        """One of its own, with the same numbers."""
        return Inertia._of(self._p.copy())

    __copy__ = copy

    def __deepcopy__(self, memo: Any) -> Inertia:
        return self.copy()

    def __reduce__(self) -> Any:
        return Inertia, (self.mass, self.lever.copy(), self.inertia)

    def __add__(self, other: Inertia) -> Inertia:
        return Inertia._from(self._value() + other._value()) if isinstance(other, Inertia) else NotImplemented

    def __iadd__(self, other: Inertia) -> Inertia:
        self._assign(self + other)
        return self

    def __sub__(self, other: Inertia) -> Inertia:
        return Inertia.FromDynamicParameters(self.toDynamicParameters() - other.toDynamicParameters())

    def __mul__(self, motion: Any) -> Any:
        if not isinstance(motion, Motion):
            return self.matrix() @ vector(motion, 6, "motion")
        return Force._from(self._value().apply(motion._value()))

    def __eq__(self, other: object) -> bool:
        return bool((self._p == other._p).all()) if isinstance(other, Inertia) else NotImplemented

    __hash__ = object.__hash__

    def __str__(self) -> str:
        return f"  m = {self.mass:.6g}\n  c = {text(self.lever)}\n  I = \n{text(self.inertia)}"

    __repr__ = __str__


@final
class Symmetric3:
    """A symmetric 3x3 matrix, stored as xx, xy, yy, xz, yz, zz: `Symmetric3(matrix)`, or those six numbers."""

    __slots__ = ("_d",)

    def __init__(self, *parts: Any) -> None:
        self._d = np.zeros(6)
        if len(parts) == 1:
            one = parts[0]
            if isinstance(one, Symmetric3):
                self._d[:] = one._d
            elif np.shape(one) == (6,):
                self._d[:] = vector(one, 6, "data")
            else:
                self._d[:] = _packed(matrix(one, (3, 3), "matrix"))
        elif parts:
            self._d[:] = vector(parts, 6, "data")

    @staticmethod
    def Zero() -> Symmetric3:
        """All zero."""
        return Symmetric3()

    @staticmethod
    def Identity() -> Symmetric3:
        """The identity."""
        return Symmetric3(np.eye(3))

    @staticmethod
    def Random() -> Symmetric3:
        """Entries drawn evenly from [-1, 1]."""
        return Symmetric3(generator().uniform(-1.0, 1.0, 6))

    @property
    def data(self) -> Floats:
        """xx, xy, yy, xz, yz, zz, a view."""
        return self._d

    @data.setter
    def data(self, value: Any) -> None:
        self._d[:] = vector(value, 6, "data")

    def matrix(self) -> Floats:
        """The 3x3 matrix."""
        xx, xy, yy, xz, yz, zz = self._d
        return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])

    def inverse(self, out: Floats | None = None) -> Floats:
        """The inverse matrix; written into `out` as well where it is given."""
        found = np.asarray(np.linalg.inv(self.matrix()), dtype=float)
        if out is not None:
            out[:] = found
        return found

    def rotate(self, R: Any) -> Symmetric3:
        """R S R^T."""
        turn = matrix(R, (3, 3), "R")
        return Symmetric3(turn @ self.matrix() @ turn.T)

    def vtiv(self, v: Any) -> float:
        """v^T S v."""
        return float(vector(v, 3, "v") @ self.matrix() @ vector(v, 3, "v"))

    @staticmethod
    def vxs(v: Any, S: Symmetric3) -> Floats:
        """[v]x S."""
        return skew(v) @ S.matrix()

    @staticmethod
    def svx(v: Any, S: Symmetric3) -> Floats:
        """S [v]x."""
        return S.matrix() @ skew(v)

    @staticmethod
    def rhsMult(S: Symmetric3, v: Any, out: Floats) -> None:
        """Writes S v into `out`."""
        out[:] = S.matrix() @ vector(v, 3, "v")

    def fill(self, value: float) -> None:
        """Makes all entries `value`."""
        self._d[:] = value

    def setDiagonal(self, diagonal: Any) -> None:
        """Changes the diagonal."""
        self._d[[0, 2, 5]] = vector(diagonal, 3, "diagonal")

    def setZero(self) -> None:
        """Makes it zero."""
        self._d[:] = 0.0

    def setIdentity(self) -> None:
        """Makes it the identity."""
        self._d[:] = 1.0, 0.0, 1.0, 0.0, 0.0, 1.0

    def setRandom(self) -> None:
        """Draws it anew; see `Random`."""
        self._d[:] = Symmetric3.Random()._d

    def isZero(self, prec: float = 1e-12) -> bool:
        """Whether all entries are at most `prec`."""
        return bool(np.abs(self._d).max() <= prec)

    def isApprox(self, other: Symmetric3, prec: float = 1e-12) -> bool:
        """Whether the entries differ by at most `prec` times their norm."""
        return bool(np.linalg.norm(self._d - other._d) <= prec * max(1.0, float(np.linalg.norm(self._d))))

    def copy(self) -> Symmetric3:
        """One of its own, with the same numbers."""
        return Symmetric3(self)

    def __add__(self, other: Any) -> Symmetric3:
        return Symmetric3(self._d + Symmetric3(other)._d)

    def __sub__(self, other: Any) -> Symmetric3:
        return Symmetric3(self._d - Symmetric3(other)._d)

    def __neg__(self) -> Symmetric3:
        return Symmetric3(-self._d)

    def __mul__(self, other: Any) -> Any:
        return Symmetric3(self._d * other) if np.ndim(other) == 0 else self.matrix() @ vector(other, 3, "v")

    def __eq__(self, other: object) -> bool:
        return bool((self._d == other._d).all()) if isinstance(other, Symmetric3) else NotImplemented

    __hash__ = object.__hash__

    def __reduce__(self) -> Any:
        return Symmetric3, (self._d.copy(),)

    def __str__(self) -> str:
        return f"m_data: {text(self._d)}\n"

    __repr__ = __str__


def _packed(full: Floats) -> list[float]:
    return [full[i, j] for i, j in ((0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2))]
