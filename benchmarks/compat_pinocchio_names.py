"""Which public names of Pinocchio 4.1 the package offers, which of them tests ask of both, and what it says of the others.

Run: python benchmarks/compat_pinocchio_names.py [--check | --write]

`--write` writes docs/pinocchio_names.md; `--check` compares it, and exits with 1 where it differs. A name counts as
asked when a script that the tests run on both packages (*asked*.py in tests/compat/pinocchio and seed1) holds `pin.name`; a
member of a class, when such a script holds `.member`.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from _pair import environments

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "pinocchio_names.md"
SCRIPTS = sorted(
    p for folder in ("pinocchio", "seed1") for p in (ROOT / "tests" / "compat" / folder).glob("*asked*.py")
)

GROUPS = (
    ("constraints and contacts", r".*([Cc]onstraint|Delassus|KKT|Cone$|Prox|PGS|ADMM|Baumgarte|FrictionCoeff|Cholesky(Dec|Exp))"
     r".*|ContactType|lcaba|contactInverse.*|forwardDynamics|impulseDynamics|computeImpulse.*|BoxSet|Lanczos.*|Tridiag.*"
     r"|AUTOMATIC|MANUAL|CONSTANT|LINEAR|OSQP|SPECTRAL|computeJointMinimalOrdering"),
    ("MJCF and SDF", r".*(MJCF|Sdf).*"),
    ("package and binding", r".*VERSION|WITH_.*|checkVersion.*|printVersion|.*type_index|map_indexing.*|module_info|submodules"
     r"|pin|pinocchio_pywrap.*|sys|numpy|inspect|Deprecated.*|deprecated|Exception|LogLevel|ScalarType|sharedMemory|omp_.*"),
    ("joints", r"Joint(Model|Data).*|StdVec_Joint.*"),
    ("wrapper and viewers", r"RobotWrapper|robot_wrapper|shortcuts|utils|createDatas|buildModelsFromUrdf|.*Visualizer"),
    ("Lie", r"squaredDistance|(exp|log|Jexp|Jlog|Hlog)\d?(_quat)?|explog|lie.*|LieGroup|.*angentMap.*|getTangentTo.*|(d?(I|i)ntegrate|d?(D|d)ifference"
     r"|neutral|normalize|interpolate|distance|squaredDistance|randomConfiguration|isNormalized|isSameConf.*|dIntegrateTransport)"),
    ("geometry", r".*(Geom|Colli|Distance[A-Z]?|BroadPhase|MeshLoader|Physics|computeContactPatch|BodyRadius|Contact).*|coal|hppfcl"
     r"|ICE|METAL|WOOD|PLASTIC|CONCRETE|VISUAL|COLLISION|computeDistances?"),
    ("spatial", r"SE3.*|Motion|Force|Inertia|Symmetric3|PseudoInertia|LogChol.*|Quaternion|AngleAxis|XYZQUATToSE3|rpy|skew.*"
     r"|unSkew|classicAcc.*|[XYZ]Axis|StdVec_(SE3|Motion|Force|Inertia|Symmetric3|Matrix.*|Vec.*)|linalg|ortho.*|isOrtho.*"),
    ("model", r"Model|Data|Frame(Type)?|build.*|append.*|load.*|remove.*|transform.*|graph|serialization|StdMap.*|StdVec.*"
     r"|FIXED_JOINT|JOINT|BODY|OP_FRAME|SENSOR|seed|findCommon.*"),
    ("algorithms", r".*"),
)  # fmt: skip
CHIEF = (
    "SE3", "Motion", "Force", "Inertia", "Symmetric3", "PseudoInertia", "LogCholeskyParameters", "Quaternion", "AngleAxis",
    "Model", "Data", "Frame", "JointModel", "JointModelComposite", "JointModelRevoluteUnaligned", "JointModelUniversal",
    "JointData", "LieGroup", "GeometryModel", "GeometryData", "GeometryObject", "ModelPool", "RobotWrapper", "StdVec_SE3",
    "utils", "rpy", "cholesky", "linalg", "liegroups", "serialization", "GepettoVisualizer", "MeshcatVisualizer",
    "ViserVisualizer",
)  # fmt: skip

ASK = """
import json, sys, types
import numpy as np
import pinocchio as pin
seen = dir(pin)
import pinocchio.visualize
told = json.loads(sys.argv[1])
def public(thing):
    return sorted(n for n in dir(thing) if not n.startswith("_") and not isinstance(getattr(thing, n, None), types.ModuleType))
