"""The state of a builder: links, joints and frames by name, not yet put together."""

from __future__ import annotations

from dataclasses import field
from typing import Any

from ulna.data_classes import dataclass
from ulna.errors import ModelError
from ulna.geometry import Geometry
from ulna.model.joints import Fixed, JointKind
from ulna.model.parts import FrameKind, Limits
from ulna.spatial import SE3, Inertia


@dataclass(frozen=True)
class LinkRecord:
    """A link, before its place in the tree is known."""

    name: str
    inertia: Inertia
    visuals: tuple[Geometry, ...]
    collisions: tuple[Geometry, ...]
    where: str


@dataclass(frozen=True)
class JointRecord:
    """A joint, movable or fixed; `parent` None is the world."""

    name: str
    kind: JointKind
    parent: str | None
    child: str
    placement: SE3
    offset: SE3
    limits: Limits
    damping: tuple[float, ...]
    friction: tuple[float, ...]
    armature: tuple[float, ...]
    mimic: tuple[str, float, float] | None
    where: str

    @property
    def movable(self) -> bool:
        """Whether it moves."""
        return not isinstance(self.kind, Fixed)


@dataclass(frozen=True)
class FrameRecord:
    """A named point on a link."""

    name: str
    link: str
    placement: SE3
    kind: FrameKind
    where: str


@dataclass
class BuilderState:
    """The parts added to a builder so far."""

    name: str
    source: str | None = None
    gravity: Any = (0.0, 0.0, -9.81)
    links: dict[str, LinkRecord] = field(default_factory=dict)
    joints: dict[str, JointRecord] = field(default_factory=dict)
    frames: dict[str, FrameRecord] = field(default_factory=dict)
    root_joint: JointRecord | None = None
    configurations: dict[str, Any] = field(default_factory=dict)
    tool: str | None = None
    disabled_pairs: set[tuple[str, str]] = field(default_factory=set)
    groups: dict[str, tuple[str, ...]] = field(default_factory=dict)
    from_models: set[str] = field(
        default_factory=set
    )  # links of finished models, warned of when those were built


def with_location(where: str, text: str) -> str:
    """A message that begins with the place in a file that it is about.

    Args:
        where: The place; empty for none.
        text: The message.

    Returns:
        The message with its place.
    """
    return f"{where}: {text}" if where else text


def model_error(where: str, text: str) -> ModelError:
    """A ModelError whose message begins with the place in a file that it is about.

    Args:
        where: The place; empty for none.
        text: The message.

    Returns:
        The error.
    """
    return ModelError(with_location(where, text))
