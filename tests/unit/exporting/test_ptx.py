"""The target "ptx": files, names, descriptions, refusals."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import ulna
from ulna.errors import UnknownName

ROBOT = ulna.load("panda", visuals="simple")


def test_kernels_header_and_description(tmp_path: Path) -> None:
    double = ulna.compile(lambda q, k: k * q, ROBOT, k=(), dtype="float32")
    folder = ulna.export(ROBOT, {"fk": "fk", "scaled": double}, to="ptx", path=tmp_path / "panda")
    assert sorted(p.name for p in folder.iterdir()) == [
        "panda.cuh", "panda.json", "panda.ptx", "ulna_export.json",
    ]  # fmt: skip
    text = (folder / "panda.ptx").read_text()
    assert re.findall(r"\.entry (\w+)", text) == ["panda_fk", "panda_scaled"]
    assert (
        "f32" in text
        and ".f64" not in re.sub(r"\.func.*?\n}", "", text, flags=re.S).split(".entry")[1][:2000]
    )
    header = (folder / "panda.cuh").read_text()
    assert "//   q: 7 [rad or m]" in header and "//   T: 4 x 4 [m]" in header
    assert (
        'extern "C" __global__ void panda_fk(\n    int64_t count,\n    const float* q, int64_t q_sample'
        in header
    )
    about = json.loads((folder / "panda.json").read_text())
    assert about["dtype"] == "float32" and about["kernels"]["panda_scaled"]["inputs"][1]["shape"] == []


def test_a_search_says_where_it_starts_and_the_architecture_is_an_option(tmp_path: Path) -> None:
    folder = ulna.export(ROBOT, "ik", to="ptx", path=tmp_path / "ik", architecture="sm_90")
    assert ".target sm_90" in (folder / "panda.ptx").read_text()
    ik = json.loads((folder / "panda.json").read_text())["kernels"]["panda_ik"]
    assert [p["name"] for p in ik["inputs"]] == ["T", "q0", "shift", "settings"]
    assert len(ik["starts"]["q0"]) == 7 and "position_tolerance^2 [m^2]" in ik["summary"]
    folder = ulna.export(ROBOT, "ik", to="ptx", path=tmp_path / "single", dtype=np.float32)
    assert "const float* settings" in (folder / "panda.cuh").read_text()


def test_refusals_leave_nothing(tmp_path: Path) -> None:
    place = tmp_path / "out"
    with pytest.raises(UnknownName, match="value of option 'architecture' named 'sm_76'. Did you mean 'sm_"):
        ulna.export(ROBOT, "fk", to="ptx", path=place, architecture="sm_76")
    with pytest.raises(UnknownName, match="No export target named 'ptxx'. Did you mean 'ptx'"):
        ulna.export(ROBOT, "fk", to="ptxx", path=place)
    assert not place.exists()


def test_the_command_line_writes_it(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "ulna", "export", "panda", "--kernel", "fk", "--to", "ptx", "--output"]
    done = subprocess.run(
        [*command, str(tmp_path / "x")], capture_output=True, text=True, timeout=200, check=False
    )
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "x" / "panda.ptx").exists()
