"""The base of the mixins of a robot: each has methods on one theme, and uses those of the others."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ulna.typing import Floats

if TYPE_CHECKING:
    from roboticstoolbox._links.gripper import Gripper
    from roboticstoolbox._links.link import Link


class RobotMixin:
    """Methods of a robot on one theme."""

    name: str
    n: int
    _links: list[Link]
    _grippers: list[Gripper]
    _base: Floats | None
    _tool: Floats | None
    _gravity: Floats

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any: ...
