"""Warnings name the line of the program that called Ulna."""

from pathlib import Path

import pytest

import ulna
from ulna.errors import ModelWarning

MISSING = '<robot name="a"><link name="b"><visual><geometry><mesh filename="no.stl"/></geometry></visual></link></robot>'
IMPOSSIBLE = """<robot name="a"><link name="b"/><link name="c"><inertial><mass value="1"/>
<inertia ixx="1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="j" type="continuous"><parent link="b"/><child link="c"/></joint></robot>"""
SPRING = IMPOSSIBLE.replace('ixx="1"', 'ixx="0.1"').replace(
    "</joint>", '<dynamics spring_stiffness="3"/></joint>'
)


@pytest.mark.parametrize("text", [MISSING, IMPOSSIBLE, SPRING])
@pytest.mark.parametrize("how", ["text", "file", "model"])
def test_warnings_of_readers_name_the_line_of_the_caller(text: str, how: str, tmp_path: Path) -> None:
    file = tmp_path / "a.urdf"
    file.write_text(text)
    with pytest.warns(ModelWarning) as caught:
        if how == "model":
            ulna.Robot(ulna.loading.load_model(file))
        else:
            ulna.load(text if how == "text" else file)
    assert [w.filename for w in caught] == [__file__] * len(caught)
