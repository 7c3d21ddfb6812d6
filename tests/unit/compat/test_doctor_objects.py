"""The doctor follows what names of a script hold: attributes and keywords of objects that are not offered are found."""

from __future__ import annotations

import ast
from pathlib import Path
from typing import Any

import pytest

from ulna.compat import doctor, packages
from ulna.compat.members import missing_keywords, offered_member, refused
from ulna.compat.script_names import expressions

LIBRARY = '''
from __future__ import annotations
from typing import Any, Self
import numpy as np

class Leg:
    length = 3
    def __init__(self, size: float = 1.0) -> None:
        self.size = size

class Arm:
    def __init__(self) -> None:
        for name in ("home", "rest"):
            setattr(self, name, 0)
    @property
    def leg(self) -> Leg: return Leg()
    def copy(self) -> Self: return self
    def solve(self, q: Any, *, tol: float = 0.1) -> Leg: return Leg()
    def matrix(self) -> np.ndarray: return np.eye(2)
    def anything(self) -> Any: return None
    def plot(self, **options: Any) -> None: ...
    def light(self) -> None:
        """Not offered."""
        raise NotImplementedError("Use the theme.")
    def __getattr__(self, name: str) -> Any:
        raise AttributeError(f"No {name}; use a leg.")

def make() -> Arm: return Arm()
'''


