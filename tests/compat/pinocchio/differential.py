"""Puts generated calls to the package and to Pinocchio, in processes that are restarted when a call ends them, and compares.

`python differential.py [--every N] [--offset K] [--seed S] [--out FILE]` prints the share of equal behaviour of each group;
with --writes, of assignments to attributes, with --operators and --containers, of operators and of what is done with lists.
"""

from __future__ import annotations

import argparse
import json
import math
import re
import subprocess
import sys
import tempfile
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent
sys.path[:0] = str(HERE), str(HERE.parents[1])

from generated_calls import calls, reads  # noqa: E402
from generated_containers import DOCUMENTED as DOCUMENTED_CONTAINERS  # noqa: E402
from generated_containers import containers  # noqa: E402
from generated_operators import DOCUMENTED as DOCUMENTED_OPERATORS  # noqa: E402
from generated_operators import operators  # noqa: E402
from generated_writes import DOCUMENTED as DOCUMENTED_WRITES  # noqa: E402
from generated_writes import writes  # noqa: E402

from support.two_pythons import variables  # noqa: E402

PROPERTIES = """
import json, inspect, pinocchio as pin
binding = type(pin.rnea)
found = {}
for name in dir(pin):
    cls = getattr(pin, name)
    if inspect.isclass(cls):
        static = {n: inspect.getattr_static(cls, n) for n in dir(cls) if not n.startswith("_")}
        found[name] = {n: p.fset is not None for n, p in static.items() if isinstance(p, property)}
print(json.dumps(found))
"""


