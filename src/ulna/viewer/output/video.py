"""Films as files: MP4 by way of FFmpeg and GIF by way of Pillow, each picture shown for as long as it should be."""

from __future__ import annotations

import contextlib
import itertools
import os
import subprocess
import tempfile
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from ulna.checks.paths import checked_path
from ulna.checks.values import number
from ulna.errors import InputError, MissingExtra
from ulna.typing import Array
from ulna.viewer.output.atomic_file import atomic_write

SUFFIXES = (".mp4", ".gif")
_MAX_FRAMES = 10**7
_GIF_COLOURS = 255
_RARE_COLOURS = 32  # how many of them are kept for what covers few pixels
_MIN_PIXELS = 12  # from which a colour counts, in all pictures that are looked at
_MIN_GIF_DURATION = 2  # hundredths of a second for which a picture of a GIF is shown


def frame_times(duration: float, fps: float, speed: float = 1.0) -> Array:
    """The times [s] of what happened that a film shows, one for each picture, from 0 to `duration`.

    Args:
        duration: How long what happened took [s].
        fps: Pictures a second [1/s].
        speed: Seconds of what happened per second of film [-].

    Returns:
        Times (n,) [s].

    Raises:
        InputError: A number is out of range.
    """
    length = number("duration", duration, "a time of at least 0 [s]", least=0.0)
    rate = number("fps", fps, "pictures a second, above 0 and up to 240", above=0.0, most=240.0)
    pace = number("speed", speed, "seconds of what happened per second of film, above 0", above=0.0)
    pictures = length / pace * rate + 1e-9
    if not pictures < _MAX_FRAMES:
        raise InputError(
            f"{length:g} s at {rate:g} pictures a second and speed {pace:g} are {pictures:.3g} pictures; expected "
            f"fewer than {_MAX_FRAMES:.0e}. Take a lower `fps`, or a higher `speed`."
        )
    count = int(pictures) + 1
    return np.minimum(np.arange(count) * (pace / rate), length)


def checked_video_path(path: str | os.PathLike[str]) -> Path:
    """The path of a film, when its kind is known and what writes it is installed.

    Raises:
        UnknownName: It ends neither in .mp4 nor in .gif.
        MissingExtra: imageio-ffmpeg or Pillow is not installed.
    """
    target = checked_path(path, "film", SUFFIXES)
    suffix = target.suffix.lower()
    package = "imageio_ffmpeg" if suffix == ".mp4" else "PIL"
    try:
        __import__(package)
    except ImportError:
        name = "imageio-ffmpeg" if suffix == ".mp4" else "pillow"
        raise MissingExtra(name, "film", f"Writing {suffix} films") from None
    return target


def write_video(path: str | os.PathLike[str], pictures: Iterable[Array], fps: float) -> Path:
    """Write pictures as a film.

    A GIF counts in hundredths of a second: its pictures take turns being shown a little shorter and longer, so that
    the film as a whole keeps its time.

    Args:
        path: Path of the file, .mp4 or .gif.
        pictures: Pictures (h, w, 3) uint8, all of one size.
        fps: Pictures a second [1/s].

    Returns:
        The path of the file.

    Raises:
        UnknownName, MissingExtra: See `check_film`.
        InputError: There are no pictures, or the file cannot be written.
    """
    target = checked_video_path(path)
    first = iter(pictures)
    picture = next(first, None)
    if picture is None:
        raise InputError("A film needs at least one picture.")
    with atomic_write(target, "film") as file:
        write = _write_gif if target.suffix.lower() == ".gif" else _write_mp4
        write(file, itertools.chain([picture], first), fps, picture.shape)
    return target


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
    with tempfile.TemporaryFile() as stderr:
        process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=stderr)
        assert process.stdin is not None
        try:
            with (
                contextlib.suppress(BrokenPipeError),
                process.stdin as pipe,
            ):  # its stderr states why it stopped
                for picture in pictures:
                    pipe.write(np.ascontiguousarray(picture[: even[1], : even[0], :3]).tobytes())
        except BaseException:
            process.kill()
            process.wait()
            raise
        if process.wait() != 0:
            stderr.seek(0)
            message = stderr.read().decode(errors="replace").strip()
            raise OSError(message or "FFmpeg failed")


