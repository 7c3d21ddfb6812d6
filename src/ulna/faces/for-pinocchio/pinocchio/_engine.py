"""From the face's Model to the tower's, and the kernels that algorithms of the face call."""

from __future__ import annotations

import threading
from collections.abc import Callable
from functools import cached_property
from typing import TYPE_CHECKING, Any, final

import numpy as np

from ulna import kernels, spatial
from ulna.algorithms.constrained_factors import joined
from ulna.errors import InputError
from ulna.model import Frame, Joint, Limits, Link, Mimic
from ulna.model import Model as TowerModel
from ulna.model.joints.axes import constant, snap_pose
from ulna.trace import compile as compile_function

if TYPE_CHECKING:
    from pinocchio._model import Model

WORLD_LINK = "universe"
MAKING = threading.RLock()
"""Held while something is compiled, so that threads that want the same wait for it instead of compiling it, too."""


@final
class Engine:
    """A model of the tower with the numbers of one moment, and what is compiled for it."""

    def __init__(self, source: Model) -> None:
        self.source = source
        self.model = tower_model(source)
        self.kernels: dict[Any, Any] = {}
        self.of_frames: dict[Any, Any] = {}
        self._frame_state: Any = None
        self._frames: tuple[Frame, ...] = ()

    def kernel(self, name: str, **options: Any) -> Any:
        """The tower's kernel of that name."""
        if not options:
            return self.plain(name)
        key = (name, *options.items())
        return _once(self.kernels, key, lambda: kernels.kernel(self.model, name, **options))

    def plain(self, name: str) -> Any:
        """The tower's kernel of that name, without options."""
        return _once(self.kernels, name, lambda: kernels.kernel(self.model, name))

    def made(self, key: Any, build: Any, /, **shapes: Any) -> Any:
        """The compiled `build(model)`, a function of arrays of these shapes; made once."""
        return _once(self.kernels, key, lambda: compile_function(build(self.model), **shapes))

    @cached_property
    def joined(self) -> bytes:
        """Where the mass matrix may have entries, a byte for each."""
        return joined(self.model).astype(bool).tobytes()

    def frames(self) -> tuple[Frame, ...]:
        """The frames as they are now; what was compiled for other frames is forgotten."""
        state = self.source.frame_state()
        if state != self._frame_state:
            self._frame_state = state
            self.of_frames = {}
            self._frames = tuple(
                Frame(
                    f"{i}:{f.name}",
                    f.parentJoint - 1,
                    snap_pose(f.placement._pose()),
                    "user",
                    "",
                    spatial.SE3.identity(),
                )
                for i, f in enumerate(self.source.frames)
            )
        return self._frames

    def of_frame(self, key: Any, build: Any, /, **shapes: Any) -> Any:
        """The same for a function that depends on frames: the compiled `build(model, frames)`."""
        frames = self.frames()
        return _once(self.of_frames, key, lambda: compile_function(build(self.model, frames), **shapes))


def _once(known: dict[Any, Any], key: Any, make: Callable[[], Any]) -> Any:
    found = known.get(key)
    if found is None:
        with MAKING:
            found = known.get(key)
            if found is None:
                found = known[key] = make()
    return found


def tower_model(source: Model) -> TowerModel:
    """The tower's model of the face's model: one link for each joint, in the same order."""
    identity = snap_pose(spatial.SE3.identity())
    joints: list[Joint] = []
    inertias: list[spatial.Inertia] = []
    names = [WORLD_LINK, *(f"body of {name}" for name in source.names[1:])]
    links = [_link(WORLD_LINK, -1, source.inertias[0], None, None, identity)]
    for i in range(1, source.njoints):
        joint, parent = source.joints[i], source.parents[i]
        kind = joint.kind
        if kind is None:
            raise InputError(f"Joint {i}, {source.names[i]!r}, has no kind.")
        rows = slice(joint.idx_v, joint.idx_v + joint.nv)
        zeros = (0.0,) * kind.nv
        places = slice(joint.idx_q, joint.idx_q + joint.nq)
        low, high = (
            tuple(float(x) for x in source._arrays[key][places])
            for key in ("lowerPositionLimit", "upperPositionLimit")
        )
        speed, effort = (
            tuple(float(x) for x in source._arrays[key][rows])
            for key in ("upperVelocityLimit", "upperEffortLimit")
        )
        joints.append(
            Joint(
                name=source.names[i],
                kind=kind,
                parent=parent - 1,
                placement=snap_pose(source.jointPlacements[i]._pose()),
                idx_q=joint.idx_q,
                idx_v=joint.idx_v,
                limits=Limits(low, high, speed, effort),
                damping=zeros,
                friction=zeros,
                armature=tuple(float(x) for x in source._arrays["armature"][rows]) if joint.nv else zeros,
                mimic=None if joint.mimic is None else Mimic(joint.mimic[0] - 1, *joint.mimic[1:]),
                parent_link=names[parent],
                child_link=names[i],
            )
        )
        links.append(
            _link(names[i], i - 1, source.inertias[i], names[parent], source.names[i], joints[-1].placement)
        )
        inertias.append(links[-1].inertia)
    frames = [Frame(link.name, link.joint, identity, "link", link.name, identity) for link in links]
    return TowerModel(
        name=source.name or "model",
        joints=tuple(joints),
        links=tuple(links),
        frames=tuple(frames),
        inertias=tuple(inertias),
        base_inertia=links[0].inertia,
        gravity=np.array(source.gravity.linear),
        configurations={},
        tool=links[-1].name,
    )


def _link(name: str, joint: int, inertia: Any, parent: str | None, above: str | None, origin: Any) -> Link:
    identity = snap_pose(spatial.SE3.identity())
    value = inertia._value()
    own = spatial.Inertia(float(value.mass), constant(value.com + 0.0), constant(value.inertia + 0.0))
    return Link(name, joint, identity, own, (), (), parent, above, origin, identity)
