"""Films as files: MP4 by way of FFmpeg and GIF by way of Pillow, each picture shown for as long as it should be."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any

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
    writer: Any = imageio_ffmpeg.write_frames(
        str(target),
        even,
        fps=fps,  # type: ignore[arg-type]
        codec="libx264",
        macro_block_size=1,
        output_params=["-crf", "18", "-preset", "medium", "-movflags", "+faststart"],
        ffmpeg_log_level="error",
    )
    writer.send(None)
    try:
        for picture in pictures:
            writer.send(np.ascontiguousarray(picture[: even[1], : even[0], :3]))
    finally:
        writer.close()


def _write_gif(target: Path, pictures: Iterable[Array], fps: float) -> None:
    from PIL import Image

    frames, palette = [], None
    for picture in pictures:
        frame = Image.fromarray(picture[:, :, :3])
        # one palette for all pictures: the background does not flicker
        palette = palette or frame.quantize(255, dither=Image.Dither.NONE)
        frames.append(frame.quantize(palette=palette, dither=Image.Dither.NONE))
    ends = np.round(np.arange(1, len(frames) + 1) * 100.0 / fps).astype(int)
    durations = np.maximum(np.diff(ends, prepend=0), 1) * 10
    frames[0].save(
        target, save_all=True, append_images=frames[1:], duration=durations.tolist(), loop=0, optimize=False
    )
