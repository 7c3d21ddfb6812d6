"""Exported C beside the C that CasADi generates for the same quantities, both compiled with gcc and timed in turns.

    python -m pip install casadi; python benchmarks/export_c.py [panda g1 ...] [-O3 ...]

CasADi is given the textbook form of each algorithm (`ulna.algorithms`, run on its SX symbols), as a user of CasADi would
write it (its own derivatives, where there are some), and the graph that Ulna's kernel is made from; the better of the
two counts. It simplifies and generates by itself. Both sides are called in a loop in C, with an angle that changes at each call, through function pointers.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from pathlib import Path

import casadi
import numpy as np
from _timing import table

import ulna
from ulna import algorithms

FLAGS = ["-O3", "-march=native", "-fno-math-errno"]
KERNELS = (
    "fk",
    "jacobian",
    "inverse_dynamics",
    "forward_dynamics",
    "mass_matrix",
    "inverse_dynamics_derivatives",
)
LONGEST = 120.0  # s that gcc may take

_MAIN = """
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
@declarations@
static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec + 1e-9 * t.tv_nsec;
}
static int ascending(const void *a, const void *b)
{
    return (*(double *)a > *(double *)b) - (*(double *)a < *(double *)b);
}
static double q[@nq@], v[@nv@], a[@nv@], out[3][@most@], other[3][@most@], w[@w@];
static const double *args[3] = {q, v, a};
static double *results[3] = {other[0], other[1], other[2]};
static long long iw[@iw@];
@calls@
typedef void (*call)(void);
int main(void)
{
    static const call all[] = {@all@};
    enum { N = sizeof all / sizeof *all, ROUNDS = 31 };
    static double seconds[N][ROUNDS];
    int k, r, i;
    for (i = 0; i < @nq@; i++) q[i] = 0.3 + 0.05 * i;
    for (i = 0; i < @nv@; i++) { v[i] = 0.2 + 0.01 * i; a[i] = -0.3 + 0.02 * i; }
    for (r = 0; r < ROUNDS; r++)
        for (k = 0; k < N; k++) {
            long n = 2000, j;
            const double start = now();
            for (j = 0; j < n; j++) { q[0] = 0.3 + 1e-9 * j; all[k](); }
            seconds[k][r] = (now() - start) / n;
        }
    for (k = 0; k < N; k++) {
        qsort(seconds[k], ROUNDS, sizeof(double), ascending);
        printf("%.3e\\n", seconds[k][ROUNDS / 2]);
    }
    return 0;
}
"""


_SEARCHES = """
#include <stdio.h>
#include <time.h>
#include "ik/own.h"
@tables@
static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec + 1e-9 * t.tv_nsec;
}
int main(void)
{
    @real@ q[@nq@];
    int near, round, i, met;
    for (near = 0; near < 2; near++) {
        double best = 1.0;
        for (round = 0; round < 15; round++) {
            const double start = now();
            double seconds;
            for (i = met = 0; i < @count@; i++) met += own_ik(goals[i], near ? starts[i] : 0, 0, q, 0) == OWN_IK_MET;
            seconds = (now() - start) / @count@;
            best = seconds < best ? seconds : best;
        }
        printf("%d %.3e\\n", met, best);
    }
    return 0;
}
"""


def searches(robot: ulna.Robot, folder: Path, flags: list[str], count: int = 1000) -> list[list[str]]:
    """Rows of inverse kinematics: goals of random configurations, from rest and from 0.1 rad beside."""
    rng, limits = np.random.default_rng(0), robot.limits
    q = limits.lower + (limits.upper - limits.lower) * rng.random((count, robot.nq))
    goals, starts = robot.fk(q).reshape(count, 16), q + rng.uniform(-0.1, 0.1, q.shape)
    rows = []
    for dtype, real in (("float64", "double"), ("float32", "float")):
        ulna.export(robot, "ik", to="c", path=folder / "ik", name="own", dtype=dtype, test=False)
        tables = [
            f"static const {real} {name}[{count}][{x.shape[1]}] = {{{', '.join(map(repr, x.ravel().tolist()))}}};"
            for name, x in (("goals", goals), ("starts", starts))
        ]
        text = _SEARCHES.replace("@tables@", "\n".join(tables)).replace("@real@", real)
        (folder / "searches.c").write_text(text.replace("@nq@", str(robot.nq)).replace("@count@", str(count)))
        sources = ["searches.c", "ik/own_ik.c", "ik/own_model.c"]
        subprocess.run(["gcc", *flags, "-I.", *sources, "-lm", "-o", "searches"], cwd=folder, check=True)
        out = subprocess.run([folder / "searches"], capture_output=True, text=True, check=True).stdout
        for kind, line in zip(("from rest", "from 0.1 rad beside"), out.splitlines(), strict=True):
            met, seconds = line.split()
            rows.append([f"{robot.name}, {dtype}", kind, f"{met} of {count}", f"{1e6 * float(seconds):.2f}"])
    return rows


def textbook(robot: ulna.Robot, name: str, q: casadi.SX, v: casadi.SX, a: casadi.SX) -> list[casadi.SX]:
    """The textbook algorithm of a quantity, on symbols; derivatives are CasADi's."""
    model, frame = robot.model, robot.model.frame(robot.tool)
    x = [np.array(casadi.vertsplit(s), dtype=object) for s in (q, v, a)]
    if name == "fk":
        return [matrix(algorithms.frame_pose(model, x[0], frame).matrix())]
    if name == "jacobian":
        return [matrix(algorithms.frame_jacobian(model, x[0], frame, "local_world_aligned"))]
    if name == "inverse_dynamics":
        return [matrix(algorithms.rnea(model, *x))]
    if name == "forward_dynamics":
        return [matrix(algorithms.aba(model, *x))]
    if name == "mass_matrix":
        return [matrix(algorithms.crba(model, x[0]))]
    return [casadi.jacobian(matrix(algorithms.rnea(model, *x)), s) for s in (q, v, a)]


