"""What is written into a page: frames to drag, sliders, motions, licences; and what is refused."""

from __future__ import annotations

import base64
import gzip
import json
import re
import subprocess
import sys
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ulna
from support.small_robots import arm, gripper
from ulna.errors import InputError, ModelWarning, NonFiniteError, ShapeError, UnknownName
from ulna.geometry import Box, Geometry, Mesh
from ulna.model import FreeFlyer, ModelBuilder, Revolute
from ulna.sim import Recording
from ulna.spatial import SE3, Inertia
from ulna.viewer.live.credits import credits_of
from ulna.viewer.live.draggable import draggable_frames

ROOT = Path(__file__).resolve().parents[4]


def described(path: Path) -> dict[str, Any]:
    """What a page says of its robot."""
    content = path.read_text(encoding="utf-8")
    return json.loads(re.findall(r"^ulnaRobot\(\"[^\"]*\",(.*)\);$", content, re.M)[0].replace("<\\/", "</"))


def two_arms(floating: bool = False) -> ulna.Robot:
    """A body with two arms of six joints and a head of two."""
    b = ModelBuilder("twin")
    b.add_link("body", Inertia.from_point(1.0))
    if floating:
        b.add_link("world")
        b.add_joint("base", FreeFlyer(), "world", "body")
    for name, count, side in (("left", 6, 0.2), ("right", 6, -0.2), ("head", 2, 0.0)):
        parent = "body"
        for k in range(count):
            link = f"{name}_link{k}"
            b.add_link(link, Inertia.from_point(0.1), [Geometry("", Box((0.04, 0.04, 0.1)))])
            axis = ((0, 0, 1), (0, 1, 0), (1, 0, 0))[k % 3]
            place = SE3.trans(0.0, side if k == 0 else 0.0, 0.15)
            b.add_joint(f"{name}_joint{k}", Revolute(axis), parent, link, place, lower=-2.0, upper=2.0)
            parent = link
    b.set_tool("right_link5")
    return ulna.Robot(b.build())


@pytest.fixture(scope="module")
def panda() -> ulna.Robot:
    return ulna.load("panda", visuals="simple")


def test_the_tool_of_an_arm_is_dragged_by_all_its_joints(panda: ulna.Robot) -> None:
    (frame,) = draggable_frames(panda.model)
    assert frame.frame.name == panda.tool and frame.joints == tuple(range(7)) and frame.turns


@pytest.mark.parametrize("floating", [False, True])
def test_both_hands_are_dragged_each_by_its_own_joints(floating: bool) -> None:
    robot = two_arms(floating)
    frames = draggable_frames(robot.model)
    assert [f.frame.name for f in frames] == ["right_link5", "left_link5"]  # the tool first
    for f in frames:
        side = f.frame.name.partition("_")[0]
        assert [robot.model.joints[j].name for j in f.joints] == [f"{side}_joint{k}" for k in range(6)]


def test_frames_that_share_joints_keep_them_where_few_are_left() -> None:
    model = two_arms().model
    tool, elbow = draggable_frames(model, ("right_link5", "right_link4"))
    assert [len(f.joints) for f in (tool, elbow)] == [6, 5]
    assert tool.turns and not elbow.turns and elbow.mask == "position"


def test_a_robot_with_few_joints_has_sliders_only() -> None:
    assert draggable_frames(gripper()) == ()


def test_frames_are_refused() -> None:
    model = two_arms().model
    with pytest.raises(UnknownName, match="right_link5"):
        draggable_frames(model, ("right_link_5",))
    for frames in ("right_link5", ("left_link5", "left_link5"), (3,)):
        with pytest.raises(InputError, match="different names of frames"):
            draggable_frames(model, frames)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="no joint with one coordinate moves"):
        draggable_frames(model, ("body",))


def test_a_page_holds_everything_and_names_no_address(panda: ulna.Robot, tmp_path: Path) -> None:
    page = panda.save_html(tmp_path / "panda.html", title='<Panda> & "friends"')
    content = page.read_text(encoding="utf-8")
    assert "<title>&lt;Panda&gt; &amp; &quot;friends&quot;</title>" in content
    head = content[: content.index("<script>")]
    assert not re.search(r"(src|href)=[\"'](?!data:)", head)
    assert content.count("<script>") == 1 and content.count("</script>") == 1
    data = described(page)
    assert data["title"] == '<Panda> & "friends"' and data["start"] == panda.configurations["qr"].tolist()
    code = zlib.decompress(base64.b64decode(data["wasm"]))
    assert code.startswith(b"\0asm") and len(zlib.compress(code)) < 20_000
    assert any("three.js" in c["title"] and "MIT" in c["licence"] for c in data["credits"])
    assert [s["hint"] for s in data["sliders"]][3].startswith("panda_joint4 (revolute z), -176")


