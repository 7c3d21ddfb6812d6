"""Mesh files whose numbers cannot be are refused with what is wrong; the parsers underneath let them pass."""

from __future__ import annotations

from pathlib import Path

import pytest

from ulna.errors import InputError
from ulna.geometry.meshes import read_pieces

pytest.importorskip("trimesh")

PLY = """ply
format ascii 1.0
element vertex 3
property float x
property float y
property float z
element face 1
property list uchar int vertex_indices
end_header
0 0 0
1 0 0
{}
3 0 1 {}
"""


@pytest.mark.parametrize(
    ("vertex", "index", "said"),
    [
        ("0 nan 0", "2", "is damaged: vertex 2 is not finite"),
        ("0 1e30 0", "2", "a vertex is 1e\\+30 m from the origin"),
        ("0 1 0", "7", "a face names vertex 7, and there are 3"),
        ("0 1 0", "-2", "a face names vertex -2, and there are 3"),
    ],
)
def test_damage_is_named(vertex: str, index: str, said: str, tmp_path: Path) -> None:
    (tmp_path / "a.ply").write_text(PLY.format(vertex, index))
    with pytest.raises(InputError, match=said):
        read_pieces(str(tmp_path / "a.ply"))
    (tmp_path / "a.ply").write_text(PLY.format("0 1 0", "2"))
    assert len(read_pieces(str(tmp_path / "a.ply"))[0].triangles) == 1