@pytest.fixture
def examined(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    """A function that examines a script of a library, and returns findings by name."""
    import sys

    package = tmp_path / "for-legs" / "legs"
    package.mkdir(parents=True)
    (package / "__init__.py").write_text(LIBRARY)
    monkeypatch.setattr(packages, "FOLDERS", {"legs": package.parent})
    monkeypatch.setattr(doctor, "FOLDERS", {"legs": package.parent})
    monkeypatch.setattr(sys, "path", list(sys.path))
    sys.modules.pop("legs", None)

    def examine(text: str) -> dict[str, Any]:
        script = tmp_path / "script.py"
        script.write_text("import legs, numpy as np\n" + text)
        return {one.name: one for one in doctor.examine(script)}

    yield examine
    sys.modules.pop("legs", None)


def _missing(found: dict[str, Any]) -> set[str]:
    return {name for name, one in found.items() if one.offered is False}


@pytest.mark.parametrize(
    ("text", "missing"),
    [
        ("arm = legs.Arm()\narm.leg.size, arm.home, arm.rest", set()),
        ("arm = legs.Arm()\narm.wheel", {"legs.Arm.wheel"}),
        ("arm = legs.make()\narm.wheel", {"legs.Arm.wheel"}),
        ("arm = legs.make().copy()\narm.leg.toe", {"legs.Leg.toe"}),
        ("legs.Arm().light()", {"legs.Arm.light"}),
        ("arm = legs.Arm()\nleg = arm.solve(0, tol=1, speed=2)\nleg.toe", {"legs.Arm.solve(speed=)", "legs.Leg.toe"}),
        ("legs.Leg(size=2, color=3)\nlegs.Arm().plot(anything=1)", {"legs.Leg(color=)"}),
        ("def f():\n    arm = legs.Arm()\n    return arm.wheel", {"legs.Arm.wheel"}),
        ("arm = legs.Arm()\ndef f(arm):\n    return arm.wheel", set()),
        ("arm = legs.Arm()\narm.wheel = 3\narm.wheel", set()),
        ("arm = legs.Arm()\narm.addconfiguration_attr('up', 0)\narm.up", {"legs.Arm.addconfiguration_attr"}),
        ("thing = legs.Arm()\nthing = legs.Leg()\nthing.size\nthing.toe", {"legs.Arm.toe"}),
        ("def f(arm: legs.Arm, q: np.ndarray):\n    return arm.wheel, q.T", {"legs.Arm.wheel"}),
        ("arm: legs.Arm = get()\nleg: legs.Leg\nleg.toe", {"legs.Leg.toe"}),
        ("m = legs.Arm().matrix()\nm.anything_at_all", set()),
    ],
)  # fmt: skip
def test_attributes_and_keywords_of_objects(examined: Any, text: str, missing: set[str]) -> None:
    assert _missing(examined(text)) == missing


def test_the_report_gives_hints_and_says_what_was_not_examined(examined: Any) -> None:
    found = examined(
        "arm = legs.Arm()\narm.wheel\nx = arm.anything()\nx.y\nfor a in [arm]:\n    a.wheel\nn = np.eye(3)\nn.T"
    )
    assert found["legs.Arm.wheel"].line == 3 and "use a leg" in found["legs.Arm.wheel"].hint
    assert {name for name, one in found.items() if one.offered is None} == {"x", "a"}
    text = doctor.report("script.py", list(found.values()))
    assert "line 3: legs.Arm.wheel is not offered. No wheel; use a leg." in text
    assert "Not examined" in text and "x (line 5), a (line 7)" in text


def test_methods_that_only_raise_are_refused(examined: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(packages.FOLDERS["legs"])
    import legs  # pyright: ignore[reportMissingImports]

    assert refused(legs.Arm.light) == "Use the theme." and refused(legs.Arm.copy) is None
    assert offered_member(legs.Leg, "size") == (True, "") and not offered_member(legs.Leg, "toe")[0]
    assert missing_keywords(legs.Arm.solve, ["tol", "nonsense"]) == ["nonsense"]
    assert missing_keywords(legs.Arm.plot, ["nonsense"]) == [] == missing_keywords(3, ["nonsense"])


def test_names_are_found_in_the_innermost_scope() -> None:
    tree = ast.parse("a = 1\ndef f(b):\n    a = 2\n    return a.x, b.x, [c.x for c in b], d.x\n")
    scopes = {node.value.id: scope for node, scope in expressions(tree) if isinstance(node, ast.Attribute)}
    assert scopes["a"].find("a")[1][0].value == 2 and scopes["b"].find("b")[1] == [None]
    assert scopes["c"].find("c")[1] == [None] and scopes["d"].find("d") is None


def test_loaded_libraries_are_not_examined_in_place_of_the_packages(tmp_path: Path) -> None:
    toolbox = pytest.importorskip("roboticstoolbox")
    script = tmp_path / "lab.py"
    script.write_text("import roboticstoolbox as rtb\np = rtb.models.DH.Puma560()\np.pay\n")
    for _ in range(2):
        assert "roboticstoolbox.Puma560.pay" in _missing({f.name: f for f in doctor.examine(script)})
        import roboticstoolbox

        assert roboticstoolbox is toolbox


def test_scripts_of_the_toolbox(tmp_path: Path) -> None:
    pytest.importorskip("spatialmath")
    script = tmp_path / "lab.py"
    script.write_text(
        "import roboticstoolbox as rtb, swift\nenv = swift.Swift()\nenv.launch(realtime=True)\nenv.set_lights([])\n"
        "p = rtb.models.DH.Puma560()\np.pay\np.fkinee(p.qz)\np.fkine(p.qn, nonsense=1)\nenv.add(p, wrong=2)\n"
    )
    found = {one.name: one for one in doctor.examine(script)}
    assert _missing(found) == {
        "swift.Swift.set_lights", "roboticstoolbox.Puma560.pay", "roboticstoolbox.Puma560.fkinee",
        "roboticstoolbox.Puma560.fkine(nonsense=)", "swift.Swift.add(wrong=)",
    }  # fmt: skip
    assert "payload" in found["roboticstoolbox.Puma560.pay"].hint


def test_keywords_that_a_class_passes_to_its_base_class(tmp_path: Path) -> None:
    pytest.importorskip("spatialmath")
    script = tmp_path / "lab.py"
    script.write_text(
        "import roboticstoolbox as rtb, spatialgeometry as sg\n"
        "link = rtb.RevoluteDH(zzz=1, a=0.1, m=2, qlim=[0, 1], name='one')\n"
        "rtb.DHRobot([link], nme='x', gravity=[0, 0, 1])\nrtb.IK_LM(foo=1, verbose=True)\n"
        "sg.Cuboid([1, 1, 1], colour='red', pose=None)\nrtb.models.DH.Puma560(symbolic=True)\n"
    )
    assert _missing({one.name: one for one in doctor.examine(script)}) == {
        "roboticstoolbox.RevoluteDH(zzz=)", "roboticstoolbox.DHRobot(nme=)", "roboticstoolbox.IK_LM(foo=)",
        "spatialgeometry.Cuboid(colour=)",
    }  # fmt: skip


def test_attributes_that_only_some_trajectories_have(tmp_path: Path) -> None:
    pytest.importorskip("spatialmath")
    script = tmp_path / "lab.py"
    script.write_text(
        "import roboticstoolbox as rtb\nm = rtb.mstraj(rtb.via, 0.1, 0.2, qdmax=1)\nm.arrive, m.info, m.via, m.duration\n"
        "rtb.trapezoidal(0, 1, 5).tblend\n"
    )
    missing = _missing({one.name: one for one in doctor.examine(script)})
    assert missing == {"roboticstoolbox.via", "roboticstoolbox.Trajectory.duration"}


def test_modules_that_are_not_offered(tmp_path: Path) -> None:
    pytest.importorskip("spatialmath")
    script = tmp_path / "lab.py"
    script.write_text(
        "import swift.phys\nimport roboticstoolbox.mobile.drivers as d\nimport swift.Elements\n"
    )
    found = {one.name: one for one in doctor.examine(script)}
    assert _missing(found) == {"swift.phys", "roboticstoolbox.mobile.drivers"}
    assert (
        "env.step" in found["swift.phys"].hint
        and "for robot arms" in found["roboticstoolbox.mobile.drivers"].hint
    )


def test_what_is_not_known_is_named_once_whatever_it_is_taken_from(tmp_path: Path) -> None:
    pytest.importorskip("spatialmath")
    script = tmp_path / "lab.py"
    script.write_text(
        "import numpy as np, roboticstoolbox as rtb\np = rtb.models.DH.Puma560()\np.links[0].foo()\n"
        "d = {'arm': p}\nd['arm'].bar\nT = p.fkine(p.qn)\nT.t.max().x.y\nnp.eye(4).T.z\n"
    )
    unknown = [one.name for one in doctor.examine(script) if one.offered is None]
    assert unknown == ["p.links[0]", "d['arm']", "T"]
