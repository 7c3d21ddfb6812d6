"""Spheres that cover a robot's links: as values, as text, and placed in the world."""

from __future__ import annotations

import json
from collections.abc import Mapping
from types import MappingProxyType
from typing import final

import numpy as np

from ulna import algorithms
from ulna.checks.arrays import finite_array
from ulna.data_classes import dataclass
from ulna.errors import FormatError, InputError, ShapeError
from ulna.model import Model
from ulna.model.content import fingerprint
from ulna.system.cached import cached_property
from ulna.typing import Array, ArrayLike, Floats


@final
@dataclass(frozen=True, eq=False)
class LinkSpheres:
    """The spheres of one link.

    Attributes:
        centres: In the link's frame, (n, 3) [m].
        radii: (n,) [m].
        excess: No point of them is farther from the link's geometry than this [m]; None where
            that is not known, since they were edited.
    """

    centres: Floats
    radii: Floats
    excess: float | None = None

    def __post_init__(self) -> None:
        centres, radii = finite_array("centres", self.centres), finite_array("radii", self.radii)
        if centres.ndim != 2 or centres.shape[1] != 3:
            raise ShapeError("centres", centres.shape, "(n, 3)")
        if radii.shape != (len(centres),):
            raise ShapeError("radii", radii.shape, f"({len(centres)},), one for each centre")
        for name, array in (("centres", centres), ("radii", radii)):
            array.setflags(write=False)
            object.__setattr__(self, name, array)
        if (radii <= 0.0).any():
            raise InputError(f"`radii` holds {radii.min():g}; expected lengths above 0 [m].")


@final
@dataclass(frozen=True, eq=False)
class Spheres:
    """Spheres for the links of a robot, by link name; frozen, edited by making new ones.

    Spheres that `fit` makes cover their link's geometry: what they do not touch the link does not touch. After
    `replace` that is the editor's word.
    """

    links: Mapping[str, LinkSpheres]

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Spheres) and self.fingerprint == other.fingerprint

    def __hash__(self) -> int:
        return hash(self.fingerprint)

    @property
    def count(self) -> int:
        """How many spheres there are in all."""
        return sum(len(s.radii) for s in self.links.values())

    @property
    def excess(self) -> dict[str, float | None]:
        """By link, how far spheres stick out at most [m]; None where they were edited."""
        return {name: s.excess for name, s in self.links.items()}

    @cached_property
    def fingerprint(self) -> str:
        """SHA-256 of the content."""
        return fingerprint([[name, s.centres, s.radii] for name, s in self.links.items()])

    def replace(self, link: str, centres: ArrayLike, radii: ArrayLike) -> Spheres:
        """The same with other spheres on one link.

        Args:
            link: Name of the link.
            centres: Centres in its frame, shape (n, 3) [m].
            radii: Radii, shape (n,) [m].

        Returns:
            New spheres.
        """
        new = LinkSpheres(np.asarray(centres, dtype=float), np.asarray(radii, dtype=float))
        return Spheres({**self.links, link: new})

    def grown(self, by: float) -> Spheres:
        """The same with every radius larger [m]: a margin that follows the robot."""
        return Spheres({k: LinkSpheres(s.centres, s.radii + by) for k, s in self.links.items()})

    def to_json(self) -> str:
        """As text that `from_json` reads; numbers survive to the last bit."""
        links = {
            name: {"centres": s.centres.tolist(), "radii": s.radii.tolist(), "excess": s.excess}
            for name, s in self.links.items()
        }
        return json.dumps({"ulna": "spheres", "links": links}, indent=1)

    @classmethod
    def from_json(cls, text: str) -> Spheres:
        """From the text of `to_json`. Raises FormatError if it is not such a text."""
        try:
            links = json.loads(text)["links"]
            return cls({k: LinkSpheres(v["centres"], v["radii"], v.get("excess")) for k, v in links.items()})
        except (ValueError, TypeError, KeyError, AttributeError) as error:
            raise FormatError(
                f"this is no text of spheres: {error}", fix="Write one with `Spheres.to_json()`."
            ) from error

    def __repr__(self) -> str:
        return f"<{self.count} spheres on {len(self.links)} links>"


def sphere_centres(
    model: Model, q: Array, spheres: Spheres, carriers: Mapping[str, str] = MappingProxyType({})
) -> dict[str, Array]:
    """Where the spheres are in the world.

    Args:
        model: The robot.
        q: Configuration, (..., nq) [rad or m].
        spheres: The spheres on its links, and of objects in the frames of the links that carry them.
        carriers: These links by name of the object.

    Returns:
        By link the centres (..., n, 3) [m]; (n, 3) for a link that no joint moves.
    """
    joints = algorithms.joint_poses(model, q)
    points = {}
    for name, balls in spheres.links.items():
        link = model.link(carriers.get(name, name))
        points[name] = link.placement @ balls.centres
        if link.joint >= 0:
            T = joints[link.joint]
            points[name] = points[name] @ np.swapaxes(T.rotation, -1, -2) + T.translation[..., None, :]
    return points
