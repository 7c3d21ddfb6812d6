"""Where a robot's description and meshes come from, and under which licences, as far as the files beside them say."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from ulna.geometry import Mesh

_LEVELS = 5  # folders above a mesh that may hold what is said of its package
_MAX_LICENCE_LENGTH = 4_000  # characters above which a licence is named only
_NAMES = ("LICENSE", "LICENSE.txt", "LICENSE.md", "LICENCE", "COPYING")


def credits_of(robot: Any) -> list[dict[str, str]]:
    """Credits for the meshes of a robot, a package each: title, text and licence.

    Args:
        robot: The robot.

    Returns:
        One entry for each package; none for a robot without meshes.
    """
    shapes = [g.shape for link in robot.model.links for g in (*link.visuals, *link.collisions)]
    paths = {Path(s.path) for s in shapes if isinstance(s, Mesh) and s.path is not None and not s.missing}
    folders = sorted({folder for path in paths for folder in [_package(path)]})
    return [_credit(folder) for folder in folders]


def _package(path: Path) -> Path:
    """The nearest folder above a mesh that has a licence, a package.xml or a README; else the mesh's own."""
    for folder in path.resolve().parents[:_LEVELS]:
        if any((folder / name).is_file() for name in (*_NAMES, "package.xml", "README.md")):
            return folder
    return path.resolve().parent


def _credit(folder: Path) -> dict[str, str]:
    readme, package = _content(folder / "README.md"), _content(folder / "package.xml")
    licence = next((content for name in _NAMES if (content := _content(folder / name))), "")
    name = _first(r"(?im)^\W*licen[sc]e\W*:\s*(.+)$", readme) or _first(r"<license[^>]*>([^<]+)<", package)
    source = _first(r"(?im)^\W*upstream\W*:\s*(\S+)", readme)
    if licence and not name:
        name = licence.strip().splitlines()[0].strip()
    parts = [f"Licence: {name.strip()}." if name else "No licence was found beside the meshes."]
    parts.append("The meshes were simplified.")
    if source:
        parts.append(f"Source: {source}")
    text = licence if len(licence) <= _MAX_LICENCE_LENGTH else ""
    return {"title": f"Meshes of {folder.name}", "text": " ".join(parts), "licence": text}


def _content(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8", errors="replace")[:50_000]
    except OSError:
        return ""


def _first(pattern: str, text: str) -> str:
    match = re.search(pattern, text)
    return match.group(1) if match else ""
