"""A picture of a scene without a browser or a graphics card: triangles, light and shadow in NumPy."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ulna.errors import InputError
from ulna.typing import Array, Floats
from ulna.viewer import light
from ulna.viewer.camera import Camera, frame
from ulna.viewer.node import Snapshot
from ulna.viewer.png import write_png
from ulna.viewer.scene import Scene
from ulna.viewer.surface import paint, unit
from ulna.viewer.theme import LIGHT, Theme, theme_of
from ulna.viewer.words import write_words
from ulna.viewer.zbuffer import clip_near, rasterise

__all__ = ["render", "write_png"]

_NEAR = 0.02
_MOST = 2**28  # samples
_SHADOW = np.array([0.20, 0.195, 0.185])  # how much a full shadow takes from red, green, blue


@dataclass(frozen=True, eq=False)
class _Triangles:
    """Everything of a scene, in the world.

    Args:
        corners: Corners [m], shape (m, 3, 3).
        normals: Normals at the corners, shape (m, 3, 3).
        rgba: Colours, shape (m, 4).
        shadow: Which cast a shadow, shape (m,).
        through: Which show faintly through what hides them, shape (m,).
    """

    corners: Floats
    normals: Floats
    rgba: Floats
    shadow: Array
    through: Array


def render(
    scene: Scene,
    width: int = 1600,
    height: int = 1000,
    camera: Camera | None = None,
    samples: int = 2,
    theme: Theme | str = LIGHT,
    floor: float | None = None,
) -> Array:
    """A picture of the scene.

    Args:
        scene: What to draw.
        width: Width of the picture [pixels].
        height: Height of the picture [pixels].
        camera: From where; one that has everything in view when not given.
        samples: Samples along each edge of a pixel; 2 is smooth, 1 quick.
        theme: "light", "dark", or a `Theme`.
        floor: Height of the floor [m]; below everything when not given.

    Returns:
        The picture, shape (height, width, 3), uint8.
    """
    if not (0 < width <= 16384 and 0 < height <= 16384 and 1 <= samples <= 4):
        raise InputError(
            "A picture is 1 to 16384 pixels wide and high, with 1 to 4 samples; "
            f"got {width} x {height} with {samples}."
        )
    if width * height * samples**2 > _MOST:
        raise InputError(
            f"{width} x {height} pixels with {samples} x {samples} samples each need too much memory. "
            "Take a smaller picture, or samples=1."
        )
    look = theme_of(theme)
    camera = camera or frame(scene, width / height)
    floor = scene.floor() if floor is None else floor
    seen = scene.snapshot()
    triangles = _gather(seen)
    solid = triangles.rgba[:, 3] >= 0.999
    casting = triangles.corners[triangles.shadow & (triangles.rgba[:, 3] > 0.6)]
    shadows = light.shadow_map(casting, floor)
    picture = _ground(camera, width, height, floor, shadows, casting, look)
    view = _View(camera, width * samples, height * samples)
    for chosen in (solid, ~solid):
        picture, view.depth = _layer(picture, view, triangles, np.flatnonzero(chosen), shadows, samples)
    if triangles.through.any():  # once more over everything, faintly: no change where they were in sight
        faint = replace(triangles, rgba=triangles.rgba * (1.0, 1.0, 1.0, 0.3))
        view.depth = None
        picture, _ = _layer(picture, view, faint, np.flatnonzero(triangles.through), shadows, samples)
    # half a step of noise hides the bands of slow gradients
    noise = np.random.default_rng(0).random((height, width, 1), dtype=np.float32) - 0.5
    image = np.clip(picture * 255 + 0.5 + 0.9 * noise, 0, 255).astype(np.uint8)
    return write_words(image, camera, seen, look)


class _View:
    """A camera and the grid of samples it is looked through."""

    def __init__(self, camera: Camera, width: int, height: int) -> None:
        self.width, self.height = width, height
        self.eye, self.axes = np.asarray(camera.position, dtype=float), camera.axes()
        self.focus = height / (2 * np.tan(camera.fov / 2))
        self.depth: Array | None = None

    def local(self, points: Floats) -> Floats:
        """Points in the camera's frame, z the distance along the view."""
        return ((points - self.eye) @ self.axes) * (1.0, 1.0, -1.0)

    def screen(self, local: Floats) -> Floats:
        """Where points in the camera's frame are seen [samples]."""
        x = self.width / 2 + self.focus * local[..., 0] / local[..., 2]
        y = self.height / 2 - self.focus * local[..., 1] / local[..., 2]
        return np.stack([x, y], axis=-1)

    def rays(self, column: Array, row: Array) -> Array:
        """Directions in the world from the eye through the middle of samples, of length 1 along the view."""
        x = (column + 0.5 - self.width / 2) / self.focus
        y = (self.height / 2 - row - 0.5) / self.focus
        return x[:, None] * self.axes[:, 0] + y[:, None] * self.axes[:, 1] - self.axes[:, 2]