def of(name):
    return getattr(pin, name, None) or getattr(pin.visualize, name)
def example(name):
    m = pin.buildSampleModelManipulator()
    g = pin.buildSampleGeometryModelManipulator(m)
    made = {"Model": lambda: m, "Data": m.createData, "Frame": lambda: m.frames[1], "GeometryModel": lambda: g,
            "GeometryData": g.createData, "GeometryObject": lambda: g.geometryObjects[0], "AngleAxis": pin.AngleAxis,
            "JointModel": lambda: m.joints[1], "JointModelComposite": pin.JointModelComposite, "RobotWrapper": lambda: pin.RobotWrapper(m),
            "JointModelUniversal": lambda: pin.JointModelUniversal(1, 0, 0, 0, 1, 0), "JointData": lambda: m.joints[1].createData(),
            "JointModelRevoluteUnaligned": lambda: pin.JointModelRevoluteUnaligned(1, 0, 0), "StdVec_SE3": pin.StdVec_SE3}
    return made[name]() if name in made else of(name)
def there(n):
    try:
        return getattr(pin, n) is not None
    except AttributeError as error:
        return str(error).partition(". ")[2]
if told is None:
    names = [n for n in seen if not n.startswith("_")]
    members = {c: public(of(c)) for c in CHIEF}
else:
    names = {n: there(n) for n in told["names"]}
    members = {c: [n for n in told["members"][c] if n in dir(example(c)) or hasattr(example(c), n)] for c in CHIEF}
