"""The space of a robot's configurations: steps, differences, distances, random points."""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna import algorithms
from ulna.errors import InputError
from ulna.methods.base import Part
from ulna.typing import ArrayLike, Floats


class ConfigurationSpace(Part):
    """Configurations as points of a manifold, on which quaternions stay unit."""

    __slots__ = ()

    def integrate(self, q: ArrayLike, v: ArrayLike) -> Any:
        """The configuration reached from `q` by the step `v` (velocity times time), (..., nq)."""
        return self._plain["integrate"](q, v)

    def difference(self, q0: ArrayLike, q1: ArrayLike) -> Any:
        """The step that leads from `q0` to `q1`, (..., nv): `integrate(q0, difference(q0, q1))` is `q1`."""
        return self._plain["difference"](q0, q1)

    def interpolate(self, q0: ArrayLike, q1: ArrayLike, t: ArrayLike) -> Any:
        """The point at `t` in [0, 1] on the way from `q0` to `q1`, (..., nq); batches of `t` broadcast."""
        return self._plain["interpolate"](q0, q1, t)

    def normalize(self, q: ArrayLike) -> Any:
        """`q` with its quaternions made unit, (..., nq)."""
        out = self._plain["normalize"](q)
        if np.isnan(out).any():
            raise InputError(
                "`q` holds a quaternion of length 0, which is no rotation and cannot be normalised."
            )
        return out

    def configuration_distance(self, q0: ArrayLike, q1: ArrayLike) -> Any:
        """Length of the difference of two configurations, (...)."""
        return self._plain["distance"](q0, q1)

    def squared_distance(self, q0: ArrayLike, q1: ArrayLike) -> Any:
        """Square of the distance of two configurations, (...)."""
        return self._plain["squared_distance"](q0, q1)

    def is_same_configuration(self, q0: ArrayLike, q1: ArrayLike, tolerance: float = 1e-9) -> Any:
        """Whether two configurations place the robot alike, (...): no entry of their difference is larger."""
        return (np.abs(self.difference(q0, q1)) <= tolerance).all(axis=-1)

    def integrate_derivatives(self, q: ArrayLike, v: ArrayLike) -> tuple[Floats, Floats]:
        """Derivatives of `integrate` by `q` and by `v` on the tangent spaces, (..., nv, nv) each."""
        return self._plain["integrate_derivatives"](q, v)

    def difference_derivatives(self, q0: ArrayLike, q1: ArrayLike) -> tuple[Floats, Floats]:
        """Derivatives of `difference` by `q0` and by `q1` on the tangent spaces, (..., nv, nv) each."""
        return self._plain["difference_derivatives"](q0, q1)

    def random_configuration(self, size: int | tuple[int, ...] = (), seed: Any = None) -> Floats:
        """Random configurations within the limits, (*size, nq).

        `seed` is a number or a `numpy.random.Generator`. Coordinates without limits are drawn as the joint kind says:
        angles from [-pi, pi], lengths from [-1, 1] m, rotations uniformly.
        """
        shape = tuple(np.atleast_1d(np.asarray(size)).tolist()) if np.size(size) else ()
        if not all(isinstance(n, int) and n >= 0 for n in shape):
            raise InputError(f"`size` is {size!r}; expected a count or a tuple of counts.")
        return algorithms.random(self.model, np.random.default_rng(seed), shape)
