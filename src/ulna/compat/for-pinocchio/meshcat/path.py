"""The place of an object in MeshCat's tree."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

from ulna.errors import InputError


@final
@dataclass(frozen=True)
class Path:
    """Names from the root to an object.

    Args:
        entries: The names.
    """

    entries: tuple[str, ...] = ()

    def append(self, other: str) -> Path:
        """The path to an object below this one; "/" at the beginning of `other` starts from the root.

        Args:
            other: Names with "/" between them.

        Returns:
            The path.

        Raises:
            InputError: It is no text.
        """
        if not isinstance(other, str):
            raise InputError(f"A path of MeshCat's tree is {other!r}; expected names with '/' between them.")
        start = () if other.startswith("/") else self.entries
        return Path((*start, *(name for name in other.split("/") if name)))

    def lower(self) -> str:
        """The path as one text."""
        return "/" + "/".join(self.entries)
