"""Methods that return a changed copy warn where the copy is thrown away."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

import ulna
from ulna.collision import World
from ulna.errors import InputError, UlnaWarning
from ulna.geometry import Sphere
from ulna.trajectory import quintic

BALL = Sphere(0.1)


def test_a_world_to_which_nothing_was_added_is_warned_of():
    world = World()
    with pytest.warns(
        UlnaWarning, match=r"add returns a new world, .* Write `world = world.add\(...\)`"
    ) as found:
        world.add("ball", BALL, (0.5, 0.0, 0.3))
    assert found[0].filename == __file__
    with pytest.warns(UlnaWarning, match="add returns"):
        for k in range(2):
            world.add(f"ball {k}", BALL)
    arguments = ("ball", BALL)
    with pytest.warns(UlnaWarning, match="add returns"):
        world.add(*arguments)
    assert len(world) == 0


def test_the_others_warn_too():
    world, robot = World().add("ball", BALL), ulna.load("panda")
    motion = quintic(np.zeros(7), np.ones(7), duration=2.0)
    with pytest.warns(UlnaWarning, match="move returns a new world"):
        world.move("ball", (0.0, 0.0, 1.0))
    with pytest.warns(UlnaWarning, match="lock returns a new robot"):
        robot.lock(["panda_joint4"])
    with pytest.warns(UlnaWarning, match="slowed returns a new trajectory"):
        motion.slowed(2.0)


def test_results_that_are_used_are_not():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        world = World().add("a", BALL).add("b", BALL)
        worlds = [world.add(name, BALL) for name in "cd"]
        table = {name: world.add(name, BALL) for name in "cd"}
        assert len(world.add("c", BALL)) == 3 and world.remove("a").names == ("b",)

        def longer():
            return world.add("c", BALL)

        copies = list(map(world.remove, "ab"))
        assert [len(w) for w in (*worlds, *table.values(), longer(), *copies)] == [3, 3, 3, 3, 3, 1, 1]
        with pytest.raises(InputError):
            world.add("a", BALL)


def test_signatures_and_documentation_stay():
    assert World.add.__name__ == "add" and "T_world_shape" in (World.add.__doc__ or "")
