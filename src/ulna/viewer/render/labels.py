"""Labels drawn into a picture, with Pillow where it is installed."""

from __future__ import annotations

import warnings
from contextlib import suppress
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from ulna.errors import UlnaWarning
from ulna.extras import install_command
from ulna.typing import Array
from ulna.viewer.graph.camera import Camera
from ulna.viewer.graph.content import Text
from ulna.viewer.graph.node import Snapshot
from ulna.viewer.graph.theme import Theme

_FONTS = ("DejaVuSans.ttf", "Arial Unicode.ttf", "Arial.ttf", "arial.ttf", "LiberationSans-Regular.ttf")
_MATPLOTLIB_FONT = Path("mpl-data", "fonts", "ttf", "DejaVuSans.ttf")


def draw_labels(image: Array, camera: Camera, snapshot: Snapshot, theme: Theme) -> Array:
    """Draw the labels of a scene over a picture, each where its node is.

    Args:
        image: The picture, (h, w, 3) uint8.
        camera: The camera.
        snapshot: The scene.
        theme: Colours.

    Returns:
        The picture with labels, (h, w, 3) uint8.
    """
    labels = [(i, node.content) for i, node in enumerate(snapshot.nodes) if isinstance(node.content, Text)]
    labels = [(i, text) for i, text in labels if snapshot.visible[i] and snapshot.opacity[i] > 0.0]
    if not labels:
        return image
    try:
        from PIL import Image, ImageDraw
    except ImportError:
        warnings.warn(
            "Words are left out of the picture: they need the package 'pillow'. Install it with: "
            + install_command("film", "pillow"),
            UlnaWarning,
            stacklevel=3,
        )
        return image
    height, width = image.shape[:2]
    focus = height / (2 * np.tan(camera.fov / 2))
    canvas = Image.fromarray(image)
    for i, text in labels:
        x, y, z = (snapshot.poses[i, :3, 3] - camera.position) @ camera.axes()
        size = text.height * float(snapshot.scales[i, 2]) * focus / max(-z, 1e-9)
        if z < -0.02 and 1.0 < size < height:
            text_colour = (
                theme.text if snapshot.tint[i, 0] < 0 else tuple(int(255 * c) for c in snapshot.tint[i])
            )
            anchor = (width / 2 - focus * x / z, height / 2 + focus * y / z)
            font = _font(size)
            mask = Image.new("L", canvas.size)  # text that is drawn right onto a picture is never translucent
            draw: Any = ImageDraw.Draw(mask)
            lines = text.text.split("\n")
            for k, line in enumerate(lines):  # the last one stands on the place, as in the page
                at = (anchor[0], anchor[1] - 1.25 * size * (len(lines) - 1 - k))
                draw.text(at, line, fill=round(255 * snapshot.opacity[i]), font=font, anchor="ls")
            canvas.paste(text_colour, mask=mask)
    return np.asarray(canvas)


@lru_cache(maxsize=64)
def _font(size: float) -> Any:
    """A font with units and Greek letters, where one is found; Pillow's own lacks them."""
    from PIL import ImageFont

    matplotlib = find_spec("matplotlib")
    bundled = (
        []
        if matplotlib is None or matplotlib.origin is None
        else [Path(matplotlib.origin).parent / _MATPLOTLIB_FONT]
    )
    for font in (*_FONTS, *bundled):
        with suppress(OSError):
            return ImageFont.truetype(str(font), size)
    return ImageFont.load_default(size)
