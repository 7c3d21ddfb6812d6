"""Films as files: MP4 by way of FFmpeg and GIF by way of Pillow, each picture shown for as long as it should be."""

from __future__ import annotations

import contextlib
import os
import subprocess
import tempfile
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from ulna.errors import InputError, MissingExtra, UnknownName
from ulna.typing import Array

SUFFIXES = (".mp4", ".gif")


def moments(duration: float, fps: float, speed: float = 1.0) -> Array:
    """The times [s] of what happened that a film shows, one for each picture, from 0 to `duration`.

    Args:
        duration: How long what happened took [s].
        fps: Pictures a second.
        speed: Seconds of what happened per second of film.

    Raises:
        InputError: A number is out of range.
    """
    if not (
        np.isfinite([duration, fps, speed]).all() and duration >= 0.0 and 0.0 < fps <= 240.0 and speed > 0.0
    ):
        raise InputError(
            f"A film of {duration} s at {fps} pictures a second and speed {speed}; expected a duration of at least 0, "
            "up to 240 pictures a second, and a speed above 0."
        )
    count = int(np.floor(duration / speed * fps + 1e-9)) + 1
    return np.minimum(np.arange(count) * (speed / fps), duration)


def check_film(path: str | os.PathLike[str]) -> Path:
    """The path of a film, when its kind is known and what writes it is installed.

    Raises:
        UnknownName: It ends neither in .mp4 nor in .gif.
        MissingExtra: imageio-ffmpeg or Pillow is not installed.
    """
    target = Path(path)
    suffix = target.suffix.lower()
    if suffix not in SUFFIXES:
        raise UnknownName("kind of film", suffix, SUFFIXES)
    package = "imageio_ffmpeg" if suffix == ".mp4" else "PIL"
    try:
        __import__(package)
    except ImportError:
        name = "imageio-ffmpeg" if suffix == ".mp4" else "pillow"
        raise MissingExtra(name, "film", f"Writing {suffix} films") from None
    return target


def write_film(path: str | os.PathLike[str], pictures: Iterable[Array], fps: float) -> Path:
    """Write pictures (h, w, 3) uint8 as a film, each shown for 1 / `fps` seconds; returns the path.

    A GIF counts in hundredths of a second: its pictures take turns being shown a little shorter and longer, so that
    the film as a whole keeps its time.

    Raises:
        UnknownName, MissingExtra: See `check_film`.
        InputError: There are no pictures, or the file cannot be written.
    """
    target = check_film(path)
    first = iter(pictures)
    picture = next(first, None)
    if picture is None:
        raise InputError("A film needs at least one picture.")
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        if target.suffix.lower() == ".gif":
            _write_gif(target, _chain(picture, first), fps)
        else:
            _write_mp4(target, _chain(picture, first), fps, picture.shape)
    except OSError as error:
        raise InputError(f"Cannot write the film {str(target)!r}: {error.strerror or error}.") from error
    return target


def _chain(picture: Array, rest: Iterable[Array]) -> Iterable[Array]:
    yield picture
    yield from rest


def _write_mp4(target: Path, pictures: Iterable[Array], fps: float, shape: tuple[int, ...]) -> None:
    import imageio_ffmpeg

    height, width = shape[:2]
    even = (width - width % 2, height - height % 2)  # the codec halves colours, so it wants even sizes
    what = [
        "-f",
        "rawvideo",
        "-pix_fmt",
        "rgb24",
        "-s",
        f"{even[0]}x{even[1]}",
        "-r",
        f"{fps:.6g}",
        "-i",
        "-",
    ]
    how = ["-an", "-c:v", "libx264", "-pix_fmt", "yuv420p", "-crf", "18", "-movflags", "+faststart"]
    command = [imageio_ffmpeg.get_ffmpeg_exe(), "-y", "-v", "error", *what, *how, str(target)]
    with tempfile.TemporaryFile() as complaints:
        process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=complaints
        )
        assert process.stdin is not None
        try:
            with contextlib.suppress(BrokenPipeError), process.stdin as pipe:  # it says itself why it stopped
                for picture in pictures:
                    pipe.write(np.ascontiguousarray(picture[: even[1], : even[0], :3]).tobytes())
        except BaseException:
            process.kill()
            process.wait()
            raise
        if process.wait() != 0:
            complaints.seek(0)
            said = complaints.read().decode(errors="replace").strip()
            raise InputError(f"Cannot write the film {str(target)!r}: {said or 'FFmpeg failed'}")


def _write_gif(target: Path, pictures: Iterable[Array], fps: float) -> None:
    from PIL import Image

    with (
        tempfile.TemporaryFile() as spool
    ):  # all pictures share their colours, which only the last one completes
        count, shape = 0, (0, 0, 3)
        for picture in pictures:
            shape = picture[:, :, :3].shape
            spool.write(np.ascontiguousarray(picture[:, :, :3]).tobytes())
            count += 1
        size = int(np.prod(shape))

        def read(k: int) -> Array:
            spool.seek(k * size)
            return np.frombuffer(spool.read(size), dtype=np.uint8).reshape(shape)

        some = np.unique(np.linspace(0, count - 1, 6).astype(int))
        palette = Image.fromarray(np.concatenate([read(int(k)) for k in some])).quantize(255)
        frames = (
            Image.fromarray(read(k)).quantize(palette=palette, dither=Image.Dither.NONE) for k in range(count)
        )
        ends = np.round(np.arange(1, count + 1) * 100.0 / fps).astype(int)
        durations = (np.maximum(np.diff(ends, prepend=0), 1) * 10).tolist()
        first = next(frames)
        first.save(target, save_all=True, append_images=frames, duration=durations, loop=0, optimize=False)
