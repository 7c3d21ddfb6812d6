"""Textures of the NumPy renderer: decoded with Pillow, with mip levels, sampled bilinearly.

The level of halving is chosen by how many points of the texture fall into a pixel, and read bilinearly
(Williams, "Pyramidal parametrics", 1983).
"""

from __future__ import annotations

import functools
import io
import warnings

import numpy as np

from ulna.errors import UlnaWarning
from ulna.extras import install_command
from ulna.typing import Array
from ulna.viewer.mesh.surface import linear_from_srgb


def sample_texture(image: bytes, uv: Array, density: Array) -> Array | None:
    """Linear colours of a texture, shape (n, 3); None where it cannot be decoded.

    Args:
        image: The content of a PNG or JPEG file.
        uv: Where, from 0 to 1 with the origin at the lower left, repeating beyond; shape (n, 2).
        density: How much of the texture's area a pixel covers, as a share, shape (n,).

    Returns:
        Linear colours (n, 3), or None.
    """
    levels = _mip_levels(image)
    if not levels:
        return None
    height, width = levels[0].shape[:2]
    wanted = 0.5 * np.log2(np.maximum(density * (height * width), 1.0))
    level = np.clip(np.round(wanted), 0, len(levels) - 1).astype(int)
    out = np.zeros((len(uv), 3), dtype=np.float32)
    for k in np.unique(level):
        chosen = level == k
        out[chosen] = _bilinear(levels[k], uv[chosen])
    return out


def _bilinear(texels: Array, uv: Array) -> Array:
    height, width = texels.shape[:2]
    x, y = uv[:, 0] * width - 0.5, (1.0 - uv[:, 1]) * height - 0.5
    i, j = np.floor(x).astype(np.int64), np.floor(y).astype(np.int64)
    u, v = (x - i)[:, None].astype(np.float32), (y - j)[:, None].astype(np.float32)
    here, right, above, below = i % width, (i + 1) % width, j % height, (j + 1) % height
    upper = texels[above, here] * (1 - u) + texels[above, right] * u
    lower = texels[below, here] * (1 - u) + texels[below, right] * u
    return upper * (1 - v) + lower * v


@functools.lru_cache(maxsize=32)
def _mip_levels(image: bytes) -> tuple[Array, ...]:
    """The texture in linear colours, halved down to a point; nothing where it cannot be decoded."""
    try:
        from PIL import Image

        decoded = np.asarray(Image.open(io.BytesIO(image)).convert("RGB"))
    except ImportError:
        warnings.warn(
            "Textures are drawn in their mean colour: they need the package 'pillow'. Install it with: "
            + install_command("film", "pillow"),
            UlnaWarning,
            stacklevel=6,
        )
        return ()
    except OSError:
        return ()
    levels = [linear_from_srgb(decoded / 255.0).astype(np.float32)]
    while max(levels[-1].shape[:2]) > 1:
        levels.append(_half_resolution(_half_resolution(levels[-1], 0), 1))
    return tuple(levels)


def _half_resolution(texels: Array, axis: int) -> Array:
    count = texels.shape[axis]
    if count == 1:
        return texels
    even = np.take(texels, range(0, count - 1, 2), axis)
    return (even + np.take(texels, range(1, count, 2), axis)) / 2
