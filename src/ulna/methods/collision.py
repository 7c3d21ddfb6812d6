"""Whether a robot touches itself or its world, how near it is, and when it would."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Literal, final

from ulna.errors import InputError, UnknownName
from ulna.methods.traced import only_numbers
from ulna.quantities.part import Part
from ulna.typing import ArrayLike, Floats

if TYPE_CHECKING:
    from ulna.collision import Distance, Spheres, World

Method = Literal["exact", "spheres"]

_TRACED = (
    "There use ulna.collision.sphere_clearance(robot.model, world), a function of q by covering spheres; or call this "
    "outside, and pass what it finds as an argument."
)

_CACHED_CHECKERS = (
    16  # checkers of worlds used last; a world that changes with every call must not fill the memory
)


class CollisionQueries(Part):
    """Collision of a robot with itself and with a `ulna.collision.World`.

    "exact" asks coal, shape by shape. "spheres" is compiled and far faster; its spheres cover the links, so that it
    never says free where "exact" says touching, but may say touching where there is a small gap. Both leave out
    links that are joined, and the pairs that the model disables (SRDF).
    """

    __slots__ = ()

    def collides(
        self,
        q: ArrayLike,
        world: World | None = None,
        *,
        moving: Mapping[str, ArrayLike] | None = None,
        margin: float = 0.0,
        method: Method = "exact",
        **options: Any,
    ) -> Any:
        """Whether the robot touches itself or the world, (...).

        Args:
            q: Configuration, (..., nq) [rad or m].
            world: Obstacles; None for none.
            moving: Poses of the world's moving obstacles by name, T_world_shape (..., 4, 4).
            margin: What comes as near as this counts as touching [m].
            method: "exact" or "spheres".
            **options: Of `robot.collision.checker`.

        Returns:
            Truth values, (...).

        Raises:
            ShapeError, DtypeError, NonFiniteError: If `q` or a pose cannot be one.
            ModelError: If the robot has no collision geometry, or a mesh file is missing.
            UnknownName: If a name of an obstacle or link is unknown.
            MissingExtra: If what the method needs is not installed.

        Example:
            >>> from ulna.collision import World
            >>> from ulna.geometry import Sphere
            >>> robot = ulna.load("panda")
            >>> q = robot.configurations["ready"]
            >>> world = World().add("ball", Sphere(0.1), (0.5, 0.0, 0.9))
            >>> robot.collides(np.stack([q, robot.configurations["qz"]]), world)
            array([False,  True])
        """
        only_numbers("robot.collides", _TRACED, q)
        return _checker(self, world, method=method, **options).collides(q, moving, margin=margin)

    def distance(
        self,
        q: ArrayLike,
        world: World | None = None,
        *,
        moving: Mapping[str, ArrayLike] | None = None,
        stop_below: float | None = None,
        **options: Any,
    ) -> Distance:
        """How near the robot is to itself and the world: distance, nearest points, normal and names, by coal.

        Args:
            q: Configuration, (..., nq) [rad or m].
            world: Obstacles; None for none.
            moving: Poses of the world's moving obstacles by name, T_world_shape (..., 4, 4).
            stop_below: The first pair this near ends the search [m].
            **options: Of `robot.collision.checker`; distances are those of its method "exact".

        Returns:
            An `ulna.collision.Distance`: `.distance` (...) [m], `.points`, `.normal` and the two names.

        Raises:
            ShapeError, DtypeError, NonFiniteError, ModelError, UnknownName, MissingExtra: As for `collides`.
            InputError: If `method` is "spheres".

        Example:
            >>> from ulna.collision import World
            >>> from ulna.geometry import Sphere
            >>> robot = ulna.load("panda")
            >>> q = robot.configurations["ready"]
            >>> near = robot.distance(q, World().add("ball", Sphere(0.1), (0.8, 0.0, 0.5)))
            >>> round(float(near.distance), 3), near.names
            (0.07, array(['panda_link2', 'panda_link4'], dtype=object))
        """
        only_numbers("robot.distance", _TRACED, q)
        return _exact(self, world, "robot.distance", options).distance(q, moving, stop_below=stop_below)


@final
class Collision(Part):
    """Collision checkers for hot loops, gradients of distances, first contacts, and spheres that cover the links.

    Whether a robot touches something, and how near it is, are `robot.collides` and `robot.distance`.
    """

    __slots__ = ()

    def distance_gradient(
        self,
        q: ArrayLike,
        world: World | None = None,
        *,
        moving: Mapping[str, ArrayLike] | None = None,
        **options: Any,
    ) -> Floats:
        """Gradient of `robot.distance` by the configuration's tangent.

        Args:
            q: Configuration, (..., nq) [rad or m].
            world: Obstacles; None for none.
            moving: Poses of the world's moving obstacles by name, T_world_shape (..., 4, 4).
            **options: Of `checker`.

        Returns:
            The gradient, (..., nv) [m/rad or 1].

        Raises:
            ShapeError, DtypeError, NonFiniteError, ModelError, UnknownName, MissingExtra: As for `robot.collides`.
        """
        only_numbers("robot.collision.distance_gradient", _TRACED, q)
        return _exact(self, world, "robot.collision.distance_gradient", options).gradient(q, moving)

    def first_contact(
        self,
        q0: ArrayLike,
        q1: ArrayLike,
        world: World | None = None,
        *,
        moving: Mapping[str, ArrayLike] | None = None,
        margin: float = 0.0,
        **options: Any,
    ) -> Any:
        """When the motion from `q0` to `q1` at constant velocity first touches; no contact between samples is missed.

        Continuous joints take the shorter way.

        Args:
            q0: Configuration at the start, (..., nq) [rad or m].
            q1: Configuration at the end, (..., nq) [rad or m].
            world: Obstacles; None for none.
            moving: Poses of the world's moving obstacles by name, T_world_shape (..., 4, 4).
            margin: What comes as near as this counts as touching [m].
            **options: Of `checker`.

        Returns:
            Times in [0, 1], inf for never, (...); see `ulna.collision.first_contact`.

        Raises:
            ShapeError, DtypeError, NonFiniteError, ModelError, UnknownName, MissingExtra: As for `robot.collides`.
        """
        from ulna import collision

        only_numbers("robot.collision.first_contact", _TRACED, q0, q1)
        return collision.first_contact(
            _exact(self, world, "robot.collision.first_contact", options), q0, q1, margin, moving
        )

    def checker(self, world: World | None = None, *, method: Method = "exact", **options: Any) -> Any:
        """The checker behind these methods, for hot loops; the checkers used last are cached.

        Args:
            world: Obstacles; None for none.
            method: "exact" or "spheres".
            **options: Of "exact": pairs, without, convex, missing; of "spheres": spheres, pairs, missing,
                tables.

        Returns:
            An `ulna.collision.Checker`, or a `SphereChecker` for "spheres".

        Raises:
            UnknownName: If there is no such method.
            InputError: If `world` is no World.
        """
        return _checker(self, world, method=method, **options)

    def spheres(
        self,
        tolerance: float = 0.01,
        most: int | None = None,
        *,
        progress: Callable[[int, int], object] | None = None,
    ) -> Spheres:
        """Spheres that cover the links; see `ulna.collision.fit`.

        Args:
            tolerance: How far spheres may stick out at the tips [m]; farther where there are too few.
            most: How many spheres a link has on average, at most; None for 60 and 5.5 more for each link.
            progress: Called with the numbers of steps that are done, and of all.

        Returns:
            The spheres of all links.
        """
        from ulna import collision

        return collision.fit(self.model, tolerance, most, progress=progress)


def _checker(part: Part, world: World | None = None, *, method: Method = "exact", **options: Any) -> Any:
    """The checker of a robot and a world, made when first asked for."""
    from ulna import collision

    makers = {"exact": collision.Checker, "spheres": collision.SphereChecker}
    if method not in makers:
        raise UnknownName("method of collision checking", method, makers)
    option_key = tuple((name, _cache_key(value)) for name, value in sorted(options.items()))
    if not (world is None or isinstance(world, collision.World)):
        raise InputError(f"`world` is {world!r}; expected a World, as `World().add(...)` makes.")
    key = world and world.fingerprint, method, option_key
    cache = part._searches.setdefault("collision", {})
    checker = cache.pop(key, None)
    if checker is None:
        checker = makers[method](part.model, world, **options)
    cache[key] = checker
    for old in list(cache)[:-_CACHED_CHECKERS]:
        cache.pop(old, None)  # another thread may have been faster
    return checker


def _exact(part: Part, world: World | None, caller: str, options: Mapping[str, Any]) -> Any:
    """The exact checker; spheres know no distances."""
    if options.get("method", "exact") == "spheres":
        raise InputError(
            f"`{caller}` is exact, by coal, and takes no method='spheres'; `robot.collides` does."
        )
    return _checker(part, world, **options)


def _cache_key(value: Any) -> Any:
    """A value as a key: collections by content, spheres by fingerprint."""
    if isinstance(value, (list, tuple, set, frozenset)):
        return tuple(_cache_key(item) for item in value)
    return getattr(value, "fingerprint", value)
