"""Generated calls have the same results in the Robotics Toolbox and here, or differ in a documented way.

Calls are generated from the signatures of the installed toolbox (`differential/generate.py`) and made by both packages in
separate processes: values, types, printed text, warnings and classes of exceptions are compared.
"""

from __future__ import annotations

import collections
import importlib
import json
import pickle
import subprocess
import sys
import zlib
from pathlib import Path
from typing import Any

import pytest

from ulna.compat.packages import environment

pytest.importorskip("roboticstoolbox")
HERE = Path(__file__).parent / "differential"
NOT_COUNTED = ("crash", "TimeoutError", "no subject")  # what the toolbox's own failures begin with
QUICK, SLOW = 601, 26  # one call in so many; a thirteenth is a part of docs/robotics_toolbox_calls.md


def _module(name: str) -> Any:
    sys.path.insert(0, str(HERE))
    try:
        return importlib.import_module(name)
    finally:
        sys.path.remove(str(HERE))


def _run(script: str, *arguments: Path, package: str | None) -> None:
    env = environment([package] if package else [])
    env["MPLBACKEND"] = "agg"
    command = [sys.executable, str(HERE / script), *map(str, arguments)]
    subprocess.run(
        command, env=env, check=True, timeout=900, cwd=arguments[-1].parent
    )  # some calls write files


def results(folder: Path, every: int) -> tuple[dict[str, Any], dict[str, Any]]:
    """Results of one call in `every`, of the package here and of the toolbox, by key."""
    _run("generate.py", folder / "all.json", package=None)
    calls = json.loads((folder / "all.json").read_text())
    assert len(calls) > 10_000
    chosen = [call for call in calls if zlib.crc32(call["key"].encode()) % every == 1]
    (folder / "calls.json").write_text(json.dumps(chosen))
    out = []
    for package in ("roboticstoolbox", None):
        _run("run_calls.py", folder / "calls.json", folder / "results.pickle", package=package)
        out.append(pickle.loads((folder / "results.pickle").read_bytes())[1])
    return out[0], out[1]


def differing(ours: dict[str, Any], theirs: dict[str, Any]) -> tuple[collections.Counter[str], list[str]]:
    """How many calls are equal, and how many differ in each kind of documented differences; and the other differences."""
    compare, differences = _module("compare"), _module("differences")
    kinds: collections.Counter[str] = collections.Counter()
    others = []
    for key, there in theirs.items():
        if there["error"] and there["error"][0] in NOT_COUNTED:
            continue
        how = compare.difference(ours[key], there, compare.nearness(key))
        one = how and differences.documented(key, how, there, ours[key])
        kinds[one.kind if one else "equal" if how is None else "undocumented"] += 1
        if how and not one:
            others.append(f"{key}\n    {how}\n    here {_shown(ours[key])}\n    there {_shown(there)}")
    return kinds, others


def _shown(result: dict[str, Any]) -> str:
    return repr(result["error"] or result["value"])[:200]


def test_a_sample_of_calls_agrees(tmp_path: Path) -> None:
    kinds, others = differing(*results(tmp_path, QUICK))
    assert kinds.total() > 15
    assert kinds["equal"] > 0.6 * kinds.total()
    assert not others, "\n".join(others)


@pytest.mark.slow
def test_generated_calls_agree(tmp_path: Path) -> None:
    kinds, others = differing(*results(tmp_path, SLOW))
    assert kinds.total() > 500
    assert kinds["equal"] > 0.82 * kinds.total()
    assert kinds["equal"] > 0.95 * (kinds["equal"] + kinds["chosen"] + kinds["undocumented"])
    assert not others, f"{len(others)} of {kinds.total()}\n" + "\n".join(others[:40])


@pytest.mark.slow
def test_the_table_lists_the_members_and_keywords_of_the_toolbox(tmp_path: Path) -> None:
    script = Path(__file__).parents[3] / "benchmarks" / "compat_roboticstoolbox_calls.py"
    command = [sys.executable, str(script), "--check", "--folder", str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=600, check=False)
    assert done.returncode == 0, done.stdout[:2000] + done.stderr[-2000:]