def matrix(array: np.ndarray) -> casadi.SX:
    """An array of symbols as CasADi has them."""
    rows = np.atleast_1d(array)
    return casadi.vertcat(*(casadi.horzcat(*row) for row in rows.reshape(len(rows), -1)))


def casadi_function(robot: ulna.Robot, name: str, label: str, by_graph: bool) -> casadi.Function:
    """The function that CasADi generates C for."""
    f = robot.function(name)
    symbols = [casadi.SX.sym(key, n) for key, n in (("q", robot.nq), ("v", robot.nv), ("a", robot.nv))]
    arrays = [np.array(casadi.vertsplit(s), dtype=object) for s in symbols]
    if by_graph:
        out = f(*arrays[: len(f.inputs)])
        results = [matrix(one) for one in ((out,) if f.single else out)]
    else:
        results = textbook(robot, name, *symbols)
    return casadi.Function(label, symbols[: len(f.inputs)], [casadi.densify(one) for one in results])


def built(folder: Path, source: str, flags: list[str]) -> float | None:
    """Seconds that gcc takes for a source; None if it takes more than `LONGEST`."""
    start = time.perf_counter()
    command = ["gcc", *flags, "-c", source, "-o", Path(source).stem + ".o"]
    try:
        subprocess.run(command, cwd=folder, check=True, timeout=LONGEST)
    except subprocess.TimeoutExpired:
        return None
    return time.perf_counter() - start


def generated(f: casadi.Function, folder: Path) -> str:
    """The file with the C code of a function of CasADi."""
    generator = casadi.CodeGenerator(f"{f.name()}.c", {"with_header": False})
    generator.add(f)
    generator.generate(f"{folder}/")
    return f"{f.name()}.c"


