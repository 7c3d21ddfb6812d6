"""What cannot be a name, a pose, a flag or a table is refused by worlds, constraints and changed robots, and nothing else is raised."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import ulna
from ulna.collision import World
from ulna.errors import UlnaError
from ulna.geometry import Box
from ulna.model import PointContact

ROBOT = ulna.load("panda", visuals="simple")
Q = np.asarray(ROBOT.configurations["ready"])
BOX = Box((0.1, 0.1, 0.1))
WORLD = World().add("table", BOX, (0.6, 0.0, 0.3)).add("ball", BOX, (0.6, 0.5, 0.3), moving=True)
HELD = WORLD.attach("table", "panda_hand")
WRONG: tuple[Any, ...] = ({}, [1, 2], np.zeros((2, 2)), object(), 3.5)
CALLS: dict[str, Callable[[Any], Any]] = {
    "move of what": lambda x: WORLD.move(x, (0, 0, 0)),
    "remove of what": lambda x: WORLD.remove(x),
    "detach of what": lambda x: HELD.detach(x, (0, 0, 0)),
    "pose of add": lambda x: WORLD.add("new", BOX, x),
    "pose of move": lambda x: WORLD.move("table", x),
    "moving of add": lambda x: WORLD.add("new", BOX, moving=x),
    "touches of add": lambda x: WORLD.add("new", BOX, touches=x if not isinstance(x, dict) else 3),
    "link of attach": lambda x: WORLD.attach("table", x),
    "moving of collides": lambda x: ROBOT.collides(Q, WORLD, moving=x if not isinstance(x, dict) else "ball"),
    "moving of distance": lambda x: ROBOT.distance(Q, WORLD, moving=x if not isinstance(x, dict) else "ball"),
    "inertias": lambda x: ROBOT.with_link_inertias(x if not isinstance(x, dict) else None),
    "values": lambda x: ROBOT.with_parameters(x if not isinstance(x, dict) else None),  # type: ignore[arg-type]
    "kernel": lambda x: ROBOT.kernel(x),
    "device": lambda x: ROBOT.kernel("fk", device=x),
    "forces of constraints": lambda x: ROBOT.constraints.forward_dynamics(
        Q, Q, Q, [PointContact("panda_hand")], x if not isinstance(x, dict) else "panda_hand"
    ),
    "reference of constraints": lambda x: ROBOT.constraints.forward_dynamics(
        Q, Q, Q, [PointContact("panda_hand")], None, x
    ),
}


@pytest.mark.parametrize("name", CALLS)
def test_what_makes_no_sense_is_refused(name: str) -> None:
    for wrong in WRONG:
        if name == "touches of add" and isinstance(wrong, np.ndarray):
            continue
        with pytest.raises(UlnaError):
            CALLS[name](wrong)
