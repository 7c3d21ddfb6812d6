"""Spheres that cover a robot's links: fitted, kept, edited, written down."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import final

import numpy as np

from ulna import algorithms
from ulna import disk_cache as cache
from ulna.checks.arrays import finite_array
from ulna.collision.fit import cover
from ulna.collision.pairs import LinkPair, link_pairs
from ulna.collision.solids import Missing, Solid, link_solids
from ulna.errors import FormatError, InputError, ShapeError
from ulna.geometry import Mesh
from ulna.model import Model
from ulna.model.content import fingerprint
from ulna.system.cached import cached_property
from ulna.typing import Array, ArrayLike, Floats

_TRIALS = 64
_SHARPEST = 8  # how much finer than asked for the spheres of links that pass each other closely may be
_VERSION = 4  # of the fit: changed with every change to what it finds


@final
@dataclass(frozen=True, eq=False)
class LinkSpheres:
    """The spheres of one link.

    Attributes:
        centres: In the link's frame, (n, 3) [m].
        radii: (n,) [m].
        excess: No point of them is farther from the link's geometry (meshes: convex hulls) than this [m]; None where
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


def fit(model: Model, tolerance: float = 0.012, most: int = 12, *, missing: Missing = "error") -> Spheres:
    """Spheres that cover the collision geometry of every link; stored on disk, since computing them may take seconds.

    Links whose spheres touch those of another in most configurations get finer ones, up to eight times.

    Args:
        model: The robot.
        tolerance: How far spheres should stick out of curved surfaces [m]; of flat ones twice that.
        most: The largest number of spheres for one shape; where they do not suffice, `excess` is larger.
        missing: What to do about a mesh file that is missing: "error", or "skip" it with a warning.

    Returns:
        The spheres of each link.

    Raises:
        InputError: If tolerance or count make no sense.
        ModelError: If the robot has no collision geometry, or a mesh is missing.
        MissingExtra: If scipy is not installed.
    """
    if not (np.isfinite(tolerance) and tolerance >= 1e-4):
        raise InputError(f"`tolerance` is {tolerance!r}; expected a length of at least 0.0001 [m].")
    if int(most) != most or most < 1:
        raise InputError(f"`most` is {most!r}; expected a count, 1 or more.")
    by_link: dict[str, list[Solid]] = {}
    for solid in link_solids(model, missing):
        by_link.setdefault(solid.owner, []).append(solid)
    sharpness = dict.fromkeys(by_link, 1)
    while True:
        fitted = Spheres(
            {k: _link(model, k, v, tolerance / sharpness[k], most * sharpness[k]) for k, v in by_link.items()}
        )
        blunt = {name for pair in _crowded(model, fitted) for name in pair if sharpness[name] < _SHARPEST}
        if not blunt:
            return fitted
        for name in blunt:
            sharpness[name] *= 2


def _link(model: Model, name: str, solids: list[Solid], tolerance: float, most: int) -> LinkSpheres:
    """The spheres of one link, from the disk where they are."""
    base = model.link(name).placement.inverse()
    places = [base @ solid.placement for solid in solids]
    parts = [[s.shape, s.vertices if isinstance(s.shape, Mesh) else None] for s in solids]
    key = cache.key("spheres", fingerprint([_VERSION, parts, places, float(tolerance), int(most)]))
    stored = cache.read(key)
    if stored is not None:
        (same,) = Spheres.from_json(
            stored.decode()
        ).links.values()  # of a link of any name: shapes are the key
        return same
    fitted = LinkSpheres(*cover(solids, places, float(tolerance), int(most)))
    cache.write(key, Spheres({name: fitted}).to_json().encode())
    return fitted


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


def _crowded(model: Model, spheres: Spheres) -> list[LinkPair]:
    """Pairs of links whose spheres touch in more than half of some configurations: links that pass each other closely,
    where blunt spheres would leave no room at all.
    """
    q = algorithms.random(model, np.random.default_rng(0), (_TRIALS,))
    placed = {
        name: np.broadcast_to(points, (_TRIALS, *points.shape[-2:]))
        for name, points in sphere_centres(model, q, spheres).items()
    }
    crowded = []
    for a, b in link_pairs(model):
        if model.link(a).joint < 0 or model.link(b).joint < 0 or not {a, b} <= placed.keys():
            continue  # fixed links need no spheres against others; what was skipped has none
        apart = ((placed[a][:, :, None] - placed[b][:, None]) ** 2).sum(axis=-1)
        reach = spheres.links[a].radii[:, None] + spheres.links[b].radii
        if (apart <= reach**2).any(axis=(1, 2)).mean() > 0.5:
            crowded.append((a, b))
    return crowded
