"""Films keep their time, HTML files hold everything, stick figures stand where the robot does."""

import base64
import os
import re
import subprocess
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import ulna
from ulna.errors import InputError, MissingExtra, ShapeError, UnknownName
from ulna.sim import Recording
from ulna.viewer.output.video import frame_times, gif_frame_durations, write_video
from ulna.viewer.viewer import Viewer


@pytest.fixture(scope="module")
def panda() -> ulna.Robot:
    return ulna.load("panda", visuals="simple")


def swing(panda: ulna.Robot, seconds: float) -> Recording:
    recording = Recording()
    for t in np.linspace(0, seconds, 50):
        recording.add(t, panda.configurations["qr"] + 0.5 * np.sin(t))
    return recording


def pictures(count: int) -> list[np.ndarray]:
    return [np.full((20, 33, 3), 5 * k, dtype=np.uint8) for k in range(count)]


def test_the_moments_of_a_film() -> None:
    np.testing.assert_allclose(frame_times(1.0, 4.0), [0, 0.25, 0.5, 0.75, 1.0])
    np.testing.assert_allclose(frame_times(1.0, 4.0, 2.0), [0, 0.5, 1.0])
    assert len(frame_times(0.0, 25.0)) == 1
    for wrong in ((-1.0, 25.0, 1.0), (1.0, 0.0, 1.0), (1.0, 25.0, 0.0), (np.nan, 25.0, 1.0)):
        with pytest.raises(InputError):
            frame_times(*wrong)


@pytest.mark.parametrize("fps", [25.0, 30.0, 60.0])
def test_a_gif_keeps_its_time(tmp_path: Path, fps: float) -> None:
    Image = pytest.importorskip("PIL.Image")
    path = write_video(tmp_path / "new" / "a.gif", pictures(31), fps)
    with Image.open(path) as film:
        total = 0
        for k in range(film.n_frames):
            film.seek(k)
            total += film.info["duration"]
    assert total == pytest.approx(31 / fps * 1000, abs=10)


def test_an_mp4_keeps_its_time_and_size(tmp_path: Path) -> None:
    ffmpeg = pytest.importorskip("imageio_ffmpeg")
    path = write_video(tmp_path / "a.mp4", pictures(31), 30.0)
    command = [ffmpeg.get_ffmpeg_exe(), "-i", str(path), "-f", "null", "-"]
    about = subprocess.run(command, capture_output=True, text=True, check=True).stderr
    assert "32x20" in about  # the codec wants even sizes
    assert "30 fps" in about
    assert "Duration: 00:00:01.03" in about
    assert re.search(r"frame=\s*31\b", about)


@pytest.mark.parametrize(("fps", "shortest"), [(60.0, 20), (100.0, 20), (240.0, 20), (25.0, 40)])
def test_a_gif_shows_no_picture_for_less_than_browsers_keep_to(fps: float, shortest: int) -> None:
    chosen, durations = gif_frame_durations(481, fps)
    assert min(durations) >= shortest
    assert sum(durations) == pytest.approx(481 / fps * 1000, abs=20)
    assert chosen == sorted(set(chosen))
    assert chosen[-1] == 480


def test_a_thin_line_keeps_its_colour_in_a_gif(tmp_path: Path) -> None:
    """Its few pixels had no share in the palette: a red line was grey."""
    image = pytest.importorskip("PIL.Image")
    rng = np.random.default_rng(0)
    grey = np.linspace(60, 230, 240)[:, None] + rng.uniform(-20, 20, (240, 320))
    scene = np.stack([grey, grey + 5, grey + 12], axis=-1).clip(0, 255).astype(np.uint8)
    scene[120, 100:160] = (255, 99, 71)
    path = write_video(tmp_path / "a.gif", [scene, scene], 5.0)
    with image.open(path) as film:
        shown = np.asarray(film.convert("RGB")).astype(int)
    assert np.abs(shown[120, 100:160] - (255, 99, 71)).max() < 10
    assert np.abs(shown - scene).mean() < 6.0


