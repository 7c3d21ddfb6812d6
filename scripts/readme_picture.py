"""Writes docs/_static/panda.gif, the moving picture of README: a Panda goes around a wall and back.

Run: python scripts/readme_picture.py [--check | --write]

`--check` exits with 1 where the pictures differ visibly from what would be written.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image, ImageSequence

import ulna

PICTURE = Path(__file__).parents[1] / "docs" / "_static" / "panda.gif"
LARGEST = 1_000_000
"""The most that the file may have [bytes]."""
ALIKE = 4.0
"""The largest mean difference of two pictures that nobody sees, of 255: other processors round differently."""


def write(path: Path) -> None:
    """Draw the film.

    Args:
        path: The file.
    """
    robot = ulna.load("panda")
    corners = [(0.5, -0.28, 0.25), (0.45, -0.12, 0.54), (0.45, 0.12, 0.54), (0.5, 0.28, 0.25)]
    points = [robot.configurations["ready"]]
    for corner in corners:
        points.append(robot.ik(ulna.SE3.pointing_down(corner), points[-1]).q)
    there = ulna.trajectory.minimum_jerk(np.array(points[1:]), times=[0.0, 0.9, 1.4, 2.3])
    viewer = ulna.Viewer(page=False)
    arm = viewer.add(robot, q=points[1])
    viewer.box((0.3, 0.03, 0.45), pose=(0.55, 0.0, 0.225), color="tomato", opacity=0.75)
    arm.trace(color="orange")
    viewer.camera = ulna.viewer.Camera((2.1, -1.45, 1.15), (0.22, 0.0, 0.38))
    viewer.film(path, there + there.reversed(), speed=1.3, fps=10, width=480, height=300)


def frames(path: Path) -> np.ndarray:
    """The pictures of a film.

    Args:
        path: The file.

    Returns:
        The pictures, (n, height, width, 3).
    """
    with Image.open(path) as film:
        return np.stack([np.asarray(frame.convert("RGB"), float) for frame in ImageSequence.Iterator(film)])


def differences(old: Path, new: Path) -> str:
    """What is visibly different between two films.

    Args:
        old: The file that is committed.
        new: The file that was drawn now.

    Returns:
        A sentence; empty where they look alike.
    """
    if not old.exists():
        return f"{old.name} is missing"
    if old.stat().st_size > LARGEST:
        return f"{old.name} has {old.stat().st_size} bytes, more than {LARGEST}"
    a, b = frames(old), frames(new)
    if a.shape != b.shape:
        return f"{old.name} has pictures of shape {a.shape}, drawn now {b.shape}"
    most = float(np.abs(a - b).mean(axis=(1, 2, 3)).max())
    return f"the pictures of {old.name} differ by {most:.1f} of 255" if most > ALIKE else ""


def main() -> None:
    """Write the film, or compare it."""
    if "--write" in sys.argv:
        write(PICTURE)
        print(f"{PICTURE}: {PICTURE.stat().st_size / 1e3:.0f} kB")
        return
    with tempfile.TemporaryDirectory() as folder:
        new = Path(folder) / PICTURE.name
        write(new)
        if wrong := differences(PICTURE, new):
            sys.exit(f"{wrong}: run python scripts/readme_picture.py --write")


if __name__ == "__main__":
    main()
