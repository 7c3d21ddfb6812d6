"""Every attribute of URDF against a table: what is honoured equals Pinocchio, what is not is warned of or has no effect."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lxml import etree  # pyright: ignore[reportAttributeAccessIssue]

from support.urdf_table import DOCUMENT, FOREIGN, OF_LINKS, SHAPES, TABLE, Row
from ulna import algorithms as alg
from ulna.errors import FormatError, ModelWarning
from ulna.formats.urdf import model_from_urdf
from ulna.formats.urdf_parse import parse_urdf
from ulna.model import Model
from ulna.robots import example_robot_data

pin: Any = pytest.importorskip("pinocchio")


def loaded(text: str) -> tuple[Model, list[str]]:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        model = model_from_urdf(parse_urdf(text))
    return model, [str(w.message) for w in caught if issubclass(w.category, ModelWarning)]


def of_pinocchio(text: str, seed: int = 0) -> dict[str, Any]:
    m = pin.buildModelFromXML(text, True)  # with mimic joints
    d, rng = m.createData(), np.random.default_rng(seed)
    q = pin.integrate(m, pin.neutral(m), rng.normal(size=m.nv))
    v = rng.normal(size=m.nv)
    pin.framesForwardKinematics(m, d, q)
    M = np.array(pin.crba(m, d, q))
    return {
        "q": q,
        "v": v,
        "joints": [n for n in m.names if n != "universe"],
        "poses": {
            f.name: d.oMf[k].homogeneous for k, f in enumerate(m.frames) if f.name in ("base", "arm", "hand")
        },
        "mass": np.triu(M) + np.triu(M, 1).T,
        "bias": np.array(pin.rnea(m, d, q, v, np.zeros(m.nv))),
        "lower": np.array(m.lowerPositionLimit),
        "upper": np.array(m.upperPositionLimit),
        "velocity": np.array(m.upperVelocityLimit),
        "effort": np.array(m.upperEffortLimit),
        "damping": np.array(m.damping),
        "friction": np.array(m.upperDryFrictionLimit),
    }


def of_ulna(model: Model, q: Any, v: Any) -> dict[str, Any]:
    frames = {f.name: alg.frame_pose(model, q, f).matrix() for f in model.frames if f.kind == "link"}
    return {
        "joints": list(model.joint_names),
        "poses": {name: frames[name] for name in ("base", "arm", "hand")},
        "mass": alg.mass_matrix(model, q),
        "bias": alg.bias_forces(model, q, v),
        "lower": model.lower_position,
        "upper": model.upper_position,
        "velocity": model.velocity_limit,
        "effort": model.effort_limit,
        "damping": model.damping,
        "friction": model.friction,
    }


def different(one: dict[str, Any], two: dict[str, Any]) -> list[str]:
    return [key for key, value in two.items() if not _same(key, one[key], value)]


def _same(key: str, one: Any, two: Any) -> bool:
    if key == "joints":
        return sorted(one) == sorted(two)
    if key == "poses":
        return all(np.allclose(one[name], T, atol=1e-9) for name, T in two.items())
    a, b = np.asarray(one), np.asarray(two)
    return a.shape == b.shape and bool(np.allclose(a[np.isfinite(b)], b[np.isfinite(b)], atol=1e-9))


@pytest.mark.parametrize("row", TABLE, ids=lambda row: row.name)
def test_an_attribute_is_read_or_reported(row: Row) -> None:
    model, said = loaded(row.source)
    listed = [text for text in said if "parts of this file" in text]
    if row.verdict == "warned":
        assert len(listed) == 1
        assert row.words in listed[0]
        return
    assert not said
    theirs = of_pinocchio(row.source)
    assert different(theirs, of_ulna(model, theirs["q"], theirs["v"])) == []
    changed = bool(different(of_pinocchio(DOCUMENT), {k: theirs[k] for k in theirs if k not in ("q", "v")}))
    names_only = row.new.replace(" ", "") == row.old.replace(" ", "")
    assert changed == (row.verdict == "honoured" and not names_only)


def test_quaternions_need_a_version() -> None:
    given = DOCUMENT.replace('rpy=".3 .2 .1"', 'quat_xyzw=".1 .2 .3 .4"')
    old = given.replace('version="1.2"', 'version="1.0"')
    model, said = loaded(old)
    assert '<origin quat_xyzw> of <joint> (line 8): it is ignored below <robot version="1.1">' in said[0]
    theirs = of_pinocchio(old)
    assert different(theirs, of_ulna(model, theirs["q"], theirs["v"])) == []
    with pytest.raises(FormatError, match="both rpy and quat_xyzw"):
        loaded(given.replace("quat_xyzw", 'rpy="0 0 0" quat_xyzw'))
    with pytest.raises(FormatError, match="no length"):
        loaded(given.replace(".1 .2 .3 .4", "0 0 0 0"))


def files() -> list[Path]:
    share = example_robot_data.share_folder()
    assert share is not None
    return sorted(Path(share).rglob("*.urdf"))


def attributes(file: Path) -> Iterator[tuple[str, str]]:
    """The elements of a file by their paths, with each of their attributes."""
    tree = etree.fromstring(file.read_bytes(), etree.XMLParser(recover=True))
    for element in tree.iter(etree.Element):
        path = "/".join([str(x.tag) for x in reversed([element, *element.iterancestors()])][1:])
        for name, _ in element.items():
            yield path, str(name)


def test_the_table_knows_what_the_files_of_robots_have() -> None:
    known = {(row.element, row.attribute) for row in TABLE}
    unknown = set()
    for file in files():
        for path, name in attributes(file):
            parts = path.split("/")
            elsewhere = parts[0] in FOREIGN or (parts[0] == "link" and parts[1:2] and parts[1] in OF_LINKS)
            shape = (
                parts[0] == "link"
                and len(parts) > 2
                and parts[1] in ("visual", "collision")
                and parts[2] in SHAPES
            )
            if not (elsewhere or shape or (path, name) in known or "{" in path):
                unknown.add((path, name, file.name))
    assert unknown == set()


@pytest.mark.slow
@pytest.mark.parametrize("file", files(), ids=lambda f: f.stem)
def test_files_of_robots_cause_no_warning_about_omitted_elements(file: Path) -> None:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            parse_urdf(file.read_bytes(), str(file))
        except FormatError:
            pytest.skip("not a URDF")
    assert [w for w in caught if "parts of this file" in str(w.message)] == []
