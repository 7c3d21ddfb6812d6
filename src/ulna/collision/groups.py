"""What the spheres of a robot are checked against by formulas: obstacles and links that never move, in groups."""

from __future__ import annotations

from collections.abc import Container, Iterable, Sequence

from ulna.collision import clearance as gap
from ulna.collision.clouds import is_points
from ulna.collision.pairs import LinkPair
from ulna.collision.solids import Missing
from ulna.collision.spheres import Spheres
from ulna.collision.world import World
from ulna.model import Model
from ulna.spatial import SE3
from ulna.typing import Floats

Group = tuple[gap.Kind, tuple[str, ...], list[tuple[gap.Part, SE3, str]]]
"""A formula, links, and the pieces checked by it against their spheres: each with its pose, and whose pose that is."""


def grouped(
    model: Model,
    world: World,
    covering: Spheres,
    attached: Container[str],
    pairs: Sequence[LinkPair],
    missing: Missing,
) -> list[Group]:
    """What spheres are checked against, by formula and by the links: fixed links, and the world's obstacles.

    Attached objects have separate groups, and so have links that keep another distance.

    Args:
        model: The robot.
        world: The world.
        covering: Spheres of links and attached objects.
        attached: Names of attached objects.
        pairs: Pairs of links and attached objects.
        missing: What to do about a mesh file that is missing: "error", or "skip" it with a warning.

    Returns:
        The groups.
    """
    groups: dict[tuple[gap.Kind, tuple[str, ...]], list[tuple[gap.Part, SE3, str]]] = {}

    def put(part: gap.Part, links: Sequence[str], pose: SE3, name: str) -> None:
        attached_links = [(link,) for link in links if link in attached]
        margins = {link: world.margin(part.owner, link) for link in links}
        rest = [
            tuple(link for link in links if link not in attached and margins[link] == margin)
            for margin in sorted(set(margins.values()))
        ]
        for chosen in (*rest, *attached_links):
            if chosen:
                members = groups.setdefault((part.kind, chosen), [])
                members.append((part.grown(margins[chosen[0]]), pose, name))

    for part, links in gap.fixed_parts(model, pairs, missing):
        put(part, links, SE3.identity(), "")
    for part in gap.parts(World(tuple(o for o in world if not is_points(o.shape))), missing):
        obstacle = world[part.owner]
        put(part, gap.checked_links(model, covering, obstacle, world), obstacle.pose, part.owner)
    return [(kind, links, members) for (kind, links), members in groups.items()]


def pairs_apart(
    model: Model,
    world: World,
    covering: Spheres,
    pairs: Iterable[LinkPair],
    attached_pairs: Iterable[LinkPair],
) -> list[tuple[str, str, Floats]]:
    """Pairs that the kernel of the links' spheres does not know: of attached objects, and those with margins.

    Args:
        model: The robot.
        world: The world.
        covering: Spheres of links and attached objects.
        pairs: Pairs of links.
        attached_pairs: Pairs of which the first is an attached object.

    Returns:
        Both names, and the least distances of their centres, shape (spheres, spheres) [m].
    """
    still = {link.name for link in model.links if link.joint < 0}
    balls = covering.links
    return [
        (a, b, balls[a].radii[:, None] + balls[b].radii + world.margin(a, b))
        for a, b in (*attached_pairs, *(pair for pair in pairs if world.margin(*pair)))
        if a not in still and b not in still
    ]
