"""A picture of a scene without a browser or a graphics card: triangles, light and shadow on the processor."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ulna.checks.values import count
from ulna.errors import InputError
from ulna.typing import Array
from ulna.viewer.graph.camera import Camera, camera_for
from ulna.viewer.graph.scene_graph import SceneGraph
from ulna.viewer.graph.theme import LIGHT, Theme, theme_of
from ulna.viewer.mesh.surface import normalized
from ulna.viewer.output.png import write_png
from ulna.viewer.render import lighting as light
from ulna.viewer.render import textures as texels
from ulna.viewer.render.ground import ground
from ulna.viewer.render.labels import draw_labels
from ulna.viewer.render.projection import Projection
from ulna.viewer.render.world_triangles import Triangles, world_triangles
from ulna.viewer.render.zbuffer import clip_near, rasterise

__all__ = ["render", "write_png"]

_SHADED_AT_ONCE = 400_000  # samples, for memory
_NEAR_PLANE = 0.02
_MAX_SAMPLES = 2**28  # samples
_SAME_SHADING_COSINE = 0.95  # cosine between triangles of one surface that a pixel shades as one


def check_size(width: int, height: int, samples: int) -> None:
    """Check that a picture has pixels and is not too large.

    Args:
        width: Width [pixels].
        height: Height [pixels].
        samples: Samples along each edge of a pixel.

    Raises:
        InputError: It is too large, or a number is out of range.
    """
    pixels = count("width", width, 1, 16384) * count("height", height, 1, 16384)
    if pixels * count("samples", samples, 1, 4) ** 2 > _MAX_SAMPLES:
        raise InputError(
            f"{width} x {height} pixels with {samples} x {samples} samples each need too much memory. "
            "Take a smaller picture, or samples=1."
        )


def render(
    scene: SceneGraph,
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
        camera: The camera; one that shows the whole scene when not given.
        samples: Samples along each edge of a pixel; 2 is smooth, 1 quick.
        theme: "light", "dark", or a `Theme`.
        floor: Height of the floor [m]; below everything when not given.

    Returns:
        The picture, shape (height, width, 3), uint8.
    """
    check_size(width, height, samples)
    colours = theme_of(theme)
    camera = camera or camera_for(scene, width / height)
    floor = scene.floor() if floor is None else floor
    snapshot = scene.snapshot()
    view = Projection(camera, width * samples, height * samples)
    triangles = world_triangles(snapshot, view)
    solid = triangles.rgba[:, 3] >= 0.999
    casting = triangles.corners[triangles.shadow & (triangles.rgba[:, 3] > 0.6)]
    shadows = light.shadow_map(casting, floor, 512 if width <= 320 else 1024 if width <= 1200 else 1536)
    picture = ground(camera, width, height, floor, shadows, casting, colours)
    depth = None
    for chosen in (solid, ~solid):
        depth = _draw_layer(picture, depth, view, triangles, np.flatnonzero(chosen), shadows, samples)
    if (
        triangles.show_occluded.any()
    ):  # drawn again over everything, translucent: no change where they were visible
        faint = replace(triangles, rgba=triangles.rgba * np.array((1.0, 1.0, 1.0, 0.3), np.float32))
        _draw_layer(picture, None, view, faint, np.flatnonzero(triangles.show_occluded), shadows, samples)
    # half a step of noise hides the bands of slow gradients
    noise = np.random.default_rng(0).random((height, width, 1), dtype=np.float32) - 0.5
    image = np.clip(picture * 255 + 0.5 + 0.9 * noise, 0, 255).astype(np.uint8)
    return draw_labels(image, camera, snapshot, colours)


