"""The target "object": what the files need from elsewhere, their test programs here and under qemu, refusals."""

from __future__ import annotations

import platform
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ulna
from ulna import numeric
from ulna.cli import main
from ulna.errors import InputError, UnknownName
from ulna.exporting.objects.processors import PROCESSORS
from ulna.exporting.objects.symbols import undefined_symbols
from ulna.model import PointContact
from ulna.quantities import QUANTITIES

KERNELS = ["fk", "jacobian", "inverse_dynamics", "ik"]


@pytest.fixture(scope="module")
def panda() -> ulna.Robot:
    return ulna.load("panda")


def _functions(x: Any) -> Any:
    """All operations that a processor may need a library for."""
    y = np.sin(x) + np.tan(x) + np.arcsin(0.1 * x) + np.arccos(0.1 * x) + np.exp(x) + np.log(x)
    return (
        np.floor(y)
        + np.sqrt(y)
        + np.arctan2(y, x)
        + numeric.minimum(y, x)
        + numeric.maximum(x, np.abs(y)) / y
    )


def _moved(x: Any) -> Any:
    """Long rows of zeros and of inputs, which compilers write by calls of memset and memcpy."""
    rows = np.zeros((40, 64), dtype=object)
    rows[5], rows[6], rows[7, 3] = x, x, x[0] * 2.0
    return rows


def exported(robot: ulna.Robot, kernels: Any, path: Path, **options: Any) -> tuple[Path, bytes]:
    place = ulna.export(robot, kernels, to="object", path=path, **options)
    file = next(p for p in place.iterdir() if p.suffix in (".o", ".obj"))
    return place, file.read_bytes()


@pytest.mark.parametrize("triple", ["x86_64-linux-gnu", "aarch64-linux-gnu", "x86_64-windows-msvc"])
def test_forward_kinematics_needs_nothing_but_what_the_table_says(
    panda: ulna.Robot, tmp_path: Path, triple: str
) -> None:
    place, content = exported(panda, "fk", tmp_path / "x", triple=triple)
    assert undefined_symbols(content) == PROCESSORS[triple].undefined
    needs = ", ".join(PROCESSORS[triple].undefined) or "nothing"
    assert f"It needs from other libraries: {needs}." in (place / "panda.h").read_text()
    assert (place / "test_panda.c").exists()


@pytest.mark.slow
@pytest.mark.parametrize("dtype", ["float64", "float32"])
@pytest.mark.parametrize("triple", list(PROCESSORS))
def test_the_table_of_undefined_symbols(panda: ulna.Robot, tmp_path: Path, triple: str, dtype: str) -> None:
    chosen = PROCESSORS[triple]
    if dtype == "float64" and not chosen.target.arithmetic.double_precision:
        pytest.skip("the processor has no float64")
    kernels = {k: k for k in ("fk", "ik")}
    own = ulna.compile(_functions, x=(3,), dtype=dtype)
    own = {"own": own, "moved": ulna.compile(_moved, x=(64,), dtype=dtype)}
    _, content = exported(panda, {**kernels, **own}, tmp_path / "x", triple=triple, dtype=dtype)
    expected = chosen.undefined if dtype == "float64" else chosen.undefined_float32
    assert undefined_symbols(content) == expected


def run_test_program(place: Path, compiler: str, *runner: str) -> str:
    """The output of the test program, linked with the object file."""
    for program in (compiler, *runner):
        if shutil.which(program) is None:
            pytest.skip(
                f"{program} is not installed (apt-get install qemu-user-static gcc-aarch64-linux-gnu ...)"
            )
    linking = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-static", "-o", str(place.parent / "program")]
    command = [compiler, *linking, str(place / "test_panda.c"), str(place / "panda.o"), "-lm"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=600, check=False)
    assert done.returncode == 0, done.stderr
    ran = subprocess.run(
        [*runner, str(place.parent / "program")], capture_output=True, text=True, timeout=600, check=False
    )
    assert ran.returncode == 0, ran.stdout + ran.stderr
    return ran.stdout


@pytest.mark.skipif(
    platform.machine() != "x86_64" or sys.platform != "linux", reason="links an object file of x86-64 Linux"
)
@pytest.mark.parametrize("options", [{}, {"cpu": "x86-64", "lanes": 4}, {"dtype": "float32", "lanes": 1}])
def test_the_test_program_passes_here(panda: ulna.Robot, tmp_path: Path, options: dict[str, Any]) -> None:
    place, _ = exported(panda, ["fk", "ik"], tmp_path / "x", triple="x86_64-linux-gnu", **options)
    assert "ik: 8 of 8 goals met" in run_test_program(place, "gcc")


@pytest.mark.skipif(
    platform.machine() != "x86_64" or sys.platform != "linux", reason="links an object file of x86-64 Linux"
)
@pytest.mark.parametrize("times", [1, 2])
def test_constraints_in_single_precision_pass_the_test_program(
    panda: ulna.Robot, tmp_path: Path, times: int
) -> None:
    held = (PointContact("panda_hand"),) * times
    kernels = ["constrained_dynamics", "impulse_dynamics"]
    place, _ = exported(
        panda, kernels, tmp_path / "x", triple="x86_64-linux-gnu", dtype="float32", constraints=held
    )
    assert run_test_program(place, "gcc").count("largest difference") == 2


