"""Fewer triangles: never farther from the surface than the given bound, colours closed against each other, kept by content."""

import os
from pathlib import Path

import numpy as np
import pytest

import ulna
from ulna.errors import UnknownName
from ulna.geometry import Capsule, Cylinder, Mesh
from ulna.viewer.mesh import decimation as decimate
from ulna.viewer.mesh import mesh_cache as mesh_store
from ulna.viewer.mesh import mesh_files as meshes
from ulna.viewer.mesh.decimation import decimated, distances
from ulna.viewer.mesh.mesh_files import Detail, load_mesh
from ulna.viewer.mesh.primitives import tessellate, tube
from ulna.viewer.mesh.surface import Surface
from ulna.viewer.mesh.vertex_normals import merged_vertices, surface_with_normals

pytest.importorskip(
    "fast_simplification", reason="fast-simplification, which collapses edges, is not installed"
)
RNG = np.random.default_rng(11)


def spread(vertices: np.ndarray, triangles: np.ndarray, count: int) -> np.ndarray:
    """Points evenly spread over a surface."""
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    which = RNG.choice(len(triangles), count, p=area / area.sum())
    u, v = RNG.random((2, count))
    u, v = np.where(u + v > 1, 1 - u, u), np.where(u + v > 1, 1 - v, v)
    return a[which] + u[:, None] * (b - a)[which] + v[:, None] * (c - a)[which]


def apart(points: np.ndarray, vertices: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Distances of points from a surface, by trying every triangle."""
    who, which = np.meshgrid(np.arange(len(points)), np.arange(len(triangles)), indexing="ij")
    each = decimate._point_triangle(points[who.reshape(-1)], vertices[triangles[which.reshape(-1)]])
    return each.reshape(who.shape).min(axis=1)


def knot() -> tuple[np.ndarray, np.ndarray]:
    """A closed tube along a trefoil, finely divided."""
    t = np.linspace(0, 2 * np.pi, 241)
    way = 0.1 * np.stack([np.sin(t) + 2 * np.sin(2 * t), np.cos(t) - 2 * np.cos(2 * t), -np.sin(3 * t)], 1)
    surface = tube(way, 0.03, (1, 1, 1, 1), 24)
    place, index = merged_vertices(surface.vertices)
    return place, index[surface.triangles]


def closed(triangles: np.ndarray) -> bool:
    """Whether every edge has a triangle on either side."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    forth, back = {tuple(e) for e in edges.tolist()}, {tuple(e[::-1]) for e in edges.tolist()}
    return forth == back


@pytest.mark.parametrize(("bound", "share"), [(1e-4, 0.95), (5e-4, 0.6), (3e-3, 0.2)])
def test_no_point_of_either_surface_is_farther_from_the_other_than_the_bound(
    bound: float, share: float
) -> None:
    vertices, triangles = knot()
    points, faces = decimated(vertices, triangles, bound)
    assert len(faces) < share * len(triangles)
    assert apart(vertices[::40], points, faces).max() <= bound
    assert apart(spread(vertices, triangles, 120), points, faces).max() <= 1.05 * bound
    assert apart(spread(points, faces, 120), vertices, triangles).max() <= 1.5 * bound


def test_a_surface_without_a_hole_gets_none() -> None:
    place, index = merged_vertices(tessellate(Capsule(0.1, 0.4)).vertices)
    triangles = index[tessellate(Capsule(0.1, 0.4)).triangles]
    triangles = triangles[(np.diff(np.sort(triangles, axis=1), axis=1) > 0).all(axis=1)]
    assert closed(triangles)
    points, faces = decimated(place, triangles, 1e-3)
    assert len(faces) < len(triangles)
    assert closed(merged_vertices(points)[1][faces])


def test_where_two_colours_meet_nothing_moves() -> None:
    vertices, triangles = knot()
    above = vertices[triangles].mean(axis=1)[:, 2] > 0.0
    for side in (above, ~above):
        before, after = triangles[side], decimated(vertices, triangles[side], 2e-3)
        assert len(after[1]) < 0.8 * len(before)
        assert rim(*after) == rim(vertices, before)


def rim(vertices: np.ndarray, triangles: np.ndarray) -> set[tuple[float, ...]]:
    """Places of the ends of edges that have one triangle only."""
    place, index = merged_vertices(vertices)
    corners = index[triangles]
    edges = np.sort(np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]]), axis=1)
    ends, count = np.unique(edges, axis=0, return_counts=True)
    return {tuple(np.round(place[k], 6) + 0.0) for k in np.unique(ends[count == 1])}


