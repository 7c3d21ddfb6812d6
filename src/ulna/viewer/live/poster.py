"""The picture that a page shows until its program has started: the robot without its surroundings."""

from __future__ import annotations

import base64
import io
from dataclasses import replace
from typing import Any

import numpy as np

from ulna.typing import Array
from ulna.viewer.graph.camera import Camera
from ulna.viewer.graph.scene_graph import SceneGraph
from ulna.viewer.graph.theme import LIGHT
from ulna.viewer.output.png import encode_png
from ulna.viewer.render.renderer import render

_WIDTH, _HEIGHT = 720, 450
_FALLBACK_SIZE = 320, 200  # pixels where no compact format can be written
_OPAQUE = 3  # of 255: opacity below which nothing is seen


def poster(scene: SceneGraph, camera: Camera, floor: float) -> str:
    """The robot and its shadow on a transparent ground, as a data URL.

    It is a WebP file, or, without the package Pillow, a smaller PNG file.

    Args:
        scene: The robot alone.
        camera: The camera.
        floor: Height of the floor [m].

    Returns:
        The URL.
    """
    try:
        from PIL import Image, features
    except ImportError:
        return _url("png", encode_png(_coarse(_cut_out(scene, camera, floor, *_FALLBACK_SIZE))))
    image: Any = Image.fromarray(_cut_out(scene, camera, floor, _WIDTH, _HEIGHT))
    file = io.BytesIO()
    if not features.check("webp"):
        image.quantize(64).save(file, "PNG", optimize=True)
        return _url("png", file.getvalue())
    image.save(file, "WEBP", quality=62, method=6, alpha_quality=60)
    return _url("webp", file.getvalue())


def _cut_out(scene: SceneGraph, camera: Camera, floor: float, width: int, height: int) -> Array:
    """Colour and opacity (h, w, 4), uint8, from pictures on white and on black ground."""
    on_white, on_black = (
        render(scene, width, height, camera, 2, _plain(ground), floor).astype(float)
        for ground in ((255, 255, 255), (0, 0, 0))
    )
    alpha = 255.0 - (on_white - on_black).mean(axis=2)
    alpha = np.where(alpha < _OPAQUE, 0.0, np.clip(alpha, 0.0, 255.0))
    colour = on_black * 255.0 / np.maximum(alpha, 1.0)[..., None]
    return np.dstack([np.clip(colour, 0, 255), alpha]).astype(np.uint8)


def _plain(rgb: tuple[int, int, int]) -> Any:
    return replace(LIGHT, top=rgb, horizon=rgb, floor=rgb, section=rgb, cell=rgb)


def _coarse(image: Array) -> Array:
    return (image & 0xF0) | (image >> 4)


def _url(kind: str, content: bytes) -> str:
    return f"data:image/{kind};base64,{base64.b64encode(content).decode()}"
