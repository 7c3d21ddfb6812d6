"""Robots made of a robot: locked, attached, with another tool, other numbers, a payload."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Self

from ulna import model as models
from ulna.errors import InputError
from ulna.quantities.part import Part
from ulna.spatial import SE3
from ulna.typing import ArrayLike


class Variants(Part):
    """New robots; the one at hand never changes."""

    __slots__ = ()

    def lock(self, joints: Mapping[str, Any] | Sequence[str], q: Any = None) -> Self:
        """The robot with some joints held still; see `ulna.model.lock_joints`."""
        return type(self)(models.lock_joints(self.model, joints, q))

    def attach(
        self,
        other: Self,
        frame: str | None = None,
        placement: SE3 | None = None,
        prefix: str = "",
        **options: Any,
    ) -> Self:
        """This robot carrying another: a gripper on an arm, an arm on a base; see `ulna.model.attach`."""
        if not isinstance(other, type(self)):
            raise InputError(f"`other` is {other!r}; expected a Robot, such as ulna.load(...) returns.")
        return type(self)(models.attach(self.model, other.model, frame, placement, prefix, **options))

    def with_tool(self, frame: str, placement: SE3 | None = None, name: str = "tool") -> Self:
        """The robot with another tool: a frame, or a new one at `placement` (T_frame_tool) in it."""
        return type(self)(models.with_tool(self.model, frame, placement, name))

    def with_dynamic_parameters(self, parameters: ArrayLike, *, check: bool = True) -> Self:
        """The robot with other masses and inertias; see `ulna.model.with_dynamic_parameters`."""
        return type(self)(models.with_dynamic_parameters(self.model, parameters, check=check))

    def with_parameters(self, values: Mapping[str, Any], *, check: bool = True) -> Self:
        """The robot with other inertias, placements, offsets, gravity ...; see `ulna.model.with_parameters`."""
        return type(self)(models.with_parameters(self.model, values, check=check))

    def with_payload(
        self,
        frame: str | None = None,
        mass: float = 1.0,
        com: ArrayLike = (0.0, 0.0, 0.0),
        inertia: ArrayLike | None = None,
        *,
        name: str = "payload",
    ) -> Self:
        """The robot carrying a body at a frame, the tool for None; see `ulna.model.with_payload`."""
        return type(self)(models.with_payload(self.model, frame, mass, com, inertia, name=name))

    def perturbed(self, fraction: float = 0.1, seed: Any = None, com: float = 0.0) -> Self:
        """A robot like this one, with masses and inertias off at random; see `ulna.model.perturbed`."""
        return type(self)(models.perturbed(self.model, fraction, seed, com))

    def with_configuration(self, name: str, q: Any) -> Self:
        """The robot with a named configuration: numbers (nq,), or a dictionary from joint names to positions."""
        return type(self)(models.with_configuration(self.model, name, q))
