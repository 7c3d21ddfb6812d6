"""The background and the floor of a picture: cached for each camera; shadows are drawn for each picture."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np

from ulna.typing import Array, Floats
from ulna.viewer.graph.camera import Camera
from ulna.viewer.graph.theme import Theme
from ulna.viewer.render import lighting as light
from ulna.viewer.render.projection import Projection
from ulna.viewer.render.zbuffer import rasterise

_SHADOW_COLOUR = np.array(
    [0.20, 0.195, 0.185], dtype=np.float32
)  # how much a full shadow takes from red, green, blue
_OCCLUSION_PIXELS = 192  # of the picture of the scene from above, along each side
_OCCLUSION_RADIUS = 0.25  # m around things that their nearness darkens


@dataclass(frozen=True, eq=False)
class _GroundImage:
    """A floor that nothing stands on.

    Args:
        picture: What is seen, shape (height, width, 3).
        pixels: Those that show the floor, as indices of the flattened picture, shape (n,).
        points: What they show of it, x and y in the world [m], shape (n, 2).
        fade: How much of a shadow is seen there, from 0 to 1, shape (n,).
    """

    picture: Array
    pixels: Array
    points: Array
    fade: Array


def ground(
    camera: Camera,
    width: int,
    height: int,
    floor: float,
    shadows: light.ShadowMap,
    casting: Floats,
    theme: Theme,
) -> Array:
    """The background and the floor with its grid and shadows, one sample a pixel.

    Args:
        camera: The camera.
        width: Width [pixels].
        height: Height [pixels].
        floor: Height of the floor [m].
        shadows: Shadows of the key light.
        casting: Triangles that darken the floor, (m, 3, 3) [m].
        theme: Colours and intensities.

    Returns:
        Linear colours, (height, width, 3) float32.
    """
    bare = _ground_image(camera, width, height, float(floor), theme)
    picture = bare.picture.copy()
    if not len(casting):
        return picture
    # only where something can cast a shadow, or is close above
    above, reached = casting[:, :, 2] - floor, np.ones(len(bare.points), dtype=bool)
    for axis in (0, 1):
        over = casting[:, :, axis]
        thrown = over - above * (light.KEY_DIRECTION[axis] / light.KEY_DIRECTION[2])
        reached &= bare.points[:, axis] > min(over.min(), thrown.min()) - _OCCLUSION_RADIUS
        reached &= bare.points[:, axis] < max(over.max(), thrown.max()) + _OCCLUSION_RADIUS
    shadowed = np.flatnonzero(reached)
    point = bare.points[shadowed]
    level = np.full((len(point), 1), floor, dtype=np.float32)
    dark = np.clip(shadows.floor_shadow(np.concatenate([point, level], axis=1)), 0, 1)[:, None]
    near = _ambient_occlusion(casting, floor, point)[:, None]
    darkness = (1 - (1 - dark * _SHADOW_COLOUR) * (1 - np.float32(0.30) * near)) * bare.fade[shadowed, None]
    flat = picture.reshape(-1, 3)
    flat[bare.pixels[shadowed]] *= 1 - darkness
    return picture


@functools.lru_cache(maxsize=2)
def _ground_image(camera: Camera, width: int, height: int, floor: float, theme: Theme) -> _GroundImage:
    view = Projection(camera, width, height)
    share = np.clip((np.arange(height) + 0.5) / height / 0.33, 0, 1) ** 0.8
    top, horizon = np.array(theme.top) / 255, np.array(theme.horizon) / 255
    background = (top + (horizon - top) * share[:, None])[:, None, :]
    picture = np.broadcast_to(background, (height, width, 3)).astype(np.float32)
    pixels, points, fade = [np.zeros(0, np.int64)], [np.zeros((0, 2), np.float32)], [np.zeros(0, np.float32)]
    step = max(500_000 // width, 1)
    for first in range(0, height if view.eye[2] > floor + 1e-6 else 0, step):
        last = min(first + step, height)
        row, column = (a.reshape(-1) for a in np.mgrid[first:last, 0:width])
        ray = view.rays(column, row)
        down = ray[:, 2] < -1e-4
        distance = (floor - view.eye[2]) / ray[down, 2]
        point = view.eye + distance[:, None] * ray[down]
        away = np.linalg.norm(point[:, :2] - view.eye[:2], axis=1)
        solid = np.exp(-((away / 7.0) ** 1.6))[:, None]
        colour = np.broadcast_to(np.array(theme.floor) / 255, (len(point), 3)).astype(np.float32)
        foot = distance / view.focus
        slant = foot * np.linalg.norm(ray[down], axis=1) / np.maximum(-ray[down, 2], 1e-3)
        for period, wide, tint, strength in ((0.1, 0.7, theme.cell, 0.22), (1.0, 1.1, theme.section, 0.6)):
            line = _grid_coverage(point[:, :2], ray[down], foot, slant, period, wide) * strength
            colour = colour + line[:, None] * (np.array(tint) / 255 - colour)
        picture[row[down], column[down]] = colour * solid + picture[row[down], column[down]] * (1 - solid)
        pixels.append(row[down] * width + column[down])
        points.append(point[:, :2].astype(np.float32))
        fade.append(np.exp(-((away / 14.0) ** 2)).astype(np.float32))
    return _GroundImage(picture, np.concatenate(pixels), np.concatenate(points), np.concatenate(fade))


def _grid_coverage(
    point: Array, ray: Array, foot: Array, slant: Array, period: float, pixels: float
) -> Array:
    """How much of each pixel the lines of a grid cover, from 0 to 1."""
    flat = ray[:, :2] / np.maximum(np.linalg.norm(ray[:, :2], axis=1, keepdims=True), 1e-9)
    cover = np.zeros(len(point))
    for axis in (0, 1):
        along, across = np.abs(flat[:, axis]), np.abs(flat[:, 1 - axis])
        grain = np.hypot(along * slant, across * foot)  # a pixel's extent on the floor in this direction [m]
        offset = np.abs(point[:, axis] / period - np.round(point[:, axis] / period)) * period / grain
        crowded = np.clip(1.0 - 3.0 * grain / period, 0, 1)  # lines closer than a few pixels would flicker
        cover = np.maximum(cover, np.clip(0.5 + pixels / 2 - offset, 0, min(pixels, 1.0)) * crowded)
    return cover


def _ambient_occlusion(casting: Floats, floor: float, points: Array) -> Array:
    """How much of the sky is hidden at points (n, 2) of the floor by things close above, from 0 to 1."""
    low, high = (np.array([f(casting[:, :, 0]), f(casting[:, :, 1])]) for f in (np.min, np.max))
    centre, half = (low + high) / 2, float((high - low).max()) / 2 + _OCCLUSION_RADIUS
    scale = _OCCLUSION_PIXELS / (2 * half)
    top = float(casting[:, :, 2].max())
    screen = (casting[:, :, :2] - centre + half) * scale
    owner, size = np.zeros(len(casting), np.int64), _OCCLUSION_PIXELS
    nearness, _ = rasterise(screen, top - casting[:, :, 2] + 1.0, owner, size, size)
    height = np.where(nearness > 0, top + 1.0 - nearness - floor, np.inf)
    hidden = light.gaussian((1.0 / (1.0 + (height / 0.08) ** 2)).astype(np.float32), max(0.035 * scale, 1.0))
    x, y = ((points[:, k] - centre[k] + half) * scale - 0.5 for k in (0, 1))
    return light.bilinear(hidden, x, y)
