"""Chains of elementary transforms: tz(0.333) Rz(q0) Rx(-90 deg) ..., as objects and as text -> Model.

An elementary transform is a turn about, or a shift along, one axis of the current frame, by a constant or by
a joint coordinate; a chain of them describes any serial arm without the conventions of Denavit and Hartenberg
(Corke, A simple and systematic approach to assigning Denavit-Hartenberg parameters, IEEE Transactions on
Robotics 23, 2007).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol, final, overload

from ulna.errors import InputError, ShapeError, UnknownName
from ulna.formats.ets_text import NAMES, parse_steps
from ulna.formats.poses import without_rounding
from ulna.model import JointKind, Model, ModelBuilder, Prismatic, Revolute
from ulna.numeric import is_symbolic
from ulna.spatial import SE3
from ulna.system.cached import cached_property
from ulna.typing import ArrayLike

_AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
_UNITS = {"angle": "[rad]", "distance": "[m]"}


class _Constructor(Protocol):
    def __call__(self, value: float | None = None, **joint: Any) -> ET: ...


def _constructor(name: str, action: str, coordinate: str) -> _Constructor:
    """The method of `ET` that makes the transforms of a name, a turn or a shift."""

    def make(cls: type[ET], value: float | None = None, **joint: Any) -> ET:
        if value is None:
            return cls(name, **joint)
        if joint:
            raise InputError(
                f"ET.{name}({value!r}, {', '.join(joint)}=...): a constant has no {' or '.join(joint)}."
            )
        number = float(value)
        if not math.isfinite(number):
            raise InputError(f"ET.{name}({number}): expected a finite {coordinate} {_UNITS[coordinate]}.")
        return cls(name, number)

    make.__name__, make.__qualname__ = name, f"ET.{name}"
    make.__doc__ = f"""A {action}.

        Args:
            value: A constant {_UNITS[coordinate]}; None for a joint {coordinate}.
            **joint: `index`, `flip` and `limits` of a joint; see `ET`.

        Returns:
            The transform.
        """
    return classmethod(make)  # type: ignore[return-value]


@final
@dataclass(frozen=True)
class ET:
    """One elementary transform.

    Attributes:
        name: "rx", "ry", "rz", "tx", "ty", "tz", or "SE3" for a constant pose.
        value: the constant angle [rad] or distance [m]; None for a joint.
        index: which joint coordinate it is; None for the next one in the chain, and for constants.
        flip: whether the joint coordinate counts backwards.
        limits: lowest and highest joint coordinate [rad or m].
        pose: the constant of "SE3".
    """

    name: str
    value: float | None = None
    index: int | None = None
    flip: bool = False
    limits: tuple[float, float] | None = None
    pose: SE3 | None = None

    def __post_init__(self) -> None:
        if self.name not in (*NAMES, "SE3"):
            raise UnknownName("elementary transform", self.name, (*NAMES, "SE3"))
        if (self.name == "SE3") != (self.pose is not None):
            raise InputError("A constant pose is written ET.se3(pose), the others ET.rx(...) to ET.tz(...).")

    rx = _constructor("rx", "turn about x", "angle")
    ry = _constructor("ry", "turn about y", "angle")
    rz = _constructor("rz", "turn about z", "angle")
    tx = _constructor("tx", "shift along x", "distance")
    ty = _constructor("ty", "shift along y", "distance")
    tz = _constructor("tz", "shift along z", "distance")

    @classmethod
    def se3(cls, pose: SE3) -> ET:
        """A constant pose."""
        return cls("SE3", pose=pose)

    @property
    def is_joint(self) -> bool:
        """Whether it moves."""
        return self.value is None and self.pose is None

    def transform(self, value: Any = None) -> SE3:
        """The pose; `value` (...) is the joint coordinate, for a joint."""
        if self.pose is not None:
            return self.pose
        if not self.is_joint:
            value = self.value
        elif self.flip:
            value = -value
        if self.name[0] == "r":
            turned = {"x": SE3.rx, "y": SE3.ry, "z": SE3.rz}[self.name[1]](value)
            return turned if self.is_joint else without_rounding(turned)
        zero = 0.0 * value if self.is_joint and not is_symbolic(value) else 0.0
        return SE3.trans(*(value if axis == self.name[1] else zero for axis in "xyz"))

    def __mul__(self, other: ET | ETS) -> ETS:
        return ETS((self,)) * other

    def __str__(self) -> str:
        if self.pose is not None:
            return "SE3(...)"
        letters = self.name[0].upper() + self.name[1] if self.name[0] == "r" else self.name
        if self.is_joint:
            return f"{letters}({'-' * self.flip}q{'' if self.index is None else self.index})"
        assert self.value is not None
        if self.name[0] == "r":
            return f"{letters}({math.degrees(self.value):.6g} deg)"
        return f"{letters}({self.value:.6g})"


@final
@dataclass(frozen=True)
class ETS:
    """A chain of elementary transforms; compose with `*`.

    Attributes:
        transforms: in order, from the base to the tool. Joints without an index take the next free one.
    """

    transforms: tuple[ET, ...] = ()

    @cached_property
    def joint_indices(self) -> tuple[int | None, ...]:
        """The joint coordinate of each transform; None for the constant ones."""
        following = 0
        numbered = []
        for et in self.transforms:
            index = et.index
            if et.is_joint:
                index = following if index is None else index
                following = max(following, index + 1)
            numbered.append(index)
        return tuple(numbered)

    @property
    def n(self) -> int:
        """The number of joint coordinates."""
        return max((i + 1 for i in self.joint_indices if i is not None), default=0)

    @classmethod
    def parse(cls, text: str) -> ETS:
        """The chain that a text such as "tz(0.333) Rz(q0) Rx(-90 deg) ty(-0.316)" describes.

        A step is tx, ty, tz, Rx, Ry or Rz (any case) with a number, a number in degrees ("90 deg", "90°"), a
        multiple of pi ("pi/2", "-3*pi/4"), or a joint: "q" (the next), "q3", "-q3" (counts backwards). Steps
        are separated by blanks, "*" or nothing.

        Raises:
            InputError: a step cannot be read; says which.
        """
        return cls(
            tuple(
                ET(step.name, index=step.index, flip=step.flip)
                if step.value is None
                else getattr(ET, step.name)(step.value)
                for step in parse_steps(text)
            )
        )

    def transform(self, q: ArrayLike = ()) -> SE3:
        """The pose of the end of the chain, for joint coordinates q (..., n) [rad, m].

        Raises:
            ShapeError: q has not n entries.
        """
        import numpy as np

        values = np.asarray(q) if is_symbolic(q) else np.asarray(q, dtype=float)
        if values.ndim == 0 or values.shape[-1] != self.n:
            raise ShapeError("q", values.shape, f"(..., {self.n})")
        pose = SE3.identity()
        for et, index in zip(self.transforms, self.joint_indices, strict=True):
            pose = pose @ et.transform(None if index is None else values[..., index])
        return pose

    def model(
        self,
        name: str = "robot",
        *,
        joint_names: Sequence[str] | None = None,
        configurations: Mapping[str, ArrayLike] | None = None,
    ) -> Model:
        """The serial arm of the chain: links "base", "link1", "link2", ..., and the frame "tool" at its end.

        A joint coordinate that occurs again gives a joint that follows the first one.

        Args:
            name: of the robot.
            joint_names: one for each moving transform; "joint1", "joint2", ... where left out.
            configurations: Named configurations, each of shape (n,) [rad, m].

        Returns:
            The model.

        Raises:
            InputError: the chain has no joint, or the indices of its joints do not rise along it.
        """
        moving = [(et, i) for et, i in zip(self.transforms, self.joint_indices, strict=True) if i is not None]
        _check_order([i for _, i in moving])
        names = list(joint_names or (f"joint{k}" for k in range(1, len(moving) + 1)))
        if len(names) != len(moving):
            raise InputError(f"`joint_names` has {len(names)} names; the chain has {len(moving)} joints.")
        builder = ModelBuilder(name)
        builder.add_link("base")
        parent, before = "base", SE3.identity()
        leaders: dict[int, str] = {}
        count = 0
        for et, index in zip(self.transforms, self.joint_indices, strict=True):
            if index is None:
                before = before @ et.transform()
                continue
            joint, link = names[count], f"link{count + 1}"
            count += 1
            extra: dict[str, Any] = {}
            if index in leaders:
                extra["mimic"] = (leaders[index], 1.0, 0.0)
            else:
                leaders[index] = joint
            if et.limits is not None:
                extra |= {"lower": et.limits[0], "upper": et.limits[1]}
            builder.add_link(link)
            builder.add_joint(joint, _kind(et.name, et.flip), parent, link, before, **extra)
            parent, before = link, SE3.identity()
        builder.add_frame("tool", parent, before)
        builder.set_tool("tool")
        for key, q in (configurations or {}).items():
            builder.add_configuration(key, q)
        return builder.build()

    @overload
    def __getitem__(self, item: int) -> ET: ...
    @overload
    def __getitem__(self, item: slice) -> ETS: ...
    def __getitem__(self, item: int | slice) -> ET | ETS:
        return ETS(self.transforms[item]) if isinstance(item, slice) else self.transforms[item]

    def __len__(self) -> int:
        return len(self.transforms)

    def __iter__(self) -> Iterator[ET]:
        return iter(self.transforms)

    def __mul__(self, other: ET | ETS) -> ETS:
        if not isinstance(other, (ET, ETS)):
            return NotImplemented
        return ETS(self.transforms + ((other,) if isinstance(other, ET) else other.transforms))

    def __str__(self) -> str:
        shown = []
        for et, index in zip(self.transforms, self.joint_indices, strict=True):
            shown.append(str(et if index is None else ET(et.name, index=index, flip=et.flip)))
        return " ".join(shown)


def _kind(name: str, flip: bool) -> JointKind:
    axis = _AXES[name[1]]
    if flip:
        axis = (-axis[0] + 0.0, -axis[1] + 0.0, -axis[2] + 0.0)
    return Revolute(axis) if name[0] == "r" else Prismatic(axis)


def _check_order(indices: Sequence[int]) -> None:
    if not indices:
        raise InputError("The chain has no joint; write one with ET.rz() or Rz(q).")
    firsts = list(dict.fromkeys(indices))
    if firsts != list(range(len(firsts))):
        shown, wanted = (", ".join(f"q{i}" for i in order) for order in (firsts, range(len(firsts))))
        raise InputError(
            f"The joints occur in the order {shown}; expected {wanted}. "
            "Number them along the chain, and permute q where you need another order."
        )
