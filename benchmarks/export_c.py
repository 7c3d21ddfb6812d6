"""Exported C beside the C that CasADi generates for the same quantities, both compiled with gcc and timed in turns.

    python -m pip install casadi; python benchmarks/export_c.py [panda g1 ...]

CasADi is given the textbook form of each algorithm (`ulna.algorithms`, run on its SX symbols), as a user of CasADi would
write it, and the graph that Ulna's kernel is made from; its best of the two counts. It simplifies and generates by
itself. Both sides are called in a loop in C, with an angle that changes at each call, through function pointers.
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
KERNELS = ("fk", "jacobian", "inverse_dynamics", "forward_dynamics", "mass_matrix")

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
static double q[@nq@], v[@nv@], a[@nv@], out[@most@], other[@most@], w[@w@];
static const double *args[3] = {q, v, a};
static double *results[1] = {other};
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


def textbook(robot: ulna.Robot, name: str, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
    """The textbook algorithm of a quantity, on symbols."""
    model, frame = robot.model, robot.model.frame(robot.tool)
    if name == "fk":
        return algorithms.frame_pose(model, q, frame).matrix()
    if name == "jacobian":
        return algorithms.frame_jacobian(model, q, frame, "local_world_aligned")
    if name == "inverse_dynamics":
        return algorithms.rnea(model, q, v, a)
    if name == "forward_dynamics":
        return algorithms.aba(model, q, v, a)
    return algorithms.crba(model, q)


def casadi_function(robot: ulna.Robot, name: str, label: str, by_graph: bool) -> casadi.Function:
    """The function that CasADi generates C for."""
    f = robot.function(name)
    symbols = {key: casadi.SX.sym(key, n) for key, n in (("q", robot.nq), ("v", robot.nv), ("a", robot.nv))}
    arrays = [np.array(casadi.vertsplit(s), dtype=object) for s in symbols.values()]
    out = f(*arrays[: len(f.inputs)]) if by_graph else textbook(robot, name, *arrays)
    out = np.atleast_1d(out)
    rows = out.reshape(out.shape[0], -1)
    result = casadi.vertcat(*(casadi.horzcat(*row) for row in rows))
    return casadi.Function(label, [*symbols.values()][: len(f.inputs)], [casadi.densify(result)])


def built(folder: Path, source: str, flags: list[str]) -> float:
    """Seconds that gcc takes for a source."""
    start = time.perf_counter()
    subprocess.run(["gcc", *flags, "-c", source, "-o", Path(source).stem + ".o"], cwd=folder, check=True)
    return time.perf_counter() - start


def measure(robot: ulna.Robot, folder: Path) -> list[list[str]]:
    """A row for each kernel."""
    ulna.export(robot, KERNELS, to="c", path=folder / "c", name="own")
    declared, calls, names, seconds = ['#include "c/own.h"'], [], [], {}
    sizes = {"w": 1, "iw": 1, "most": 1}
    for name in KERNELS:
        inputs = len(robot.function(name).inputs)
        sizes["most"] = max(sizes["most"], robot.function(name).outputs[0].size)
        calls.append(f"static void own_{name}_call(void) {{ own_{name}({', '.join('qva'[:inputs])}, out); }}")
        names.append(f"own_{name}_call")
        seconds[name, "own"] = built(folder, f"c/own_{name}.c", ["-std=c99", *FLAGS])
        for kind in (False, True):
            label = f"casadi_{name}_{int(kind)}"
            f = casadi_function(robot, name, label, kind)
            sizes["w"], sizes["iw"] = max(sizes["w"], f.sz_w() + 1), max(sizes["iw"], f.sz_iw() + 1)
            generator = casadi.CodeGenerator(f"{label}.c", {"with_header": False})
            generator.add(f)
            generator.generate(f"{folder}/")
            seconds[name, kind] = built(folder, f"{label}.c", FLAGS)
            declared.append(f"int {label}(const double **, double **, long long *, double *, int);")
            calls.append(f"static void {label}_call(void) {{ {label}(args, results, iw, w, 0); }}")
            names.append(f"{label}_call")
    values = {"nq": robot.nq, "nv": robot.nv, **sizes, "all": ", ".join(names)}
    values |= {"calls": "\n".join(calls), "declarations": "\n".join(declared)}
    text = _MAIN
    for key, value in values.items():
        text = text.replace(f"@{key}@", str(value))
    (folder / "main.c").write_text(text)
    objects = sorted(p.name for p in folder.glob("*.o"))
    subprocess.run(["gcc", "-O2", "-I.", "main.c", *objects, "-lm", "-o", "main"], cwd=folder, check=True)
    out = subprocess.run([folder / "main"], capture_output=True, text=True, check=True).stdout
    times = iter(map(float, out.split()))
    rows = []
    for name in KERNELS:
        own, book, graph = next(times), next(times), next(times)
        best = min(book, graph)
        rows.append(
            [f"{robot.name}, {name}", str(robot.function(name).operations)]
            + [f"{1e6 * t:.3f}" for t in (own, book, graph)]
            + [f"{best / own:.1f}", f"{seconds[name, 'own']:.1f}", f"{seconds[name, False]:.1f}"]
        )
    return rows


def main(names: list[str]) -> None:
    """Prints the table."""
    rows = []
    for name in names or ["panda", "g1"]:
        with tempfile.TemporaryDirectory() as folder:
            rows += measure(ulna.load(name), Path(folder))
    columns = ["kernel", "operations", "Ulna [us]", "CasADi, textbook [us]", "CasADi, Ulna's graph [us]"]
    columns += ["best of CasADi / Ulna", "gcc, Ulna [s]", "gcc, CasADi [s]"]
    print(table(f"C, gcc {' '.join(FLAGS)}, CasADi {casadi.__version__}", columns, rows))


if __name__ == "__main__":
    main(sys.argv[1:])