def _gather(seen: Snapshot) -> _Triangles:
    corners, normals, rgba = [np.zeros((0, 3, 3))], [np.zeros((0, 3, 3))], [np.zeros((0, 4))]
    shadow, through = [np.zeros(0, bool)], [np.zeros(0, bool)]
    for i in np.flatnonzero(seen.visible):
        node, pose, scale, tint = seen.nodes[i], seen.poses[i], seen.scales[i], seen.tint[i]
        rotation, translation = pose[:3, :3], pose[:3, 3]
        turned = bool(np.prod(scale) < 0)
        for surface in (*node.surfaces, *(node.content.surfaces if node.content else ())):
            count, opacity = len(surface.triangles), surface.rgba[3] * seen.opacity[i]
            if count == 0 or opacity <= 0.002:
                continue
            faces = surface.triangles[:, ::-1] if turned else surface.triangles
            corners.append(((surface.vertices * scale) @ rotation.T + translation)[faces])
            bent = surface.normals if (scale == scale[0]).all() else unit(surface.normals / scale)
            normals.append((bent @ rotation.T)[faces])
            colour = surface.rgba[:3] if tint[0] < 0 else tint
            rgba.append(np.broadcast_to((*colour, opacity), (count, 4)))
            shadow.append(np.full(count, node.shadow))
            through.append(np.full(count, node.through))
    return _Triangles(*(np.concatenate(part) for part in (corners, normals, rgba, shadow, through)))


