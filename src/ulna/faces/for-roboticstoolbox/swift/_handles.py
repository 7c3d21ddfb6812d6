"""What is in the environment: robots, assemblies of parts, shapes; moved on in each step, and shown."""

from __future__ import annotations

import abc
from collections.abc import Callable, Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np

from ulna.errors import InputError, ShapeError
from ulna.spatial import so3_exp
from ulna.typing import Floats

Callback = Callable[[float, dict[str, Any]], Any]

_MODES = ("p", "v", "a")


def pose_of(value: Any) -> Floats:
    """A pose (4, 4) from an array or an SE3."""
    return np.asarray(getattr(value, "A", value), dtype=float)


def model_behind(robot: Any) -> Any:
    """The `ulna.Robot` behind a robot of the toolbox; None where there is none."""
    if hasattr(robot, "ulna"):
        return robot.ulna
    return robot._everything() if hasattr(robot, "_everything") else None


class Item(abc.ABC):
    """Something in the environment.

    Args:
        id: Its number.
        name: Its name, for `env[name]`.
        callback: Called before each step with the time [s] and the values of named controls.
    """

    def __init__(self, id: int, name: str | None, callback: Callback | None) -> None:
        self.id, self.name, self.callback = id, name, callback

    @property
    @abc.abstractmethod
    def thing(self) -> Any:
        """What it was made of."""

    @abc.abstractmethod
    def tell(self, t: float, dt: float, values: dict[str, Any]) -> None:
        """Move it on by `dt` [s], to the time `t`."""

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


class AssemblyHandle(Item):
    """Something with joints: `q` and `qd` are its state, `control_mode` says what a step does.

    "v" moves it at `qd`, held at its joint limits; "p" leaves it at `q`.
    """

    readonly: bool
    robot: Any

    @property
    @abc.abstractmethod
    def _state(self) -> Any:
        """What holds `q`, `qd` and `control_mode`."""

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
        mode = self.control_mode
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


class RobotHandle(AssemblyHandle):
    """A robot in the environment. Its state is the robot's own `q` and `qd`, whichever of the two one assigns to.

    Args:
        viewer: The `ulna.Viewer`.
        robot: A robot of the toolbox, with `q`, `qd`, `qlim`, `base`, and the `ulna.Robot` behind it.
        alphas: Opacity of what it looks like and of what it collides with.
        readonly: Whether it is shown only, never moved.
        own: Whether it has a state of its own, as a robot has that is there already.
        more: As for `Item`.
    """

    def __init__(
        self, viewer: Any, robot: Any, alphas: tuple[float, float], readonly: bool, own: bool, **more: Any
    ) -> None:
        super().__init__(**more)
        self._viewer, self.robot, self.readonly = viewer, robot, bool(readonly)
        self._holds = SimpleNamespace(q=np.array(robot.q), qd=np.array(robot.qd)) if own else robot
        self._model = model_behind(robot)
        limits = getattr(robot, "qlim", None)
        self._low, self._high = (
            (self._model.limits.lower, self._model.limits.upper)
            if limits is None
            else np.array(limits, dtype=float)
        )
        start = self._configuration()
        stands = np.asarray(self._model.link_poses(self._model.neutral))[0]
        self._base = self._placed()
        # a model may have the base built in
        self._within = np.linalg.inv(stands) if np.allclose(stands, self._base) else np.eye(4)
        self.figures = [
            viewer.add(self._model, start, pose=self._base @ self._within, opacity=alpha, show=what)
            for alpha, what in zip(alphas, ("visual", "collision"), strict=True)
            if alpha > 0.0
        ]
        """What the viewer has of it."""

    @property
    def thing(self) -> Any:
        """The robot."""
        return self.robot

    @property
    def _state(self) -> Any:
        return self._holds

    def _joints(self) -> Floats:
        q = np.asarray(self._holds.q, dtype=float)
        if q.shape != self._low.shape:
            raise ShapeError(
                "q", q.shape, f"({len(self._low)},), a number for each joint of {self._model.name!r}"
            )
        return q

    def _configuration(self) -> Floats:
        """The configuration of the model: the joints, and those of grippers where it has them."""
        q = self._joints()
        return q if len(q) == self._model.nq else self.robot._configuration(q)

    def _placed(self) -> Floats:
        return pose_of(getattr(self.robot, "base", np.eye(4)))

    def tell(self, t: float, dt: float, values: dict[str, Any]) -> None:
        """Move it on: joints turn and slide, so that moving is adding."""
        if self._moves(t, values):
            q, qd = self._joints(), np.asarray(self._holds.qd, dtype=float)
            if not np.isfinite(qd.sum()) or qd.shape != q.shape:
                raise InputError(
                    f"`qd` of {self._model.name!r} is {qd.tolist()}; expected {len(q)} finite numbers."
                )
            self._holds.q = np.minimum(np.maximum(q + dt * qd, self._low), self._high)

    def show(self) -> None:
        """Show where it is."""
        q = self._configuration()
        for figure in self.figures:
            figure.q = q
        self._viewer.scene.later(self, self._place)  # a base seldom moves, and asking for it takes time

    def _place(self) -> None:
        base = self._placed()
        if not np.array_equal(base, self._base):
            self._base = base
            for figure in self.figures:
                figure.pose = base @ self._within

    def remove(self) -> None:
        """Take it out of the scene."""
        for figure in self.figures:
            self._viewer.remove(figure)
        self.figures = []

    def part_poses(self) -> list[Any]:
        """Where its links are in the world, an SE3 each."""
        from spatialmath import SE3  # pyright: ignore[reportMissingImports]

        poses = self._placed() @ self._within @ self._model.link_poses(self._configuration())
        return [SE3(T, check=False) for T in poses]