DOCUMENTED = (
    (
        r"accepted",
        r"pin\.(centerOfMass|jacobianCenterOfMass)\(.*, None, True\)",
        "True is the default, so that None counts as the argument before it",
    ),
    (
        r"accepted",
        r"pin\.(isOrthonormal|orthonormalization)\((T|R|np\.eye\(6\)|M\.homogeneous\S*), 0\.4\)",
        "for matrices of any size",
    ),
    (
        r"accepted",
        r"pin\.(randomConfiguration\(m, q\)|compute(Distances|Collisions)\(m, d, g, gd\)|BaumgarteCorrectorParameters\(0\.4\))"
        r"|\(own_m\)\.appendBodyToJoint\(2, I\)",
        "the last argument has a default",
    ),
    (
        r"refused",
        r"pin\.randomConfiguration\(m, (q, (k|upper_bound=k|np\.full.*)|np\.full.*)\)",
        "limits are checked",
    ),
    (
        r"refused|error class",
        r"pin\.linalg\.(computeLargestEigenvector|inv)\(.*",
        "what is no matrix is refused",
    ),
    (
        r"refused",
        r"pin\.(computeKKTContactDynamicMatrixInverse|getKKTContactDynamicMatrixInverse)\(.*np\.zeros\(\(0,\)\).*",
        "an array of one dimension is no Jacobian",
    ),
    (r"refused", r".*\.weightedProject\(three, three\)", "weights below zero have no projection; nan there"),
    (r"refused", r"\(pool\)\.resize\(10\*\*6\)", "sizes are bounded"),
    (r"refused", r".*BoxSet\(.*", "sizes are checked"),
    (
        r"refused",
        r"pin\.ProximalSettings\(0\.4, 0\.4, (0\.4, )?-1\)",
        "negative numbers of iterations are refused",
    ),
    (r"refused", r"pin\.JointModelUniversal\(.*", "axes that are not perpendicular are refused"),
    (r"refused", r"pin\.Data\(\)", "data are made for a model"),
    (r"refused|error class", r"\(own_m\)\.addJoint\(.*", "names are given once"),
    (r"refused", r"\(own_m\)\.addJointFrame\(2, 10\*\*6\)", "indices of frames are checked"),
    (
        r"refused",
        r"pin\.JointModelPrismaticUnaligned\(.*",
        "an axis of another length than 1 makes the joint slide farther than its position says",
    ),
    (
        r"value",
        r"\(d\)\.oYaba",
        "computed of the last configuration, whichever algorithm ran; there zero after aba in LOCAL",
    ),
    (
        r"error class",
        r"\(gd\)\.contact_patch_functors",
        "it cannot be converted there",
    ),
    (
        r"refused",
        r"pin\.(XYZQUATToSE3|log6_quat)\(np\.arange\(1\.0, 8\.0\)\)",
        "of a quaternion 11 long no rotation is made; there a matrix that is none",
    ),
    (
        r"value",
        r"pin\.(computeABADerivatives|computeMinverse)\(m, (d|data=d)\b.*",
        "right here; there after aba in WORLD alone, until Jacobians are computed again",
    ),
    (
        r"value",
        r"pin\.get\w+KinematicHessian\(.*",
        "axes are mixed up there: differences of the Jacobian say so",
    ),
    (r"value", r".*BoxSet.*", "sets made in Python read freed memory there"),
    (
        r"value",
        r"pin\.computeCentroidalMapTimeVariation\(m, d, [qv], (v=)?v\)",
        "it takes the centre's velocity of an earlier call: differences of the map say so",
    ),
    (
        r"value",
        r"pin\.getJacobianSubtreeCenterOfMass\(m, d, .*",
        "that of jacobianSubtreeCenterOfMass; there centres that a later call left in joints' frames count as in the world",
    ),
    (r"accepted", r"\(AA\)\.fromRotationMatrix\(rotation=R\)", "its name there has a space"),
    (
        r"value",
        r"\(d\)\.Fcrb",
        "of the universe it is what a call before crba left there, an intermediate step",
    ),
    (r"value", r"\(d\)\.nvSubtree", "of the universe it is nv; there 2 nv + 2"),
    (r"value", r"\(gd\)\.oMg|pin\.SE3\(\)|\(pin\.JointModelH\w\(\)\)\.pitch", "it is not initialised there"),
    (
        r"value",
        r"pin\.(Contact|Constraint)CholeskyDecomposition\(m, (data=)?d\)",
        "it is not initialised there",
    ),
    (
        r"value",
        r"\(pin\.JointModelSphericalZYX\(\)\.createData\(\)\)\.S",
        "the subspace at zero; there all zero before calc",
    ),
    (
        r"value",
        r"\((m|composite)\)\.joints",
        "joints are of the classes of their kinds, with axes and pitches; there all are a JointModel, without them",
    ),
    (r"value", r"\(m\)\.sparsity_pattern_vector", "the universe's row holds what is read past its end there"),
    (r"value", r"\(m\)\.lower\w+Limit", "lower limits are positive there"),
    (
        r"value|text",
        r"pin\.(Inertia|Symmetric3|Quaternion|AngleAxis|Frame)\(\)",
        "it is not initialised there",
    ),
    (
        r"text",
        r"\((pin\.JointModelPlanar\(\)|m\.joints\[2\])\.createData\(\)\)\.M|.*(Quaternion|Vectors)\(three, three\)",
        "a zero is printed with its sign",
    ),
    (
        r"refused",
        r".*\.appendCouplingConstraintInertias\(.*",
        "sizes of vectors are checked",
    ),
    (r"refused|error class", r".*\.getRow(Indexes|SparsityPattern)\(.*, -1\)", "rows are counted from 0"),
    (
        r"refused",
        r".*\.(mapJointSpaceToConstraintMotion|setPositionLimitAndMargin|makeSelectionFilteredByLimitProximity)\(.*",
        "sizes of vectors are checked",
    ),
    (
        r"value",
        r"\(calculated\(m, d, limits\)\)\.constraint_residual",
        "it is of q = 0 there, after forwardKinematics(m, d, q), too",
    ),
    (r"error class", r"pin\.(LanczosDecomposition|TridiagonalSymmetricMatrix)\(.*", "sizes are checked"),
    (r"refused", r"pin\.\w+ConstraintModel\(m, (2, )?(M, )?10\*\*6.*\)", "indices of joints are checked"),
    (r"error class", r".*\.rowise_tangent_map", "it cannot be converted there"),
    (r"refused|error class", r"pin\.(ADMM|PGS)\w+\((.*, )?10\*\*6\)", "sizes are bounded"),
    (r"refused", r"pin\.ConstraintData\(\)", "data are made for a constraint"),
    (r"value", r".*\.getA[12]\(.*LOCAL_WORLD_ALIGNED\)", "it is not initialised there"),
    (r"text", r"\(M\)\.actInv\((M=)?M\)|\(mo\)\.cross\((m=)?mo\)", "rounding, printed"),
)
"""What differs on purpose: the kind of difference, the expressions, and why."""


UNWRITTEN = "unwritten"
"""What a difference is called where Pinocchio answers by memory that nobody wrote."""


def documented(what: str, expression: str, reasons: Sequence[tuple[str, str, str]] = DOCUMENTED) -> bool:
    """Whether a difference is one of those that have a reason."""
    return what == UNWRITTEN or any(
        re.fullmatch(kind, what) and re.fullmatch(text, expression) for kind, text, _ in reasons
    )


def properties() -> dict[str, dict[str, bool]]:
    """For each class of Pinocchio the names of its properties, and whether they can be assigned to."""
    command = [sys.executable, "-c", PROPERTIES]
    done = subprocess.run(command, env=variables(None), check=True, capture_output=True, text=True)
    return json.loads(done.stdout)


