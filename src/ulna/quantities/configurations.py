"""The space of a robot's configurations: steps, differences, distances, random points."""

from __future__ import annotations

from typing import Any, final

import numpy as np

from ulna.checks.values import generator, number
from ulna.errors import InputError
from ulna.lazy import Slot, apply, is_deferred
from ulna.numeric import is_symbolic
from ulna.quantities.deferred_algorithms import algorithms
from ulna.quantities.part import Part
from ulna.quantities.quantity import quantity
from ulna.typing import ArrayLike, Floats, Numbers


class Configurations(Part):
    """Configurations as points of a manifold, on which quaternions stay unit."""

    __slots__ = ()

    @quantity(algorithms.integrate, "(nq,) [rad or m]", v="Step, velocity times time, (..., nv) [rad or m].")
    def integrate(self, q: ArrayLike, v: ArrayLike) -> Floats:
        """The configuration reached from `q` by the step `v` [Solà, Deray & Atchuthan 2018, section II].

        Example:
            >>> robot = ulna.load("solo12", root="free_flyer")
            >>> q = robot.configurations["standing"]
            >>> v = np.eye(18)[5]  # the base turns about its z axis
            >>> robot.integrate(q, 0.5 * v)[3:7].round(3)
            array([0.   , 0.   , 0.247, 0.969])
        """
        ...

    @quantity(algorithms.difference, "(nv,) [rad or m]")
    def difference(self, q0: ArrayLike, q1: ArrayLike) -> Floats:
        """The step that leads from `q0` to `q1`: `integrate(q0, difference(q0, q1))` is `q1`
        [Solà, Deray & Atchuthan 2018, section II].

        Example:
            >>> robot = ulna.load("panda")
            >>> q = robot.configurations["ready"]
            >>> robot.difference(q, q + 0.1).round(6)
            array([0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1])
        """
        ...

    @quantity(algorithms.interpolate, "(nq,) [rad or m]")
    def interpolate(self, q0: ArrayLike, q1: ArrayLike, t: ArrayLike) -> Floats:
        """The point at `t` on the geodesic from `q0` to `q1`; batches of `t` broadcast.

        Example:
            >>> robot = ulna.load("panda")
            >>> q = robot.configurations["ready"]
            >>> robot.interpolate(q, robot.neutral, [0.0, 0.5, 1.0]).shape
            (3, 7)
        """
        ...

    def random_configuration(self, size: int | tuple[int, ...] = (), seed: Any = None) -> Floats:
        """Random configurations within the limits.

        Coordinates without limits are drawn as the joint kind says: angles from [-pi, pi], lengths from [-1, 1] m,
        rotations uniformly.

        Args:
            size: How many, or a shape.
            seed: A number or a `numpy.random.Generator`; None for other ones at each call.

        Returns:
            Configurations, (*size, nq) [rad or m].

        Raises:
            InputError: If `size` is no count or tuple of counts.

        Example:
            >>> robot = ulna.load("panda")
            >>> robot.random_configuration(1000, seed=0).shape
            (1000, 7)
        """
        shape = tuple(np.atleast_1d(np.asarray(size)).tolist()) if np.size(size) else ()
        if not all(isinstance(n, int) and n >= 0 for n in shape):
            raise InputError(f"`size` is {size!r}; expected a count or a tuple of counts.")
        return algorithms.random(self.model, generator("seed", seed), shape)


@final
class ConfigurationSpace(Part):
    """Distances of configurations, and configurations made valid; steps are on the robot: `robot.integrate`."""

    __slots__ = ()

    @quantity(algorithms.normalize, "(nq,) [rad or m]", options={})
    def normalize(self, q: ArrayLike) -> Floats:
        """The same pose with unit quaternions and free angles in (-pi, pi]; InputError where a quaternion is zero."""
        if is_deferred(q):  # block by block, what is refused, too
            shape = (self.model.nq,)
            slot = Slot("q", shape, np.float64, self.model.position_names)
            return apply(self.normalize, (q,), [slot], [Slot("", shape)])
        out = self._kernel("normalize")(q)
        if not is_symbolic(out) and np.isnan(out).any():
            raise InputError(
                "`q` holds a quaternion of length 0, which is no rotation and cannot be normalised."
            )
        return out

    @quantity(algorithms.distance, "() [rad or m]")
    def distance(self, q0: ArrayLike, q1: ArrayLike) -> Numbers:
        """Length of the difference of two configurations."""
        ...

    @quantity(algorithms.squared_distance, "() [rad^2 or m^2]")
    def squared_distance(self, q0: ArrayLike, q1: ArrayLike) -> Numbers:
        """Square of the distance of two configurations."""
        ...

    def is_same(self, q0: ArrayLike, q1: ArrayLike, tolerance: float = 1e-9) -> Any:
        """Whether two configurations place the robot alike.

        Args:
            q0: Configuration, (..., nq) [rad or m].
            q1: Configuration, (..., nq) [rad or m].
            tolerance: Greatest entry of their difference [rad or m].

        Returns:
            Truth values, (...).

        Raises:
            ShapeError, DtypeError, NonFiniteError: If an array has another shape or type, or is not finite.
        """
        tolerance = number("tolerance", tolerance, "a number of zero or more [rad or m]", least=0.0)
        return (np.abs(self._kernel("difference")(q0, q1)) <= tolerance).all(axis=-1)
