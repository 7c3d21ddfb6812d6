"""Mesh files as surfaces: colours, units, sharp edges, and errors that say how to fix them."""

import os
import struct
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from ulna.errors import InputError, UnknownName
from ulna.geometry import Box, Sphere
from ulna.viewer.mesh.mesh_files import load_mesh
from ulna.viewer.mesh.primitives import tessellate
from ulna.viewer.mesh.surface import DEFAULT_COLOUR, Surface
from ulna.viewer.mesh.vertex_normals import surface_with_normals

pytest.importorskip("trimesh", reason="trimesh, which reads mesh files, is not installed")


def write_stl(path: Path, surface: Surface) -> Path:
    corners = surface.vertices[surface.triangles].astype("<f4")
    rows = b"".join(struct.pack("<12fH", 0, 0, 0, *c.reshape(-1), 0) for c in corners)
    path.write_bytes(b" " * 80 + struct.pack("<I", len(corners)) + rows)
    return path


def test_a_box_from_loose_triangles_keeps_its_edges(tmp_path: Path) -> None:
    (box,) = load_mesh(str(write_stl(tmp_path / "box.stl", tessellate(Box((1, 2, 3))))))
    assert len(box.triangles) == 12
    assert len(box.vertices) == 24  # a corner belongs to three sides
    assert set(map(tuple, np.round(box.normals, 9) + 0.0)) == {
        (1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)
    }  # fmt: skip
    assert box.rgba == DEFAULT_COLOUR


def test_a_ball_from_loose_triangles_becomes_smooth(tmp_path: Path) -> None:
    (ball,) = load_mesh(str(write_stl(tmp_path / "ball.stl", tessellate(Sphere(0.5)))))
    assert len(ball.vertices) == len(ball.triangles) // 2 + 2  # Euler: every position once
    outwards = ball.vertices / np.linalg.norm(ball.vertices, axis=1, keepdims=True)
    assert (np.einsum("ij,ij->i", outwards, ball.normals) > 0.995).all()


def test_triangles_without_area_are_dropped() -> None:
    vertices = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (2, 0, 0)], dtype=float)
    out = surface_with_normals(vertices, np.array([(0, 1, 2), (0, 0, 1), (0, 1, 3)]))
    assert len(out.triangles) == 1


def test_no_triangles_at_all() -> None:
    assert len(surface_with_normals(np.zeros((0, 3)), np.zeros((0, 3), dtype=int)).triangles) == 0


@pytest.mark.parametrize(("bend", "shared"), [(20.0, 4), (60.0, 6)])
def test_the_crease_angle_decides_what_is_shared(bend: float, shared: int) -> None:
    b = np.deg2rad(bend)
    vertices = np.array([(0, 0, 0), (0, 1, 0), (-1, 0, 0), (np.cos(b), 0, np.sin(b))])
    out = surface_with_normals(vertices, np.array([(0, 1, 2), (1, 0, 3)]))
    assert len(out.vertices) == shared


def test_two_colours_of_an_obj_file_are_two_surfaces(tmp_path: Path) -> None:
    (tmp_path / "m.mtl").write_text("newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\n")
    (tmp_path / "m.obj").write_text(
        "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nusemtl red\nf 1 2 3\nusemtl blue\nf 1 2 4\n"
    )
    colours = sorted(s.rgba for s in load_mesh(str(tmp_path / "m.obj")))
    np.testing.assert_allclose(colours, [(0, 0, 1, 1), (1, 0, 0, 1)], atol=0.01)


DAE = """<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="millimeter" meter="0.001"/><up_axis>Y_UP</up_axis></asset>
<library_effects><effect id="e"><profile_COMMON><technique sid="c"><phong>
<diffuse><color>0.2 0.4 0.6 1</color></diffuse></phong></technique></profile_COMMON></effect></library_effects>
<library_materials><material id="m"><instance_effect url="#e"/></material></library_materials>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="9">0 0 0 100 0 0 0 200 0</float_array><technique_common>
<accessor source="#pa" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles material="s" count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><translate>0 0 50</translate>
<instance_geometry url="#g"><bind_material><technique_common><instance_material symbol="s" target="#m"/>
</technique_common></bind_material></instance_geometry></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>
"""


def test_a_collada_file_has_its_unit_applied_and_its_axes_kept(tmp_path: Path) -> None:
    pytest.importorskip("collada")
    (tmp_path / "m.dae").write_text(DAE)
    (surface,) = load_mesh(str(tmp_path / "m.dae"))
    np.testing.assert_allclose(surface.vertices.max(axis=0), (0.1, 0.2, 0.05))
    np.testing.assert_allclose(surface.rgba, (0.2, 0.4, 0.6, 1.0), atol=0.005)


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="nothing.stl"):
        load_mesh(str(tmp_path / "nothing.stl"))