def _write_gif(target: Path, pictures: Iterable[Array], fps: float, shape: tuple[int, ...]) -> None:
    from PIL import Image

    size = (*shape[:2], 3)
    with (
        tempfile.TemporaryFile() as spool
    ):  # all pictures share their colours, which only the last one completes
        count = 0
        for picture in pictures:
            spool.write(np.ascontiguousarray(picture[:, :, :3]).tobytes())
            count += 1

        def read(k: int) -> Array:
            spool.seek(k * int(np.prod(size)))
            return np.frombuffer(spool.read(int(np.prod(size))), dtype=np.uint8).reshape(size)

        some = np.unique(np.linspace(0, count - 1, 6).astype(int))
        palette = Image.new("P", (1, 1))
        palette.putpalette(_gif_colours(np.concatenate([read(int(k)) for k in some])).tobytes())
        chosen, durations = gif_frame_durations(count, fps)
        frames = (
            Image.fromarray(read(k)).quantize(palette=palette, dither=Image.Dither.NONE) for k in chosen
        )
        first = next(frames)
        first.save(target, save_all=True, append_images=frames, duration=durations, loop=0, optimize=False)


def _gif_colours(picture: Array) -> Array:
    """The colours of a GIF (256, 3): those that cover most pixels, then rare ones: a thin line keeps its colour.

    The first are found by median cut, each of the others is the one that is farthest from all before it.

    Args:
        picture: The picture, or several below each other, (h, w, 3) uint8.

    Returns:
        Colours (256, 3) uint8.
    """
    from PIL import Image

    common = Image.fromarray(picture).quantize(_GIF_COLOURS - _RARE_COLOURS).getpalette()
    colours = np.array(common, dtype=float).reshape(-1, 3)[: _GIF_COLOURS - _RARE_COLOURS]
    pixels = picture.reshape(-1, 3)
    levels = pixels.astype(np.uint16) >> 4  # 16 levels of each of red, green and blue
    code = levels[:, 0] << 8 | levels[:, 1] << 4 | levels[:, 2]
    counts = np.bincount(code, minlength=4096)
    is_present = counts >= _MIN_PIXELS
    sums = [np.bincount(code, pixels[:, k], minlength=4096)[is_present] for k in range(3)]
    present = np.stack(sums, axis=1) / counts[is_present, None]
    away = np.linalg.norm(present[:, None] - colours, axis=2).min(axis=1, initial=np.inf)
    while len(colours) < _GIF_COLOURS and len(present):
        colours = np.vstack([colours, present[away.argmax()]])
        away = np.minimum(away, np.linalg.norm(present - colours[-1], axis=1))
    return np.resize(colours.round().astype(np.uint8), (256, 3))


def gif_frame_durations(count: int, fps: float) -> tuple[list[int], list[int]]:
    """Which of `count` pictures a GIF holds, and how long each of them is shown [ms].

    Browsers show a picture that is to be shown for less than 20 ms for 100 ms: of faster films some are left out.

    Args:
        count: Number of pictures.
        fps: Pictures a second [1/s].

    Returns:
        Numbers of the pictures, and milliseconds of each.
    """
    end_times = np.round(np.arange(1, count + 1) * 100.0 / fps).astype(int)  # in hundredths of a second
    chosen, durations, shown = [], [], 0
    for k, end in enumerate(end_times.tolist()):
        if end - shown >= _MIN_GIF_DURATION or k == count - 1:
            chosen.append(k)
            durations.append(10 * max(end - shown, _MIN_GIF_DURATION))
            shown = end
    return chosen, durations
