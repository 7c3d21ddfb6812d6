"""Repair of inertias in URDF text: those that no body can have become the nearest possible ones, all else stays.

| symbol | meaning | unit | equation |
|---|---|---|---|
| I | inertia about the centre of mass | kg m^2 | |
| S | second moments of the mass distribution, positive semidefinite for every body | kg m^2 | S = tr(I) E / 2 - I |

I has positive principal moments that obey the triangle inequality where S is positive definite; so negative eigenvalues
of S are raised to a small fraction of the largest, which changes S least in the Frobenius norm. Source: Wensing, Kim &
Slotine, Linear matrix inequalities for physically consistent inertial parameter identification (2018).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from lxml import etree  # pyright: ignore[reportAttributeAccessIssue]

from ulna.formats.markup import parse_tree
from ulna.formats.urdf_parse import parse_urdf
from ulna.spatial import Inertia
from ulna.typing import Floats

_MIN_RELATIVE_MOMENT = 1e-6
"""What the smallest second moment is raised to, as a part of the largest."""

_ENTRIES = {"ixx": (0, 0), "ixy": (0, 1), "ixz": (0, 2), "iyy": (1, 1), "iyz": (1, 2), "izz": (2, 2)}


def nearest_inertia(inertia: Floats) -> Floats:
    """The nearest inertia that a body can have.

    Args:
        inertia: About the centre of mass, symmetric, (3, 3) [kg m^2].

    Returns:
        An inertia (3, 3) [kg m^2]: the same where a body can have it, but for rounding; zero where S has no
        positive eigenvalue.
    """
    if Inertia(1.0, np.zeros(3), inertia).is_physical():
        return inertia
    values, vectors = np.linalg.eigh(0.5 * np.trace(inertia) * np.eye(3) - inertia)
    floor = _MIN_RELATIVE_MOMENT * max(float(values.max()), 0.0)
    S = (vectors * np.maximum(values, floor)) @ vectors.T
    return np.trace(S) * np.eye(3) - S


def with_possible_inertias(data: bytes, file: str | None = None) -> tuple[bytes, tuple[str, ...]]:
    """A URDF document whose inertias bodies can have.

    Args:
        data: The document.
        file: Its name, for messages.

    Returns:
        The document with its comments, and the names of the links that were changed; the very document where none was.

    Raises:
        FormatError: The document is broken.
    """
    parse_urdf(data, file)  # which says what is wrong with a broken document, and where
    root = parse_tree(data, file)
    changed = []
    for link in root.iterfind("link"):
        for element in link.iterfind("inertial/inertia"):
            if _repair(element):
                changed.append(link.get("name"))
    if not changed:
        return data, ()
    return _document(root), tuple(changed)


def with_inertias(data: bytes, inertias: Mapping[str, Inertia], file: str | None = None) -> bytes:
    """A URDF document with other inertias of some links.

    Args:
        data: The document.
        inertias: For names of links, the inertia in the frame of the link.
        file: The document's name, for messages.

    Returns:
        The document with its comments; the <inertial> elements of these links are written anew.

    Raises:
        FormatError: The document is broken.
    """
    parse_urdf(data, file)
    root = parse_tree(data, file)
    for link in root.iterfind("link"):
        inertia = inertias.get(link.get("name"))
        if inertia is None:
            continue
        element = link.find("inertial")
        if element is None:
            element = etree.Element("inertial")
            element.tail = "\n  "
            link.insert(0, element)
        _write(element, inertia)
    return _document(root)


def _document(root: Any) -> bytes:
    return etree.tostring(root.getroottree(), encoding="utf-8", xml_declaration=True) + b"\n"


def _write(element: Any, inertia: Inertia) -> None:
    """Replaces the content of an <inertial> element."""
    for child in list(element):
        element.remove(child)
    element.text = None
    xyz = " ".join(f"{x:.12g}" for x in inertia.com)
    etree.SubElement(element, "origin", xyz=xyz, rpy="0 0 0")
    etree.SubElement(element, "mass", value=f"{float(inertia.mass):.12g}")
    moments = {name: f"{inertia.inertia[entry]:.12g}" for name, entry in _ENTRIES.items()}
    etree.SubElement(element, "inertia", **moments)


def _repair(element: Any) -> bool:
    """Writes the nearest possible inertia into an <inertia> element; returns whether it was another one."""
    present = np.zeros((3, 3))
    for name, (i, j) in _ENTRIES.items():
        present[i, j] = present[j, i] = float(element.get(name, "0"))
    nearest = nearest_inertia(present)
    if nearest is present:
        return False
    for name, entry in _ENTRIES.items():
        element.set(name, f"{nearest[entry]:.12g}")
    return True
