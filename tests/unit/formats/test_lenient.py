"""Files that other readers load although they are odd: they load here, too, with a warning that names what is odd."""

from __future__ import annotations

import warnings

import pytest

import ulna
from ulna.errors import FormatError, ModelWarning
from ulna.formats.markup import root_tag
from ulna.formats.prolog import prolog_of, with_plain_declaration

ROBOT = '<robot name="r"><link name="a">{}</link><link name="b"/>{}</robot>'
JOINT = '<joint name="j" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint>'


def robot(inside: str = "") -> str:
    return ROBOT.format(inside, JOINT)


@pytest.mark.parametrize(
    ("declaration", "said"),
    [
        ('<?xml version="0.0"?>', r"version '0\.0'"),
        ('<?xml version="2.0"?>', r"version '2\.0'"),
        ("<?xml version=1.0?>", "is not written as one"),
        ("<?xml ?>", "version ''"),
        ('\n\n <?xml version="1.0"?>', "does not begin the file"),
        ('<!-- made by a tool --><?xml version="1.0"?>', "does not begin the file"),
        ('<?xml version="1.0"?>\n<?xml version="1.0"?>', "2 XML declarations"),
    ],
)
def test_odd_declarations_are_read_as_version_1(declaration: str, said: str, tmp_path) -> None:
    file = tmp_path / "r.urdf"
    file.write_text(declaration + robot())
    with pytest.warns(ModelWarning, match=said) as warned:
        assert ulna.load(file).model.joint_names == ("j",)
    assert str(file) in str(warned[0].message)
    lines = declaration.count("\n") + 1
    file.write_text(declaration + robot('<visual><geometry><box size="a b c"/></geometry></visual>'))
    with pytest.warns(ModelWarning), pytest.raises(FormatError) as refused:
        ulna.load(file)
    assert refused.value.line == lines  # lines keep their numbers


@pytest.mark.parametrize(
    "declaration",
    ['<?xml version="1.0"?>', "<?xml version='1.1' encoding='utf-8' standalone='yes' ?>", "", "\ufeff"],
)
def test_sound_declarations_stay_and_do_not_warn(declaration: str, tmp_path) -> None:
    (tmp_path / "r.urdf").write_text(declaration + robot(), encoding="utf-8")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert ulna.load(tmp_path / "r.urdf").model.nq == 1
    data = (declaration + robot()).encode()
    assert with_plain_declaration(data) == (data, "")


def test_the_encoding_of_a_misplaced_declaration_counts(tmp_path) -> None:
    (tmp_path / "r.urdf").write_bytes(
        ("\n<?xml version='1.0' encoding='ISO-8859-1'?>" + robot()).replace('"a"', '"ä"').encode("latin-1")
    )
    with pytest.warns(ModelWarning, match="does not begin"):
        assert ulna.load(tmp_path / "r.urdf").model.links[0].name == "ä"


@pytest.mark.parametrize("tag", ["visual", "collision"])
@pytest.mark.parametrize(
    ("geometry", "said"),
    [
        ("<geometry/>", "<geometry> is empty"),
        ('<geometry><mesh filename="a.stl" scale="1 2 3 4"/></geometry>', "does not hold 3 numbers but 4"),
        ('<geometry><mesh filename="a.stl" scale="2"/></geometry>', "does not hold 3 numbers but 1"),
    ],
)
def test_bodies_that_others_leave_out_are_left_out(tag: str, geometry: str, said: str) -> None:
    other = f'<{tag}><geometry><box size="1 1 1"/></geometry></{tag}>'
    with pytest.warns(ModelWarning, match=f"{said}.*the <{tag}> is left out"):
        model = ulna.load(robot(f"<{tag}>{geometry}</{tag}>{other}")).model
    link = model.links[0]
    assert [len(link.visuals), len(link.collisions)] == ([1, 0] if tag == "visual" else [0, 1])


def test_the_root_element_is_found_behind_everything_that_may_come_before() -> None:
    assert root_tag("<!-- <robot> --><?pi <a> ?><!DOCTYPE x><mujoco/>") == "mujoco"
    assert root_tag("<!-- <robot>") == root_tag("") == root_tag("a < b") == ""
    assert prolog_of(b'<!DOCTYPE r [<!ENTITY a "<b/>">]><r/>').document_type.startswith(
        b"<!DOCTYPE r [<!ENTITY"
    )
    assert prolog_of(b"<r/><!DOCTYPE r>").document_type == b""