def _layer(
    picture: Array, view: _View, triangles: _Triangles, chosen: Array, shadows: light.ShadowMap, samples: int
) -> tuple[Array, Array | None]:
    """The picture with the nearest of the chosen triangles drawn over it, and how near these are."""
    pieces, owner = clip_near(view.local(triangles.corners[chosen]), _NEAR)
    if not len(pieces):
        return picture, view.depth
    screen = view.screen(pieces)
    # only the part of the picture that holds something is worked on, in whole pixels
    size = np.array([view.width, view.height])
    low = np.clip(np.floor(screen.min(axis=(0, 1)) / samples) * samples, 0, size).astype(int)
    high = np.clip(np.ceil(screen.max(axis=(0, 1)) / samples) * samples, 0, size).astype(int)
    width, height = (high - low).tolist()
    if width <= 0 or height <= 0:
        return picture, view.depth
    near, which = rasterise(screen - low, 1.0 / pieces[:, :, 2], owner, width, height)
    window = (slice(low[1], high[1]), slice(low[0], high[0]))
    seen = near > 0
    if view.depth is not None:
        seen &= near > 1.002 * view.depth[window]  # where two surfaces coincide, the solid one shows
    row, column = np.nonzero(seen)
    colours = np.zeros((height, width, 4), dtype=np.float32)
    for start in range(0, len(row), 400_000):
        part = slice(start, start + 400_000)
        r, c = row[part], column[part]
        colours[r, c] = _colours(view, triangles, chosen[which[r, c]], c + low[0], r + low[1], shadows)
    mean = colours.reshape(height // samples, samples, width // samples, samples, 4).mean(axis=(1, 3))
    pixels = (slice(low[1] // samples, high[1] // samples), slice(low[0] // samples, high[0] // samples))
    picture[pixels] = picture[pixels] * (1 - mean[:, :, 3:]) + mean[:, :, :3]
    depth = np.zeros((view.height, view.width), dtype=np.float32)
    depth[window] = near
    return picture, depth


def _colours(
    view: _View, triangles: _Triangles, seen: Array, column: Array, row: Array, shadows: light.ShadowMap
) -> Array:
    """What is seen at samples: displayed colour, weighted with the opacity, and the opacity; (n, 4)."""
    ray = view.rays(column, row)
    corner = triangles.corners[seen]
    edge_1, edge_2 = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    # Moeller and Trumbore, "Fast, minimum storage ray/triangle intersection", 1997, section 2
    across = np.cross(ray, edge_2)
    volume = np.einsum("ij,ij->i", edge_1, across)
    inverse = 1.0 / np.where(np.abs(volume) > 1e-15, volume, 1e-15)
    from_corner = view.eye - corner[:, 0]
    u = np.clip(np.einsum("ij,ij->i", from_corner, across) * inverse, 0, 1)
    v = np.clip(np.einsum("ij,ij->i", ray, np.cross(from_corner, edge_1)) * inverse, 0, 1)
    point = corner[:, 0] + u[:, None] * edge_1 + v[:, None] * edge_2
    own = triangles.normals[seen]
    normal = unit(own[:, 0] + u[:, None] * (own[:, 1] - own[:, 0]) + v[:, None] * (own[:, 2] - own[:, 0]))
    towards_eye = unit(view.eye - point)
    face = np.cross(edge_1, edge_2)
    # an open surface seen from behind is lit as from its front
    away = np.einsum("ij,ij->i", face, towards_eye) < 0
    normal = np.where(away[:, None], -normal, normal)
    rgba = triangles.rgba[seen]
    albedo = paint(rgba[:, :3])
    lit = shadows.lit(point, normal)
    seen_as = light.shade(
        albedo.astype(np.float32), normal.astype(np.float32), towards_eye.astype(np.float32), lit
    )
    shaded = light.display(seen_as)
    opacity = rgba[:, 3:]
    return np.concatenate([shaded * opacity, opacity], axis=1)


def _ground(
    camera: Camera,
    width: int,
    height: int,
    floor: float,
    shadows: light.ShadowMap,
    casting: Floats,
    look: Theme,
) -> Array:
    """The background and the floor with its grid and shadows, one sample a pixel; (height, width, 3)."""
    view = _View(camera, width, height)
    share = np.clip((np.arange(height) + 0.5) / height / 0.33, 0, 1) ** 0.8
    top, horizon = np.array(look.top) / 255, np.array(look.horizon) / 255
    background = (top + (horizon - top) * share[:, None])[:, None, :]
    picture = np.broadcast_to(background, (height, width, 3)).astype(np.float32)
    if view.eye[2] <= floor + 1e-6:
        return picture
    shelter = _shelter(casting, floor)
    step = max(500_000 // width, 1)
    for top in range(0, height, step):
        bottom = min(top + step, height)
        row, column = (a.reshape(-1) for a in np.mgrid[top:bottom, 0:width])
        ray = view.rays(column, row)
        down = ray[:, 2] < -1e-4
        distance = (floor - view.eye[2]) / ray[down, 2]
        point = view.eye + distance[:, None] * ray[down]
        away = np.linalg.norm(point[:, :2] - view.eye[:2], axis=1)
        solid = np.exp(-((away / 7.0) ** 1.6))[:, None]
        colour = np.broadcast_to(np.array(look.floor) / 255, (len(point), 3)).astype(np.float32)
        foot = distance / view.focus
        slant = foot * np.linalg.norm(ray[down], axis=1) / np.maximum(-ray[down, 2], 1e-3)
        for period, pixels, tint, strength in ((0.1, 0.7, look.cell, 0.22), (1.0, 1.1, look.section, 0.6)):
            line = _lines(point[:, :2], ray[down], foot, slant, period, pixels) * strength
            colour = colour + line[:, None] * (np.array(tint) / 255 - colour)
        dark = np.clip(shadows.floor_shadow(point), 0, 1)[:, None]
        near = shelter(point)[:, None]
        held = 1 - (1 - dark * _SHADOW) * (1 - 0.30 * near)
        held = held * np.exp(-((away / 14.0) ** 2))[:, None]
        colour = (colour * solid + picture[row[down], column[down]] * (1 - solid)) * (1 - held)
        picture[row[down], column[down]] = colour
    return picture


def _lines(point: Array, ray: Array, foot: Array, slant: Array, period: float, pixels: float) -> Array:
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


def _shelter(casting: Floats, floor: float, size: int = 384):
    """A function of floor points: how much of the sky is hidden there by things close above, from 0 to 1."""
    if not len(casting):
        return lambda point: np.zeros(len(point), dtype=np.float32)
    low, high = casting[:, :, :2].min(axis=(0, 1)), casting[:, :, :2].max(axis=(0, 1))
    centre, half = (low + high) / 2, float((high - low).max()) / 2 + 0.25
    scale = size / (2 * half)
    top = float(casting[:, :, 2].max())
    screen = (casting[:, :, :2] - centre + half) * scale
    nearness, _ = rasterise(
        screen, top - casting[:, :, 2] + 1.0, np.zeros(len(casting), np.int64), size, size
    )
    height = np.where(nearness > 0, top + 1.0 - nearness - floor, np.inf)
    hidden = light.gaussian((1.0 / (1.0 + (height / 0.08) ** 2)).astype(np.float32), max(0.035 * scale, 1.0))

    def shelter(point: Array) -> Array:
        x, y = ((point[:, :2] - centre + half) * scale - 0.5).T
        return light.bilinear(hidden, x, y)

    return shelter
