"""The numbers of a model that kernels depend on: where they lie, and what is compiled for them.

Placements and inertias of joints, and placements of frames, lie in rows that never move from the moment a joint or
frame is added, so that references to them stay live, and a change of any is seen by comparing a few blocks of memory.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, final

import numpy as np

from pinocchio._containers.arrays import StdVec
from pinocchio._data.binding import refuse
from pinocchio._model.frame import Frame, changes
from pinocchio._model.kernel_parameters import NAMES
from pinocchio._model.kernels import MAKING, Engine
from ulna.typing import Array, Floats

if TYPE_CHECKING:
    from pinocchio._model.joint_kinds import JointModel
    from pinocchio._spatial.inertia import Inertia
    from pinocchio._spatial.motion_force import Motion
    from pinocchio._spatial.se3 import SE3

_ROWS = 64  # in a block
_KEPT = 3
"""How many states of a model have kernels of their own; what differs among more is an input of kernels."""


@final
class Rows:
    """Storage of objects, each in a row of a block; `slot` is the attribute in which an object holds its array."""

    def __init__(self, slot: str) -> None:
        self._slot = slot
        self._owners: list[Any] = []
        self._blocks: list[Floats] = []

    def adopt(self, owners: list[Any]) -> bool:
        """Moves into rows what does not lie in its row yet; whether anything did not."""
        known = len(self._owners)
        same = len(owners) >= known and all(a is b for a, b in zip(owners, self._owners, strict=False))
        if same and len(owners) == known:
            return False
        if not same:
            self._owners, self._blocks = [], []
        for owner in owners[len(self._owners) :]:
            values = getattr(owner, self._slot)
            at = len(self._owners) % _ROWS
            if at == 0:
                self._blocks.append(np.zeros((_ROWS, *values.shape)))
            row = self._blocks[-1][at]
            row[...] = values
            setattr(owner, self._slot, row)
            self._owners.append(owner)
        return True

    def parts(self) -> list[Floats]:
        """The rows in use."""
        count = len(self._owners)
        return [block[: count - k * _ROWS] for k, block in enumerate(self._blocks)]


class Frames(StdVec[Frame]):
    """The frames of a model; kernels see when one is added or taken away."""


def _noticed(name: str) -> Any:
    change = getattr(list, name)

    def method(self: Frames, *args: Any, **options: Any) -> Any:
        changes[0] += 1
        return change(self, *args, **options)

    method.__name__, method.__doc__ = name, change.__doc__
    return method


for _name in (
    "append",
    "extend",
    "insert",
    "pop",
    "remove",
    "clear",
    "reverse",
    "sort",
    "__delitem__",
    "__iadd__",
):
    setattr(Frames, _name, _noticed(_name))


class Numbers:
    """What of a Model is about its numbers."""

    joints: StdVec[JointModel]
    _placements: StdVec[SE3]
    _inertias: StdVec[Inertia]
    _gravity: Motion
    _arrays: dict[str, Floats]

    _engines: dict[tuple[bytes, ...], Engine]
    _telling: Engine | None
    _heard: int
    _places: tuple[tuple[str, int], ...]

    def _begin(self) -> None:
        self._frames, self._heard, self._places = Frames(), -1, ()
        self._version = np.zeros(1, np.int64)
        self._rows = Rows("_m"), Rows("_p"), Rows("_m")

    @property
    def frames(self) -> StdVec[Frame]:
        """The frames, live references."""
        return self._frames

    @frames.setter
    def frames(self, values: Any) -> None:
        self._frames = Frames(values)
        changes[0] += 1

    def _changed(self) -> None:
        """Joints were added: what was compiled serves no more, and Data made before do not fit."""
        self._layout = tuple((j.shortname(), j.idx_q, j.idx_v) for j in self.joints)
        self._version[0] += 1
        for rows, owners in zip(self._rows, (self._placements, self._inertias), strict=False):
            rows.adopt(owners)
        self._engines, self._telling = {}, None
        self._bits, self._newest = (), None
        self._integrate = self._difference = self._random = refuse
        self._narrowest = np.zeros(())
        self._frames_changed()

    def _frames_changed(self) -> None:
        changes[0] += 1  # also when joints are added
        self._rows[2].adopt([frame._placement for frame in self._frames])

    def part(self, name: str) -> list[Floats]:
        """The blocks in which numbers of that name, one of `NAMES` or "frames", lie."""
        if name == "gravity":
            return [self._gravity._v]
        if name == "armature":
            return [self._arrays["armature"]]
        return self._rows[("placements", "inertias", "frames").index(name)].parts()

    def engine(self) -> Engine:
        """The tower's model of the present numbers, and its kernels.

        They are made anew when a number has changed, but not again and again: then they take such numbers as inputs.
        """
        bits = tuple(b"".join(block.tobytes() for block in self.part(name)) for name in NAMES)
        if bits == self._bits and self._newest is not None:
            return self._newest
        with MAKING:
            found = self._engines.get(bits) or self._engine_of(bits)
            self._bits, self._newest = bits, found
        return found

    def _engine_of(self, bits: tuple[bytes, ...]) -> Engine:
        """That of a state that has none of its own."""
        telling, names = self._telling, ()
        if telling is None:
            self._engines = {state: engine for state, engine in self._engines.items() if engine.kernels}
            if len(self._engines) < _KEPT:
                found = self._engines[bits] = Engine(self, (), self._newest)  # type: ignore[arg-type]
                return found
            known = [*self._engines, bits]
        else:
            names, known = telling.names, [self._bits, bits]
        more = {name for name, *states in zip(NAMES, *known, strict=True) if len({*states}) > 1}
        if telling is None or not more <= {*names}:
            self._engines = {}
            chosen = tuple(name for name in NAMES if name in {*names, *more})
            telling = self._telling = Engine(self, chosen, self._newest)  # type: ignore[arg-type]
        return telling.at(tuple(block.copy() for block in telling.live))

    def shape(self) -> Engine:
        """Kernels that depend on the kinds of joints alone, not on any number."""
        return (self._newest or self.engine()).fixed

    def watched(self, on: Literal["shape", "places", "numbers", "frame", "frames"], frame: Any = None) -> Any:
        """Pairs of what kernels depend on, live and as it is now: kinds of joints, with placements, with all numbers.

        Or the kinds and one frame; or placements and all frames.
        """
        if on in ("frame", "frames"):
            self.frame_state()
        if on == "shape":
            live: list[Array] = [self._version]
        elif on == "frame":
            live = [changes, self.frames[frame].placement._m]
        else:
            which = NAMES if on == "numbers" else ("placements",)
            live = [self._version, *(x for name in which for x in self.part(name))]
        if on == "frames":
            live += [changes, *self.part("frames")]
        return [(block, block.copy()) for block in live]

    def frame_state(self) -> tuple[Any, bytes]:
        """What changes when a frame of this model does."""
        count = int(changes[0])
        if count != self._heard:
            self._heard, self._places = count, tuple((f.name, f.parentJoint) for f in self._frames)
            self._rows[2].adopt([frame._placement for frame in self._frames])
        return self._places, b"".join(part.tobytes() for part in self._rows[2].parts())
