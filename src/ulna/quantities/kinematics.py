"""Where the frames of a robot are, and how they move with its joints."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal, get_args

import numpy as np

from ulna.algorithms.multibody.references import Reference
from ulna.checks.values import one_of
from ulna.model import Frame, Model
from ulna.quantities.deferred_algorithms import algorithms
from ulna.quantities.part import Part
from ulna.quantities.quantity import frame_of, of_frame, quantity
from ulna.typing import Array, ArrayLike, Floats, Numbers

if TYPE_CHECKING:
    from ulna.algorithms import Representation

FrameName = str | Sequence[str] | None
Measure = Literal["yoshikawa", "inverse_condition", "minimum_singular_value", "asada"]


def _frame_poses(model: Model, q: Array, frame: Any) -> Array:
    """Of one frame (4, 4), of several (k, 4, 4)."""
    if frame == "all" or isinstance(frame, tuple):
        names = model.frame_names if frame == "all" else frame
        return _stacked(model, q, [model.frame(name) for name in names])
    return algorithms.frame_pose(model, q, frame_of(model, frame)).matrix()


def _stages_of_frame_pose(model: Model, frame: Any) -> Any:
    """Of one frame; None for several."""
    if frame == "all" or isinstance(frame, tuple):
        return None
    return algorithms.stages_of_frame_pose(model, frame_of(model, frame))


def _stacked(model: Model, q: Array, frames: Sequence[Frame]) -> Array:
    matrices = [T.matrix() for T in algorithms.frame_poses(model, q, frames)]
    return np.stack(matrices, axis=-3) if matrices else np.zeros((*q.shape[:-1], 0, 4, 4))


def _link_poses(model: Model, q: Array) -> Array:
    return _stacked(model, q, [model.frame(name) for name in model.link_names])


def _frame_velocity(model: Model, q: Array, v: Array, frame: Any, reference: Any) -> Array:
    return algorithms.frame_velocity(model, q, v, frame_of(model, frame), reference).vector()


def _frame_acceleration(model: Model, *arrays: Array, frame: Any, **options: Any) -> Array:
    q, v, a = arrays
    return algorithms.frame_acceleration(model, q, v, a, frame_of(model, frame), **options).vector()


class Kinematics(Part):
    """Poses, Jacobians, velocities and accelerations of frames, and how far they are from singular."""

    __slots__ = ()

    @quantity(
        _frame_poses,
        "(4, 4) [m]",
        name="fk",
        returns="T_world_frame, which maps coordinates of the frame to the world; of several frames (..., k, 4, 4)",
        nodes=58,
        stages=_stages_of_frame_pose,
        stages_from=16,
        scans=True,
        frame='Name; None for the tool, a list of names for several, "all" for every frame, as in `frame_names`.',
    )
    def fk(
        self, q: ArrayLike, frame: FrameName = None, out: Floats | None = None, threads: int | None = None
    ) -> Floats:
        """Forward kinematics: the pose of a frame in the world [Featherstone 2008, section 4.1].

        Example:
            >>> robot = ulna.load("panda")
            >>> T = robot.fk([0, 0.3, 0, -1.6, 0, 1.9, 0])
            >>> T[:3, 3].round(3)
            array([0.65 , 0.   , 0.354])
            >>> robot.fk(np.zeros((1000, 7)), ["panda_link4", "panda_hand"]).shape
            (1000, 2, 4, 4)
        """
        ...

    @quantity(
        _link_poses, "(nlinks, 4, 4) [m]", returns="T_world_link, in the order of `link_names`", nodes=58
    )
    def link_poses(self, q: ArrayLike) -> Floats:
        """Poses of all links in the world.

        Example:
            >>> robot = ulna.load("panda")
            >>> q = robot.configurations["ready"]
            >>> robot.link_poses(q).shape, len(robot.link_names)
            ((13, 4, 4), 13)
        """
        ...

    @quantity(
        of_frame(algorithms.frame_jacobian),
        "(6, nv) [m/rad or 1, 1 or rad/m]",
        name="jacobian",
        nodes=70,
        stages=of_frame(algorithms.stages_of_frame_jacobian),
        stages_from=16,
        scans=True,
    )
    def jacobian(
        self,
        q: ArrayLike,
        frame: str | None = None,
        reference: Reference = "local_world_aligned",
        out: Floats | None = None,
        threads: int | None = None,
    ) -> Floats:
        """The Jacobian of a frame: maps joint velocities to the frame's twist, linear part first
        [Featherstone 2008, section 4.1; Siciliano et al. 2009, section 3.1].

        Example:
            >>> robot = ulna.load("panda")
            >>> q, v = robot.configurations["qr"], np.full(7, 0.1)
            >>> J = robot.jacobian(q, "panda_hand", "local")
            >>> np.allclose(J @ v, robot.frame_velocity(q, v, "panda_hand", "local"))
            True
        """
        ...

    @quantity(
        of_frame(algorithms.frame_jacobian_dot),
        "(6, nv) [m/(rad s) or 1/s, 1/s or rad/(m s)]",
        name="jacobian_dot",
        nodes=116,
    )
    def jacobian_dot(
        self,
        q: ArrayLike,
        v: ArrayLike,
        frame: str | None = None,
        reference: Reference = "local_world_aligned",
    ) -> Floats:
        """Time derivative of the Jacobian of a frame along the velocity `v`.

        Example:
            >>> robot = ulna.load("panda")
            >>> q = robot.configurations["ready"]
            >>> robot.jacobian_dot(q, np.full(7, 0.1)).shape
            (6, 7)
        """
        ...

    @quantity(_frame_velocity, "(6,) [m/s, rad/s]", nodes=97)
    def frame_velocity(
        self,
        q: ArrayLike,
        v: ArrayLike,
        frame: str | None = None,
        reference: Reference = "local_world_aligned",
    ) -> Floats:
        """Twist of a frame, linear part first [Featherstone 2008, section 4.1].

        Example:
            >>> robot = ulna.load("panda")
            >>> q = robot.configurations["ready"]
            >>> robot.frame_velocity(q, [1, 0, 0, 0, 0, 0, 0]).round(3)
            array([0.   , 0.307, 0.   , 0.   , 0.   , 1.   ])
        """
        ...

    @quantity(
        _frame_acceleration,
        "(6,) [m/s^2, rad/s^2]",
        classical="Whether the linear part is the acceleration of the frame's origin, instead of the spatial one.",
        nodes=144,
    )
    def frame_acceleration(
        self,
        q: ArrayLike,
        v: ArrayLike,
        a: ArrayLike,
        frame: str | None = None,
        reference: Reference = "local_world_aligned",
        classical: bool = False,
    ) -> Floats:
        """Acceleration of a frame, linear part first: the spatial one, or the classical one of its origin
        [Featherstone 2008, section 2.11].

        Example:
            >>> robot = ulna.load("panda")
            >>> q = robot.configurations["ready"]
            >>> v = [1, 0, 0, 0, 0, 0, 0]
            >>> robot.frame_acceleration(q, v, np.zeros(7), classical=True).round(3)
            array([-0.307, -0.   ,  0.   ,  0.   ,  0.   ,  0.   ])
        """
        ...

    @quantity(
        of_frame(algorithms.analytical_jacobian),
        "(6, nv) [m/rad or 1, 1 or rad/m]",
        representation='Angles: "rpy/xyz", "rpy/zyx", "eul" or "exp".',
        nodes=84,
    )
    def analytical_jacobian(
        self, q: ArrayLike, representation: Representation = "rpy/xyz", frame: str | None = None
    ) -> Floats:
        """Jacobian of a frame whose lower rows belong to rates of angles instead of the angular velocity
        [Siciliano et al. 2009, section 3.6].

        Example:
            >>> robot = ulna.load("panda")
            >>> q = robot.configurations["ready"]
            >>> robot.analytical_jacobian(q, "rpy/zyx").shape
            (6, 7)
        """
        ...

    @quantity(
        of_frame(algorithms.manipulability),
        "()",
        options={"frame": None, "axes": "all"},
        direct=True,
        measure='"yoshikawa" (compiled), "inverse_condition", "minimum_singular_value", or "asada" (of the inertia).',
        nodes=141,
    )
    def manipulability(
        self, q: ArrayLike, measure: Measure = "yoshikawa", axes: Any = "all", frame: str | None = None
    ) -> Numbers:
        """How far the Jacobian of a frame is from losing rank; see `ulna.algorithms.kinematics.manipulability`
        [Yoshikawa 1985; Asada 1983].

        Example:
            >>> robot = ulna.load("panda")
            >>> q = robot.configurations["ready"]
            >>> robot.manipulability(q).round(4)
            np.float64(0.0802)
            >>> robot.manipulability(q, "minimum_singular_value").round(4)
            np.float64(0.2211)
        """
        one_of("measure", measure, get_args(Measure))
        if measure == "yoshikawa":
            return self._kernel("manipulability", frame, axes)(q)
        if measure == "asada":
            return algorithms.asada(self.jacobian(q, frame), self._kernel("mass_matrix")(q), axes)
        return algorithms.measure_of(self.jacobian(q, frame), measure, axes)
