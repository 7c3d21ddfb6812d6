"""The model of a robot: joints, links, frames and inertias as frozen data, made by a `ModelBuilder`."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable, Mapping
from dataclasses import field
from typing import Any

import numpy as np

from ulna.data_classes import dataclass
from ulna.errors import UnknownName
from ulna.idioms import Explained, explained
from ulna.model.content import fingerprint
from ulna.model.joints.axes import constant
from ulna.model.named import Named
from ulna.model.parts import Frame, FrameKind, Joint, Link
from ulna.model.table import table
from ulna.spatial import Inertia
from ulna.system.cached import cached_property
from ulna.typing import Floats

_OF_JOINT = "joint:"
_UNIT_VECTORS = {"qx": 4, "cos": 2}
"""The entries of unit vectors of q, by the name of the first one."""
_LOOKUP_ORDER: tuple[FrameKind, ...] = ("link", "tool", "user", "joint", "fixed_joint")


@explained("model")
@dataclass(frozen=True, eq=False, repr=False)
class Model(metaclass=Explained):
    """A tree of joints with the bodies they carry.

    Two models are equal when their content is; the hash and `fingerprint` go by content too and are the same
    in every process. Everything in it is read-only; functions such as `ulna.model.lock_joints` return new
    models.

    Attributes:
        name: Its name.
        joints: The joints that move, parents before children, depth first in the order of the file.
        links: The bodies, parents before children, depth first in the order of the file.
        frames: Every link, every joint (fixed ones too) and every named point is a frame.
        inertias: For each joint, all it carries rigidly, in its moving frame.
        base_inertia: All that does not move, in the world frame.
        gravity: Acceleration of free fall in the world frame, shape (3,) [m/s^2].
        configurations: Named positions, each of shape (nq,).
        tool: Name of the frame that is meant when none is named.
        disabled_pairs: Pairs of link names that need no collision check.
        groups: Named groups of joint names.
        source: The file it was read from; takes no part in equality.
    """

    name: str
    joints: tuple[Joint, ...]
    links: tuple[Link, ...]
    frames: tuple[Frame, ...]
    inertias: tuple[Inertia, ...]
    base_inertia: Inertia
    gravity: Floats
    configurations: Mapping[str, Floats]
    tool: str
    disabled_pairs: tuple[tuple[str, str], ...] = ()
    groups: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    source: str | None = None

    def __post_init__(self) -> None:
        set_field = object.__setattr__
        set_field(self, "gravity", constant(self.gravity))
        positions = {name: np.array(q, dtype=float) for name, q in self.configurations.items()}
        set_field(self, "configurations", Named("configuration", positions))
        set_field(self, "groups", Named("group", self.groups))

    # sizes and vectors -------------------------------------------------------------------------------------

    @cached_property
    def nq(self) -> int:
        """Number of entries of q."""
        return sum(joint.nq for joint in self.joints)

    @cached_property
    def nv(self) -> int:
        """Number of entries of v."""
        return sum(joint.nv for joint in self.joints)

    @cached_property
    def lower_position(self) -> Floats:
        """Smallest positions, shape (nq,) [rad, m]; -inf where there is no limit."""
        return self._gather(lambda joint: joint.limits.lower)

    @cached_property
    def upper_position(self) -> Floats:
        """Largest positions, shape (nq,) [rad, m]; inf where there is no limit."""
        return self._gather(lambda joint: joint.limits.upper)

    @cached_property
    def velocity_limit(self) -> Floats:
        """Largest speeds, shape (nv,) [rad/s, m/s]; inf where there is no limit."""
        return self._gather(lambda joint: joint.limits.velocity)

    @cached_property
    def effort_limit(self) -> Floats:
        """Largest forces and torques, shape (nv,) [N, N m]; inf where there is no limit."""
        return self._gather(lambda joint: joint.limits.effort)

    @cached_property
    def damping(self) -> Floats:
        """Viscous friction, shape (nv,) [N s/m, N m s/rad]; that of a mimic joint adds multiplier^2 times its own."""
        return self._reflected(lambda joint: joint.damping, lambda ratio: ratio * ratio)

    @cached_property
    def friction(self) -> Floats:
        """Coulomb friction, shape (nv,) [N, N m]; that of a mimic joint adds |multiplier| times its own."""
        return self._reflected(lambda joint: joint.friction, abs)

    @cached_property
    def armature(self) -> Floats:
        """Inertia of the drives seen at the joints, shape (nv,) [kg, kg m^2].

        That of a mimic joint adds multiplier^2 times its own, so that v . armature v / 2 is the energy of all drives.
        """
        return self._reflected(lambda joint: joint.armature, lambda ratio: ratio * ratio)

    @cached_property
    def neutral(self) -> Floats:
        """The neutral position of every joint (`JointKind.neutral`), shape (nq,); limits play no part."""
        return self._gather(lambda joint: joint.kind.neutral())

    @cached_property
    def mass(self) -> float:
        """Mass of all links, also of those that do not move [kg]."""
        return float(sum(link.inertia.mass for link in self.links))

    def _gather(self, part: Callable[[Joint], Iterable[float]]) -> Floats:
        return constant([x for joint in self.joints if joint.mimic is None for x in part(joint)])

    def _reflected(
        self, part: Callable[[Joint], tuple[float, ...]], share: Callable[[float], float]
    ) -> Floats:
        """A property of the drives reflected at the joints, (nv,): mimic joints add to their source by virtual work."""
        totals = [x for joint in self.joints if joint.mimic is None for x in part(joint)]
        for joint in self.joints:
            if joint.mimic is not None:
                for k, value in enumerate(part(joint), start=joint.idx_v):
                    totals[k] = totals[k] + share(joint.mimic.multiplier) * value
        return constant(totals)

    # names -------------------------------------------------------------------------------------------------

    @cached_property
    def joint_names(self) -> tuple[str, ...]:
        """Names of the joints that move, mimic joints included."""
        return tuple(joint.name for joint in self.joints)

    @cached_property
    def link_names(self) -> tuple[str, ...]:
        """Names of the links."""
        return tuple(link.name for link in self.links)

    @cached_property
    def frame_names(self) -> tuple[str, ...]:
        """A name for each of `frames`, in their order, no two alike.

        It is the frame's own name; where a link and a joint share one, the link keeps it and the joint is "joint:NAME".
        """
        return tuple(self._frame_places)

    @cached_property
    def position_names(self) -> tuple[str, ...]:
        """A name for each entry of q: the joint's, followed by the coordinate's where it has several."""
        return _coordinate_names((j.name, j.kind.coordinates) for j in self.joints if j.mimic is None)

    @cached_property
    def velocity_names(self) -> tuple[str, ...]:
        """A name for each entry of v: the joint's, followed by the coordinate's where it has several."""
        return _coordinate_names((j.name, j.kind.rates) for j in self.joints if j.mimic is None)

    @cached_property
    def quaternions(self) -> tuple[tuple[int, ...], ...]:
        """Which entries of q form unit quaternions (xyzw), four each."""
        return tuple(entries for entries in self.unit_vectors if len(entries) == 4)

    @cached_property
    def unit_vectors(self) -> tuple[tuple[int, ...], ...]:
        """Which entries of q have length one together: quaternions, and cosine and sine of an angle."""
        found = []
        for joint in self.joints:
            for place, coordinate in enumerate(joint.kind.coordinates if joint.mimic is None else ()):
                count = 0 if coordinate.unit else _UNIT_VECTORS.get(coordinate.name.rpartition(".")[2], 0)
                if count:
                    start = joint.idx_q + place
                    found.append(tuple(range(start, start + count)))
        return tuple(found)

    def joint(self, name: str) -> Joint:
        """The movable joint of that name. Raises UnknownName with the nearest one."""
        return self.joints[self.joint_index(name)]

    def link(self, name: str) -> Link:
        """The link of that name. Raises UnknownName with the nearest one."""
        return self.links[self.link_index(name)]

    def frame(self, name: str, kind: FrameKind | None = None) -> Frame:
        """The frame of that name, out of `frame_names`.

        Args:
            name: Its name. Where a link and a joint share one, the link's frame is meant; "joint:NAME" is the
                joint's.
            kind: Its kind; None for any.

        Returns:
            The frame.

        Raises:
            UnknownName: there is none; offers the nearest one.
        """
        if kind is None:
            return self.frames[self.frame_index(name)]
        of_kind = {frame.name: frame for frame in self.frames if frame.kind == kind}
        if name not in of_kind:
            raise UnknownName(f"{kind} frame", name, of_kind)
        return of_kind[name]

    def joint_index(self, name: str) -> int:
        """Where the joint of that name stands in `joints`. Raises UnknownName with the nearest one."""
        index = _place(self._joint_places, name)
        if index is None:
            advice = self._about_frame(name)
            if isinstance(name, int) and not isinstance(name, bool) and 0 <= name < len(self.joint_names):
                advice = f"Joints go by name: joint_names[{name}] is {self.joint_names[name]!r}."
            raise UnknownName("joint", name, self.joint_names, advice)
        return index

    def _about_frame(self, name: object) -> str:
        """What a name says that was given for that of a joint; empty where it names nothing else."""
        given = name if isinstance(name, str) else None
        frame = next((frame for frame in self.frames if frame.name == given), None)
        if frame is None:
            return ""
        if frame.kind == "fixed_joint":
            return "That joint is fixed."
        mover = (
            "no joint moves it" if frame.joint < 0 else f"joint {self.joints[frame.joint].name!r} moves it"
        )
        return f"{frame.name!r} is a {'link' if frame.kind == 'link' else 'frame'}; {mover}."

    def link_index(self, name: str) -> int:
        """Where the link of that name stands in `links`. Raises UnknownName with the nearest one."""
        index = _place(self._link_places, name)
        if index is None:
            raise UnknownName("link", name, self.link_names)
        return index

    def frame_index(self, name: str) -> int:
        """Where the frame of that name stands in `frames`, in `frame_names` and in the poses of all frames.

        Raises:
            UnknownName: there is none; offers the nearest one.
        """
        index = _place(self._frame_places, name)
        if index is None:
            is_reference = isinstance(name, str) and name in ("world", "local", "local_world_aligned")
            advice = f'{name!r} is a reference: write reference="{name}".' if is_reference else ""
            raise UnknownName("frame", name, self.frame_names, advice)
        return index

    @cached_property
    def _joint_places(self) -> dict[str, int]:
        return {name: i for i, name in enumerate(self.joint_names)}

    @cached_property
    def _link_places(self) -> dict[str, int]:
        return {name: i for i, name in enumerate(self.link_names)}

    def frame_name(self, frame: Frame) -> str:
        """The name out of `frame_names` of one of `frames`."""
        return self.frame_names[self.frames.index(frame)]

    @cached_property
    def _frame_places(self) -> dict[str, int]:
        owners: dict[str, Frame] = {}
        for kind in _LOOKUP_ORDER:
            for frame in self.frames:
                if frame.kind == kind:
                    owners.setdefault(frame.name, frame)
        places: dict[str, int] = {}
        for i, frame in enumerate(self.frames):
            name = frame.name
            while owners.setdefault(name, frame) is not frame:
                name = _OF_JOINT + name
            places[name] = i
        return places

    # the tree ----------------------------------------------------------------------------------------------

    def children(self, joint: int) -> tuple[int, ...]:
        """Indices of the joints that follow `joint` at once; -1 asks for those on the world."""
        return tuple(i for i, other in enumerate(self.joints) if other.parent == joint)

    def support(self, joint: int) -> tuple[int, ...]:
        """Indices of the joints from the world out to `joint`, both ends included; () for -1, the world."""
        chain = []
        while joint >= 0:
            chain.append(joint)
            joint = self.joints[joint].parent
        return tuple(reversed(chain))

    def subtree(self, joint: int) -> tuple[int, ...]:
        """Indices of the joints moved by `joint`, itself included, in order; -1 asks for all."""
        inside = {joint}
        for i, other in enumerate(self.joints):
            if other.parent in inside:
                inside.add(i)
        return tuple(sorted(inside - {-1}))

    # content -----------------------------------------------------------------------------------------------

    @cached_property
    def fingerprint(self) -> str:
        """SHA-256 of the content, 64 hexadecimal digits; the same in every process and on every machine.

        Meshes count by file name and scale, not by the folder they lie in; `source` does not count.
        """
        return fingerprint([getattr(self, f.name) for f in dataclasses.fields(self) if f.name != "source"])

    def __eq__(self, other: object) -> bool:
        return self.fingerprint == other.fingerprint if isinstance(other, Model) else NotImplemented

    def __hash__(self) -> int:
        return int(self.fingerprint[:15], 16)

    def __reduce__(self) -> tuple[Any, ...]:
        # without the cached properties, and through __post_init__, which makes the arrays read-only again
        return Model, tuple(_plain(getattr(self, f.name)) for f in dataclasses.fields(self))

    def table(self) -> str:
        """Joints, kinds, axes, limits, parents and masses as a text table."""
        return table(self)

    def __str__(self) -> str:
        return self.table()

    def __repr__(self) -> str:
        sizes = f"{len(self.joints)} joints, nq={self.nq}, nv={self.nv}"
        return f"<Model {self.name!r}: {sizes}, tool={self.tool!r}>"


def _plain(value: Any) -> Any:
    return dict(value) if isinstance(value, Named) else value


def _coordinate_names(entries: Iterable[tuple[str, Iterable[Any]]]) -> tuple[str, ...]:
    return tuple(f"{joint}.{c.name}" if c.name else joint for joint, cs in entries for c in cs)


def _place(places: Mapping[str, int], name: Any) -> int | None:
    """Where something of that name is; None also for what cannot be a name, such as an array."""
    try:
        return places.get(name)
    except TypeError:  # it has no hash
        return None
