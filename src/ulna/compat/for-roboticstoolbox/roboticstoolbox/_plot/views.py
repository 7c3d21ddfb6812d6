"""Views of figures along an axis, and whether to wait for their windows."""

from __future__ import annotations

from typing import Any

from roboticstoolbox._common.errors import UnknownOption

_VIEWS = {"xy": (90, -90), "xz": (0, -90), "yz": (0, 0)}


def plane_view(plane: str) -> dict[str, int]:
    """Elevation and azimuth [deg] of the view of a plane, "xy", "xz" or "yz", as arguments of `Axes3D.view_init`.

    Raises:
        UnknownOption: There is no such plane.
    """
    key = plane.lower() if isinstance(plane, str) else plane
    if key not in _VIEWS:
        raise UnknownOption("plane", str(plane), _VIEWS)
    elevation, azimuth = _VIEWS[key]
    return {"elev": elevation, "azim": azimuth}


def set_plane_view(ax: Any, plane: str) -> None:
    """Shows axes of Matplotlib in the view of a plane; see `plane_view`.

    Args:
        ax: The axes.
        plane: The plane; see `plane_view`.
    """
    ax.view_init(**plane_view(plane))


def apply_block(block: bool | None) -> None:
    """Shows the figures: True waits until their windows are closed, False does not, None does nothing."""
    if block is not None:
        import matplotlib.pyplot as plt

        plt.show(block=block)
