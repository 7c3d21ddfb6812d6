"""What is in the environment: moved on in each step, and shown; shapes, and how they are drawn."""

from __future__ import annotations

import abc
import math
from collections.abc import Callable
from typing import Any

import numpy as np

from ulna.sim.kinematic import pose_step
from ulna.typing import Floats

Callback = Callable[[float, dict[str, Any]], Any]


def pose_of(value: Any) -> Floats:
    """A pose (4, 4) from an array or an SE3."""
    return np.asarray(getattr(value, "A", value), dtype=float)


class Item(abc.ABC):
    """Something in the environment.

    Args:
        id: Its number.
        name: Its name, for `env[name]`.
        callback: Called before each step with the time [s] and the values of named controls.
    """

    figures: tuple[Any, ...] = ()
    """What the viewer has of it, if it is a robot."""

    def __init__(self, id: int, name: str | None, callback: Callback | None) -> None:
        self.id, self.name, self.callback = id, name, callback

    @property
    @abc.abstractmethod
    def thing(self) -> Any:
        """What it was made of."""

    @abc.abstractmethod
    def advance(self, t: float, dt: float, values: dict[str, Any]) -> None:
        """Advances the object by one step.

        Args:
            t: Time at the end of the step [s].
            dt: Length of the step [s].
            values: Values of named controls.
        """

    @abc.abstractmethod
    def show(self) -> None:
        """Show where it is, and how it looks by now."""

    @abc.abstractmethod
    def remove(self) -> None:
        """Take it out of the scene."""

    @property
    def drawn(self) -> list[str]:
        """Names in the scene of the shapes that it consists of."""
        return []


class ShapeHandle(Item):
    """A shape; a step moves it by its velocity `v`."""

    def __init__(self, viewer: Any, shape: Any, **more: Any) -> None:
        super().__init__(**more)
        self._shape = shape
        self._drawn = DrawnShape(viewer, shape, self.name or f"{shape.stype} {self.id}")

    @property
    def thing(self) -> Any:
        """The shape."""
        return self._shape

    def advance(self, t: float, dt: float, values: dict[str, Any]) -> None:
        """Advances the shape by one step.

        Args:
            t: Time at the end of the step [s].
            dt: Length of the step [s].
            values: Values of named controls.
        """
        shape = self._shape
        if self.callback is not None:
            shape.T = self.callback(t, values)
        elif np.count_nonzero(shape.v):
            pose, sound = pose_step()(shape.T, shape.v, dt)
            if not math.isfinite(sound):
                shape.v = shape.v  # which raises an error that names what is wrong
            shape.put(pose)

    def show(self) -> None:
        """Show where it is, and how it looks by now."""
        self._drawn.show()

    @property
    def drawn(self) -> list[str]:
        """Names in the scene of the shapes that it consists of."""
        return [self._drawn.name]

    def remove(self) -> None:
        """Take it out of the scene."""
        self._drawn.remove()


class DrawnShape:
    """A shape as the viewer has it: drawn anew when its size or colour changes, moved when it moves."""

    def __init__(self, viewer: Any, shape: Any, name: str) -> None:
        self._viewer, self._shape = viewer, shape
        plain = name.replace("/", ".").strip() or "shape"
        self.name = next(n for n in (plain, *(f"{plain} ({k})" for k in range(2, 10**6))) if n not in viewer)
        self._draw()

    def _draw(self) -> None:
        self._changes, self._pose = self._shape.changes, None
        self._shape.draw(self._viewer, self.name)
        self.show()

    def show(self) -> None:
        """Bring it up to date."""
        shape = self._shape
        if shape.changes != self._changes:
            self._viewer.remove(self.name)
            self._draw()
            return
        pose = shape._wT
        if pose is not self._pose:
            self._pose = pose
            scene = self._viewer.scene
            scene.set_poses(pose, scene.row(self.name))

    def remove(self) -> None:
        """Take it out of the scene."""
        self._viewer.remove(self.name)
