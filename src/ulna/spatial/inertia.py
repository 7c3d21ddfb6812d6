"""The inertia of a rigid body: mass, centre of mass, and rotational inertia about the centre of mass."""

from __future__ import annotations

from typing import Any, ClassVar, final

import numpy as np

from ulna.checks.arrays import batched_array
from ulna.data_classes import dataclass
from ulna.errors import InputError
from ulna.numeric import apply, cross, dot, is_symbolic, matrix, skew, vector, where
from ulna.spatial.batched import FLOAT, Batched, as_array, column, component
from ulna.spatial.solid_moments import solid_moments
from ulna.spatial.vectors import Force, Motion
from ulna.typing import Array, ArrayLike

_SYMMETRIC = 1e-9  # relative asymmetry that passes for rounding
_ROUNDING = 64.0 * float(
    np.finfo(float).eps
)  # of moments about the origin, relative to mass times distance squared


@final
@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Inertia(Batched):
    """The inertia of a rigid body in some frame.

    Attributes:
        mass: mass (...) [kg].
        com: centre of mass (..., 3) [m] in the frame.
        inertia: rotational inertia (..., 3, 3) [kg m^2] about the centre of mass, along the axes of the
            frame.
    """

    mass: Any
    com: Array
    inertia: Array

    _ranks: ClassVar[dict[str, int]] = {"mass": 0, "com": 1, "inertia": 2}

    def __post_init__(self) -> None:
        com, inertia = self.com, self.inertia
        if type(com) is not np.ndarray or com.dtype is not FLOAT:
            object.__setattr__(self, "com", as_array(com))
        if type(inertia) is not np.ndarray or inertia.dtype is not FLOAT:
            object.__setattr__(self, "inertia", as_array(inertia))
        if isinstance(self.mass, (list, np.ndarray, np.generic)):
            object.__setattr__(self, "mass", as_array(self.mass)[()])

    @classmethod
    def zero(cls) -> Inertia:
        """The inertia of nothing: mass, centre of mass and moments are zero.

        Example:
            >>> body = ulna.Inertia.zero() + ulna.Inertia.from_box(2.0, (0.1, 0.1, 0.1))
            >>> float(body.mass)
            2.0
        """
        return cls(0.0, np.zeros(3), np.zeros((3, 3)))

    @classmethod
    def from_com(cls, mass: Any, com: ArrayLike, inertia: ArrayLike) -> Inertia:
        """From mass, centre of mass and rotational inertia about it, checked.

        Args:
            mass: Mass, shape (...) [kg].
            com: Centre of mass in the frame, shape (..., 3) [m].
            inertia: Rotational inertia about the centre of mass [kg m^2]: a symmetric matrix, shape (..., 3, 3), or
                its entries, shape (..., 6), in the order xx, xy, xz, yy, yz, zz of URDF.

        Returns:
            The inertia.

        Raises:
            InputError: negative mass, an inertia that is not symmetric, wrong shapes, nan or inf.
        """
        return cls(_checked_mass(mass), np.array(batched_array("com", com, (3,))), _checked_inertia(inertia))

    @classmethod
    def from_origin(cls, mass: Any, com: ArrayLike, inertia: ArrayLike) -> Inertia:
        """As `from_com`, with the rotational inertia about the origin of the frame instead.

        Args:
            mass: Mass, shape (...) [kg].
            com: Centre of mass in the frame, shape (..., 3) [m].
            inertia: Rotational inertia about the origin, shape (..., 3, 3) or (..., 6) [kg m^2].

        Returns:
            The inertia.

        Raises:
            InputError: negative mass, an inertia that is not symmetric, wrong shapes, nan or inf.
        """
        at_com = cls.from_com(mass, com, inertia)
        shift = column(at_com.mass, 2) * _steiner(at_com.com)
        return cls(at_com.mass, at_com.com, at_com.inertia - shift)

    @classmethod
    def from_parameters(cls, parameters: ArrayLike) -> Inertia:
        """From the ten dynamic parameters (..., 10); see `parameters`. The mass must not be zero."""
        p = batched_array("parameters", parameters, (10,))
        mass = p[..., 0]
        com = p[..., 1:4] / column(mass)
        xx, xy, yy, xz, yz, zz = (p[..., n] for n in range(4, 10))
        about_origin = matrix([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        return cls(mass[()], com, about_origin - column(mass, 2) * _steiner(com))

    @classmethod
    def from_point(cls, mass: float, com: ArrayLike = (0.0, 0.0, 0.0)) -> Inertia:
        """A point mass.

        Args:
            mass: Mass [kg].
            com: Where it is in the frame, shape (3,) [m].

        Returns:
            The inertia.
        """
        return cls.from_com(mass, com, np.zeros((3, 3)))

    @classmethod
    def from_sphere(cls, mass: float, radius: float) -> Inertia:
        """A solid sphere centred in the frame.

        Args:
            mass: Mass [kg].
            radius: Radius [m].

        Returns:
            The inertia.

        Raises:
            InputError: If the radius is negative.
        """
        (radius,) = _checked_lengths(radius=radius)
        return cls._solid(mass, 0.4 * radius**2, 0.4 * radius**2, 0.4 * radius**2)

    @classmethod
    def from_ellipsoid(cls, mass: float, radii: ArrayLike) -> Inertia:
        """A solid ellipsoid centred in the frame.

        Args:
            mass: Mass [kg].
            radii: Half axes along x, y, z, shape (3,) [m].

        Returns:
            The inertia.
        """
        a, b, c = batched_array("radii", radii, (3,)) ** 2
        return cls._solid(mass, (b + c) / 5, (a + c) / 5, (a + b) / 5)

    @classmethod
    def from_box(cls, mass: float, size: ArrayLike) -> Inertia:
        """A solid box centred in the frame.

        Args:
            mass: Mass [kg].
            size: Full lengths along x, y, z, shape (3,) [m].

        Returns:
            The inertia.

        Raises:
            InputError: If a length is negative.

        Example:
            >>> inertia = ulna.Inertia.from_box(12.0, (1.0, 2.0, 3.0))
            >>> np.diag(inertia.inertia)
            array([13., 10.,  5.])
        """
        edges = batched_array("size", size, (3,))
        (size,) = _checked_lengths(size=edges)
        a, b, c = edges**2
        return cls._solid(mass, (b + c) / 12, (a + c) / 12, (a + b) / 12)

    @classmethod
    def from_cylinder(cls, mass: float, radius: float, length: float) -> Inertia:
        """A solid cylinder centred in the frame, its axis along z.

        Args:
            mass: Mass [kg].
            radius: Radius [m].
            length: Length [m].

        Returns:
            The inertia.

        Raises:
            InputError: If a length is negative.
        """
        radius, length = _checked_lengths(radius=radius, length=length)
        across = radius**2 / 4 + length**2 / 12
        return cls._solid(mass, across, across, radius**2 / 2)

    @classmethod
    def from_capsule(cls, mass: float, radius: float, length: float) -> Inertia:
        """A solid capsule centred in the frame: a cylinder along z, and two half spheres.

        Args:
            mass: Mass [kg].
            radius: Radius [m].
            length: Length of the cylinder [m].

        Returns:
            The inertia.

        Raises:
            InputError: If a length is negative.
        """
        radius, length = _checked_lengths(radius=radius, length=length)
        cylinder, ball = length, 4 * radius / 3  # volumes over pi radius^2
        share = cylinder / (cylinder + ball)
        half_sphere = 2 * radius**2 / 5 + length**2 / 4 + 3 * length * radius / 8
        across = share * (radius**2 / 4 + length**2 / 12) + (1 - share) * half_sphere
        return cls._solid(mass, across, across, share * radius**2 / 2 + (1 - share) * 2 * radius**2 / 5)

    @classmethod
    def from_cone(cls, mass: float, radius: float, length: float) -> Inertia:
        """A solid cone along z, its tip at z = length/2 and its base at z = -length/2.

        Args:
            mass: Mass [kg].
            radius: Radius of the base [m].
            length: Length [m].

        Returns:
            The inertia.

        Raises:
            InputError: If a length is negative.
        """
        radius, length = _checked_lengths(radius=radius, length=length)
        across = 3 * radius**2 / 20 + 3 * length**2 / 80
        body = cls._solid(mass, across, across, 3 * radius**2 / 10)
        return cls(body.mass, np.array([0.0, 0.0, -length / 4]), body.inertia)

    @classmethod
    def from_mesh(cls, mass: float, vertices: ArrayLike, triangles: ArrayLike) -> Inertia:
        """A solid of one density inside a closed surface.

        Source: Tonon, Explicit exact formulas for the 3-D tetrahedron inertia tensor (2005).

        Args:
            mass: Mass [kg].
            vertices: Corners, shape (n, 3) [m].
            triangles: The corners of each triangle, all in one direction of rotation seen from outside, shape (m, 3).

        Returns:
            The inertia in the frame of the vertices.

        Raises:
            InputError: If the surface encloses no volume or is not closed.

        Example:
            >>> vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
            >>> ulna.Inertia.from_mesh(2.0, vertices, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]).com
            array([0.25, 0.25, 0.25])
        """
        volume, com, moments = solid_moments(vertices, triangles)
        second = mass / volume * moments
        return cls.from_com(mass, com, np.trace(second) * np.eye(3) - second)

    @classmethod
    def _solid(cls, mass: float, x: float, y: float, z: float) -> Inertia:
        """A centred body with the given squared radii of gyration [m^2]."""
        mass = component("mass", mass)
        return cls.from_com(mass, np.zeros(3), mass * np.diag([x, y, z]))

    def apply(self, motion: Motion) -> Force:
        """The momentum at a velocity, or the force at an acceleration. Source: Featherstone, eq. (2.63)."""
        f = column(self.mass) * (motion.linear - cross(self.com, motion.angular))
        return Force(f, apply(self.inertia, motion.angular) + cross(self.com, f))

    def kinetic_energy(self, motion: Motion) -> Any:
        """Half of velocity times momentum (...) [J]."""
        return 0.5 * motion.dot(self.apply(motion))

    def __add__(self, other: Inertia) -> Inertia:
        """The inertia of two bodies joined rigidly, both given in one frame."""
        if not isinstance(other, Inertia):
            return NotImplemented
        mass = self.mass + other.mass
        # Two massless bodies have no centre of mass; the origin stands for it.
        whole = mass if is_symbolic(mass) else where(mass == 0.0, 1.0, mass)
        share = other.mass / whole
        offset = other.com - self.com
        reduced = column(self.mass * share, 2) * _steiner(offset)
        com = (column(self.mass / whole) * self.com) + column(share) * other.com
        return Inertia(mass, com, self.inertia + other.inertia + reduced)

    def as_matrix(self) -> Array:
        """The 6x6 inertia (..., 6, 6) about the origin: momentum = matrix @ twist, linear part first."""
        mc = skew(self.first_moment())
        eye = column(self.mass, 2) * np.eye(3)
        corner = self.about_origin()
        eye, mc, corner = np.broadcast_arrays(eye, mc, corner)
        return np.concatenate(
            [np.concatenate([eye, -mc], axis=-1), np.concatenate([mc, corner], axis=-1)], axis=-2
        )

    def matrix(self) -> Array:
        """The same as `as_matrix()`."""
        return self.as_matrix()

    def first_moment(self) -> Array:
        """Mass times centre of mass (..., 3) [kg m]."""
        return column(self.mass) * self.com

    def about_origin(self) -> Array:
        """The rotational inertia (..., 3, 3) [kg m^2] about the origin of the frame, by Steiner's theorem."""
        return self.inertia + column(self.mass, 2) * _steiner(self.com)

    def parameters(self) -> Array:
        """The ten dynamic parameters (..., 10), in which the equations of motion are linear.

        m, m cx, m cy, m cz, Ixx, Ixy, Iyy, Ixz, Iyz, Izz; rotational inertia about the origin of the frame.
        The order is Pinocchio's.
        """
        i = self.about_origin()
        mc = self.first_moment()
        entries = (i[..., a, b] for a, b in ((0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2)))
        return vector(self.mass, mc[..., 0], mc[..., 1], mc[..., 2], *entries)

    def is_physical(self, tolerance: float = 1e-9) -> Any:
        """Whether some body of positive mass density has this inertia (...).

        The mass is not negative and the principal moments obey the triangle inequality, within `tolerance`
        relative to the largest, and within rounding of the moments about the frame's origin, from which those of a
        point mass are never exactly zero.
        """
        moments = np.linalg.eigvalsh(self.inertia)
        to_origin = np.abs(self.mass) * (self.com * self.com).sum(axis=-1)
        slack = tolerance * np.abs(moments).max(axis=-1) + _ROUNDING * to_origin
        sums = moments[..., 0] + moments[..., 1] - moments[..., 2]
        return (np.asarray(self.mass) >= 0.0) & (moments[..., 0] >= -slack) & (sums >= -slack)

    def is_close(self, other: Inertia, tolerance: float = 1e-9) -> Any:
        """Whether two inertias have nearly the same dynamic parameters.

        Args:
            other: The other inertia.
            tolerance: The largest difference of a parameter that is accepted [kg, kg m, kg m^2].

        Returns:
            Truth values, shape (...).
        """
        return (np.abs(self.parameters() - other.parameters()) <= tolerance).all(axis=-1)

    def _moved(self, rotation: Array, translation: Array) -> Inertia:
        return Inertia(
            self.mass, apply(rotation, self.com) + translation, rotate_tensor(rotation, self.inertia)
        )

    def _moved_back(self, rotation: Array, translation: Array) -> Inertia:
        back = np.swapaxes(rotation, -1, -2)
        return Inertia(self.mass, apply(back, self.com - translation), rotate_tensor(back, self.inertia))

    def _dense(self) -> Array:
        return self.matrix()


def _steiner(offset: Array) -> Array:
    """|d|^2 I - d d^T (..., 3, 3): what a unit mass displaced by `offset` adds to a rotational inertia."""
    x, y, z = offset[..., 0], offset[..., 1], offset[..., 2]
    xx, yy, zz, xy, xz, yz = x * x, y * y, z * z, -x * y, -x * z, -y * z
    return matrix([[yy + zz, xy, xz], [xy, xx + zz, yz], [xz, yz, xx + yy]])


def rotate_tensor(rotation: Array, inertia: Array) -> Array:
    """R I R^T of a symmetric I, of which only six entries are computed.

    Args:
        rotation: R, shape (..., 3, 3) [-].
        inertia: I, shape (..., 3, 3).

    Returns:
        The rotated matrix, shape (..., 3, 3), in the unit of `inertia`.
    """
    half = rotation @ inertia
    xx, xy, xz, yy, yz, zz = (
        dot(half[..., i, :], rotation[..., j, :]) for i, j in ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))
    )
    return matrix([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def _checked_mass(mass: Any) -> Any:
    array = batched_array("mass", mass, ())
    if array.dtype != object and (array < 0.0).any():
        raise InputError(f"`mass` is {float(array.min()):g} kg; expected zero or more.")
    return array[()]


def _checked_inertia(inertia: ArrayLike) -> Array:
    array = inertia if isinstance(inertia, np.ndarray) else as_array(inertia)
    if array.shape[-1:] == (6,):
        xx, xy, xz, yy, yz, zz = (batched_array("inertia", array, (6,))[..., n] for n in range(6))
        return matrix([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    array = batched_array("inertia", array, (3, 3), "Six numbers xx, xy, xz, yy, yz, zz will do, too.")
    if array.dtype == object:
        return array
    skewness = np.abs(array - np.swapaxes(array, -1, -2)).max(initial=0.0)
    if skewness > _SYMMETRIC * max(1.0, np.abs(array).max(initial=0.0)):
        raise InputError(
            f"`inertia` is not symmetric: entries across the diagonal differ by {skewness:.3g} kg m^2; "
            "expected none. Give the upper triangle instead: xx, xy, xz, yy, yz, zz."
        )
    return 0.5 * (array + np.swapaxes(array, -1, -2))


def _checked_lengths(**lengths: Any) -> tuple[Any, ...]:
    """The lengths, none of which is negative; symbols pass."""
    checked = {name: component(name, value) for name, value in lengths.items()}
    for name, value in checked.items():
        array = np.asarray(value)
        if array.dtype.kind == "f" and (array < 0).any():
            raise InputError(f"`{name}` is {value!r} m; expected zero or more.")
    return tuple(checked.values())