def generated(folder: Path) -> list[tuple[str, str]]:
    """All calls, as pairs of a path and an expression."""
    target = folder / "overloads.json"
    command = [sys.executable, str(HERE / "overloads.py"), str(target)]
    subprocess.run(command, env=variables(None), check=True, capture_output=True)
    overloads = json.loads(target.read_text(encoding="utf-8"))
    return [*calls(overloads), *reads(properties())]


MODES: dict[str, tuple[Callable[[Path], Iterable[tuple[str, str]]], Sequence[tuple[str, str, str]]]] = {
    "calls": (generated, DOCUMENTED),
    "writes": (lambda _: writes(properties()), DOCUMENTED_WRITES),
    "operators": (lambda _: operators(), DOCUMENTED_OPERATORS),
    "containers": (lambda _: containers(), DOCUMENTED_CONTAINERS),
}
"""What is generated, and the reasons for what differs."""


def answers(
    expressions: Sequence[str], real: bool, seed: int = 0, **environment: str
) -> list[dict[str, Any]]:
    """What a package answers to each expression; {"crash": ...} where the process ended.

    Args:
        expressions: The expressions.
        real: Whether Pinocchio is asked.
        seed: See `names_with_numbers`.
        environment: Further variables of the process.

    Returns:
        An answer for each.
    """
    found: list[dict[str, Any]] = [{} for _ in expressions]
    at = 0
    while at < len(expressions):
        lines = "".join(json.dumps([i, expressions[i]]) + "\n" for i in range(at, len(expressions)))
        done = subprocess.run(
            [sys.executable, str(HERE / "answers.py"), str(seed)],
            input=lines, env=variables(None if real else "pinocchio", **environment), capture_output=True, text=True, check=False,
        )  # fmt: skip
        begun = at
        for line in done.stdout.splitlines():
            number, *rest = json.loads(line)
            begun = number
            if rest:
                found[number] = rest[0]
        if found[begun] or not done.stdout:
            if begun != len(expressions) - 1:
                raise RuntimeError(done.stderr)
            break
        found[begun] = {"crash": done.returncode}
        at = begun + 1
    return found


def difference(own: dict[str, Any], theirs: dict[str, Any], path: str, text: str) -> str:
    """What differs between two answers; empty for nothing."""
    if not has_answer(theirs):
        return ""
    if "crash" in own or "unusable" in own:
        return "crash"
    if "np.nan" in text and "error" not in theirs and "error" not in own:
        return ""  # zeros that a robot's structure brings are not computed here
    if "error" in theirs:
        if "error" not in own:
            return "accepted"
        return (
            "" if theirs["error"][0] in own["error"] or theirs["error"][0] == "Exception" else "error class"
        )
    if "error" in own:
        return "missing" if own["error"][0] == "AttributeError" else "refused"
    for key in ("type", "size", "shape", "kind"):
        if own.get(key) != theirs.get(key):
            return key
    if "andom" in path or "andom" in str(theirs.get("text", "")):
        return ""
    for key in ("value", "text", "printed", "self"):
        if not same(own.get(key), theirs.get(key)):
            return key
    return ""


def has_answer(theirs: dict[str, Any]) -> bool:
    """Whether Pinocchio answers by a value or an error that says something of the call."""
    return not ("crash" in theirs or "unusable" in theirs or "No to_python" in theirs.get("message", ""))


def same(own: Any, theirs: Any) -> bool:
    """Whether two contents are equal, numbers to nine digits or 1e-9."""
    if isinstance(theirs, dict) and isinstance(own, dict):
        return own.keys() == theirs.keys() and all(same(own[k], theirs[k]) for k in theirs)
    if isinstance(theirs, list) and isinstance(own, list):
        return len(own) == len(theirs) and all(map(same, own, theirs))
    if own == theirs:
        return True
    try:
        a, b = float(own), float(theirs)
    except (TypeError, ValueError):
        return False
    return abs(a - b) <= 1e-9 * max(1.0, abs(a), abs(b)) + 2e-7 * abs(b) or (math.isnan(a) and math.isnan(b))


def group_of(path: str) -> str:
    """The group of a path: its class, or the functions."""
    owner = path.rpartition(".")[0]
    if owner in ("SE3", "Motion", "Force", "Inertia", "Symmetric3", "PseudoInertia", "LogCholeskyParameters"):
        return "spatial algebra"
    if owner in ("Quaternion", "AngleAxis", "rpy", "LieGroup", "liegroups"):
        return "rotations and Lie groups"
    if (owner.startswith(("Joint", "Frame")) and "Constraint" not in owner) or owner in (
        "Model",
        "ModelPool",
    ):
        return "models, frames, joints"
    if owner == "Data":
        return "data"
    if (
        "Constraint" in owner
        or "Cone" in owner
        or owner in ("BoxSet", "ProximalSettings")
        or "Delassus" in owner
    ):
        return "constraints"
    if owner.startswith("Geometry") or "Collision" in owner or "Physics" in owner:
        return "geometry"
    return "functions" if not owner or owner[0].islower() else "others"