class PartsHandle(AssemblyHandle):
    """Shapes that a function of the joint coordinates places.

    Args:
        viewer: The `ulna.Viewer`.
        fk: Gives the world pose of each part at `q`.
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
        super().__init__(**more)
        self.readonly, self.robot = bool(readonly), None
        self._fk, self._parts = fk, list(parts)
        q = np.array([] if q0 is None else q0, dtype=float).reshape(-1)
        self._holds = SimpleNamespace(q=q, qd=np.zeros(len(q)), control_mode="v")
        label = self.name or f"assembly {self.id}"
        self._drawn = [Drawn(viewer, part, f"{label} · {k}") for k, part in enumerate(self._parts)]
        if len(q):
            self.show()

    @property
    def thing(self) -> Any:
        """It stands for itself."""
        return self

    @property
    def _state(self) -> Any:
        return self._holds

    def tell(self, t: float, dt: float, values: dict[str, Any]) -> None:
        """Move the joint coordinates on."""
        if self._moves(t, values):
            self.q = np.asarray(self.q) + dt * np.asarray(self.qd)

    def show(self) -> None:
        """Place the parts."""
        poses = list(self._fk(self.q))
        if len(poses) != len(self._parts):
            raise InputError(
                f"`fk` gave {len(poses)} poses for {len(self._parts)} parts; expected one for each."
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


class ShapeHandle(Item):
    """A shape; a step moves it by its velocity `v`."""

    def __init__(self, viewer: Any, shape: Any, **more: Any) -> None:
        super().__init__(**more)
        self._shape = shape
        self._drawn = Drawn(viewer, shape, self.name or f"{shape.stype} {self.id}")

    @property
    def thing(self) -> Any:
        """The shape."""
        return self._shape

    def tell(self, t: float, dt: float, values: dict[str, Any]) -> None:
        """Move it on."""
        shape = self._shape
        if self.callback is not None:
            shape.T = self.callback(t, values)
        elif shape.v.any():
            pose, v = shape.T, dt * shape.v
            pose[:3, 3] += v[:3]
            pose[:3, :3] = so3_exp(v[3:]) @ pose[:3, :3]  # v is of the world
            shape.T = pose

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


class Drawn:
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
        if self._shape.changes != self._changes:
            self._viewer.remove(self.name)
            self._draw()
            return
        pose = self._shape._wT
        if pose is not self._pose:
            self._pose = pose
            self._viewer.scene.set_pose(self.name, pose)

    def remove(self) -> None:
        """Take it out of the scene."""
        self._viewer.remove(self.name)
