"""A heavy surface in few triangles: near the surface, both sides of sheets apart, and only in pages of ours."""

import json

import numpy as np

from ulna.viewer.mesh.gltf import glb
from ulna.viewer.mesh.surface import Surface
from ulna.viewer.mesh.vertex_clustering import CLUSTERING_THRESHOLD, clustered


def sheet(size: int, height: float = 0.0, up: float = 1.0) -> Surface:
    x, y = np.meshgrid(np.linspace(-1, 1, size + 1), np.linspace(-1, 1, size + 1))
    vertices = np.stack([x, y, 0.1 * np.sin(3 * x) * np.cos(2 * y) + height], -1).reshape(-1, 3)
    i = (np.arange(size)[:, None] * (size + 1) + np.arange(size)).reshape(-1)
    first, second = np.stack([i, i + 1, i + size + 2], 1), np.stack([i, i + size + 2, i + size + 1], 1)
    return Surface(vertices, np.concatenate([first, second]), np.broadcast_to((0.0, 0.0, up), vertices.shape))


def test_few_triangles_lie_where_all_did() -> None:
    whole = sheet(400)
    few = clustered(whole)
    assert 20_000 < len(few.triangles) < 70_000
    x, y, z = few.vertices.T
    np.testing.assert_allclose(z, 0.1 * np.sin(3 * x) * np.cos(2 * y), atol=3e-4)
    np.testing.assert_allclose(np.ptp(few.vertices, axis=0)[:2], 2.0, atol=0.02)
    a, b, c = (few.vertices[few.triangles[:, k]] for k in range(3))
    assert (np.cross(b - a, c - a)[:, 2] > 0.0).all()


def test_both_sides_of_a_thin_sheet_stay_apart() -> None:
    over, under = sheet(300, 1e-4), sheet(300, -1e-4, up=-1.0)
    count = len(over.vertices)
    few = clustered(
        Surface(
            np.concatenate([over.vertices, under.vertices]),
            np.concatenate([over.triangles, under.triangles[:, ::-1] + count]),
            np.concatenate([over.normals, under.normals]),
        )
    )
    np.testing.assert_allclose(np.abs(few.normals[:, 2]), 1.0)


def test_a_heavy_surface_is_there_twice_in_our_page_alone() -> None:
    def levels(surface: Surface, ours: bool) -> list[str | None]:
        content = glb([surface], ours=ours)
        document = json.loads(content[20 : 20 + int.from_bytes(content[12:16], "little")])
        return [p.get("extras", {}).get("level") for p in document["meshes"][0]["primitives"]]

    heavy, light = sheet(230), sheet(20)
    assert len(heavy.triangles) > CLUSTERING_THRESHOLD
    assert levels(heavy, True) == ["few", "all"]
    assert levels(heavy, False) == levels(light, True) == [None]