def test_distances_found_by_walking_are_those_found_by_trying() -> None:
    vertices, triangles = knot()
    points = spread(vertices, triangles, 80) + RNG.normal(0, 2e-3, (80, 3))
    near = np.array([np.linalg.norm(vertices - p, axis=1).argmin() for p in points])
    np.testing.assert_allclose(
        distances(points, vertices, triangles, near), apart(points, vertices, triangles)
    )


def test_small_surfaces_and_a_bound_of_nothing_leave_all_as_it_is() -> None:
    vertices, triangles = knot()
    assert decimated(vertices, triangles[:100], 1.0)[1] is not None
    np.testing.assert_array_equal(decimated(vertices, triangles[:100], 1.0)[1], triangles[:100])
    assert len(surface_with_normals(vertices, triangles).triangles) == len(triangles)


def test_without_the_package_all_is_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(decimate, "can_decimate", lambda: False)
    vertices, triangles = knot()
    assert decimated(vertices, triangles, 1e-3)[1] is triangles


def write_obj(path: Path, surface: Surface) -> str:
    """A file of triangles."""
    lines = [f"v {x:.9f} {y:.9f} {z:.9f}" for x, y, z in surface.vertices]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in surface.triangles]
    path.write_text("\n".join(lines))
    return str(path)


@pytest.fixture
def knot_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    pytest.importorskip("trimesh")
    monkeypatch.setenv("ULNA_CACHE", str(tmp_path / "cache"))
    return write_obj(tmp_path / "knot.obj", surface_with_normals(*knot()))


def test_detail_is_what_is_asked_for(knot_file: str) -> None:
    whole, seen = (sum(len(s.triangles) for s in load_mesh(knot_file, detail=d)) for d in ("full", "seen"))
    assert whole == len(knot()[1])
    assert seen < 0.7 * whole
    with pytest.raises(UnknownName, match="full"):
        load_mesh(knot_file, detail="ful")  # type: ignore[arg-type]
    viewer = ulna.Viewer(page=False)
    levels: tuple[tuple[Detail, int], ...] = (("full", whole), ("seen", seen))
    for detail, count in levels:
        for thing in (knot_file, Mesh(knot_file)):
            handle = viewer.add(thing, detail=detail)
            assert sum(len(s.triangles) for s in viewer.scene.node(handle.name).surfaces) == count


def test_a_mesh_shown_large_keeps_more_of_its_triangles(knot_file: str) -> None:
    small, usual, large = (
        sum(len(s.triangles) for s in load_mesh(knot_file, (f, f, f))) for f in (0.1, 1.0, 10.0)
    )
    assert small < usual < large
    bounds = [mesh_store.cache_key(knot_file, meshes.MAX_DEVIATION / f) for f in (0.1, 1.0, 10.0)]
    assert len(set(bounds)) == 3


def test_each_bound_is_kept_by_itself_and_by_content(knot_file: str, monkeypatch: pytest.MonkeyPatch) -> None:
    counts = [len(load_mesh(knot_file, detail=d)[0].triangles) for d in ("seen", "full")]
    meshes._load_cached.cache_clear()
    monkeypatch.setattr(meshes, "_read_surfaces", lambda *_: pytest.fail("it should be in the store"))
    assert [len(load_mesh(knot_file, detail=d)[0].triangles) for d in ("seen", "full")] == counts
    before = mesh_store.cache_key(knot_file, 1e-3)
    assert before not in (mesh_store.cache_key(knot_file), mesh_store.cache_key(knot_file, 2e-3))
    os.utime(knot_file, (1, 1))
    assert mesh_store.cache_key(knot_file, 1e-3) == before
    write_obj(Path(knot_file), tessellate(Cylinder(0.1, 0.2)))
    assert mesh_store.cache_key(knot_file, 1e-3) != before


def test_what_is_very_large_stays_whole_because_nobody_waits_for_it(monkeypatch: pytest.MonkeyPatch) -> None:
    sheet = np.stack(np.meshgrid(np.arange(20.0), np.arange(20.0), [0.0]), -1).reshape(-1, 3)
    corner = (20 * np.arange(19)[:, None] + np.arange(19)).reshape(-1, 1)
    triangles = np.concatenate([corner + (0, 1, 21), corner + (0, 21, 20)])
    assert len(decimated(sheet, triangles, 1e-3)[1]) < len(triangles)
    monkeypatch.setattr("ulna.viewer.mesh.decimation._MAX_TRIANGLES", len(triangles) - 1)
    assert decimated(sheet, triangles, 1e-3)[1] is triangles