def test_a_script_for_other_pages(panda: ulna.Robot, tmp_path: Path) -> None:
    script = panda.save_html(tmp_path / "panda.js").read_text(encoding="utf-8")
    assert 'customElements.define("ulna-robot"' in script and script.rstrip().endswith("});")


def test_sliders_have_limits_headings_and_places(tmp_path: Path) -> None:
    data = described(two_arms(floating=True).save_html(tmp_path / "twin.html", q=None))
    groups = {s["group"] for s in data["sliders"]}
    assert {"left: joint0 to joint5", "right: joint0 to joint5", "head: joint0 to joint1"} < groups
    base = [s for s in data["sliders"] if s["part"] >= 0]
    assert [s["part"] for s in base] == [0, 1, 2] and {s["index"] for s in base} == {3}
    arm_slider = next(s for s in data["sliders"] if s["group"].startswith("left"))
    assert (arm_slider["low"], arm_slider["high"], arm_slider["bounded"]) == (-2.0, 2.0, True)
    assert arm_slider["axis"] == [0, 0, 1] and data["links"][arm_slider["link"]] == "left_link0"
    assert data["quaternions"] == [3]


def test_mimic_joints_have_no_slider_and_slides_count_metres(tmp_path: Path) -> None:
    with pytest.warns(ModelWarning):
        data = described(ulna.Robot(arm()).save_html(tmp_path / "arm.html"))
    assert [s["angle"] for s in data["sliders"]] == [True, False, True, False] and data["joints"] == 4
    assert data["start"] == [1.0, 0.0, -0.5, 0.02]  # "home"


def rows(page: Path, nq: int) -> tuple[np.ndarray, np.ndarray]:
    motion = described(page)["motion"]
    numbers = np.frombuffer(zlib.decompress(base64.b64decode(motion["data"])), "<f8")
    return numbers[: motion["count"]], numbers[motion["count"] :].reshape(-1, nq)


def test_recordings_are_played_no_denser_than_a_screen(panda: ulna.Robot, tmp_path: Path) -> None:
    recording = Recording()
    for k in range(1001):
        recording.add(5.0 + 1e-3 * k, panda.neutral + 1e-3 * k)
    t, q = rows(panda.save_html(tmp_path / "run.html", recording), 7)
    assert t[0] == 0.0 and t[-1] == pytest.approx(1.0) and 60 <= len(t) <= 62 and np.diff(t).min() > 0
    assert np.allclose(q, panda.neutral + t[:, None])
    assert described(tmp_path / "run.html")["start"] == pytest.approx(panda.neutral)


def test_trajectories_and_rows_are_played(panda: ulna.Robot, tmp_path: Path) -> None:
    from ulna.trajectory import quintic

    start, end = panda.configurations["qr"], panda.configurations["ready"]
    way = quintic(start, end, 2.0)
    t, q = rows(panda.save_html(tmp_path / "way.html", way, q="qz"), 7)
    assert np.allclose(q, way.q(t)) and t[-1] == pytest.approx(2.0)
    assert described(tmp_path / "way.html")["start"] == panda.configurations["qz"].tolist()
    _, q = rows(panda.save_html(tmp_path / "rows.html", np.array([start, end])), 7)
    assert np.array_equal(q, [start, end])


@pytest.mark.parametrize(
    ("arguments", "error", "words"),
    [
        ({"path": "panda.txt"}, UnknownName, "No kind of page named '.txt'"),
        ({"path": 3}, InputError, "path of a page"),
        ({"theme": "drak"}, UnknownName, "dark"),
        ({"show": "visuals"}, UnknownName, "visual"),
        ({"q": [0.0] * 6}, ShapeError, r"\(7,\)"),
        ({"q": [np.nan] * 7}, NonFiniteError, "q"),
        ({"q": "redy"}, UnknownName, "ready"),
        ({"title": None, "live": "yes"}, InputError, "True or False"),
        ({"live": False, "frames": ("panda_hand",)}, InputError, "nothing is dragged"),
        ({"live": False, "path": "panda.js"}, UnknownName, "html"),
        ({"recorded": 3.0}, InputError, "Cannot play"),
        ({"recorded": np.zeros((3, 6))}, ShapeError, r"\(n, 7\)"),
        ({"recorded": np.zeros((1, 7))}, InputError, "1 configuration; expected two or more"),
        ({"recorded": np.zeros((5, 7))}, InputError, "rising times"),
    ],
)
def test_what_means_nothing_is_refused_and_nothing_written(
    panda: ulna.Robot, tmp_path: Path, arguments: dict[str, Any], error: type[Exception], words: str
) -> None:
    path = arguments.pop("path", "panda.html")
    with pytest.raises(error, match=words):
        panda.save_html(tmp_path / path if isinstance(path, str) else path, **arguments)
    assert not list(tmp_path.iterdir())


