"""Spheres from files of others: spherized URDFs (as VAMP has them), YAML or JSON by link (as cuRobo has them)."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ulna.collision.spheres import LinkSpheres, Spheres
from ulna.errors import FormatError, needed
from ulna.formats.urdf import model_from_urdf
from ulna.geometry import Sphere
from ulna.model import Model
from ulna.model.of_robot import model_of

_KEYS = ("robot_cfg", "kinematics", "collision_spheres")


def spheres_of(model: Model | Any) -> Spheres:
    """The balls that a model's links have as collision geometry, as they are.

    Args:
        model: The Model, or its Robot, whose collision geometry is balls alone, such as a spherized URDF.

    Returns:
        The spheres of each link that has any; they bound what they bound, `excess` is None.

    Raises:
        FormatError: If a link has another shape, or no link has any.
    """
    model = model_of(model, "model")
    spheres_by_link = {}
    for link in model.links:
        balls = [
            (g.placement.translation, g.shape.radius) for g in link.collisions if isinstance(g.shape, Sphere)
        ]
        others = [g.shape.describe() for g in link.collisions if not isinstance(g.shape, Sphere)]
        if others:
            raise FormatError(
                f"link {link.name!r} of {model.name!r} has a {others[0]} as collision geometry; expected balls alone",
                fix="Fit spheres with ulna.collision.fit(model).",
            )
        if balls:
            spheres_by_link[link.name] = LinkSpheres(
                np.array([c for c, _ in balls]), np.array([r for _, r in balls])
            )
    if not spheres_by_link:
        raise FormatError(
            f"{model.name!r} has no balls as collision geometry", fix="Use ulna.collision.fit(model)."
        )
    return Spheres(spheres_by_link)


def read_spheres(path: str | os.PathLike[str]) -> Spheres:
    """The spheres in a file.

    Args:
        path: A URDF whose collision geometry is balls alone; or JSON or YAML: `Spheres.to_json()`, or the centres and
            radii of each link's spheres, `{link: [{center: [x, y, z], radius: r}, ...]}`, also below
            `collision_spheres` or `robot_cfg: kinematics: collision_spheres`. Spheres with radii that are not above 0
            are left out: cuRobo marks places for attached objects so.

    Returns:
        The spheres, by link.

    Raises:
        FormatError: If the file is missing, or is none of these.
        MissingExtra: If it is YAML, and PyYAML is not installed.
    """
    file = Path(path)
    if file.suffix.lower() in (".urdf", ".xml"):
        return spheres_of(model_from_urdf(file))
    try:
        text = file.read_text(encoding="utf-8")
    except OSError as error:
        raise FormatError(f"{file} cannot be read: {error}", fix="Look at the path.") from error
    content = _parsed(file, text)
    if isinstance(content, Mapping) and content.get("ulna") == "spheres":
        return Spheres.from_json(text)
    return _by_link(file, content)


def _parsed(file: Path, text: str) -> Any:
    try:
        if file.suffix.lower() == ".json":
            return json.loads(text)
        with needed("pyyaml", "collision", "Reading spheres from YAML"):
            import yaml
        try:
            return yaml.safe_load(text)
        except yaml.YAMLError as error:
            raise ValueError(str(error)) from error
    except ValueError as error:
        raise FormatError(f"{file} is broken: {error}", fix="Write one with `Spheres.to_json()`.") from error


def _by_link(file: Path, content: Any) -> Spheres:
    for key in _KEYS:
        if isinstance(content, Mapping) and key in content:
            content = content[key]
    if isinstance(content, str):
        return read_spheres(file.parent / content)
    spheres_by_link = {}
    try:
        for name, balls in content.items():
            rows = [(*ball["center"], ball["radius"]) for ball in balls if ball["radius"] > 0.0]
            if rows:
                table = np.array(rows, dtype=float)
                spheres_by_link[name] = LinkSpheres(table[:, :3], table[:, 3])
    except (TypeError, KeyError, AttributeError, ValueError) as error:
        raise FormatError(
            f"{file} has no spheres by link ({type(error).__name__}: {error})",
            fix="Expected {link: [{center: [x, y, z], radius: r}, ...]}, or what `Spheres.to_json()` writes.",
        ) from error
    if not spheres_by_link:
        raise FormatError(f"{file} has no spheres", fix="Fit some with ulna.collision.fit(model).")
    return Spheres(spheres_by_link)