def _draw_layer(
    picture: Array,
    before: Array | None,
    view: Projection,
    triangles: Triangles,
    chosen: Array,
    shadows: light.ShadowMap,
    samples: int,
) -> Array | None:
    """Draw the nearest of the chosen triangles over the picture, where they are before what is there already.

    Returns how near they are, for what is drawn next.
    """
    pieces, owner = clip_near(view.local(triangles.corners[chosen]), _NEAR_PLANE)
    if not len(pieces):
        return before
    screen = view.screen(pieces)
    low, high = _covered(screen, view, samples)
    width, height = (high - low).tolist()
    if width <= 0 or height <= 0:
        return before
    near, which = rasterise(screen - low, 1.0 / pieces[:, :, 2], owner, width, height)
    window = (slice(low[1], high[1]), slice(low[0], high[0]))
    visible = near > 0
    if before is not None:
        visible &= near > 1.002 * before[window]  # where two surfaces coincide, the solid one shows
    # samples by pixel: (pixels, samples^2)
    by_pixel = np.where(visible, chosen[which], -1).reshape(
        height // samples, samples, width // samples, samples
    )
    by_pixel = by_pixel.transpose(0, 2, 1, 3).reshape(-1, samples * samples)
    pixel = np.flatnonzero(np.logical_or.reduce([column >= 0 for column in by_pixel.T]))
    triangle_of = by_pixel[pixel]
    pixel_rows, pixel_columns = np.divmod(pixel, width // samples)
    corner = pixel_columns * samples + low[0], pixel_rows * samples + low[1]
    mixed = _pixel_colours(view, triangles, triangle_of, corner, shadows, samples)
    window_pixels = picture[low[1] // samples : high[1] // samples, low[0] // samples : high[0] // samples]
    window_pixels[pixel_rows, pixel_columns] *= 1 - mixed[:, 3:]
    window_pixels[pixel_rows, pixel_columns] += mixed[:, :3]
    depth = np.zeros((view.height, view.width), dtype=np.float32)
    depth[window] = near
    return depth


def _pixel_colours(
    view: Projection,
    triangles: Triangles,
    triangle_of: Array,
    corner: tuple[Array, Array],
    shadows: light.ShadowMap,
    samples: int,
) -> Array:
    """The mean over the samples of pixels: colour, weighted with the opacity, and the opacity; (pixels, 4).

    `triangle_of` is the triangle of each sample, (pixels, samples^2); `corner` the first column and row of each pixel.
    """
    at, sample, weight = _samples_to_shade(triangle_of, triangles)
    row, column = corner[1][at] + sample // samples, corner[0][at] + sample % samples
    mixed = np.zeros((len(triangle_of), 4), dtype=np.float32)
    for start in range(0, len(at), _SHADED_AT_ONCE):
        part = slice(start, start + _SHADED_AT_ONCE)
        colours = _shaded_colours(
            view, triangles, triangle_of[at[part], sample[part]], column[part], row[part], shadows, samples
        )
        for k in range(4):
            mixed[:, k] += np.bincount(at[part], weight[part] * colours[:, k], len(triangle_of))
    return mixed


def _covered(screen: Array, view: Projection, samples: int) -> tuple[Array, Array]:
    """The corners of the part of the picture, in whole pixels, that holds points (..., 2 or more) on the screen."""
    size = np.array([view.width, view.height])
    least, most = (np.array([f(screen[..., 0]), f(screen[..., 1])]) for f in (np.min, np.max))
    low = np.clip(np.floor(least / samples) * samples, 0, size).astype(int)
    return low, np.clip(np.ceil(most / samples) * samples, 0, size).astype(int)


def _samples_to_shade(triangle_of: Array, triangles: Triangles) -> tuple[Array, Array, Array]:
    """What to shade of pixels whose samples (n, k) show triangles, -1 for none: once for what looks alike in a pixel.

    Returns the row, the sample, and the share of the pixel that it stands for.
    """
    count, many = triangle_of.shape
    first = np.tile(np.arange(many, dtype=np.int8), (count, 1))
    plain = np.logical_and.reduce([triangle_of[:, k] == triangle_of[:, 0] for k in range(many)])
    first[plain] = 0
    mixed_rows = np.flatnonzero(~plain)
    if len(mixed_rows):
        used, index = np.unique(triangle_of[mixed_rows], return_inverse=True)
        corners = triangles.corners[used].astype(np.float32)
        facing = normalized(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])).astype(
            np.float32
        )
        piece, index = triangles.surface[used], index.reshape(len(mixed_rows), many)
        leader, there = first[mixed_rows], triangle_of[mixed_rows] >= 0
        for k in range(1, many):
            for j in range(k):
                a, b = index[:, j], index[:, k]
                alike = (piece[a] == piece[b]) & (
                    np.einsum("ij,ij->i", facing[a], facing[b]) > _SAME_SHADING_COSINE
                )
                leader[:, k] = np.where(
                    alike & there[:, j] & there[:, k] & (leader[:, j] == j) & (leader[:, k] == k),
                    j,
                    leader[:, k],
                )
        first[mixed_rows] = leader
    share = np.zeros((count, many), dtype=np.float32)
    rows = np.arange(count)
    for k in range(many):
        share[rows, first[:, k]] += (triangle_of[:, k] >= 0) / np.float32(many)
    at, sample = np.nonzero(share)
    return at, sample, share[at, sample]


