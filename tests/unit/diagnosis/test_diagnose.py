"""`ulna info --check`: every check finds what it is for, names the line, and says nothing of a sound robot."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ulna
from ulna.cli import main
from ulna.diagnosis import Finding, diagnose, report
from ulna.errors import UnknownName
from ulna.geometry import Box, Geometry
from ulna.model import ModelBuilder, Revolute
from ulna.spatial import Inertia

SOUND = {
    "limit": '<limit lower="-1.5" upper="1.5" velocity="2" effort="10"/>',
    "kind": "revolute",
    "axis": "0 0 1",
    "mass": "1.0",
    "com": "0 0 0.1",
    "inertia": 'ixx="0.01" iyy="0.01" izz="0.005" ixy="0" ixz="0" iyz="0"',
    "geometry": '<box size="0.1 0.1 0.3"/>',
    "collision": '<box size="0.1 0.1 0.3"/>',
    "more": "",
}


def urdf(**changes: str) -> str:
    d = SOUND | changes
    return f"""<robot name="arm">
  <link name="base"/>
  <link name="arm">
    <inertial><origin xyz="{d["com"]}"/><mass value="{d["mass"]}"/><inertia {d["inertia"]}/></inertial>
    <visual><geometry>{d["geometry"]}</geometry></visual>
    <collision><geometry>{d["collision"]}</geometry></collision>
  </link>
  <joint name="turn" type="{d["kind"]}">
    <parent link="base"/><child link="arm"/><axis xyz="{d["axis"]}"/>{d["limit"]}
  </joint>{d["more"]}