@pytest.mark.slow
@pytest.mark.parametrize(
    ("architecture", "dtype"), [("aarch64", "float64"), ("aarch64", "float32"), ("riscv64", "float64")]
)
def test_the_test_program_passes_on_other_processors(
    panda: ulna.Robot, tmp_path: Path, architecture: str, dtype: str
) -> None:
    triple = f"{architecture}-linux-gnu"
    place, _ = exported(panda, KERNELS, tmp_path / "x", triple=triple, dtype=dtype)
    output = run_test_program(place, f"{triple}-gcc", f"qemu-{architecture}-static")
    assert "ik: 8 of 8 goals met" in output and "inverse_dynamics" in output


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"triple": "aarch64-linux"}, UnknownName, r"No triple named 'aarch64-linux'. Did you mean 'aarch64-linux-gnu'"),
        ({"triple": 3}, UnknownName, r"No triple named 3"),
        ({"cpu": 3}, InputError, r"`cpu` is 3; expected a name of LLVM's"),
        ({"cpu": "x86-64-v9"}, InputError, r"'x86-64-v9' is not a recognized processor"),
        ({"features": "+avx9"}, InputError, r"'\+avx9' is not a recognized feature"),
        ({"lanes": 3}, InputError, r"`lanes` is 3"),
        ({"triple": "thumbv7em-none-eabihf-m4"}, InputError, r"'cortex-m4' has no float64; export with dtype="),
        ({"tripel": "aarch64-linux-gnu"}, UnknownName, r"Did you mean 'triple'"),
    ],
)  # fmt: skip
def test_refusals_write_nothing(
    panda: ulna.Robot, tmp_path: Path, options: dict[str, Any], error: type[Exception], message: str
) -> None:
    with pytest.raises(error, match=message):
        ulna.export(panda, "fk", to="object", path=tmp_path / "x", **options)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(
    platform.machine() != "x86_64" or sys.platform != "linux", reason="links an object file of x86-64 Linux"
)
def test_arguments_of_a_search_are_checked(panda: ulna.Robot, tmp_path: Path) -> None:
    place, _ = exported(panda, ["fk", "ik"], tmp_path / "x", triple="x86_64-linux-gnu")
    (place / "test_panda.c").write_text(_CHECKS)
    assert run_test_program(place, "gcc").split() == ["1", "-1", "-1", "-1", "-2", "-2", "-2", "-2", "0", "1"]


_CHECKS = """
#include <math.h>
#include <stdio.h>
#include "panda.h"
int main(void)
{
    double q[7] = {0.1, -0.3, 0.2, -1.8, 0.4, 1.7, 0.5}, T[16], x[7], bad[7] = {0};
    panda_ik_options options = panda_ik_defaults();
    panda_ik_report report;
    panda_fk(q, T);
    printf("%d ", panda_ik(T, 0, 0, x, &report));
    T[0] = NAN;
    printf("%d ", panda_ik(T, 0, 0, x, 0));
    T[0] = 2.0;
    printf("%d ", panda_ik(T, 0, 0, x, 0));
    panda_fk(q, T);
    T[15] = INFINITY;
    printf("%d ", panda_ik(T, q, &options, x, &report));
    panda_fk(q, T);
    bad[3] = NAN;
    printf("%d ", panda_ik(T, bad, &options, x, &report));
    options.attempts = 0;
    printf("%d ", panda_ik(T, q, &options, x, &report));
    options = panda_ik_defaults();
    options.rotation_tolerance = -1;
    printf("%d ", panda_ik(T, q, &options, x, &report));
    options.rotation_tolerance = INFINITY;
    printf("%d ", panda_ik(T, q, &options, x, &report));
    options = panda_ik_defaults();
    T[3] = 3.0; /* out of reach */
    printf("%d ", panda_ik(T, q, &options, x, &report));
    printf("%d\\n", report.position_error[0] > 1.0 && report.steps > 9);
    return 0;
}
"""


def test_the_documentation_has_the_table() -> None:
    text = (Path(__file__).parents[3] / "docs" / "export.md").read_text(encoding="utf-8")
    for name, processor in PROCESSORS.items():
        row = next(line for line in text.splitlines() if line.startswith(f"| `{name}` |"))
        cells = [cell.strip() for cell in row.strip("|").split("|")]
        assert cells[1:4] == [processor.text, f"`{processor.target.cpu}`", str(processor.target.search_lanes)]
        for cell, names in zip(cells[4:], (processor.undefined, processor.undefined_float32), strict=True):
            listed = {} if cell in ("nothing", "not offered") else set(cell.replace("`", "").split(", "))
            assert set(listed) == set(names)


def test_the_command_takes_a_triple(tmp_path: Path, capsys: Any) -> None:
    words = [
        "export",
        "panda",
        "--to",
        "object",
        "--triple",
        "riscv64-linux-gnu",
        "--output",
        str(tmp_path / "x"),
    ]
    assert main(words) == 0
    assert (tmp_path / "x" / "panda.o").read_bytes()[18] == 243  # the number of RISC-V in ELF


@pytest.mark.slow
@pytest.mark.skipif(
    platform.machine() != "x86_64" or sys.platform != "linux", reason="links an object file of x86-64 Linux"
)
@pytest.mark.parametrize("dtype", ["float64", "float32"])
def test_every_quantity_of_the_panda(panda: ulna.Robot, tmp_path: Path, dtype: str) -> None:
    names = [name for name, quantity in QUANTITIES.items() if "constraints" not in quantity.options]
    place, _ = exported(panda, names, tmp_path / "x", triple="x86_64-linux-gnu", dtype=dtype)
    assert run_test_program(place, "gcc").count("largest difference") == len(names)
