"""A robot in a web page that needs no server: drag its tool, and inverse kinematics follows in the browser.

You should see the sizes of three files: a page to drag in, one that plays a motion, and a script for your own page.
"""

from __future__ import annotations

import gzip
import tempfile
from pathlib import Path

import ulna
from ulna.trajectory import quintic


def main() -> None:
    """Writes the files; open the first in any browser."""
    robot = ulna.load("panda")
    way = quintic(robot.configurations["qr"], robot.configurations["ready"], 2.0)
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        files = [
            robot.save_html(folder / "panda.html"),
            robot.save_html(folder / "way.html", way, theme="dark", show="skeleton"),
            robot.save_html(folder / "panda.js", show="skeleton"),  # for <ulna-robot> in a page of your own
        ]
        for file in files:
            print(f"{len(gzip.compress(file.read_bytes())) / 1000:6.0f} kB gzipped  {file.name}")


if __name__ == "__main__":
    main()