</robot>"""


def found(**changes: str) -> dict[str, Finding]:
    return {f.kind: f for f in diagnose(urdf(**changes))}


def limit(lower: Any = -1.5, upper: Any = 1.5, velocity: Any = 2, effort: Any = 10) -> str:
    return f'<limit lower="{lower}" upper="{upper}" velocity="{velocity}" effort="{effort}"/>'


def moments(xx: float, yy: float, zz: float, xy: float = 0.0) -> str:
    return f'ixx="{xx}" iyy="{yy}" izz="{zz}" ixy="{xy}" ixz="0" iyz="0"'


def test_one_of_several_leaf_links_as_the_tool_is_noted() -> None:
    fork = '<link name="{0}"/><joint name="{0} joint" type="{1}"><parent link="arm"/><child link="{0}"/>{2}</joint>'
    text = urdf(more=fork.format("tip", "revolute", SOUND["limit"]) + fork.format("camera", "fixed", ""))
    assert diagnose(urdf(more=fork.format("tip", "fixed", "") + fork.format("camera", "fixed", ""))) == ()
    (note,) = (f for f in diagnose(text) if f.kind == "several-tools")
    assert (note.severity, note.kind, note.subject) == ("note", "several-tools", "tool 'tip'")
    assert "'camera'" in note.message and "tool=NAME" in note.advice
    assert ulna.load(text, tool="camera").tool == "camera"
    with pytest.raises(UnknownName, match="Did you mean 'camera'"):
        ulna.load(text, tool="camer")


def test_a_sound_robot_has_no_findings() -> None:
    assert diagnose(urdf()) == ()
    assert report(()) == "Nothing looks wrong."


@pytest.mark.parametrize(
    ("changes", "kind", "severity", "said"),
    [
        ({"limit": limit(-90, 90)}, "degrees", "warning", r"-90 to 90 rad look like degrees.*-1.571 to 1.571"),
        ({"limit": limit(-1e6, 1e6)}, "endless", "note", "stand for none"),
        ({"limit": limit(0, 500), "kind": "prismatic"}, "millimetres", "warning", "0 to 500 m look like millimetres"),
        ({"limit": limit(0.5, 0.5)}, "stuck", "warning", "lower = upper = 0.5"),
        ({"limit": limit(velocity=0)}, "no-velocity", "warning", "velocity limit is zero"),
        ({"limit": limit(effort=0)}, "no-effort", "warning", "effort limit is zero"),
        ({"limit": limit(velocity=180)}, "fast", "note", "180 rad/s; .* 3.142 rad/s"),
        ({"limit": limit("-1e10", "1e10"), "kind": "prismatic"}, "endless", "note", "m stand for none"),
        ({"limit": limit("-inf", "inf")}, "unlimited", "note", "no position limits"),
        ({"limit": limit(0.5, 1.0)}, "neutral-outside", "note", "outside its limits 0.5 to 1"),
        ({"mass": "0", "inertia": moments(0, 0, 0)}, "no-mass", "warning", "moves no mass"),
        ({"mass": "0"}, "inertia-without-mass", "warning", "and no mass"),
        ({"inertia": moments(0, 0, 0)}, "mass-without-inertia", "warning", "1 kg and no rotational inertia"),
        ({"inertia": moments(0.001, 0.001, 0.01)}, "triangle-inequality", "error",
         r"0.01 > 0.001 . 0.001. A solid box of its mass and size, .* m, has ixx=\".*\" iyy=\".*\" izz=\""),
        ({"inertia": moments(0.01, 0.01, 0.01, 0.02)}, "not-positive", "error", "not positive definite"),
        ({"inertia": moments(900, 900, 500)}, "inertia-large", "warning", "times m R"),
        ({"inertia": moments(1e-8, 1e-8, 5e-9)}, "inertia-small", "note", "nearly a point"),
        ({"com": "0 0 100"}, "com-outside", "warning", "outside its geometry"),
        ({"geometry": '<mesh filename="package://gone/a.stl"/>'}, "missing-mesh", "error", "visual mesh 'a.stl' is not"),
        ({"axis": "0 0 2"}, "reader", "warning", "the axis has length 2"),
        ({"limit": ""}, "refused", "error", "a revolute joint needs a <limit>"),
        ({"more": '<link name="arm"/>'}, "refused", "error", "cannot be loaded.*arm"),
        ({"more": '<link name="alone"/>'}, "refused", "error", "alone"),
        ({"more": '<link name="turn"/><joint name="j" type="fixed"><parent link="arm"/><child link="turn"/></joint>'},
         "shared-name", "note", "a link and a joint have this name"),
    ],
)  # fmt: skip
def test_each_check(changes: dict[str, str], kind: str, severity: str, said: str) -> None:
    finding = found(**changes)[kind]
    assert finding.severity == severity
    import re

    assert re.search(said, finding.message), finding.message
    assert finding.message in report([finding])


def test_limits_that_are_fine_are_not_doubted() -> None:
    two_turns = limit(-6.2832, 6.2832)
    assert "degrees" not in found(limit=two_turns)
    assert found(kind="continuous", limit='<limit velocity="2" effort="10"/>') == {}
    assert found(inertia=moments(0.005, 0.005, 0.01)) == {}  # a flat plate: equality
    assert found(inertia=moments(0.00499, 0.005, 0.01)) == {}  # and what rounding makes of it


def box_mesh(path: Path, scale: float = 1.0, dent: float = 0.0) -> None:
    """A box of 0.1 x 0.1 x 0.3 as an .obj; with a dent its top is pushed in."""
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * [0.05, 0.05, 0.15]
    corners = np.vstack([corners, [[0.0, 0.0, 0.15 - dent]]]) * scale
    faces = [
        (1, 2, 4), (1, 4, 3), (5, 7, 8), (5, 8, 6), (1, 5, 6), (1, 6, 2), (3, 4, 8), (3, 8, 7), (1, 3, 7), (1, 7, 5),
        (2, 6, 9), (6, 8, 9), (8, 4, 9), (4, 2, 9),
    ]  # fmt: skip
    lines = [f"v {x} {y} {z}" for x, y, z in corners] + [f"f {a} {b} {c}" for a, b, c in faces]
    path.write_text("\n".join(lines))


def test_meshes(tmp_path: Path) -> None:
    pytest.importorskip("trimesh")
    pytest.importorskip("scipy")
    box_mesh(tmp_path / "box.obj")
    box_mesh(tmp_path / "huge.obj", 1000.0)
    box_mesh(tmp_path / "dent.obj", dent=0.25)
    (tmp_path / "bad.stl").write_text("no mesh")
    file = tmp_path / "arm.urdf"

    def kinds(**meshes: str) -> dict[str, Finding]:
        file.write_text(urdf(**{role: f'<mesh filename="{name}"/>' for role, name in meshes.items()}))
        return {f.kind: f for f in diagnose(file)}

    assert kinds(geometry="box.obj", collision="box.obj") == {}
    huge = kinds(geometry="huge.obj")["huge-mesh"]
    assert "300 m large" in huge.message and 'scale="0.001 0.001 0.001"' in huge.advice and huge.line == 3
    dent = kinds(collision="dent.obj")["not-convex"]
    assert dent.severity == "note" and "72 % of its hull" in dent.message
    assert "not-convex" not in kinds(geometry="dent.obj")  # what is only seen may have any shape
    assert kinds(geometry="bad.stl")["bad-mesh"].severity == "error"
    assert kinds(geometry="gone.stl")["missing-mesh"].line == 3


def test_lines_of_the_file(tmp_path: Path) -> None:
    file = tmp_path / "arm.urdf"
    file.write_text(urdf(limit=limit(-90, 90), inertia=moments(0.001, 0.001, 0.01), axis="0 0 2"))
    findings = diagnose(file)
    assert [(f.severity, f.line) for f in findings] == [("error", 3), ("warning", 9), ("warning", 8)]
    file.write_text(urdf(limit=""))
    (refused,) = diagnose(file)
    assert refused.line == 8 and "cannot be loaded" in refused.message


def test_models_and_robots_are_diagnosed_too() -> None:
    robot = ulna.load(urdf(limit=limit(-90, 90)))
    assert [f.kind for f in diagnose(robot)] == ["degrees"]
    assert diagnose(robot.model) == diagnose(robot)
    with pytest.raises(UnknownName):
        diagnose("pandaa")


def test_many_of_a_kind_are_put_together() -> None:
    many = [Finding("note", "fast", f"joint 'j{k}'", "it is fast", "Look.") for k in range(20)]
    text = report([*many, Finding("error", "stuck", "joint 'x'", "it is stuck", "Free it.", 7)])
    lines = text.splitlines()
    assert lines[0] == "error: line 7: joint 'x': it is stuck."
    assert sum("it is fast" in line for line in lines) == 4
    assert "likewise 16 more: joint 'j4'" in text and ", ..." in text
    assert lines[-1] == "1 error, 20 notes."


def test_the_command_has_an_exit_status(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "arm.urdf"
    for text, status, said in [
        (urdf(), 0, "Nothing looks wrong."),
        (urdf(limit=limit(velocity=180)), 0, "1 note."),
        (
            urdf(limit=limit(-90, 90)),
            1,
            "warning: line 8: joint 'turn': limits -90 to 90 rad look like degrees",
        ),
        (urdf(inertia=moments(0.001, 0.001, 0.01)), 1, "error: line 3: link 'arm': its inertia violates"),
        (urdf(limit=""), 1, "cannot be loaded"),
    ]:
        file.write_text(text)
        assert main(["info", str(file), "--check"]) == status
        assert said in capsys.readouterr().out
    assert main(["info", str(file.with_name("gone.urdf")), "--check"]) == 1
    assert main(["info", "panda"]) == 0
    assert "panda_joint1" in capsys.readouterr().out


def test_meshes_in_other_folders_are_found(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("trimesh")
    (tmp_path / "packages" / "parts").mkdir(parents=True)
    (tmp_path / "robot").mkdir()
    box_mesh(tmp_path / "packages" / "parts" / "box.obj")
    file = tmp_path / "robot" / "arm.urdf"
    file.write_text(urdf(geometry='<mesh filename="package://parts/box.obj"/>'))
    assert main(["info", str(file), "--check"]) == 1
    assert "--package-dirs" in capsys.readouterr().out
    assert main(["info", str(file), "--check", "--package-dirs", str(tmp_path / "packages")]) == 0


@pytest.mark.slow
def test_robots_of_others_are_diagnosed() -> None:
    data = pytest.importorskip("ulna.robots.example_robot_data")
    if data.share_folder() is None:
        pytest.skip("example-robot-data is not installed")
    for name in (
        "ur5",
        "talos_arm",
        "hyq",
        "allegro_left_hand",
        "double_pendulum",
        "solo8",
        "romeo_laas_small",
    ):
        findings = diagnose(name)
        assert len(report(findings).splitlines()) < 40
    kinds = {f.kind for f in diagnose("hyq")}
    assert "triangle-inequality" in kinds


def test_a_moved_link_with_shapes_and_no_mass_is_named() -> None:
    builder = ModelBuilder("arm")
    builder.add_link("base")
    builder.add_link("upper", collisions=(Geometry("", Box((0.1, 0.1, 0.4))),))
    builder.add_link(
        "lower", Inertia.from_box(1.0, (0.1, 0.1, 0.4)), collisions=(Geometry("", Box((0.1, 0.1, 0.4))),)
    )
    builder.add_joint("shoulder", Revolute((0.0, 1.0, 0.0)), "base", "upper", lower=-1.0, upper=1.0)
    builder.add_joint("elbow", Revolute((0.0, 1.0, 0.0)), "upper", "lower", lower=-1.0, upper=1.0)
    (found,) = (f for f in diagnose(builder.build()) if f.kind == "shape-without-mass")
    assert (found.subject, found.severity) == ("link 'upper'", "warning") and "shape_inertias" in found.advice
