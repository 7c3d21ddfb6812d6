"""The joint between the world and the base of a robot, by name."""

from __future__ import annotations

from ulna.errors import UnknownName
from ulna.model import FreeFlyer, JointKind, Planar


def root_kind(root: str | JointKind | None) -> JointKind | None:
    """The joint kind that `root` means; None for a fixed base.

    Raises:
        UnknownName: it is a word that means nothing here.
    """
    if root is None or isinstance(root, JointKind):
        return root
    kinds: dict[str, JointKind | None] = {"fixed": None, "free_flyer": FreeFlyer(), "planar": Planar()}
    if root not in kinds:
        floats = "float" in str(root).casefold()
        raise UnknownName(
            "root joint", root, kinds, 'A floating base is root="free_flyer".' if floats else ""
        )
    return kinds[root]