print(json.dumps({"names": names, "members": members}))
"""


def _asked(env: dict[str, str], told: object) -> dict[str, object]:
    command = [sys.executable, "-c", f"CHIEF = {CHIEF!r}\n{ASK}", json.dumps(told)]
    done = subprocess.run(command, env=env, capture_output=True, text=True, check=False)
    if done.returncode:
        raise SystemExit(done.stderr)
    return json.loads(done.stdout)


def _listed(names: list[str]) -> str:
    return ", ".join(f"`{n}`" for n in names)


def lines() -> str:
    """The page."""
    faced, plain = environments("pinocchio")
    theirs = _asked(plain, None)
    ours = _asked(faced, theirs)
    text = "\n".join(script.read_text(encoding="utf-8") for script in SCRIPTS)
    asked = set(re.findall(r"\bpin\.(\w+)", text))
    dotted = set(re.findall(r"\.(\w+)", text))
    group_of = {n: next(g for g, p in GROUPS if re.fullmatch(p, n)) for n in theirs["names"]}
    said = ours["names"]
    out = [HEAD, "| group | names | offered | | asked of both |", "|---|---|---|---|---|"]
    ordered = sorted({g for g, _ in GROUPS}, key=lambda g: (g in ASIDE, g))
    for title, groups in [*((g, (g,)) for g in ordered), *TOTALS]:
        names = [n for n in said if not groups or group_of[n] in groups]
        there = [n for n in names if said[n] is True]
        share = f"{100 * len(there) / len(names):.0f} %"
        out.append(f"| {title} | {len(names)} | {len(there)} | {share} | {sum(n in asked for n in there)} |")
    out += [
        "",
        "## Members",
        "",
        MEMBERS,
        "| of | members | offered | asked of both | not offered |",
        "|---|---|---|---|---|",
    ]
    whole = [0, 0, 0]
    for kind, members in theirs["members"].items():
        there = ours["members"][kind]
        counts = [len(members), len(there), sum(n in dotted for n in there)]
        whole = [a + b for a, b in zip(whole, counts, strict=True)]
        missing = _listed([n for n in members if n not in there])
        out.append(f"| `{kind}` | {counts[0]} | {counts[1]} | {counts[2]} | {missing} |")
    out.append(f"| all | {whole[0]} | {whole[1]} ({100 * whole[1] / whole[0]:.0f} %) | {whole[2]} | |")
    out += _overloads()
    for group in ordered:
        names = [n for n in said if group_of[n] == group]
        out += ["", f"## {group[0].upper()}{group[1:]}", ""]
        for title, chosen in (
            ("Offered, and asked of both", [n for n in names if said[n] is True and n in asked]),
            ("Offered", [n for n in names if said[n] is True and n not in asked]),
        ):
            if chosen:
                out += [f"{title}: {_listed(chosen)}", ""]
        refused: dict[str, list[str]] = {}
        for n in (n for n in names if said[n] is not True):
            refused.setdefault(said[n], []).append(n)
        if refused:
            out += ["| not offered | what the package says |", "|---|---|"]
            out += [f"| {_listed(chosen)} | {word} |" for word, chosen in refused.items()]
            out.append("")
        out.pop()
    return "\n".join(out) + "\n"


def _overloads() -> list[str]:
    """How many overloads there are, with how many names of arguments, and how many calls are generated of them."""
    folder = ROOT / "tests" / "compat" / "pinocchio"
    sys.path.insert(0, str(folder))
    from differential import group_of
    from generated_calls import calls

    _, plain = environments("pinocchio")
    with tempfile.TemporaryDirectory() as out:
        target = Path(out) / "overloads.json"
        subprocess.run([sys.executable, str(folder / "overloads.py"), str(target)], env=plain, check=True)
        found: dict[str, list[list[list[str | None]]]] = json.loads(target.read_text(encoding="utf-8"))
    counts: dict[str, list[int]] = {}
    for path, ways in found.items():
        names = {str(name) for way in ways for name, *_ in way if not re.fullmatch(r"arg\d+|self", str(name))}
        made = sum(1 for _ in calls({path: ways}))
        row = counts.setdefault(group_of(path), [0, 0, 0, 0, 0])
        for k, number in enumerate((1, len(ways), len(names), made, made > 0)):
            row[k] += number
    rows = [(group, *row) for group, row in sorted(counts.items())]
    rows.append(("all", *(sum(row[k] for row in counts.values()) for k in range(5))))
    head = [
        "| of | functions | overloads | names of arguments | generated calls | of so many functions |",
        "|---|---|---|---|---|---|",
    ]
    return [
        "",
        "## Overloads",
        "",
        OVERLOADS,
        *head,
        *("| " + " | ".join(map(str, row)) + " |" for row in rows),
    ]


ASIDE = ("constraints and contacts", "MJCF and SDF", "package and binding")
TOTALS = (
    ("all but the three above", tuple(g for g, _ in GROUPS if g not in ASIDE)),
    ("all", ()),
)
HEAD = """# Names of Pinocchio 4.1 that Ulna offers

Written by `python benchmarks/compat_pinocchio_names.py --write`, which compares `dir(pinocchio)` of both packages; a test
checks that it is up to date. "Asked of both" counts the names that stand in the lines that tests run with the package
and with real Pinocchio (`*asked*.py` in `tests/compat/pinocchio` and `seed1`), whose answers must be equal. What is not offered raises
AttributeError (ImportError in `from pinocchio import ...`) with the text in the table below.
"""
OVERLOADS = """What the documentation strings of Pinocchio's functions and methods list. `test_signatures.py` compares number, order, names and defaults
of the arguments of every overload. `differential.py` puts the generated calls to both packages and compares types, shapes, values, printed text
and classes of errors ([how](pinocchio.md#checked)). Calls are not generated for what reads files, draws, belongs to coal, or seeds random numbers.
"""
MEMBERS = """Of the main classes and modules; asked ones are counted by name, whatever object they were asked of.
"""


def main() -> int:
    """Prints, writes or checks the page."""
    found = lines()
    if "--write" in sys.argv:
        PAGE.write_text(found, encoding="utf-8")
    elif "--check" not in sys.argv:
        print(found)
    elif not PAGE.is_file() or PAGE.read_text(encoding="utf-8") != found:
        print(f"{PAGE.name} is out of date; run python benchmarks/compat_pinocchio_names.py --write")
        return 1
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
