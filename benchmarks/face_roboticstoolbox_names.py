"""Which public names of the Robotics Toolbox's arm part the face offers: a table for the docs.

Run: python benchmarks/face_roboticstoolbox_names.py [--check]

`--check` compares with what docs/robotics_toolbox.md says, and exits with 1 where they differ.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

from ulna.faces.shelves import environment

PAGE = Path(__file__).parents[1] / "docs" / "robotics_toolbox.md"
MARKS = ("<!-- names -->", "<!-- end of names -->")
CLASSES = (
    "Robot", "Robot2", "DHRobot", "PoERobot", "Link", "Link2", "DHLink", "ET", "ET2", "ETS", "ETS2", "Gripper",
    "IKSolution", "IK_LM",
)  # fmt: skip

ASK = """
import inspect, json, sys, warnings
warnings.simplefilter("ignore")
import roboticstoolbox as rtb
told = json.loads(sys.argv[1])
made = {}
examples = {
    "Robot": rtb.models.Panda, "DHRobot": rtb.models.DH.Puma560, "Robot2": rtb.models.ETS.Planar2,
    "PoERobot": lambda: rtb.PoERobot([rtb.PoERevolute([0, 0, 1], [0, 0, 0])], rtb.models.Panda().base),
    "Gripper": lambda: rtb.models.Panda().grippers[0], "Link": lambda: rtb.models.Panda().links[1],
    "Link2": lambda: rtb.models.ETS.Planar2().links[1], "DHLink": lambda: rtb.models.DH.Puma560().links[1],
    "ET": rtb.ET.Rz, "ET2": rtb.ET2.R, "ETS": lambda: rtb.ETS([rtb.ET.Rz()]), "ETS2": lambda: rtb.ETS2([rtb.ET2.R()]),
    "IK_LM": rtb.IK_LM, "IKSolution": lambda: rtb.IKSolution([0.0], True),
}
out = {"roboticstoolbox": [n for n in (told or {}).get("roboticstoolbox", getattr(rtb, "__all__", [])) if hasattr(rtb, n)]}
for kind in CLASSES:
    base = getattr(rtb, kind)
    thing = examples[kind]()
    names = told[kind] if told else sorted(n for n in dir(base) if not n.startswith("_"))
    def there(n):
        try:
            return inspect.getattr_static(type(thing), n, None) is not None or hasattr(base, n) or hasattr(thing, n)
        except Exception:
            return True
    out[kind] = [n for n in names if there(n)]
for room in ("DH", "ETS", "URDF"):
    module = getattr(rtb.models, room)
    names = told[f"models.{room}"] if told else sorted(module.__all__)
    out[f"models.{room}"] = [n for n in names if hasattr(module, n)]
print(json.dumps(out))
"""


def _asked(env: dict[str, str], told: dict[str, list[str]] | None) -> dict[str, list[str]]:
    code = f"CLASSES = {CLASSES!r}\n{ASK}"
    command = [sys.executable, "-c", code, json.dumps(told)]
    return json.loads(subprocess.run(command, env=env, capture_output=True, text=True, check=True).stdout)


def _arm(names: list[str]) -> list[str]:
    """The names of the package that are about arms: what the face does not refuse as mobile robots."""
    import importlib.util

    from ulna.faces.shelves import SHELVES

    place = SHELVES["roboticstoolbox"] / "roboticstoolbox" / "__init__.py"
    spec = importlib.util.spec_from_file_location("face", place)
    assert spec is not None and spec.loader is not None
    face = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(face)
    return sorted({n for n in names if n not in face._MOBILE})


def lines() -> str:
    """The table."""
    theirs = _asked(dict(os.environ), None)
    theirs["roboticstoolbox"] = _arm(theirs["roboticstoolbox"])
    ours = _asked(environment(["roboticstoolbox"]), theirs)
    rows = ["| of | names | offered | not offered |", "|---|---|---|---|"]
    whole, there = 0, 0
    for of, names in theirs.items():
        missing = [n for n in names if n not in ours[of]]
        whole, there = whole + len(names), there + len(names) - len(missing)
        listed = ", ".join(f"`{n}`" for n in missing)
        rows.append(f"| `{of}` | {len(names)} | {len(names) - len(missing)} | {listed} |")
    rows.append(f"| all | {whole} | {there} ({100 * there / whole:.0f} %) | |")
    return "\n".join(rows)


def main() -> int:
    """Prints the table, or checks the docs."""
    found = lines()
    if "--check" not in sys.argv:
        print(found)
        return 0
    said = PAGE.read_text(encoding="utf-8").split(MARKS[0])[1].split(MARKS[1])[0].strip()
    if said != found:
        print(f"{PAGE.name} is out of date; expected:\n{found}")
        return 1
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