def measure(robot: ulna.Robot, folder: Path, flags: list[str]) -> list[list[str]]:
    """A row for each kernel."""
    ulna.export(robot, KERNELS, to="c", path=folder / "c", name="own")
    declared, calls, timed, seconds = ['#include "c/own.h"'], [], [], {}
    sizes = {"w": 1, "iw": 1, "most": 1}
    for name in KERNELS:
        f = robot.function(name)
        sizes["most"] = max(sizes["most"], *(p.size for p in f.outputs))
        words = [*"qva"[: len(f.inputs)], *(f"out[{k}]" for k in range(len(f.outputs)))]
        calls.append(f"static void own_{name}_call(void) {{ own_{name}({', '.join(words)}); }}")
        timed.append((name, "own", f"own_{name}_call"))
        seconds[name, "own"] = built(folder, f"c/own_{name}.c", ["-std=c99", *flags])
        for kind in ("textbook", "graph"):
            label = f"casadi_{name}_{kind}"
            c = casadi_function(robot, name, label, kind == "graph")
            sizes["w"], sizes["iw"] = max(sizes["w"], c.sz_w() + 1), max(sizes["iw"], c.sz_iw() + 1)
            seconds[name, kind] = built(folder, generated(c, folder), flags)
            if seconds[name, kind] is not None:
                declared.append(f"int {label}(const double **, double **, long long *, double *, int);")
                calls.append(f"static void {label}_call(void) {{ {label}(args, results, iw, w, 0); }}")
                timed.append((name, kind, f"{label}_call"))
    values = {"nq": robot.nq, "nv": robot.nv, **sizes, "all": ", ".join(call for _, _, call in timed)}
    values |= {"calls": "\n".join(calls), "declarations": "\n".join(declared)}
    times = dict(zip([key[:2] for key in timed], run_main(folder, values), strict=True))
    return [row(robot, name, times, seconds) for name in KERNELS]


def run_main(folder: Path, values: dict[str, object]) -> list[float]:
    """Compiles and runs the program that calls all functions; seconds of one call of each."""
    text = _MAIN
    for key, value in values.items():
        text = text.replace(f"@{key}@", str(value))
    (folder / "main.c").write_text(text)
    objects = sorted(p.name for p in folder.glob("*.o"))
    subprocess.run(["gcc", "-O2", "-I.", "main.c", *objects, "-lm", "-o", "main"], cwd=folder, check=True)
    out = subprocess.run([folder / "main"], capture_output=True, text=True, check=True).stdout
    return [float(x) for x in out.split()]


def row(robot: ulna.Robot, name: str, times: dict, seconds: dict) -> list[str]:
    """A row of the table."""
    kinds = ("own", "textbook", "graph")
    best = min((times[name, kind] for kind in kinds[1:] if (name, kind) in times), default=None)
    shown = [f"{1e6 * times[name, kind]:.3f}" if (name, kind) in times else "-" for kind in kinds]
    compiled = [seconds[name, kind] for kind in kinds[:2]]
    ratio = "-" if best is None else f"{best / times[name, 'own']:.1f}"
    gcc = [f"{s:.1f}" if s is not None else f"> {LONGEST:.0f}" for s in compiled]
    return [f"{robot.name}, {name}", str(robot.function(name).operations), *shown, ratio, *gcc]


def main(words: list[str]) -> None:
    """Prints the table."""
    flags = [w for w in words if w.startswith("-")] or FLAGS
    rows, found = [], []
    for name in [w for w in words if not w.startswith("-")] or ["panda", "g1"]:
        with tempfile.TemporaryDirectory() as folder:
            found += searches(ulna.load(name), Path(folder), flags)
            rows += measure(ulna.load(name), Path(folder), flags)
    columns = ["kernel", "operations", "Ulna [us]", "CasADi, textbook [us]", "CasADi, Ulna's graph [us]"]
    columns += ["best of CasADi / Ulna", "gcc, Ulna [s]", "gcc, CasADi, textbook [s]"]
    print(table(f"C, gcc {' '.join(flags)}, CasADi {casadi.__version__}", columns, rows))
    print(table("Inverse kinematics in C", ["robot", "start", "goals met", "mean [us]"], found))


if __name__ == "__main__":
    main(sys.argv[1:])
