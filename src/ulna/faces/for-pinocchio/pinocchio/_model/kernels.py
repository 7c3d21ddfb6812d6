"""From the face's Model to the tower's, and the kernels that algorithms of the face call."""

from __future__ import annotations

import copy
from collections.abc import Callable, Container, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, final

import numpy as np

from pinocchio._model.kernel_parameters import Told, pose_of, with_numbers
from ulna import kernels, spatial
from ulna.algorithms.constrained_factors import joined
from ulna.compiler import compile as compile_function
from ulna.errors import InputError
from ulna.model import Frame, Joint, Limits, Link, Mimic
from ulna.model import Model as TowerModel
from ulna.model.joints.axes import constant, snap_pose
from ulna.system import forks
from ulna.system.cached import cached_property
from ulna.typing import Array, Floats

if TYPE_CHECKING:
    from pinocchio._model.model import Model

WORLD_LINK = "universe"
MAKING = forks.lock(forks.RECIPES)
"""Held while something is compiled, so that threads that want the same wait for it instead of compiling it, too."""
_PATIENCE = 3
"""How many times frames move before kernels take their placements as inputs."""


@final
class Engine:
    """A model of the tower, and what is compiled for it; some of its numbers may be inputs of all kernels.

    Attributes:
        source: The face's model.
        names: Which numbers are inputs, out of `NAMES`; the others are constants.
        numbers: Those of one moment, block by block.
        live: Where they lie in the face's model.
        kernels: What is compiled, shared by all engines that differ in `numbers` alone.
    """

    def __init__(self, source: Model, names: tuple[str, ...] = (), before: Engine | None = None) -> None:
        self.source, self.names = source, names
        self._base = tower_model(source)
        self.live = tuple(block for name in names for block in source.part(name))
        self.numbers = tuple(block.copy() for block in self.live)
        self.kernels: dict[Any, Any] = {}
        self._seen = _Seen(before and before._seen)

    def at(self, numbers: tuple[Floats, ...]) -> Engine:
        """The same kernels, told other numbers."""
        found = copy.copy(self)
        found.numbers = numbers
        return found

    @property
    def model(self) -> TowerModel:
        """The tower's model of these numbers."""
        return with_numbers(self._base, self._named(self.numbers)) if self.names else self._base

    @property
    def gravity(self) -> Array:
        """The acceleration of free fall (3,)."""
        return self._named(self.numbers).get("gravity", self._base.gravity)[:3]

    def plain(self, name: str) -> Any:
        """The tower's kernel of that name, without options."""
        if self.names:
            return self.kernel(name)
        return _once(self.kernels, name, lambda: kernels.kernel(self._base, name))

    def kernel(self, name: str, **options: Any) -> Any:
        """The tower's kernel of that name."""
        key = (name, *options.items())
        if not self.names:
            return _once(self.kernels, key, lambda: kernels.kernel(self._base, name, **options))
        ports = _once(self.kernels, ("ports", *key), lambda: self._ports(name, options))
        recipe = kernels.RECIPES[name]
        chosen = {**recipe.options, **options}
        return self.made(key, lambda tower: recipe.build(tower, **chosen), **ports)

    def _ports(self, name: str, options: dict[str, Any]) -> dict[str, Any]:
        return {port.name: port.shape for port in kernels.function(self._base, name, **options).inputs}

    def made(self, key: Any, build: Any, kept: Any = (), /, **shapes: Any) -> Any:
        """The compiled `build(model)`, a function of arrays of these shapes; made once.

        It returns numbers of the names in `kept`, too.
        """
        kernel = _once(self.kernels, key, lambda: self._compiled(build, kept, shapes))
        return Told(kernel, self.numbers) if self.names else kernel

    def _compiled(self, build: Any, kept: Any, shapes: dict[str, Any], frames: Any = ()) -> Any:
        """A kernel of inputs of these shapes, then numbers, then placements of frames."""
        if not self.names and not frames:
            return compile_function(build(self._base), **shapes)
        count, blocks = len(shapes), len(self.numbers)

        def told(*given: Any) -> Any:
            numbers = self._named(given[count : count + blocks])
            tower = with_numbers(self._base, numbers)
            seen = (placed(frames, np.concatenate(given[count + blocks :])),) if frames else ()
            found = build(tower, *seen)(*given[:count])
            also = self.at(given[count : count + blocks]).among(kept)
            return (*found, *also) if isinstance(found, tuple) else (found, *also) if also else found

        told.__name__ = build.__name__
        inputs = (*self.numbers, *(self.source.part("frames") if frames else ()))
        sizes: dict[str, Any] = {f"number{k}": x.shape for k, x in enumerate(inputs)}
        return compile_function(told, **shapes, **sizes)

    def _blocks(self) -> list[str]:
        """The name of each block of numbers."""
        return [name for name in self.names for _ in self.source.part(name)]

    def _named(self, blocks: tuple[Array, ...]) -> dict[str, Array]:
        """Numbers by name."""
        found: dict[str, list[Array]] = {}
        for name, block in zip(self._blocks(), blocks, strict=True):
            found.setdefault(name, []).append(block)
        return {name: np.concatenate(parts) for name, parts in found.items()}

    def living(self, kernel: Any) -> Any:
        """A kernel made here that, bound, reads the numbers where the face's model has them, at every call."""
        if not isinstance(kernel, Told):
            return kernel
        return Told(kernel.kernel, (*self.live, *self.source.part("frames"))[: len(kernel.numbers)])

    def copied(self) -> Engine:
        """These kernels, told the same numbers, which may change apart."""
        return self.at(tuple(x.copy() for x in self.numbers)) if self.names else self

    def among(self, names: Container[str]) -> list[Floats]:
        """The blocks of numbers of some names."""
        return [x for name, x in zip(self._blocks(), self.numbers, strict=True) if name in names]

    @cached_property
    def fixed(self) -> Engine:
        """One for kernels that depend on the kinds of joints alone."""
        return _once(self.kernels, "fixed", lambda: Engine(self.source)) if self.names else self

    @cached_property
    def joined(self) -> bytes:
        """Where the mass matrix may have entries, a byte for each."""
        return joined(self._base).astype(bool).tobytes()

    def of_frame(self, key: Any, build: Any, kept: Any = (), /, **shapes: Any) -> Any:
        """The same as `made` for a function that depends on frames: the compiled `build(model, frames)`."""
        seen = self._seen
        seen.look(self.source)
        frames, known = seen.frames, seen.kernels
        if seen.vary:
            kernel = _once(known, key, lambda: self._compiled(build, kept, shapes, frames))
            return Told(kernel, (*self.numbers, *(x.copy() for x in self.source.part("frames"))))

        def fixed(tower: TowerModel) -> Any:
            return build(tower, frames)

        kernel = _once(known, key, lambda: self._compiled(fixed, kept, shapes))
        return Told(kernel, self.numbers) if self.names else kernel


