"""Repairs of URDF files: inertias become possible, everything else stays."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import ulna
from ulna import Inertia
from ulna.cli import main
from ulna.diagnosis import diagnose, repair_inertias
from ulna.errors import FormatError, InputError, ModelWarning, UlnaError, UnknownName
from ulna.formats.urdf_repair import nearest_inertia
from ulna.identification import nearest_physical

BAD = """<?xml version="1.0"?>
<!-- of CAD -->
<robot name="bad">
  <link name="base"/>   <!-- a comment -->
  <link name="arm">
    <inertial><mass value="1"/><inertia ixx="1" iyy="0.1" izz="0.1" ixy="0.02" ixz="0" iyz="0"/></inertial>
  </link>
  <link name="tip">
    <inertial><mass value="2"/><inertia ixx="0.1" iyy="0.2" izz="0.25" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <joint name="a" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/></joint>
  <joint name="b" type="continuous"><parent link="arm"/><child link="tip"/><axis xyz="0 0 1"/></joint>
</robot>
"""


def test_inertias_become_possible_and_all_else_stays(tmp_path: Path) -> None:
    bad, good = tmp_path / "bad.urdf", tmp_path / "good.urdf"
    bad.write_text(BAD)
    assert [f.kind for f in diagnose(bad)] == ["triangle-inequality"]
    assert repair_inertias(bad, good) == ("arm",)
    assert (
        diagnose(good) == ()
        and "<!-- a comment -->" in good.read_text()
        and "<!-- of CAD -->" in good.read_text()
    )
    with pytest.warns(ModelWarning, match="'arm'"):
        before = ulna.load(BAD.partition("?>")[2]).model
    after = ulna.load(good).model
    assert after.link("tip").inertia == before.link("tip").inertia
    assert after.link("arm").inertia.mass == 1.0 and after.link("arm").inertia.is_physical()
    assert repair_inertias(good, good) == () and ulna.load(good).model == after


def test_the_nearest_inertia_is_that_of_the_pseudo_inertia() -> None:
    rng = np.random.default_rng(0)
    for _ in range(200):
        A = rng.normal(size=(3, 3))
        present = A @ A.T
        nearest = nearest_inertia(present)
        ten = [1e-9, 0, 0, 0, *(present[i, j] for i, j in ((0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2)))]
        expected = Inertia.from_parameters(nearest_physical(ten)).as_matrix()[3:, 3:]
        np.testing.assert_allclose(nearest, expected, atol=1e-5)
        a, b, c = np.linalg.eigvalsh(nearest)
        assert a > 0.0 and c <= a + b


def test_negative_inertias_become_zero_and_flat_bodies_stay(tmp_path: Path) -> None:
    """The nearest second moments to negative ones are zero; moments whose sum is rounded are those of a plate."""
    bad, good = tmp_path / "bad.urdf", tmp_path / "good.urdf"
    bad.write_text(
        BAD.replace('ixx="1" iyy="0.1" izz="0.1" ixy="0.02"', 'ixx="-1" iyy="-2" izz="-2" ixy="0"')
    )
    assert "not-positive" in [f.kind for f in diagnose(bad)]
    assert repair_inertias(bad, good) == ("arm",)
    assert "not-positive" not in [f.kind for f in diagnose(good)]
    np.testing.assert_array_equal(ulna.load(good).model.link("arm").inertia.inertia, np.zeros((3, 3)))
    plate = np.diag([0.7, 0.1, 0.7 + 0.1 + 1e-16])
    assert nearest_inertia(plate) is plate


def test_links_are_named_once_and_arguments_are_checked(tmp_path: Path) -> None:
    file, good = tmp_path / "flat.urdf", tmp_path / "good.urdf"
    shape = '<collision><geometry><box size="1 1 1e-9"/></geometry></collision>'
    file.write_text(f'<robot name="a"><link name="l">{shape}</link></robot>')
    assert repair_inertias(file, good, ["l", "l"], density=1e9) == ("l",)
    for links in (None, 5, "l", [["l"]]):
        with pytest.raises(InputError, match="`links` is .*; expected names in a list"):
            repair_inertias(file, good, links)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="`path` is None"):
        repair_inertias(None, good)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="`output` is 3"):
        repair_inertias(file, 3)  # type: ignore[arg-type]


def test_the_command_repairs_and_lists_the_rest(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    bad, good = tmp_path / "bad.urdf", tmp_path / "good.urdf"
    bad.write_text(BAD.replace('type="continuous"', 'type="fixed"', 1))
    assert main(["info", str(bad), "--repair", str(good)]) == 0
    assert f"{good}: arm repaired" in capsys.readouterr().out and good.exists()


def test_what_cannot_be_repaired_is_refused(tmp_path: Path) -> None:
    bad = tmp_path / "bad.urdf"
    bad.write_text(BAD.replace("</robot>", ""))
    with pytest.raises(FormatError, match="well-formed"):
        repair_inertias(bad, tmp_path / "good.urdf")
    with pytest.raises(FormatError, match="no such file"):
        repair_inertias(tmp_path / "absent.urdf", tmp_path / "good.urdf")
    with pytest.raises(UnknownName, match=r"\.xacro"):
        repair_inertias(tmp_path / "arm.xacro", tmp_path / "good.urdf")
    bad.write_text(BAD)
    with pytest.raises(InputError, match="Cannot write"):
        repair_inertias(bad, tmp_path / "no folder" / "good.urdf")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["bad.urdf"]


@pytest.mark.parametrize(
    "wrong", [np.full(10, np.nan), np.ones(10) * 1j, np.ma.array(np.ones(10), mask=True), ["a"] * 10]
)
def test_parameters_that_are_no_numbers_are_refused(wrong) -> None:
    with pytest.raises(UlnaError, match="`parameters"):
        nearest_physical(wrong)