def _shaded_colours(
    view: Projection,
    triangles: Triangles,
    triangle_of: Array,
    column: Array,
    row: Array,
    shadows: light.ShadowMap,
    samples: int,
) -> Array:
    """What is seen at samples: displayed colour, weighted with the opacity, and the opacity; (n, 4)."""
    ray = view.rays(column, row)
    eye = view.eye.astype(np.float32)
    corner = triangles.corners[triangle_of].astype(np.float32)
    edge_1, edge_2 = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    # Moeller and Trumbore, "Fast, minimum storage ray/triangle intersection", 1997, section 2
    across = np.cross(ray, edge_2)
    volume = np.einsum("ij,ij->i", edge_1, across)
    inverse = 1.0 / np.where(np.abs(volume) > 1e-15, volume, np.float32(1e-15))
    from_corner = eye - corner[:, 0]
    u = np.clip(np.einsum("ij,ij->i", from_corner, across) * inverse, 0, 1)[:, None]
    v = np.clip(np.einsum("ij,ij->i", ray, np.cross(from_corner, edge_1)) * inverse, 0, 1)[:, None]
    point = corner[:, 0] + u * edge_1 + v * edge_2
    normal = _interpolated_normals(triangles, triangle_of, u, v)
    towards_eye = normalized(eye - point)
    face = np.cross(edge_1, edge_2)
    # an open surface seen from behind is lit as from its front
    away = np.einsum("ij,ij->i", face, towards_eye) < 0
    normal = np.where(away[:, None], -normal, normal).astype(np.float32)
    albedo = triangles.rgba[triangle_of][:, :3]
    if triangles.textures:
        pixel_area = samples**2 * np.linalg.norm(eye - point, axis=1) ** 2 / view.focus**2
        slant = np.abs(np.einsum("ij,ij->i", face, towards_eye))
        _texture(albedo, triangles, triangle_of, u, v, pixel_area / np.maximum(slant, 1e-12))
    lit = shadows.light_fraction(point.astype(np.float32), normal)
    shaded = light.tone_mapped(light.shade(albedo, normal, towards_eye.astype(np.float32), lit))
    opacity = triangles.rgba[triangle_of][:, 3:]
    return np.concatenate([shaded * opacity, opacity], axis=1)


def _interpolated_normals(triangles: Triangles, triangle_of: Array, u: Array, v: Array) -> Array:
    """The unit normals (n, 3) at barycentric coordinates u and v, (n, 1) each."""
    at_corners = triangles.normals[triangle_of]
    from_1 = u * (at_corners[:, 1] - at_corners[:, 0])
    return normalized(at_corners[:, 0] + from_1 + v * (at_corners[:, 2] - at_corners[:, 0]))


def _texture(
    albedo: Array, triangles: Triangles, triangle_of: Array, u: Array, v: Array, footprint: Array
) -> None:
    """Writes the colours of textures at barycentric coordinates u and v into `albedo` (n, 3).

    `footprint` is the part of its triangle that a pixel covers, times twice the triangle's area.
    """
    textures = triangles.texture[triangle_of]
    for number in np.unique(textures[textures >= 0]):
        on = np.flatnonzero(textures == number)
        uv = triangles.uv[triangle_of[on]]
        uv_edge_1, uv_edge_2 = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
        # a pixel's share of the texture: that of the triangle in it, times that of the pixel in the triangle
        texture = np.abs(uv_edge_1[:, 0] * uv_edge_2[:, 1] - uv_edge_1[:, 1] * uv_edge_2[:, 0])
        colours = texels.sample_texture(
            triangles.textures[number].image,
            uv[:, 0] + u[on] * uv_edge_1 + v[on] * uv_edge_2,
            texture * footprint[on],
        )
        if colours is not None:
            albedo[on] = np.float32(0.8) * colours