@pytest.mark.parametrize("name", ["broken.stl", "broken.dae", "broken.obj", "broken.glb", "broken.xyzzy"])
def test_a_broken_file_is_named(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_bytes(b"this is no mesh")
    with pytest.raises(InputError, match=name):
        load_mesh(str(tmp_path / name))


def test_a_file_that_changed_is_read_again(tmp_path: Path) -> None:
    path = write_stl(tmp_path / "a.stl", tessellate(Box((1, 1, 1))))
    first = load_mesh(str(path))
    assert load_mesh(str(path)) is first
    write_stl(path, tessellate(Sphere(1.0)))
    os.utime(path, ns=(1, 1))
    assert len(load_mesh(str(path))[0].triangles) > 12


def textured(folder, colour: tuple[int, int, int]) -> str:
    """A square of two triangles with a picture on it, one half of it white."""
    Image = pytest.importorskip("PIL.Image")
    image = Image.new("RGB", (8, 8), (255, 255, 255))
    image.paste(colour, (0, 0, 4, 8))
    image.save(folder / "picture.png")
    (folder / "square.mtl").write_text("newmtl m\nKd 1 1 1\nmap_Kd picture.png\n")
    (folder / "square.obj").write_text(
        "mtllib square.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
        "usemtl m\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\n"
    )
    return str(folder / "square.obj")


def test_a_texture_stays_on_its_surface(tmp_path) -> None:
    pytest.importorskip("trimesh")
    (surface,) = load_mesh(textured(tmp_path, (255, 0, 0)))
    assert surface.texture is not None
    assert surface.texture.image.startswith(b"\x89PNG")
    np.testing.assert_allclose(surface.texture.uv, surface.vertices[:, :2], atol=1e-6)
    assert surface.rgba[0] > surface.rgba[1] > 0.3  # its mean colour
    assert surface.coloured((0, 0, 1)).texture is None


def test_a_mesh_is_kept_by_the_content_of_all_its_files(tmp_path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("trimesh")
    from ulna.viewer.mesh import mesh_files as meshes

    monkeypatch.setenv("ULNA_CACHE", str(tmp_path / "cache"))
    first = load_mesh(textured(tmp_path, (255, 0, 0)))[0]
    meshes._load_cached.cache_clear()
    monkeypatch.setattr(meshes, "_read_surfaces", lambda path: pytest.fail("read anew"))
    kept = load_mesh(str(tmp_path / "square.obj"))[0]
    np.testing.assert_array_equal(kept.vertices, first.vertices)
    np.testing.assert_array_equal(kept.triangles, first.triangles)
    assert kept.rgba == first.rgba
    assert kept.texture is not None and first.texture is not None
    assert kept.texture.image == first.texture.image
    meshes._load_cached.cache_clear()
    monkeypatch.undo()
    monkeypatch.setenv("ULNA_CACHE", str(tmp_path / "cache"))
    changed = load_mesh(textured(tmp_path, (0, 0, 255)))[0]  # the picture, not the mesh file
    assert changed.rgba != first.rgba


def painted(folder: Path, colours: np.ndarray, alpha: int = 255) -> str:
    """A strip of triangles in a PLY file, each face with its colour."""
    count = len(colours)
    head = ["ply", "format ascii 1.0", f"element vertex {count + 2}"]
    head += [f"property float {axis}" for axis in "xyz"]
    head += [f"element face {count}", "property list uchar int vertex_indices"]
    head += [f"property uchar {name}" for name in ("red", "green", "blue", "alpha")] + ["end_header"]
    vertices = [f"{k} {k % 2} 0" for k in range(count + 2)]
    faces = [f"3 {k} {k + 1} {k + 2} {r} {g} {b} {alpha}" for k, (r, g, b) in enumerate(colours)]
    (folder / "painted.ply").write_text("\n".join(head + vertices + faces) + "\n")
    return str(folder / "painted.ply")


def test_each_of_few_colours_of_faces_is_a_surface(tmp_path: Path) -> None:
    colours = np.array([(10 * k, 255 - 10 * k, 51) for k in range(24)])
    surfaces = load_mesh(painted(tmp_path, np.concatenate([colours, colours[:1]])), detail="full")
    found = {tuple(np.round(np.multiply(s.rgba, 255)).astype(int)): len(s.triangles) for s in surfaces}
    assert found == {(*rgb, 255): 1 + (k == 0) for k, rgb in enumerate(colours.tolist())}


def test_many_colours_of_faces_become_their_mean(tmp_path: Path) -> None:
    colours = np.array([(10 * k, 250 - 10 * k, 51) for k in range(25)])
    (surface,) = load_mesh(painted(tmp_path, colours), detail="full")
    assert len(surface.triangles) == 25
    np.testing.assert_allclose(surface.rgba, (120 / 255, 130 / 255, 0.2, 1.0), atol=1e-6)


def test_colours_of_faces_may_be_translucent(tmp_path: Path) -> None:
    (surface,) = load_mesh(painted(tmp_path, np.array([(255, 0, 0)] * 2), alpha=51), detail="full")
    np.testing.assert_allclose(surface.rgba, (1, 0, 0, 0.2), atol=1e-6)


@pytest.mark.parametrize(
    ("material", "expected"),
    [
        ({"baseColorFactor": [0.2, 0.4, 0.6, 0.8]}, (0.2, 0.4, 0.6, 0.8)),
        ({"baseColorFactor": [51, 102, 153, 204]}, (0.2, 0.4, 0.6, 0.8)),
        ({"baseColorFactor": np.array([0, 0, 1, 255], np.uint8)}, (0, 0, 1 / 255, 1)),
        (
            {"baseColorFactor": [0.2, 0.4, 0.6, 0.01]},
            (0.2, 0.4, 0.6, 1.0),
        ),  # nothing is meant to be invisible
        ({"baseColorFactor": [0.2, 0.4, 0.6, 0.03]}, (0.2, 0.4, 0.6, 0.03)),
        ({"diffuse": [255, 0, 51, 255]}, (1.0, 0.0, 0.2, 1.0)),
        ({"baseColorFactor": None, "diffuse": None}, DEFAULT_COLOUR),
        ({}, DEFAULT_COLOUR),
    ],
)
def test_the_colour_of_a_material(material: dict, expected: tuple[float, ...]) -> None:
    from ulna.viewer.mesh.mesh_files import _material_colour

    np.testing.assert_allclose(_material_colour(SimpleNamespace(**material)), expected, atol=1e-6)


def test_large_textures_are_made_smaller_and_broken_ones_left_out() -> None:
    Image = pytest.importorskip("PIL.Image")
    import io

    import trimesh

    from ulna.viewer.mesh.mesh_files import _material_colour, _texture_of

    def mesh(image: object, uv: object = None) -> trimesh.Trimesh:
        out = trimesh.creation.box()
        uv = np.tile([0.25, 0.75, 9.0], (len(out.vertices), 1)) if uv is None else uv
        out.visual = SimpleNamespace(uv=uv, material=SimpleNamespace(image=image))
        return out

    def size(picture: tuple[np.ndarray, bytes] | None) -> tuple[int, int]:
        assert picture is not None
        return Image.open(io.BytesIO(picture[1])).size

    uv, _ = picture = _texture_of(mesh(Image.new("L", (4096, 1)))) or (None, b"")
    np.testing.assert_array_equal(uv, [(0.25, 0.75)] * 8)
    assert size(picture) == (2048, 1)  # type: ignore[arg-type]
    assert size(_texture_of(mesh(Image.new("L", (1000, 4000))))) == (512, 2048)
    assert size(_texture_of(mesh(Image.new("L", (2048, 30))))) == (2048, 30)
    assert _texture_of(mesh(object())) is None
    assert _texture_of(mesh(None)) is None
    assert _texture_of(mesh(Image.new("L", (2, 2)), np.zeros((3, 2)))) is None
    assert _texture_of(mesh(Image.new("L", (2, 2)), np.full((8, 2), np.nan))) is None
    assert _material_colour(SimpleNamespace(image=object())) == DEFAULT_COLOUR
    grey = SimpleNamespace(baseColorTexture=Image.new("RGBA", (2, 2), (51, 102, 153, 204)))
    np.testing.assert_allclose(_material_colour(grey), (0.2, 0.4, 0.6, 0.8), atol=0.01)


def test_a_mesh_without_triangles_is_named(tmp_path: Path) -> None:
    (tmp_path / "flat.obj").write_text("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n")
    with pytest.raises(InputError, match=r"flat\.obj' holds no triangles"):
        load_mesh(str(tmp_path / "flat.obj"))


def test_only_seen_and_full_are_details(tmp_path: Path) -> None:
    path = str(write_stl(tmp_path / "a.stl", tessellate(Sphere(1.0))))
    full, seen = load_mesh(path, detail="full")[0], load_mesh(path)[0]
    assert len(seen.triangles) <= len(full.triangles)
    mirrored = load_mesh(path, (-1.0, 2.0, 1.0), detail="full")[0]
    np.testing.assert_allclose(np.abs(mirrored.vertices).max(axis=0), (1, 2, 1), rtol=1e-3)
    with pytest.raises(UnknownName, match="detail of a mesh"):
        load_mesh(path, detail="all")  # type: ignore[arg-type]
