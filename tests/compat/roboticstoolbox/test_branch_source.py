"""Source code of closed forms, in Python, C and C++, reaches the poses that it is asked for."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from support.compat_packages import using
from ulna.errors import InputError

pytest.importorskip("spatialmath")

MAIN_C = """
#include <stdio.h>
int main(void) {
    double T[16], q[IKINE_MAX_SOLUTIONS][IKINE_DOF];
    int count, i, k;
    for (i = 0; i < 16; ++i) if (scanf("%lf", &T[i]) != 1) return 1;
    arms(T, 1e-6, q, &count);
    for (k = 0; k < count; ++k) for (i = 0; i < IKINE_DOF; ++i) printf("%.17g ", q[k][i]);
    return 0;
}
"""
MAIN_CPP = """
#include <cstdio>
int main() {
    double T[16];
    for (double &x : T) if (std::scanf("%lf", &x) != 1) return 1;
    for (const auto &q : arms(T).solutions) for (double x : q) std::printf("%.17g ", x);
}
"""


@pytest.fixture(scope="module")
def rtb() -> Iterator[Any]:
    with using("roboticstoolbox"):
        import roboticstoolbox

        yield roboticstoolbox


@pytest.mark.parametrize("name", ["Puma560", "UR5"])
def test_python_finds_all_configurations(rtb: Any, name: str) -> None:
    robot, functions = getattr(rtb.models.DH, name)(), {}
    exec(robot.analytic_ik().generate(name="arms"), functions)
    draw = np.random.default_rng(3)
    for q in draw.uniform(-3.0, 3.0, (5, 6)):
        T = robot.fkine(q).A
        result = functions["arms"](T)
        solutions = np.array(result.solutions)
        assert result.status.name == "OK" and np.abs(solutions).max() <= np.pi
        assert max(np.abs(robot.fkine(one).A - T).max() for one in solutions) < 1e-9
        assert np.abs(np.sin((solutions - q) / 2)).max(axis=1).min() < 1e-6
        assert len(solutions) == len(robot.analytic_ik().solve(T, joint_limits=False).q)
    far = functions["arms"](np.eye(4) + [[0, 0, 0, 9.0], [0, 0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 0]])
    assert far == ([], functions["IKStatus"].UNREACHABLE)


@pytest.mark.slow
@pytest.mark.parametrize(("language", "compiler", "main"), [("c", "cc", MAIN_C), ("c++", "c++", MAIN_CPP)])
def test_compiled_languages_equal_python(
    rtb: Any, tmp_path: Path, language: str, compiler: str, main: str
) -> None:
    if shutil.which(compiler) is None:
        pytest.skip(f"there is no {compiler}")
    solver, functions = rtb.models.DH.Puma560().analytic_ik(), {}
    exec(solver.generate(), functions)
    T = solver.robot.fkine(solver.robot.qn + 0.1).A
    source = tmp_path / ("arm.c" if language == "c" else "arm.cpp")
    source.write_text(solver.generate(language, "arms") + main)
    flags = ["-std=c99" if language == "c" else "-std=c++14", "-Wall", "-Wextra", "-Wpedantic", "-Werror"]
    subprocess.run(
        [compiler, *flags, str(source), "-lm", "-o", str(tmp_path / "arm")], check=True, timeout=600
    )
    text = " ".join(map(repr, map(float, T.ravel())))
    out = subprocess.run(
        [str(tmp_path / "arm")], input=text, capture_output=True, text=True, check=True, timeout=600
    )
    found = np.array(out.stdout.split(), dtype=float).reshape(-1, 6)
    assert np.abs(found - functions["ikine"](T).solutions).max() < 1e-9


def test_what_has_no_closed_form_or_language_is_refused(rtb: Any) -> None:
    solver = rtb.models.DH.Puma560().analytic_ik()
    with pytest.raises(ValueError, match="'c'"):
        solver.generate("rust")
    with pytest.raises(InputError, match="expected letters"):
        solver.generate(name="3 arms")
    with pytest.raises(InputError, match="no closed form"):
        rtb.models.DH.Mico().analytic_ik().generate()


@pytest.mark.parametrize("language", ["python", "c", "c++"])
def test_text_of_the_robot_stays_within_the_comment(rtb: Any, language: str) -> None:
    robot = rtb.models.DH.Puma560()
    robot.name = 'x\nprint("injected")\n*/ int injected; /* @body@ @name@'
    source = robot.analytic_ik().generate(language, name="arms")
    for line in source.splitlines():
        if "injected" in line:
            assert line.startswith("# " if language == "python" else " * ") and "*/" not in line


@pytest.mark.parametrize(
    "name", ["class", "_branch", "math", "float", "_BRANCHES", "sin", "main", "größe", "namespace", "x y"]
)
def test_names_that_the_source_uses_are_refused(rtb: Any, name: str) -> None:
    for language in ("python", "c", "c++"):
        with pytest.raises(InputError, match="expected letters"):
            rtb.models.DH.Puma560().analytic_ik().generate(language, name=name)
