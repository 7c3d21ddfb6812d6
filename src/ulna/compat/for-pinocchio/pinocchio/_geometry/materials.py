"""Materials: how the surface of a geometry shines, and what it is made of."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any, ClassVar, final

import numpy as np

from pinocchio._containers.arguments import ArgumentError
from pinocchio._containers.arrays import vector
from pinocchio._containers.attributes import AttributeKind, CheckedAttributes, number, one_of
from pinocchio._containers.enums import _Named
from pinocchio._containers.files import register
from ulna.errors import excerpt
from ulna.typing import Floats

__all__ = [
    "FrictionCoefficientMatrix",
    "GeometryNoMaterial",
    "GeometryPhongMaterial",
    "PhysicsMaterial",
    "PhysicsMaterialType",
    "getFrictionCoefficientMatrix",
]


@final
@dataclasses.dataclass(init=False)
class GeometryNoMaterial:
    """Nothing is said of how it shines: `GeometryNoMaterial()`, or a copy of another one."""

    def __init__(self, other: GeometryNoMaterial | None = None) -> None:
        if not (other is None or isinstance(other, GeometryNoMaterial)):
            raise ArgumentError(f"GeometryNoMaterial was given {excerpt(repr(other))}; expected another one.")

    __hash__ = object.__hash__


@final
class GeometryPhongMaterial(CheckedAttributes):
    """`GeometryPhongMaterial(emission colour, specular colour, shininess)`: colours are red, green, blue, opacity."""

    _kinds: ClassVar[Mapping[str, AttributeKind]] = {"meshShininess": number}

    def __init__(self, *parts: Any) -> None:
        if len(parts) == 1 and isinstance(parts[0], GeometryPhongMaterial):
            other = parts[0]
            parts = (other.meshEmissionColor, other.meshSpecularColor, other.meshShininess)
        values: Any = parts or ((0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 0.0, 1.0), 0.0)
        emission, specular, shininess = values
        self._emission = np.array(vector(emission, 4, "meshEmissionColor"))
        self._specular = np.array(vector(specular, 4, "meshSpecularColor"))
        self.meshShininess = shininess
        """How sharp its highlights are, from 0 to 1."""

    @property
    def meshEmissionColor(self) -> Floats:
        """The light it gives off by itself, live."""
        return self._emission

    @meshEmissionColor.setter
    def meshEmissionColor(self, value: Any) -> None:
        self._emission[:] = vector(value, 4, "meshEmissionColor")

    @property
    def meshSpecularColor(self) -> Floats:
        """The colour of its highlights, live."""
        return self._specular

    @meshSpecularColor.setter
    def meshSpecularColor(self, value: Any) -> None:
        self._specular[:] = vector(value, 4, "meshSpecularColor")

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, GeometryPhongMaterial):
            return NotImplemented
        same = np.array_equal(self._emission, other._emission) and np.array_equal(
            self._specular, other._specular
        )
        return same and self.meshShininess == other.meshShininess

    __hash__ = object.__hash__


class PhysicsMaterialType(_Named):
    """Of what a body is made."""

    ICE = 0
    METAL = 1
    CONCRETE = 2
    PLASTIC = 3
    WOOD = 4


@final
class PhysicsMaterial(CheckedAttributes):
    """`PhysicsMaterial(type, compliance, elasticity)`: what a body is made of."""

    _kinds: ClassVar[Mapping[str, AttributeKind]] = {
        "materialType": one_of(PhysicsMaterialType),
        **dict.fromkeys(("compliance", "elasticity"), number),
    }

    def __init__(self, *parts: Any) -> None:
        if len(parts) == 1 and isinstance(parts[0], PhysicsMaterial):
            other = parts[0]
            parts = (other.materialType, other.compliance, other.elasticity)
        values: Any = parts or (PhysicsMaterialType.PLASTIC, 0.0, 0.0)
        kind, compliance, elasticity = values
        self.materialType = kind
        """Of what it is."""
        self.compliance = compliance
        """Its compliance, how far a force presses it in [m/N]."""
        self.elasticity = elasticity
        """How much of an impact's speed comes back, from 0 to 1."""

    def _assign(self, other: PhysicsMaterial) -> None:
        self.__dict__.update(other.__dict__)

    def copy(self) -> PhysicsMaterial:
        """A copy."""
        return self._with_same()

    def __eq__(self, other: object) -> bool:
        return vars(self) == vars(other) if isinstance(other, PhysicsMaterial) else NotImplemented

    __hash__ = object.__hash__


_PAIRS = {
    "ICE ICE": 0.01, "ICE CONCRETE": 0.25, "METAL METAL": 0.75, "METAL PLASTIC": 0.2, "METAL WOOD": 0.5,
    "METAL CONCRETE": 0.85, "PLASTIC PLASTIC": 0.2, "WOOD WOOD": 0.4, "CONCRETE CONCRETE": 1.0,
}  # fmt: skip
"""Friction coefficients of pairs of materials that Pinocchio knows; 0 for others, as there."""


@final
class FrictionCoefficientMatrix:
    """The friction coefficients of pairs of materials: `getFrictionCoefficientMatrix()` returns it."""

    def getFrictionFromMaterialPair(self, type1: PhysicsMaterialType, type2: PhysicsMaterialType) -> float:
        """The coefficient of Coulomb friction between two materials; 0 where none is known.

        Args:
            type1: One material.
            type2: The other one.

        Returns:
            The coefficient [-].
        """
        one, two = (PhysicsMaterialType(kind).name for kind in (type1, type2))
        return _PAIRS.get(f"{one} {two}", _PAIRS.get(f"{two} {one}", 0.0))


def getFrictionCoefficientMatrix() -> FrictionCoefficientMatrix:
    """The friction coefficients of pairs of materials."""
    return FrictionCoefficientMatrix()


ICE, METAL, CONCRETE, PLASTIC, WOOD = PhysicsMaterialType


register(GeometryNoMaterial, GeometryPhongMaterial, PhysicsMaterial, PhysicsMaterialType)
