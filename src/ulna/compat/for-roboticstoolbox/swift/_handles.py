"""Objects with joints: a handle with their state, and assemblies of shapes that a function places."""

from __future__ import annotations

import abc
from collections.abc import Callable, Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np

from swift._scene_items import DrawnShape, Item
from ulna.errors import InputError

_MODES = ("p", "v", "a")


class AssemblyHandle(Item):
    """Something with joints: `q` and `qd` are its state, `control_mode` says what a step does.

    "v" moves it at `qd`, within its joint limits; "p" leaves it at `q`.

    Args:
        state: What has `q`, `qd` and `control_mode`.
        readonly: Whether it is shown only, never moved.
        more: As for `Item`.
    """

    robot: Any = None

    def __init__(self, state: Any, readonly: bool, **more: Any) -> None:
        super().__init__(**more)
        self._state, self.readonly = state, bool(readonly)

    @property
    def q(self) -> Any:
        """The joint coordinates, (n,)."""
        return self._state.q

    @q.setter
    def q(self, q: Any) -> None:
        self._state.q = np.array(q, dtype=float).reshape(-1)

    @property
    def qd(self) -> Any:
        """The joint velocities, (n,) [rad/s or m/s]."""
        return self._state.qd

    @qd.setter
    def qd(self, qd: Any) -> None:
        self._state.qd = np.array(qd, dtype=float).reshape(-1)

    @property
    def control_mode(self) -> str:
        """What a step does: "v" or "p"."""
        return getattr(self._state, "control_mode", "v")

    @control_mode.setter
    def control_mode(self, mode: str) -> None:
        if mode not in _MODES:
            raise InputError(f"`control_mode` is {mode!r}; expected 'p', 'v' or 'a'.")
        self._state.control_mode = mode

    def _moves(self, t: float, values: dict[str, Any]) -> bool:
        """Whether it is to move by its velocity; asks the callback where to be instead, if there is one."""
        if self.callback is not None:
            self.q = self.callback(t, values)
            return False
        mode = getattr(self._state, "control_mode", "v")
        if mode == "a":
            raise NotImplementedError(
                "control_mode 'a' does nothing in Swift. Set `qd` in mode 'v', or see ulna.sim for accelerations "
                "and torques."
            )
        return mode == "v" and not self.readonly

    @abc.abstractmethod
    def part_poses(self) -> list[Any]:
        """Where its parts are in the world, an SE3 each."""

    def __repr__(self) -> str:
        what = self.name or getattr(self.robot, "name", "assembly")
        return f"AssemblyHandle({what!r}, q={np.round(self.q, 4).tolist()})"


class PartsHandle(AssemblyHandle):
    """Shapes that a function of the joint coordinates places.

    Args:
        viewer: The `ulna.Viewer`.
        fk: Returns the world pose of each part at `q`.
        parts: The shapes.
        q0: The joint coordinates at first.
        readonly: Whether it is shown only, never moved.
        more: As for `Item`.
    """

    def __init__(
        self,
        viewer: Any,
        fk: Callable[[Any], Sequence[Any]],
        parts: Sequence[Any],
        q0: Any,
        readonly: bool,
        **more: Any,
    ) -> None:
        q = np.array([] if q0 is None else q0, dtype=float).reshape(-1)
        super().__init__(SimpleNamespace(q=q, qd=np.zeros(len(q)), control_mode="v"), readonly, **more)
        self._fk, self._parts = fk, list(parts)
        label = self.name or f"assembly {self.id}"
        self._drawn: list[DrawnShape] = []
        try:
            for k, part in enumerate(self._parts):
                self._drawn.append(DrawnShape(viewer, part, f"{label} · {k}"))
            if len(q):
                self.show()
        except BaseException:
            self.remove()
            raise

    @property
    def thing(self) -> Any:
        """It stands for itself."""
        return self

    def advance(self, t: float, dt: float, values: dict[str, Any]) -> None:
        """Advances the joint coordinates by one step.

        Args:
            t: Time at the end of the step [s].
            dt: Length of the step [s].
            values: Values of named controls.
        """
        if self._moves(t, values):
            self.q = np.asarray(self.q) + dt * np.asarray(self.qd)

    def show(self) -> None:
        """Place the parts."""
        poses = list(self._fk(self.q))
        if len(poses) != len(self._parts):
            raise InputError(
                f"`fk` returned {len(poses)} poses for {len(self._parts)} parts; expected one for each."
            )
        for part, pose, drawn in zip(self._parts, poses, self._drawn, strict=True):
            part.T = pose
            drawn.show()

    @property
    def drawn(self) -> list[str]:
        """Names in the scene of the shapes that it consists of."""
        return [drawn.name for drawn in self._drawn]

    def remove(self) -> None:
        """Take the parts out of the scene."""
        for drawn in self._drawn:
            drawn.remove()

    def part_poses(self) -> list[Any]:
        """Where its parts are in the world, an SE3 each."""
        return list(self._fk(self.q))
