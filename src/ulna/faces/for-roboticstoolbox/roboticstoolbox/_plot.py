"""Pictures of a robot: stick figures, films, sliders."""

from __future__ import annotations


class Plotting:
    """Pictures."""