class _Seen:
    """The frames as kernels know them: by their numbers or, where these change again and again, without them."""

    def __init__(self, before: _Seen | None) -> None:
        self.kernels: dict[Any, Any] = {}
        self.frames: tuple[Frame, ...] = ()
        self.vary = False
        self._state: Any = before and before._state
        self._changes = before._changes if before else 0

    def look(self, source: Model) -> None:
        """Takes up the frames as they are now; what was compiled for other frames is forgotten."""
        state = source.frame_state()
        if state != self._state:
            moved = self._state is not None and state[0] == self._state[0]
            self._state, self._changes = state, self._changes + 1 if moved else 0
        elif self.frames:
            return
        if self.vary and self._changes > _PATIENCE:
            return
        self.vary = self._changes >= _PATIENCE
        self.kernels = {}
        self.frames = tuple(
            Frame(
                f"{i}:{f.name}",
                f.parentJoint - 1,
                snap_pose(f.placement._pose()),
                "user",
                "",
                spatial.SE3.identity(),
            )
            for i, f in enumerate(source.frames)
        )


def placed(frames: Sequence[Frame], places: Array) -> tuple[Frame, ...]:
    """Frames at other places, (n, 4, 4)."""
    return tuple(replace(frame, placement=pose_of(T)) for frame, T in zip(frames, places, strict=True))


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
