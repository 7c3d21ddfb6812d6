"""Whether a robot touches things, and bounds on velocities that keep it from doing so.

| symbol | meaning | unit |
|---|---|---|
| d, grad d | distance of a link from a shape, its gradient by the configuration | [m], [m/rad] |
| di, ds | distances at which damping begins, and at which it stops the approach | [m] |
| c, t, p | the camera, what it looks at, the point of the line between them that is nearest to the link | [m] |
| xi | gain: -grad d qd <= xi (d - ds) / (di - ds) | [m/s] |

Source: Faverjon & Tournassoud 1987, A local based approach for path planning of manipulators.
"""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np

from roboticstoolbox._common.numbers import vector
from roboticstoolbox._common.poses import along, matrix
from roboticstoolbox._links.shapes import obstacle
from roboticstoolbox._mixins.robot_mixin import RobotMixin
from ulna.errors import InputError
from ulna.geometry import Cylinder, Shape
from ulna.typing import Floats

_SHAPE = "the shape"


class Collision(RobotMixin):
    """Contacts and distances."""

    def _nearby_links(self, q: Any, shape: Any, within: float, links: Any = None) -> list[Any]:
        """The nearest pairs of links and a shape or a group of shapes, one for each link within the distance."""
        pairs = []
        for part in shape._parts() if hasattr(shape, "_parts") else [shape]:
            solid, T = obstacle(part)
            pairs += self._links_near_solid(q, solid, T.matrix(), within, links)
        nearest = {pair.names[0]: pair for pair in sorted(pairs, key=lambda pair: -pair.distance)}
        return [nearest[name] for name in self.link_dict if name in nearest]

    def _links_near_solid(
        self, q: Any, solid: Shape, T: Floats, within: float, links: Any = None
    ) -> list[Any]:
        from ulna import collision

        body = self._complete_robot()
        self._require_shapes()
        checker = body.collision.checker(collision.World().add(_SHAPE, solid, moving=True), pairs=())
        carried = T if self._parent is None else np.linalg.solve(self._parent._wT, T)
        near = checker.nearest(self._complete_configuration(q), {_SHAPE: carried}, within=within)
        order = list(self.link_dict)
        selected = [pair for pair in near if links is None or pair.names[0] in links]
        return sorted(selected, key=lambda pair: order.index(pair.names[0]))

    def _require_shapes(self) -> None:
        if not any(link._solids for link in self.link_dict.values()):
            raise InputError(f"Robot {self.name!r} has no collision shapes; set `collision` of its links.")

    def _links_between(self, start: Any, end: Any) -> list[str] | None:
        """Names of the links from `start` to `end` with shapes; None for all."""
        if end is None and start is None:
            return None
        return [link.name for link in self.get_path(end, start)[0] if link._solids]

    def iscollided(self, q: Any, shape: Any, skip: bool = False) -> bool:
        """Whether the robot touches a shape; itself, if that is given.

        Args:
            q: Configuration (n,) [rad or m]; None for the robot's.
            shape: A shape of spatialgeometry or a group of them, or the robot itself.
            skip: Whether to leave links where they are, at the robot's configuration, whatever `q` is.

        Returns:
            Whether they touch.
        """
        if shape is self:
            return self.isselfcollided(q, skip)
        return any(
            pair.distance <= 0.0
            for pair in self._nearby_links(self.q if q is None or skip else q, shape, 0.01)
        )

    def collided(self, q: Any, shape: Any, skip: bool = False) -> bool:
        """The former name of `iscollided`.

        Args:
            q: Configuration (n,) [rad or m]; None for the robot's.
            shape: A shape of spatialgeometry or a group of them, or the robot itself.
            skip: Whether to leave links where they are, at the robot's configuration, whatever `q` is.

        Returns:
            Whether they touch.
        """
        warnings.warn("collided is the former name of iscollided", FutureWarning, stacklevel=2)
        return self.iscollided(q, shape, skip)

    def isselfcollided(self, q: Any = None, skip: bool = False) -> bool:
        """Whether two links touch that are not joined.

        Args:
            q: Configuration (n,) [rad or m]; None for the robot's.
            skip: Whether to leave links where they are, at the robot's configuration, whatever `q` is.

        Returns:
            Whether they do.
        """
        self._require_shapes()
        return bool(
            self._complete_robot().collides(self._complete_configuration(self.q if q is None or skip else q))
        )

    def closest_point(
        self, q: Any, shape: Any, inf_dist: float = 1.0, skip: bool = False
    ) -> tuple[float | None, Floats | None, Floats | None]:
        """The points of the robot and of a shape that are nearest to each other.

        Args:
            q: Configuration (n,) [rad or m]; None for the robot's.
            shape: A shape of spatialgeometry, or a group of them.
            inf_dist: Greatest distance that counts [m].
            skip: Whether to leave links where they are, at the robot's configuration, whatever `q` is.

        Returns:
            Distance [m], point of the robot (3,) [m], point of the shape (3,) [m]; or None, None, None.
        """
        near = self._nearby_links(self.q if q is None or skip else q, shape, inf_dist)
        if not near:
            return None, None, None
        best = min(near, key=lambda pair: pair.distance)
        return best.distance, best.points[0], best.points[1]

    def joint_velocity_damper(
        self, q: Any = None, ps: float = 0.05, pi: float = 0.1, n: int | None = None, gain: float = 1.0
    ) -> tuple[Floats, Floats]:
        """A and b of A qd <= b that keep joints from their limits, (n, n) and (n,).

        Args:
            q: Configuration, (n,).
            ps: Least distance from a limit [rad or m].
            pi: Distance at which damping begins [rad or m].
            n: How many of the joints; None for all.
            gain: Greatest speed at that distance [rad/s or m/s].

        Returns:
            A (n, n) and b (n,).
        """
        at = vector("q", self.q if q is None else q, self.n)
        count = self.n if n is None else n
        A, b = np.zeros((count, count)), np.zeros(count)
        for i, (x, low, high) in enumerate(zip(at[:count], *self.qlim[:, :count], strict=True)):
            for side, margin in ((-1.0, x - low), (1.0, high - x)):
                if margin <= pi:
                    A[i, i], b[i] = side, gain * (margin - ps) / (pi - ps)
        return A, b

    def link_collision_damper(
        self,
        shape: Any,
        q: Any = None,
        di: float = 0.3,
        ds: float = 0.05,
        xi: float = 1.0,
        end: Any = None,
        start: Any = None,
        collision_list: Any = None,
    ) -> tuple[Floats | None, Floats | None]:
        """A and b of A qd <= b that keep links from a shape, a row for each link that is near; None without any.

        Args:
            shape: The shape; where it has a velocity `v`, that counts.
            q: Configuration, (n,).
            di: Distance at which damping begins [m].
            ds: Least distance [m].
            xi: Greatest speed of approach at `di` [m/s].
            end: Last link that counts.
            start: First link that counts.
            collision_list: Not supported; raises InputError.

        Returns:
            A (k, n) and b (k,), or None and None.
        """
        _reject_collision_list(collision_list)
        near = self._nearby_links(self.q if q is None else q, shape, di, self._links_between(start, end))
        movable = [pair for pair in near if pair.gradient[: self.n].any()]  # the base cannot give way
        if not movable:
            return None, None
        A = -np.array([pair.gradient for pair in movable])[:, : self.n]
        b = np.array(
            [xi * (pair.distance - ds) / (di - ds) + _retreat_speed(shape, pair) for pair in movable]
        )
        return A, b

    def vision_collision_damper(
        self,
        shape: Any,
        camera: Any = None,
        camera_n: int = 0,
        q: Any = None,
        di: float = 0.3,
        ds: float = 0.05,
        xi: float = 1.0,
        end: Any = None,
        start: Any = None,
        collision_list: Any = None,
    ) -> tuple[Floats | None, Floats | None]:
        """A and b of A qd <= b that keep links out of a camera's line of sight, a row for each link that is near it.

        A point of the line moves with the camera as |p - t| / |c - t| of it, and with the shape as the rest.

        Args:
            shape: What the camera looks at; its velocity `v` counts.
            camera: A pose, or a robot that carries the camera at its end.
            camera_n: Number of joints at the end of the robot that carries the camera that this robot does not have.
                Columns of A for them come last; its other joints are the first ones of this robot.
            q: Configuration, (n,).
            di: Distance at which damping begins [m].
            ds: Least distance [m].
            xi: Greatest speed of approach at `di` [m/s].
            end: Last link that counts.
            start: First link that counts.
            collision_list: Not supported; raises InputError.

        Returns:
            A (k, n) and b (k,), or None and None.
        """
        _reject_collision_list(collision_list)
        carries = hasattr(camera, "jacob0")
        c = matrix(camera.fkine(camera.q) if carries else camera)[:3, 3]
        t = np.asarray(shape._wT, dtype=float)[:3, 3]
        length = float(np.linalg.norm(c - t))
        line = along((c - t) / length, 0.5 * (c + t))
        at = self.q if q is None else q
        near = self._links_near_solid(at, Cylinder(0.001, length), line, di, self._links_between(start, end))
        rows, bounds = [], []
        for pair in near:
            row, (link, p) = np.zeros(self.n + camera_n), pair.points
            towards = (p - link) / pair.distance
            row[: self.n] = -pair.gradient[: self.n]
            if carries:
                rate = np.linalg.norm(p - t) / length * (towards @ camera.jacob0(camera.q)[:3])
                shared = camera.n - camera_n
                row[:shared] -= rate[:shared]
                row[self.n :] -= rate[shared:]
            rows.append(row)
            moved = np.linalg.norm(p - c) / length * (towards @ shape.v[:3])
            bounds.append(xi * (pair.distance - ds) / (di - ds) + moved)
        return (np.array(rows), np.array(bounds)) if rows else (None, None)


def _reject_collision_list(collision_list: Any) -> None:
    if collision_list is not None:
        raise InputError(
            "`collision_list` is not offered; the shapes are those of the links from start to end."
        )


def _retreat_speed(shape: Any, pair: Any) -> float:
    """How fast a moving shape moves its nearest point away from the link [m/s]."""
    v = np.asarray(getattr(shape, "v", np.zeros(6)), dtype=float)
    if not v.any():
        return 0.0
    link, p = pair.points
    centre = np.asarray(shape._wT, dtype=float)[:3, 3]
    return float((p - link) @ (v[:3] + np.cross(v[3:], p - centre))) / pair.distance
