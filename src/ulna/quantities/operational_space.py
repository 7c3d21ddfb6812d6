"""The dynamics of a robot at one of its frames."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING, Any, final

from ulna.algorithms.multibody.references import Reference
from ulna.model import Model
from ulna.quantities.deferred_algorithms import algorithms
from ulna.quantities.part import Part
from ulna.quantities.quantity import frame_of, quantity
from ulna.typing import Array, ArrayLike, Floats

if TYPE_CHECKING:
    from ulna.algorithms import Representation


def _at_frame(algorithm: Any) -> Any:
    """An algorithm that takes a task, as one that takes what a task is made of."""

    @functools.wraps(algorithm)
    def run(model: Model, *arrays: Array, frame: Any, **options: Any) -> Array:
        return algorithm(model, *arrays, algorithms.Task(frame_of(model, frame), **options))

    return run


def _stages_at_frame(stages: Any) -> Any:
    """As `_at_frame`, of a function that makes a form of stages."""
    return lambda model, frame, **options: stages(model, algorithms.Task(frame_of(model, frame), **options))


@final
class OperationalSpace(Part):
    """Inertia, Coriolis matrix, gravity and acceleration of a frame.

    The force that a motion x' of the frame takes is `inertia @ x'' + coriolis @ x' + gravity`. x' is the frame's twist
    in a `reference`, or, with a `representation` ("rpy/xyz", "rpy/zyx", "eul", "exp"), the rates of position and
    angles. Where the Jacobian is singular the inertia is infinite; the damping d bounds it: d^2 I is added to
    J M^-1 J^T. Reference: Khatib 1987.
    """

    __slots__ = ()

    @quantity(
        _at_frame(algorithms.operational_inertia),
        "(6, 6) [kg, kg m, kg m^2]",
        nodes=(230, 39, 1.4),
        inverts_mass=True,
        stages=_stages_at_frame(algorithms.stages_of_operational_inertia),
    )
    def inertia(
        self,
        q: ArrayLike,
        frame: str | None = None,
        reference: Reference = "local_world_aligned",
        representation: Representation | None = None,
        damping: float = 0.0,
    ) -> Floats:
        """The inertia against which a force at the frame works [Khatib 1987]."""
        ...

    @quantity(
        _at_frame(algorithms.operational_coriolis),
        "(6, 6) [N s/m, N s, N m s]",
        nodes=(520, 119, 1.4),
        inverts_mass=True,
        stages=_stages_at_frame(algorithms.stages_of_operational_coriolis),
        stages_from=7,
    )
    def coriolis(
        self,
        q: ArrayLike,
        v: ArrayLike,
        frame: str | None = None,
        reference: Reference = "local_world_aligned",
        representation: Representation | None = None,
        damping: float = 0.0,
    ) -> Floats:
        """The matrix that maps the motion of the frame to Coriolis and centrifugal forces there [Khatib 1987]."""
        ...

    @quantity(
        _at_frame(algorithms.operational_gravity),
        "(6,) [N, N m]",
        nodes=(190, 52, 1.4),
        inverts_mass=True,
        stages=_stages_at_frame(algorithms.stages_of_operational_gravity),
        stages_from=10,
    )
    def gravity(
        self,
        q: ArrayLike,
        frame: str | None = None,
        reference: Reference = "local_world_aligned",
        representation: Representation | None = None,
        damping: float = 0.0,
    ) -> Floats:
        """The force at the frame that holds the robot against gravity [Khatib 1987]."""
        ...

    @quantity(
        _at_frame(algorithms.operational_acceleration), "(6,) [m/s^2, rad/s^2]", nodes=530, inverts_mass=True
    )
    def acceleration(
        self,
        q: ArrayLike,
        v: ArrayLike,
        tau: ArrayLike,
        frame: str | None = None,
        reference: Reference = "local_world_aligned",
        representation: Representation | None = None,
    ) -> Floats:
        """How the frame accelerates under the joint torques `tau` [Khatib 1987]."""
        ...