def test_a_motion_of_an_hour_is_refused(panda: ulna.Robot, tmp_path: Path) -> None:
    recording = Recording()
    recording.add(0.0, panda.neutral)
    recording.add(3600.0, panda.neutral)
    with pytest.raises(InputError, match="3600 s; expected at most 600 s"):
        panda.save_html(tmp_path / "long.html", recording)


def test_meshes_that_are_too_large_are_refused(
    panda: ulna.Robot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("ulna.viewer.live.page._MAX_MESH_SIZE", 100)
    with pytest.raises(InputError, match='show="collision" or show="skeleton"'):
        panda.save_html(tmp_path / "panda.html")


def test_a_page_without_kinematics_is_the_viewers(panda: ulna.Robot, tmp_path: Path) -> None:
    pytest.importorskip("viser")
    page = panda.save_html(tmp_path / "still.html", live=False, theme="dark")
    assert "ulna-robot" not in page.read_text(encoding="utf-8")


def test_licences_beside_meshes_are_named(tmp_path: Path) -> None:
    package = tmp_path / "arm_description"
    (package / "meshes").mkdir(parents=True)
    mesh = package / "meshes" / "base.stl"
    mesh.write_text("solid\nendsolid\n")
    robot = ulna.Robot(arm())
    shape = Geometry("g", Mesh(str(mesh)))
    b = ModelBuilder("one")
    b.add_link("base", Inertia.from_point(1.0), [shape])
    robot = ulna.Robot(b.build())
    assert "No licence was found" in credits_of(robot)[0]["text"]
    (package / "README.md").write_text("# Arm\nupstream: example.org/arm\nlicense: BSD-3-Clause\n")
    (credit,) = credits_of(robot)
    assert credit["title"] == "Meshes of arm_description"
    assert "BSD-3-Clause" in credit["text"] and "example.org/arm" in credit["text"]
    for name in ("COPYING", "LICENCE", "LICENSE.md", "LICENSE.txt", "LICENSE"):  # the later ones go first
        (package / name).write_text(f"Copyright the makers of the arm: {name}")
        assert credits_of(robot)[0]["licence"] == f"Copyright the makers of the arm: {name}"


def test_the_command_writes_a_page(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from ulna.cli import main

    page = tmp_path / "p.html"
    assert main(["show", "panda", "--live", str(page), "--show", "skeleton", "-q", "ready"]) == 0
    assert capsys.readouterr().out.strip() == str(page)
    assert described(page)["start"] == ulna.load("panda").configurations["ready"].tolist()
    assert main(["show", "panda", "--live", str(page), "--film", "f.mp4"]) == 2
    assert "expected no --film" in capsys.readouterr().err


def test_the_bundle_is_made_of_these_sources() -> None:
    script = ROOT / "scripts" / "live_page_bundle.py"
    code = f"import sys; sys.path.insert(0, {str(script.parent)!r}); import live_page_bundle as b; print(b.fingerprint())"
    made = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    ).stdout.strip()
    head = (ROOT / "src/ulna/viewer/live/bundle/ulna-live.min.js").read_text(encoding="utf-8")[:200]
    assert f"Sources: {made} " in head, "run python scripts/live_page_bundle.py"


@pytest.mark.slow
def test_the_bundle_is_what_npm_makes(tmp_path: Path) -> None:
    import shutil

    if shutil.which("npm") is None:
        pytest.skip("npm is not installed")
    reached = subprocess.run(
        ["npm", "view", "three@0.187.0", "version"], capture_output=True, text=True, timeout=600, check=False
    )
    if reached.returncode:
        pytest.skip("npm reaches no registry")
    script = ROOT / "scripts" / "live_page_bundle.py"
    done = subprocess.run(
        [sys.executable, str(script), "--check"], capture_output=True, text=True, timeout=600, check=False
    )
    assert done.returncode == 0, done.stderr


@pytest.mark.slow
@pytest.mark.parametrize(("name", "most"), [("panda", 300_000), ("ur5", 300_000), ("g1", 450_000)])
def test_pages_with_meshes_are_small(name: str, most: int, tmp_path: Path) -> None:
    robot = ulna.load(name)
    shapes = [g.shape for link in robot.model.links for g in link.visuals]
    assert any(isinstance(s, Mesh) and not s.missing for s in shapes), "the meshes are not installed"
    content = robot.save_html(tmp_path / "page.html").read_bytes()
    assert len(gzip.compress(content, 9, mtime=0)) <= most
    frames = described(tmp_path / "page.html")["frames"]
    assert len(frames) == (4 if name == "g1" else 1)  # both hands and both feet
