"""Surfaces as binary glTF: read back by the specification, and by trimesh."""

import io
import json
import struct

import numpy as np
import pytest

from ulna.geometry import Box, Sphere
from ulna.viewer.mesh.gltf import glb
from ulna.viewer.mesh.primitives import tessellate
from ulna.viewer.mesh.surface import Surface

BOX = tessellate(Box((0.1, 0.2, 0.3)), (1.0, 0.0, 0.0, 1.0))
BALL = tessellate(Sphere(0.2), (0.0, 0.0, 1.0, 0.4))


def parts(content: bytes) -> tuple[dict, bytes]:
    magic, version, length = struct.unpack_from("<4sII", content)
    assert (magic, version, length) == (b"glTF", 2, len(content))
    size, kind = struct.unpack_from("<II", content, 12)
    assert (size % 4, kind) == (0, 0x4E4F534A)
    document = json.loads(content[20 : 20 + size])
    return document, content[28 + size :]


def test_numbers_survive() -> None:
    document, data = parts(glb([BOX, BALL]))
    for primitive, surface in zip(document["meshes"][0]["primitives"], (BOX, BALL), strict=True):
        for name, values in (("POSITION", surface.vertices), ("NORMAL", surface.normals)):
            accessor = document["accessors"][primitive["attributes"][name]]
            view = document["bufferViews"][accessor["bufferView"]]
            found = np.frombuffer(data, "<f4", accessor["count"] * 3, view["byteOffset"]).reshape(-1, 3)
            np.testing.assert_allclose(found, values, atol=1e-7 if surface is BOX else 1e-3)
        accessor = document["accessors"][primitive["indices"]]
        view = document["bufferViews"][accessor["bufferView"]]
        assert accessor["componentType"] == 5123  # two bytes do for so few
        found = np.frombuffer(data, "<u2", accessor["count"], view["byteOffset"])
        np.testing.assert_array_equal(found, surface.triangles.reshape(-1))
    assert document["buffers"][0]["byteLength"] == len(data)


def test_normals_that_the_reader_computes_take_no_room() -> None:
    (whole, long), (bare, short) = parts(glb([BOX])), parts(glb([BOX], ours=True))
    assert len(long) - len(short) == BOX.normals.size * 4
    primitive = bare["meshes"][0]["primitives"][0]
    normal = bare["accessors"][primitive["attributes"]["NORMAL"]]
    assert (normal["count"], normal["type"], "bufferView" in normal) == (len(BOX.vertices), "VEC3", False)
    assert len(whole["bufferViews"]) == len(bare["bufferViews"]) + 1


def test_many_vertices_are_counted_in_four_bytes() -> None:
    corners = np.zeros((70_000, 3))
    corners[:, 0] = np.arange(len(corners))
    many = Surface(corners, np.array([(0, 1, 69_999)]), np.tile((0.0, 0.0, 1.0), (len(corners), 1)))
    document, data = parts(glb([many]))
    accessor = document["accessors"][document["meshes"][0]["primitives"][0]["indices"]]
    assert accessor["componentType"] == 5125
    view = document["bufferViews"][accessor["bufferView"]]
    np.testing.assert_array_equal(np.frombuffer(data, "<u4", 3, view["byteOffset"]), (0, 1, 69_999))


def test_translucent_surfaces_say_so() -> None:
    solid, ghost = parts(glb([BOX, BALL]))[0]["materials"]
    assert "alphaMode" not in solid
    assert ghost["alphaMode"] == "BLEND"
    assert ghost["pbrMetallicRoughness"]["baseColorFactor"][3] == 0.4


def test_nothing_is_still_a_file() -> None:
    document, data = parts(glb([]))
    assert document["scenes"] == [{"nodes": []}]
    assert data == b""


def test_another_reader_agrees() -> None:
    trimesh = pytest.importorskip("trimesh")
    scene = trimesh.load(io.BytesIO(glb([BOX, BALL])), file_type="glb", force="scene")
    assert sorted(len(g.faces) for g in scene.geometry.values()) == sorted((12, len(BALL.triangles)))
    np.testing.assert_allclose(scene.bounds, [(-0.2,) * 3, (0.2,) * 3], atol=1e-3)
