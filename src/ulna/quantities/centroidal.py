"""Motion of the centre of mass of a robot, and momentum and inertia about it."""

from __future__ import annotations

from typing import final

from ulna.quantities.deferred_algorithms import algorithms
from ulna.quantities.part import Part
from ulna.quantities.quantity import quantity
from ulna.typing import ArrayLike, Floats


@final
class Centroidal(Part):
    """How the centre of mass moves, and momentum and inertia about it, along the axes of the world.

    The centre of mass itself is `robot.center_of_mass(q)`. Momentum is linear part first.
    """

    __slots__ = ()

    @quantity(algorithms.center_of_mass_velocity, "(3,) [m/s]")
    def velocity(self, q: ArrayLike, v: ArrayLike, subtree: str | None = None) -> Floats:
        """Velocity of the centre of mass in the world."""
        ...

    @quantity(algorithms.center_of_mass_acceleration, "(3,) [m/s^2]")
    def acceleration(self, q: ArrayLike, v: ArrayLike, a: ArrayLike, subtree: str | None = None) -> Floats:
        """Acceleration of the centre of mass in the world."""
        ...

    @quantity(
        algorithms.center_of_mass_jacobian,
        "(3, nv) [m/rad or 1]",
        stages=algorithms.stages_of_center_of_mass_jacobian,
        scans=True,
    )
    def jacobian(self, q: ArrayLike, subtree: str | None = None) -> Floats:
        """The matrix that maps `v` to the velocity of the centre of mass."""
        ...

    @quantity(
        algorithms.centroidal_momentum,
        "(6,) [N s, N m s]",
        stages=algorithms.stages_of_centroidal_momentum,
        scans=True,
    )
    def momentum(self, q: ArrayLike, v: ArrayLike) -> Floats:
        """The momentum about the centre of mass [Orin, Goswami & Lee 2013]."""
        ...

    @quantity(algorithms.centroidal_momentum_rate, "(6,) [N, N m]")
    def momentum_rate(self, q: ArrayLike, v: ArrayLike, a: ArrayLike) -> Floats:
        """The time derivative of the momentum about the centre of mass [Orin, Goswami & Lee 2013]."""
        ...

    @quantity(algorithms.centroidal_inertia, "(3, 3) [kg m^2]")
    def inertia(self, q: ArrayLike) -> Floats:
        """The rotational inertia about the centre of mass, all joints held [Orin, Goswami & Lee 2013]."""
        ...

    @quantity(
        algorithms.centroidal_matrix,
        "(6, nv) [kg m or kg, kg m^2 or kg m]",
        nodes=165,
        stages=algorithms.stages_of_centroidal_matrix,
        stages_from=24,
    )
    def momentum_matrix(self, q: ArrayLike) -> Floats:
        """The matrix that maps `v` to the momentum about the centre of mass [Orin, Goswami & Lee 2013]."""
        ...

    @quantity(algorithms.centroidal_matrix_dot, "(6, nv) [kg m/s or kg/s, kg m^2/s or kg m/s]", nodes=428)
    def momentum_matrix_dot(self, q: ArrayLike, v: ArrayLike) -> Floats:
        """The time derivative of the momentum matrix along the velocity `v` [Orin, Goswami & Lee 2013]."""
        ...
