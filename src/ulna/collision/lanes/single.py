"""Whether a robot touches anything in one configuration: all lanes of `touching` hold the same one."""

from __future__ import annotations

import threading
from functools import lru_cache
from typing import Any, final

import numpy as np

from ulna.collision.lanes.tables import Scene
from ulna.collision.lanes.touching import Tables, Work, block_touches
from ulna.compiler.procedures import Array1, Kernel, broadcast, f32, f64, procedure
from ulna.typing import Floats

FREE, TOUCHING, DOUBTFUL = 0, 1, 2
"""What `classified_state` returns."""


@procedure(constants={"W": 8})
def classified_state(
    kernel: Kernel, larger: Tables, smaller: Tables, low: Array1[f64], high: Array1[f64], q: Array1[f64], work: Work,
    W: int,
) -> int:  # fmt: skip
    """Whether anything touches in a configuration, to the precision of float32.

    Args:
        kernel: From configurations to poses of the bodies, in lanes.
        larger: What is checked against what, with spheres larger by what float32 may place them wrongly.
        smaller: The same with spheres smaller by as much.
        low: From where on the bounds of rounding hold, shape (n,) [rad, m].
        high: Up to where, shape (n,) [rad, m].
        q: The configuration, shape (n,) [rad, m].
        work: Working storage.
        W: Lanes, a constant [-].

    Returns:
        0 if it is free for sure, 1 if it touches for sure, else 2.
    """
    for k in range(len(q)):
        if not (low[k] <= q[k] and q[k] <= high[k]):
            return 2
        work.q[k, 0:W] = broadcast(f32(q[k]), W)
    kernel(work.q, work.c)
    if not block_touches(larger, work, W):
        return 0
    return 1 if block_touches(smaller, work, W) else 2


@final
class StateCheck:
    """Whether one configuration touches anything, or comes nearer than a reach: by float32, with proof.

    Args:
        scene: The robot and the world.
        larger: See `classified_state`.
        smaller: See `classified_state`.
    """

    def __init__(self, scene: Scene, larger: Tables, smaller: Tables) -> None:
        self._scene, self._tables = scene, (larger, smaller)
        self._storage = threading.local()

    def __call__(self, q: Floats) -> int:
        """Looks at a configuration.

        Args:
            q: The configuration, shape (nq,) [rad, m].

        Returns:
            `FREE`, `TOUCHING` or `DOUBTFUL`.
        """
        try:
            storage, run = self._storage.bound
        except AttributeError:  # this thread's first configuration
            storage, run = self._storage.bound = self._bound()
        storage[:] = q
        return run()

    def _bound(self) -> tuple[Floats, Any]:
        """This thread's configuration, and the procedure that looks at it."""
        scene = self._scene
        q = np.zeros(scene.robot.model.nq)
        arguments: tuple[Any, ...] = (*self._tables, *scene.robot.range, q, scene.moving.work())
        special = _specialized(scene.lanes)
        return q, special.bind(scene.robot.kernel, *arguments, are_arrays_private=True).unguarded


@lru_cache(maxsize=8)
def _specialized(lanes: int) -> Any:
    return classified_state.specialized(W=lanes)
