"""Pictures of a figure in which little moves: axes, grid and labels are drawn once, and kept as pixels."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any


class Background:
    """The pixels of a figure without what moves."""

    def __init__(self) -> None:
        self._key: Any = None
        self._pixels: Any = None
        self._never_drawn: set[int] = set()  # such as empty titles, and spines of axes in three dimensions

    def draw(self, canvas: Any, ax: Any, moving: Sequence[Any]) -> None:
        """Draws a figure on its canvas, as `canvas.draw()` does.

        Args:
            canvas: An Agg canvas of the figure.
            ax: Its axes, in three dimensions or in the plane.
            moving: What else than before is to be seen in the axes.
        """
        still = [a for a in ax.get_children() if all(a is not b for b in moving)]
        view = [getattr(ax, name, None) for name in ("elev", "azim", "roll")]
        limits = [getattr(ax, f"get_{axis}lim")() for axis in "xyz" if hasattr(ax, f"get_{axis}lim")]
        texts = [a.get_text() for a in still if hasattr(a, "get_text")]
        number = len(ax.figure.axes)
        key = repr((id(canvas), canvas.get_width_height(), view, limits, texts, list(map(id, still)), number))
        for artist in moving:
            artist.set_animated(True)
        try:
            if key != self._key or any(a.stale and id(a) not in self._never_drawn for a in still):
                canvas.draw()
                self._key, self._pixels = key, canvas.copy_from_bbox(ax.figure.bbox)
                self._never_drawn = {id(a) for a in still if a.stale}
            canvas.restore_region(self._pixels)
            renderer = canvas.get_renderer()
            for artist in sorted(moving, key=lambda a: (hasattr(a, "get_offsets"), a.get_zorder())):
                if hasattr(artist, "do_3d_projection"):
                    artist.do_3d_projection()
                artist.draw(renderer)
        finally:
            for artist in moving:
                artist.set_animated(False)
                artist.stale = False
