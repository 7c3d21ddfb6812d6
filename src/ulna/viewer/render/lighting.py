"""Lighting of surfaces: three directional lights, a sky, an environment, and shadows of the key light.

Colours are linear here; `display` turns them into what a screen shows. The surface model is the usual one of
real-time graphics: Lambert below a thin GGX coat with Schlick's Fresnel term (Walter et al., "Microfacet
models for refraction", 2007, eq. 33; Schlick, "An inexpensive BRDF model", 1994, eq. 15).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ulna.typing import Array, Floats
from ulna.viewer.mesh.surface import normalized
from ulna.viewer.render.zbuffer import rasterise

KEY_DIRECTION = (1.6, -1.0, 3.2)
"""From the scene towards the key light."""

_LIGHTS = (  # direction towards the light, colour, intensity
    (KEY_DIRECTION, (1.0, 0.957, 0.902), 2.9),
    ((-2.0, 2.4, 1.6), (0.902, 0.941, 1.0), 0.8),
    ((-1.0, -3.0, 1.2), (0.863, 0.910, 1.0), 0.75),
)
_SKY, _GROUND = np.array([0.36, 0.40, 0.44]), np.array([0.130, 0.150, 0.170])
_ROUGHNESS, _REFLECTANCE = 0.5, 0.04
_SELF_SHADOW = 0.55  # a robot half in its own shadow is hard to read; lit from all sides


@dataclass(frozen=True, eq=False)
class ShadowMap:
    """What the key light sees along its parallel rays: how near the nearest surface is, on a square grid.

    Args:
        rotation: Axes of the light as rows: right, up, towards the light; shape (3, 3).
        centre: The middle of the map in the world [m].
        half: Half the width of the map [m].
        nearness: 1 plus the distance [m] towards the light above the plane through the lowest point, 0 for
            nothing.
        base: The height of that plane along the light [m].
        soft: Blurred share of the light that is held back, for the floor, on a coarser grid.
    """

    rotation: Floats
    centre: Floats
    half: float
    nearness: Array
    base: float
    soft: Array

    def to_map(self, points: Array) -> tuple[Array, Array, Array]:
        """Map coordinates in samples (x, y) and nearness of world points (n, 3)."""
        scale, kind = len(self.nearness) / (2 * self.half), points.dtype.type

        def along(axis: Floats) -> Array:  # column by column: matrices this thin are slow to multiply
            a, b, c = (kind(number) for number in axis)
            return a * points[:, 0] + b * points[:, 1] + c * points[:, 2] - kind(self.centre @ axis)

        x, y, z = (along(axis) for axis in self.rotation)
        return (x + self.half) * scale, (self.half - y) * scale, z - self.base + 1.0

    def light_fraction(self, points: Array, normals: Array) -> Array:
        """The share of the key light that reaches points of surfaces.

        Args:
            points: The points, (n, 3) [m].
            normals: Unit normals, (n, 3).

        Returns:
            Shares from 0 to 1, (n,).
        """
        size = len(self.nearness)
        sample = 2 * self.half / size
        facing = np.clip(normals @ self.rotation[2].astype(normals.dtype), 0.0, 1.0)
        # lift the point off its own surface, more where the light grazes it
        lifted = points + normals * (sample * (1.5 + 2.5 * np.sqrt(1 - facing**2)))[:, None]
        x, y, near = self.to_map(lifted)
        light = np.zeros(len(points), dtype=np.float32)
        flat = self.nearness.reshape(-1)
        for dx, dy in _SHADOW_OFFSETS:
            i = np.clip((x + dx).astype(np.int64), 0, size - 1)
            j = np.clip((y + dy).astype(np.int64), 0, size - 1)
            light += flat[j * size + i] <= near + sample
        return light / len(_SHADOW_OFFSETS)

    def floor_shadow(self, points: Array) -> Array:
        """The share of the key light that is held back at points (n, 3) of the floor, from 0 to 1."""
        x, y, _ = self.to_map(points)
        finer = len(self.nearness) / len(self.soft)
        return bilinear(self.soft, x / finer - 0.5, y / finer - 0.5)


# sixteen samples spread evenly over a disc of 2.6 samples, by the golden angle
_SHADOW_OFFSETS = [
    (2.6 * np.sqrt((k + 0.5) / 16) * np.cos(2.39996 * k), 2.6 * np.sqrt((k + 0.5) / 16) * np.sin(2.39996 * k))
    for k in range(16)
]


def shadow_map(corners: Floats, floor: float, size: int = 1536, blur: float = 0.007) -> ShadowMap:
    """The shadow map of triangles.

    Args:
        corners: Corners in the world [m], shape (m, 3, 3).
        floor: Height of the floor [m].
        size: Samples along an edge of the map.
        blur: Softness of the edge of the shadow on the floor [m].

    Returns:
        The map.
    """
    towards = np.asarray(KEY_DIRECTION) / np.linalg.norm(KEY_DIRECTION)
    right = np.cross((0.0, 1.0, 0.0), towards)
    right /= np.linalg.norm(right)
    rotation = np.stack([right, np.cross(towards, right), towards])
    points = corners.reshape(-1, 3)
    if not len(points):
        nothing = np.zeros((8, 8), dtype=np.float32)
        return ShadowMap(rotation, np.zeros(3), 1.0, nothing, 0.0, nothing)
    # along the light everything falls where its shadow falls, so a map of the things holds their shadows
    x, y, z = (points @ axis for axis in rotation)
    spans = [(float(v.min()), float(v.max())) for v in (x, y, z)]
    middle = np.array([(low + high) / 2 for low, high in spans])
    half = max(high - low for low, high in spans[:2]) / 2 * 1.02 + 3 * blur + 1e-6
    base, scale = spans[2][0] - middle[2], size / (2 * half)
    across, down = (x - middle[0] + half) * scale, (half - y + middle[1]) * scale
    near = (z - middle[2] - base + 1.0).reshape(-1, 3)
    screen = np.stack([across, down], axis=-1).reshape(-1, 3, 2)
    above = (points[:, 2] > floor - 1e-6).reshape(-1, 3).any(axis=1)
    count = int(above.sum())
    nearness, _ = rasterise(screen[above], near[above], np.zeros(count, np.int64), size, size)
    coarse = next(k for k in (4, 2, 1) if k == 1 or blur * scale > 2.0 * k)
    shadowed = (nearness > 0).astype(np.float32).reshape(size // coarse, coarse, size // coarse, coarse)
    soft = gaussian(shadowed.mean(axis=(1, 3)), max(blur * scale / coarse, 1.0))
    return ShadowMap(rotation, middle @ rotation, half, nearness, base, soft)


def shade(albedo: Array, normals: Array, towards_eye: Array, lit: Array) -> Array:
    """The linear colour that surfaces send to the eye.

    Args:
        albedo: Linear colour of each point, shape (n, 3).
        normals: Unit normals, turned to the eye, shape (n, 3).
        towards_eye: Unit vectors to the eye, shape (n, 3).
        lit: The share of the key light that reaches each point, shape (n,).

    Returns:
        Linear colours, (n, 3).
    """
    facing = np.clip(_dot(normals, towards_eye), 1e-3, 1.0)
    up = 0.5 + 0.5 * normals[:, 2:3]
    colour = albedo * (_GROUND + (_SKY - _GROUND) * up).astype(np.float32)
    for number, (direction, tint, strength) in enumerate(_LIGHTS):
        towards = (np.asarray(direction) / np.linalg.norm(direction)).astype(np.float32)
        falling = np.clip(normals @ towards, 0.0, 1.0)
        power = falling * np.float32(strength / np.pi)
        if number == 0:
            power = power * (1.0 - _SELF_SHADOW * (1.0 - lit))
        middle = normalized(towards_eye + towards)
        glint = _ggx(np.clip(_dot(normals, middle), 0, 1), facing, falling, np.clip(middle @ towards, 0, 1))
        colour += (albedo + (np.pi * glint)[:, None]) * (power[:, None] * np.asarray(tint, dtype=np.float32))
    return colour + _environment_reflection(normals, towards_eye, facing)


def tone_mapped(linear: Array) -> Array:
    """Linear colours as a screen shows them, from 0 to 1: a film-like curve, then the sRGB transfer function.

    The curve is Narkowicz's fit ("ACES filmic tone mapping curve", 2016).
    """
    x = np.maximum(linear, 0.0) * 1.07
    film = np.clip(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0)
    return srgb_from_linear(film)


def srgb_from_linear(linear: Array) -> Array:
    """The sRGB transfer function (IEC 61966-2-1)."""
    return np.where(
        linear <= 0.0031308, 12.92 * linear, 1.055 * np.power(np.maximum(linear, 1e-8), 1 / 2.4) - 0.055
    )


def gaussian(image: Array, sigma: float) -> Array:
    """An image blurred by a Gaussian; beyond the edge it is 0.

    Args:
        image: The image, (h, w).
        sigma: Standard deviation [samples].

    Returns:
        The blurred image, (h, w).
    """
    reach = max(int(np.ceil(2.6 * sigma)), 1)
    weights = np.exp(-0.5 * (np.arange(-reach, reach + 1) / sigma) ** 2)
    weights = (weights / weights.sum()).astype(np.float32)
    out = image
    for axis in (0, 1):
        padding = [(reach, reach) if a == axis else (0, 0) for a in (0, 1)]
        wide = np.pad(out, padding)
        length = image.shape[axis]
        out = np.zeros_like(image)
        for k, weight in enumerate(weights):
            out += weight * (wide[k : k + length] if axis == 0 else wide[:, k : k + length])
    return out


def bilinear(image: Array, x: Array, y: Array) -> Array:
    """An image at fractional samples, 0 beyond its edge.

    Args:
        image: The image, (h, w).
        x: Columns, (n,).
        y: Rows, (n,).

    Returns:
        Values, (n,).
    """
    height, width = image.shape
    inside = (x > 0) & (y > 0) & (x < width - 1) & (y < height - 1)
    out = np.zeros(len(x), dtype=np.float32)
    x, y = x[inside], y[inside]
    i, j = x.astype(np.int64), y.astype(np.int64)
    u, v = (x - i).astype(np.float32), (y - j).astype(np.float32)
    flat, at = image.reshape(-1), j * width + i
    top = flat[at] * (1 - u) + flat[at + 1] * u
    bottom = flat[at + width] * (1 - u) + flat[at + width + 1] * u
    out[inside] = top * (1 - v) + bottom * v
    return out


def _ggx(half: Array, facing: Array, falling: Array, turned: Array) -> Array:
    alpha = _ROUGHNESS**2
    distribution = alpha**2 / (np.pi * (half**2 * (alpha**2 - 1) + 1) ** 2)
    k = alpha / 2
    visible = 0.25 / ((facing * (1 - k) + k) * (falling * (1 - k) + k))
    return distribution * visible * (_REFLECTANCE + (1 - _REFLECTANCE) * (1 - turned) ** 5)


def _environment_reflection(normals: Array, towards_eye: Array, facing: Array) -> Array:
    """The surroundings that the coat reflects: a bright ceiling, two soft boxes, a dark floor."""
    mirrored = 2 * facing[:, None] * normals - towards_eye
    x, y, z = mirrored.T
    radiance = 0.25 + 0.55 * _smoothstep(-0.3, 0.9, z)
    radiance += 1.6 * _smoothstep(0.80, 0.93, 0.55 * x - 0.45 * y + 0.70 * z)
    radiance += 0.9 * _smoothstep(0.78, 0.92, -0.75 * x - 0.40 * y + 0.52 * z)
    fresnel = (
        _REFLECTANCE + (1.0 - _ROUGHNESS - _REFLECTANCE) * (1 - facing) ** 5
    )  # (1 - roughness) bounds the rim of a rough coat
    return (radiance * fresnel)[:, None] * np.array([0.96, 0.98, 1.0], dtype=np.float32)


def _smoothstep(low: float, high: float, x: Array) -> Array:
    t = np.clip((x - low) / (high - low), 0, 1)
    return t * t * (3 - 2 * t)


def _dot(a: Array, b: Array) -> Array:
    return np.einsum("ij,ij->i", a, b)
