"""Which links touch what in one configuration, and by how much: for messages."""

from __future__ import annotations

import numpy as np

from ulna.collision import SphereChecker
from ulna.collision import clearance as gap
from ulna.collision.spheres import sphere_centres
from ulna.typing import Floats


def deepest_touch(checker: SphereChecker, q: Floats) -> tuple[float, str, str]:
    """The two things that are nearest to each other, or overlap most, by their spheres.

    Args:
        checker: The robot in its world.
        q: Configuration, shape (nq,) [rad, m].

    Returns:
        Their clearance [m], negative where they overlap, less their margin; a link or attached object, and what is near
        it: an obstacle, another link or object.
    """
    spheres = checker.covering.links
    placed = sphere_centres(checker.model, q, checker.covering, checker.carriers)
    nearest = (np.inf, "", "")
    for kind, links, rows, owners in checker.static_groups():
        for row, owner in zip(rows, owners, strict=True):
            for link in links:
                pairs = zip(placed[link], spheres[link].radii, strict=True)
                distance = min(float(gap.signed(kind, c, row)) - r for c, r in pairs)
                nearest = min(nearest, (distance, link, owner))
    for link, centres in placed.items():
        for owner, distance in checker.cloud_distances(link, centres):
            nearest = min(nearest, (distance, link, owner))
    still = {link.name for link in checker.model.links if link.joint < 0}
    for a, b in (*checker.pairs, *checker.attached_pairs):
        if a in still or b in still:
            continue  # these count by their real shapes, above
        apart = np.linalg.norm(placed[a][:, None] - placed[b][None], axis=2) - checker.world.margin(a, b)
        distance = float((apart - spheres[a].radii[:, None] - spheres[b].radii[None]).min())
        nearest = min(nearest, (distance, a, b))
    return nearest
