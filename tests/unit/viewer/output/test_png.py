"""PNG files: what is written is what a reader gets."""

import struct
import zlib
from pathlib import Path

import numpy as np
import pytest

from ulna.errors import InputError, ShapeError, UnknownName
from ulna.viewer.output.png import write_png


def read_png(path: Path) -> np.ndarray:
    """Reads back 8-bit images whose rows use the filters none, sub and up, checking every chunk's sum."""
    data = path.read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    chunks, at = {}, 8
    while at < len(data):
        (size,), kind = struct.unpack(">I", data[at : at + 4]), data[at + 4 : at + 8]
        body = data[at + 8 : at + 8 + size]
        assert struct.unpack(">I", data[at + 8 + size : at + 12 + size])[0] == zlib.crc32(kind + body)
        chunks[kind] = chunks.get(kind, b"") + body
        at += 12 + size
    width, height, depth, colour, *_ = struct.unpack(">IIBBBBB", chunks[b"IHDR"])
    channels = {2: 3, 6: 4}[colour]
    assert depth == 8
    rows = np.frombuffer(zlib.decompress(chunks[b"IDAT"]), np.uint8).reshape(height, -1)
    out = np.zeros((height, width, channels), np.uint8)
    for y, (kind, row) in enumerate(
        zip(rows[:, 0], rows[:, 1:].reshape(height, width, channels), strict=True)
    ):
        if kind == 0:
            out[y] = row
        elif kind == 1:
            out[y] = np.cumsum(row, axis=0, dtype=np.uint8)
        else:
            assert kind == 2
            out[y] = row + (out[y - 1] if y else 0)
    return out


@pytest.mark.parametrize("shape", [(1, 1, 3), (7, 5, 3), (40, 30, 4)])
@pytest.mark.parametrize("kind", ["noise", "ramp", "flat"])
def test_pixels_survive(tmp_path: Path, shape: tuple[int, ...], kind: str) -> None:
    noise = np.random.default_rng(0).integers(0, 256, shape, dtype=np.uint8)
    ramp = np.broadcast_to((np.arange(shape[0]) * 5 % 256).astype(np.uint8)[:, None, None], shape)
    image = {"noise": noise, "ramp": ramp, "flat": np.full(shape, 9, np.uint8)}[kind]
    np.testing.assert_array_equal(read_png(write_png(tmp_path / "a.png", image)), image)


def test_folders_are_made(tmp_path: Path) -> None:
    assert write_png(tmp_path / "x" / "y.png", np.zeros((2, 2, 3), np.uint8)).is_file()


def test_an_invalid_image_is_refused(tmp_path: Path) -> None:
    folder = tmp_path / "folder.png"
    folder.mkdir()
    with pytest.raises(ShapeError, match=r"\(height, width, 3\)"):
        write_png(tmp_path / "a.png", np.zeros((4, 4), np.uint8))
    with pytest.raises(InputError, match="float64"):
        write_png(tmp_path / "a.png", np.zeros((4, 4, 3)))
    with pytest.raises(InputError, match="Cannot write the picture"):
        write_png(folder, np.zeros((4, 4, 3), np.uint8))
    for name in ("a.bmp", "a.jpg", "a.svg", "a", "a.png.txt"):
        with pytest.raises(UnknownName, match=r"No kind of picture .*'\.png'"):
            write_png(tmp_path / name, np.zeros((4, 4, 3), np.uint8))
    for path in (None, 3, b"a.png", ["a.png"]):
        with pytest.raises(InputError, match="expected the path of a picture"):
            write_png(path, np.zeros((4, 4, 3), np.uint8))  # type: ignore[arg-type]
    assert [p.name for p in tmp_path.iterdir()] == ["folder.png"]