def compare(pairs: Sequence[tuple[str, str]], seed: int = 0) -> list[tuple[str, str, str, Any, Any]]:
    """For each call its path, expression, what differs, and both answers."""
    expressions = [expression for _, expression in pairs]
    with ThreadPoolExecutor(2) as both:
        own, theirs = both.map(lambda real: answers(expressions, real, seed), (False, True))
    found = [
        (path, text, difference(a, b, path, text), a, b)
        for (path, text), a, b in zip(pairs, own, theirs, strict=True)
    ]
    unwritten = _unwritten([(path, text, b) for path, text, what, _, b in found if what], seed)
    return [(path, text, UNWRITTEN if text in unwritten else what, a, b) for path, text, what, a, b in found]


def _unwritten(answered: Sequence[tuple[str, str, Any]], seed: int) -> set[str]:
    """The expressions that Pinocchio answers otherwise where the C library fills fresh and freed memory with ones."""
    answered = [one for one in answered if has_answer(one[2]) and "error" not in one[2]]
    again = answers([text for _, text, _ in answered], True, seed, MALLOC_PERTURB_="85")
    return {
        text
        for (path, text, before), after in zip(answered, again, strict=True)
        if has_answer(after) and difference(after, before, path, text)
    }


def by_answer(
    found: Iterable[tuple[str, str, str, Any, Any]], reasons: Sequence[tuple[str, str, str]] = DOCUMENTED
) -> str:
    """How many calls have the same outcome: of those that Pinocchio answers, and of those that it refuses."""
    answered: Counter[str] = Counter()
    refused: Counter[str] = Counter()
    with_reason = unwritten = 0
    for _, text, what, _, theirs in found:
        if what == UNWRITTEN:
            unwritten += 1
        elif "error" in theirs:
            refused[what] += has_answer(theirs)
        elif has_answer(theirs):
            with_reason += not what or documented(what, text, reasons)
            on_purpose = what == "refused" and documented(what, text, reasons)
            answered["refused for a reason" if on_purpose else what] += 1
    whole = max(1, answered.total())
    same = answered.pop("", 0)
    told = same + answered["refused for a reason"]
    return (
        f"Pinocchio returns a value: {same} of {whole} ({100 * same / whole:.2f} %) are the same here, "
        f"{100 * told / whole:.2f} % with those that are refused for a reason, {100 * with_reason / whole:.2f} % with all "
        f"that differ for one; others {dict(answered.most_common())}; {unwritten} more are memory that nobody wrote\n"
        f"Pinocchio raises: {refused['']} of {refused.total()} raise the same class here, {refused['error class']} another one, "
        f"{refused['accepted']} are accepted, {refused['crash']} cannot be made"
    )


def main() -> None:
    """Prints the share of each group, and the differences by path where `--out` names a file for them."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--offset", type=int, default=0)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--only", default="")
    for mode, what in (("writes", "assignments to attributes"), ("operators", "operators between all pairs of objects"),
                       ("containers", "what is done with lists")):  # fmt: skip
        parser.add_argument(
            f"--{mode}", action="store_const", const=mode, dest="mode", help=f"{what} instead of calls"
        )
    parser.set_defaults(mode="calls")
    parser.add_argument("--out", default="")
    parser.add_argument("--known", action="store_true", help="write documented differences, too")
    args = parser.parse_args()
    make, reasons = MODES[args.mode]
    with tempfile.TemporaryDirectory() as folder:
        pairs = [pair for pair in make(Path(folder)) if re.search(args.only, pair[0])][
            args.offset :: args.every
        ]
    found = compare(pairs, args.seed)
    known = sum(bool(what) and documented(what, text, reasons) for _, text, what, *_ in found)
    counts: dict[str, Counter[bool]] = defaultdict(Counter)
    for path, _, what, *_ in found:
        counts[group_of(path)][not what] += 1
    for group, count in sorted(counts.items()):
        print(f"{group:28} {count[True]:6} of {count.total():6}  {100 * count[True] / count.total():5.1f} %")
    whole = sum(counts.values(), Counter())
    print(f"{'all':28} {whole[True]:6} of {whole.total():6}  {100 * whole[True] / whole.total():5.1f} %")
    print(f"of the others {known} are documented differences")
    print(by_answer(found, reasons))
    print(Counter(what for _, _, what, *_ in found if what).most_common())
    if args.out:
        wrong = [
            each for each in found if each[2] and (args.known or not documented(each[2], each[1], reasons))
        ]
        Path(args.out).write_text("\n".join(json.dumps(each) for each in wrong), encoding="utf-8")


if __name__ == "__main__":
    main()
