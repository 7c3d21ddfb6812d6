"""Pages of a robot: HTML files. What writes them is built on robots, and registers itself here."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from ulna.quantities.part import Part
from ulna.typing import ArrayLike

_writers: list[Callable[..., Path]] = []


def register_page_writer(writer: Callable[..., Path]) -> None:
    """Makes `writer` the implementation of `robot.save_html`.

    Args:
        writer: Called with the robot and the arguments of `save_html`.
    """
    _writers[:] = [writer]


class Pages(Part):
    """A robot as a page that browsers open without a server."""

    __slots__ = ()

    def save_html(
        self,
        path: str | os.PathLike[str],
        recorded: Any = None,
        *,
        live: bool = True,
        q: ArrayLike | str | None = None,
        frames: Sequence[str] | None = None,
        show: str = "visual",
        theme: str = "auto",
        title: str | None = None,
    ) -> Path:
        """Write the robot as one HTML file that moves: drag the tool, and inverse kinematics follows in the browser.

        The file holds everything, WebAssembly kernels, meshes and program, and requests nothing. A page is described
        in docs/live_page.md.

        Args:
            path: A file that ends in .html: a complete page; or in .js: a script for other pages, which shows the
                robot in each element `<ulna-robot>`.
            recorded: What is played with a time line: a recording, a trajectory, a plan, or configurations (n, nq).
            live: False for a page without kinematics that only plays what is recorded, as `Viewer.html` writes it; it
                needs the extra `viewer`, and takes no `frames` and no .js file.
            q: The first configuration, (nq,) [rad or m], or its name; None for the first row of `recorded`, or the
                one that `ulna.show` begins with.
            frames: Names of the frames to drag; None for the tool and the ends of other limbs.
            show: "visual", "collision", "both" or "skeleton".
            theme: "light", "dark", or "auto" for what the browser prefers (light where it is not live).
            title: The title of the page; the robot's name when None.

        Returns:
            The path of the file; as the last line of a cell, a notebook displays the page.

        Raises:
            UnknownName: There is no such frame, configuration, theme or way to show it, or the file ends otherwise.
            ShapeError, NonFiniteError: `q` is no configuration, or `recorded` is of another robot.
            InputError: An argument means nothing, the meshes are too large, or the file cannot be written.

        Example:
            >>> robot = ulna.load("panda")
            >>> robot.save_html("panda.html", live=True).name
            'panda.html'
        """
        options = {"live": live, "q": q, "frames": frames, "show": show, "theme": theme, "title": title}
        return _writers[0](self, path, recorded, **options)
