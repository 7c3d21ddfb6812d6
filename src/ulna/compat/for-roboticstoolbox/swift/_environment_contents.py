"""What is in an environment: robots, assemblies, shapes and controls; added, found by name or number, removed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from swift._controls import UnknownObject
from swift._element import SwiftElement
from swift._handles import AssemblyHandle, PartsHandle
from swift._launch import LaunchedEnvironment
from swift._robot import RobotHandle
from swift._scene_items import Callback, ShapeHandle
from ulna.checks.values import fraction
from ulna.errors import InputError


class Contents(LaunchedEnvironment):
    """An environment with robots, shapes and controls."""

    def add(
        self,
        ob: Any,
        robot_alpha: float = 1.0,
        collision_alpha: float = 0.0,
        readonly: bool = False,
        name: str | None = None,
    ) -> Any:
        """Add a robot, a shape or a control.

        Args:
            ob: What to add.
            robot_alpha: How opaque a robot is, from 0 to 1 [-].
            collision_alpha: How opaque what it collides with is [-].
            readonly: Whether a robot is shown only, never moved.
            name: A name, for `env[name]`, and of a control for `env.values[name]`.

        Returns:
            A handle of a robot, the number of a shape, the control itself.

        Raises:
            InputError: It is nothing that can be added, or a control that is there already.
            ViewerError: The environment was not launched.
        """
        if isinstance(ob, SwiftElement):
            return self.add_ui(ob, name)
        if hasattr(ob, "ulna"):
            return self.add_robot(ob, robot_alpha, collision_alpha, readonly, name=name)
        if hasattr(ob, "draw") and hasattr(ob, "_wT"):
            return self.add_shape(ob, name=name)
        raise InputError(
            f"Cannot add {ob!r}; expected a robot of roboticstoolbox, a shape of spatialgeometry, or a control such as "
            "swift.Slider."
        )

    def add_robot(
        self,
        robot: Any,
        robot_alpha: float = 1.0,
        collision_alpha: float = 0.0,
        readonly: bool = False,
        callback: Callback | None = None,
        name: str | None = None,
    ) -> AssemblyHandle:
        """Add a robot.

        Its state is `robot.q` and `robot.qd`, and the handle's `q` and `qd` are the same ones: assign to whichever you
        like, before or after. A robot that is added a second time gets a handle with a separate state.

        Args:
            robot: The robot.
            robot_alpha: How opaque it is, from 0 to 1 [-].
            collision_alpha: How opaque what it collides with is [-].
            readonly: Whether it is shown only, never moved.
            callback: Called before each step with the time and the values of named controls; returns the new `q`.
            name: A name, for `env[name]`.

        Returns:
            Its handle.

        Raises:
            InputError: An opacity is out of range.
        """
        alphas = fraction("robot_alpha", robot_alpha), fraction("collision_alpha", collision_alpha)
        has_separate_state = self.has(robot)
        more = self._item_options(name, callback)
        return self._register(RobotHandle(self.viewer, robot, alphas, readonly, has_separate_state, **more))

    def add_assembly(
        self,
        fk: Callable[[Any], Sequence[Any]],
        parts: Sequence[Any],
        q0: Any = None,
        callback: Callback | None = None,
        readonly: bool = False,
        name: str | None = None,
    ) -> AssemblyHandle:
        """Add shapes that a function of joint coordinates places.

        Args:
            fk: Returns the world pose of each part at `q`.
            parts: The shapes.
            q0: The joint coordinates at first.
            callback: As for `add_robot`.
            readonly: Whether it is shown only, never moved.
            name: A name, for `env[name]`.

        Returns:
            Its handle.
        """
        return self._register(
            PartsHandle(self.viewer, fk, parts, q0, readonly, **self._item_options(name, callback))
        )

    def add_shape(self, shape: Any, callback: Callback | None = None, name: str | None = None) -> int:
        """Add a shape; one that is there already keeps its number, and takes a callback and a name that are passed.

        Args:
            shape: The shape.
            callback: Called before each step with the time and the values of named controls; returns the new
                pose.
            name: A name, for `env[name]`.

        Returns:
            Its number.

        Raises:
            InputError: Something else has that name.
        """
        item = next((item for item in self._items.values() if item.thing is shape), None)
        if item is None:
            return self._register(ShapeHandle(self.viewer, shape, **self._item_options(name, callback))).id
        if name not in (None, item.name):
            item.name = self._item_options(name, callback)["name"]
        if callback is not None:
            item.callback = callback
        return item.id

    def add_ui(self, element: SwiftElement, name: str | None = None) -> SwiftElement:
        """Add a control to the panel.

        Args:
            element: The control.
            name: Its name among the values that callbacks receive, or None.

        Returns:
            The control.

        Raises:
            InputError: It is there already.
            ViewerError: The environment was not launched.
        """
        self._controls.add(element, name)
        return element

    def _item_options(self, name: str | None, callback: Callback | None) -> dict[str, Any]:
        if name is not None and any(item.name == name for item in self._items.values()):
            raise InputError(f"There is something named {name!r} already.")
        return {"id": self._next_id, "name": name, "callback": callback}

    def _register(self, item: Any) -> Any:
        self._items[item.id] = item
        self._in_order = tuple(self._items.values())
        self._next_id += 1
        self.viewer.keep_frame()  # where it stands before the first step
        return item

    def remove(self, id: Any) -> None:
        """Take a robot, a shape or a control out, given as itself, or the first two as their handle or number.

        Raises:
            UnknownObject: It is not there.
        """
        if isinstance(id, SwiftElement):
            self._controls.remove(id)
            return
        matching = [
            i for i in self._items.values() if i is id or i.thing is id or (_is_number(id) and i.id == id)
        ]
        if not matching:
            are_several = isinstance(id, list | tuple | set | np.ndarray)
            fix = "env.remove takes one: call it for each of them." if are_several else ""
            raise UnknownObject("object in the environment", id, map(str, self._items), fix)
        for item in matching:
            bodies = [figure.body for figure in item.figures if figure.body is not None]
            item.remove()
            for body in bodies:
                self._simulation.remove(body)
            del self._items[item.id]
            self._in_order = tuple(self._items.values())

    def has(self, thing: Any) -> bool:
        """Whether a robot or a shape is in the environment."""
        return any(item.thing is thing for item in self._items.values())

    def __getitem__(self, key: str | int) -> Any:
        """The handle of a robot or the shape of that name or number."""
        for item in self._items.values():
            if item.name == key if isinstance(key, str) else _is_number(key) and item.id == key:
                return item.thing if isinstance(item, ShapeHandle) else item
        names = [i.name for i in self._items.values() if i.name]
        raise UnknownObject("object in the environment", key, names or (str(i) for i in self._items))

    @property
    def values(self) -> dict[str, Any]:
        """The values of named sliders and menus: one dict, which is kept up to date."""
        return self._controls.values

    @property
    def elements(self) -> dict[int, SwiftElement]:
        """The controls in the panel, by their number."""
        return self._controls.elements

    def show(self) -> None:
        """Print what there is."""
        print(f"Swift over Ulna, t = {self.sim_time:g} s{f', {self.viewer.url}' if self.viewer.url else ''}")
        for item in self._items.values():
            thing = item if isinstance(item, AssemblyHandle) else item.thing
            print(f"  [{item.id}] {thing!r}" + (f" {item.name!r}" if item.name else ""))
        for number, element in self.elements.items():
            print(f"  control {number}: {type(element).__name__} {element.label!r}")


def _is_number(id: Any) -> bool:
    return isinstance(id, int | np.integer) and not isinstance(id, bool)