@pytest.mark.parametrize("suffix", [".gif", ".mp4"])
def test_a_film_that_fails_leaves_what_was_there(tmp_path: Path, suffix: str) -> None:
    pytest.importorskip("PIL" if suffix == ".gif" else "imageio_ffmpeg")
    path = tmp_path / f"a{suffix}"
    path.write_bytes(b"before")

    def stops() -> Iterator[np.ndarray]:
        yield from pictures(3)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_video(path, stops(), 25.0)
    assert (path.read_bytes(), list(tmp_path.iterdir())) == (b"before", [path])
    write_video(path, pictures(3), 25.0)
    assert path.stat().st_size > 100
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="there is no device that is always full")
@pytest.mark.parametrize("suffix", [".gif", ".mp4", ".png", ".html"])
def test_a_full_disk_is_reported_and_leaves_no_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, suffix: str
) -> None:
    if suffix == ".html":
        pytest.importorskip("viser")
    viewer = Viewer(page=False)
    viewer.box((1, 1, 1))
    monkeypatch.setattr(Path, "touch", lambda path: path.symlink_to("/dev/full"))
    monkeypatch.setattr(os, "replace", None)
    write = {
        ".png": lambda path: viewer.picture(path, 16, 10),
        ".html": viewer.html,
    }.get(suffix, lambda path: viewer.film(path, move=lambda t: None, duration=0.2, width=16, height=10))
    with pytest.raises(InputError, match=r"Cannot write the (film|picture|page) .*[Nn]o space left"):
        write(tmp_path / f"a{suffix}")
    assert list(tmp_path.iterdir()) == []


def test_an_invalid_film_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import sys

    with pytest.raises(UnknownName, match=r"\.mp4"):
        write_video(tmp_path / "a.mp3", pictures(1), 25.0)
    pytest.importorskip("PIL")
    with pytest.raises(InputError, match="at least one"):
        write_video(tmp_path / "a.gif", [], 25.0)
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(MissingExtra, match=r"pip install .*'imageio-ffmpeg>="):
        write_video(tmp_path / "a.mp4", pictures(1), 25.0)


def test_a_film_of_a_recording_shows_what_happened(tmp_path: Path, panda: ulna.Robot) -> None:
    Image = pytest.importorskip("PIL.Image")
    viewer = Viewer(page=False)
    arm = viewer.add(panda, "ready")
    path = viewer.film(tmp_path / "a.gif", swing(panda, 1.0), fps=4.0, width=64, height=40, samples=1)
    with Image.open(path) as film:
        assert film.n_frames == 5
        first = np.asarray(film.convert("RGB"))
        film.seek(4)
        assert not np.array_equal(first, np.asarray(film.convert("RGB")))
    np.testing.assert_array_equal(arm.q, panda.configurations["ready"])  # it stands where it stood
    seen = []
    viewer.film(tmp_path / "b.gif", move=seen.append, duration=1.0, fps=2.0, width=32, height=20, samples=1)
    assert seen[-3:] == [0.0, 0.5, 1.0]


def test_an_html_file_needs_nothing_else(tmp_path: Path, panda: ulna.Robot) -> None:
    pytest.importorskip("viser")
    viewer = Viewer(page=False, title="swing", theme="dark")
    viewer.add(panda)
    path = viewer.html(tmp_path / "a.html", swing(panda, 0.5), fps=10.0)
    text = path.read_text()
    assert "__VISER_EMBED_DATA__" in text
    assert "darkMode:true" in text
    rest = viewer.html(tmp_path / "b.html")
    assert rest.stat().st_size < path.stat().st_size


def test_an_html_file_has_the_texts_of_labels(tmp_path: Path) -> None:
    pytest.importorskip("viser")
    zstandard = pytest.importorskip("zstandard")
    viewer = Viewer(page=False)
    viewer.text("the goal", (0.0, 0.0, 1.0))
    page = viewer.html(tmp_path / "a.html").read_text()
    data = re.search('__VISER_EMBED_DATA__="([^"]+)"', page)
    assert data is not None
    sent = zstandard.ZstdDecompressor().decompressobj().decompress(base64.b64decode(data[1])[8:])
    assert re.search(rb'"words": \{"[^"]+": "the goal"\}', sent)


def test_sticks_stand_where_the_robot_does(panda: ulna.Robot) -> None:
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    from ulna.viewer.robot.stick_figure import stick_figure

    q = panda.configurations["qr"]
    ax = stick_figure(panda, np.stack([panda.neutral, q]), frames=["panda_link4"])
    ends = np.concatenate([np.stack(line.get_data_3d(), -1) for line in ax.lines])
    for frame in ("panda_hand", "panda_link4"):
        assert np.linalg.norm(ends - panda.fk(q, frame)[:3, 3], axis=1).min() < 1e-9
    assert stick_figure(panda, None, ax, shadow=False) is ax
    with pytest.raises(ShapeError):
        stick_figure(panda, np.zeros(6), ax)
    with pytest.raises(UnknownName):
        stick_figure(panda, q, ax, frames=["nowhere"])
    plt.close("all")
