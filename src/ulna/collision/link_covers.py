"""Spheres of single links, kept on disk by shape: robots that share links compute them once."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any, final

import numpy as np

from ulna import disk_cache as cache
from ulna.collision.cover import Task
from ulna.collision.spheres import LinkSpheres

_MAX_COVERS = 12  # covers that are kept for a link


@final
class LinkCover:
    """What is known of covers of one link; its task is made when something else is asked.

    Args:
        key: Where it is stored: decided by the link's shapes and by how spheres are fitted.
        make: Makes the task.
    """

    def __init__(self, key: str, make: Callable[[], Task]) -> None:
        stored = cache.read(key)
        self._key, self._make, self._task = key, make, None
        self._known: dict[str, Any] = {} if stored is None else json.loads(stored.decode())
        self._covers: dict[int, LinkSpheres] = {}
        self._is_new = False
        for name in ("counts", "covers"):
            self._known.setdefault(name, {})

    @property
    def is_done(self) -> bool:
        """Whether the balls among the link's shapes cover everything."""
        if "is_done" not in self._known:
            self._learn("is_done", self._ready().is_done)
        return self._known["is_done"]

    def count(self, e: float) -> int:
        """How many spheres it takes besides the balls.

        Args:
            e: How far they may stick out, about [m].

        Returns:
            The count.
        """
        name, counts = repr(float(e)), self._known["counts"]
        if name not in counts:
            counts[name] = self._ready().count(e)
            self._is_new = True
        return counts[name]

    def solve(self, count: int) -> LinkSpheres:
        """The spheres.

        Args:
            count: How many besides the balls, at most.

        Returns:
            Spheres in the link's frame.
        """
        if count not in self._covers:
            covers = self._known["covers"]
            if str(count) not in covers:
                c, r, excess = self._ready().solve(count)
                covers[str(count)] = [c.tolist(), r.tolist(), excess]
                self._is_new = True
            c, r, excess = covers[str(count)]
            self._covers[count] = LinkSpheres(
                np.reshape(np.array(c, dtype=float), (-1, 3)), np.array(r), excess
            )
        return self._covers[count]

    def keep(self) -> None:
        """Writes what was computed; of many covers, those that were asked for now or last."""
        if not self._is_new:
            return
        covers = self._known["covers"]
        for name in [name for name in covers if int(name) not in self._covers][
            : max(0, len(covers) - _MAX_COVERS)
        ]:
            del covers[name]
        cache.write(self._key, json.dumps(self._known).encode())

    def _learn(self, name: str, value: Any) -> None:
        self._known[name], self._is_new = value, True

    def _ready(self) -> Task:
        if self._task is None:
            self._task = self._make()
        return self._task
