"""A C program that compares the functions with recorded values of the interpreter."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ulna.exporting.c.expressions import number, wrapped
from ulna.exporting.c.header import comment, real_of
from ulna.exporting.record import Export, ExportedFunction, ExportedSearch
from ulna.exporting.sensitivity import compared_outputs, tolerance

_MAX_CASES = 3000
"""Recorded numbers of a function."""


def test_program(export: Export) -> str:
    """The text of the program. It prints a line for each function, and returns 1 if one is wrong.

    Args:
        export: The export.

    Returns:
        The text.
    """
    real = real_of(export)
    blocks = [_function_test(export, f) for f in export.functions]
    blocks += [_search_test(export, s) for s in export.searches]
    names = [*(f.name for f in export.functions), *(s.name for s in export.searches)]
    calls = [f"    failures += test_{name}();" for name in names]
    header = (
        "Compares the functions with recorded values of Ulna's interpreter. Written by Ulna; do not edit."
    )
    compare = _COMPARE.replace("@real@", real)
    compare = compare.replace("@fabs@", "fabsf" if real == "float" else "fabs")
    head = [
        comment([header]),
        "#include <math.h>",
        "#include <stdio.h>",
        "",
        f'#include "{export.name}.h"',
        "",
    ]
    main = ["int main(void)", "{", "    int failures = 0;", *calls, "    return failures != 0;", "}", ""]
    return "\n".join([*head, *([compare] if export.functions else []), *blocks, *main])


def _table(name: str, values: Any, real: str) -> list[str]:
    rows = np.asarray(values, dtype=float).reshape(len(values), -1)
    if not rows.shape[1]:
        rows = np.zeros((len(rows), 1))
    lines = [f"static const {real} {name}[{rows.shape[0]}][{rows.shape[1]}] = {{"]
    for row in rows:
        words = [f"{number(x, real)}," for x in row]
        lines += ["    {", *wrapped(words, "        "), "    },"]
    return [*lines, "};"]


def _function_test(export: Export, f: ExportedFunction) -> str:
    real, name = real_of(export), f.name
    size = sum(a.size for a in (*f.inputs, *f.outputs))
    count = min(len(f.samples[0]) if f.samples else 1, max(1, _MAX_CASES // max(size, 1)))
    samples = [np.asarray(s[:count], dtype=export.dtype).astype(float) for s in f.samples]
    results: Sequence[Any] = [f.function(*[s[k] for s in samples]) for k in range(count)]
    each = [(r,) if f.function.single else r for r in results]
    bound = number(tolerance(f, samples, export.dtype.name), real)
    lines: list[str] = []
    for j, sample in enumerate(samples):
        lines += _table(f"{name}_in{j}", sample, real)
    compared = [j for j, is_compared in enumerate(compared_outputs(f, export.dtype.name)) if is_compared]
    for j in compared:
        lines += _table(f"{name}_expected{j}", np.array([np.ravel(r[j]) for r in each]), real)
    lines += [
        "",
        f"static int test_{name}(void)",
        "{",
        f"    {real} largest = 0;",
        "    int i, failures = 0;",
    ]
    lines += [f"    {real} out{j}[{max(o.size, 1)}];" for j, o in enumerate(f.outputs)]
    arguments = [f"{name}_in{j}[i]" for j in range(len(samples))] + [f"out{j}" for j in range(len(f.outputs))]
    lines += [
        f"    for (i = 0; i < {count}; i++) {{",
        f"        {export.name}_{name}({', '.join(arguments)});",
    ]
    lines += [
        f"        failures += differ(out{j}, {name}_expected{j}[i], {f.outputs[j].size}, {bound}, &largest);"
        for j in compared
    ]
    lines += ["    }", f'    printf("{name}: largest difference %.1e%s\\n", (double)largest,']
    return "\n".join([*lines, '           failures ? ", WRONG" : "");', "    return failures;", "}", ""])


def _search_test(export: Export, s: ExportedSearch) -> str:
    real, name, full = real_of(export), s.name, f"{export.name}_{s.name}"
    goals = np.asarray(s.goals, dtype=export.dtype).astype(float)
    lines = _table(f"{name}_goals", goals.reshape(len(goals), -1), real)
    text = _SEARCH.replace("@real@", real).replace("@short@", name).replace("@name@", full)
    text = text.replace("@NAME@", full.upper()).replace("@count@", str(len(goals)))
    text = text.replace("@nq@", str(s.problem.model.nq)).replace("@k@", str(len(s.problem.frames)))
    return "\n".join([*lines, "", text])


_COMPARE = """\
/* Whether n numbers differ from those that are expected; also finds the largest difference. */
static int differ(const @real@ *x, const @real@ *expected, int n, @real@ tolerance, @real@ *largest)
{
    @real@ scale = 1;
    int i, wrong = 0;
    for (i = 0; i < n; i++) {
        scale = @fabs@(expected[i]) > scale && !isinf(expected[i]) ? @fabs@(expected[i]) : scale;
    }
    for (i = 0; i < n; i++) {
        const @real@ difference = isinf(x[i]) && x[i] == expected[i] ? 0 : @fabs@(x[i] - expected[i]) / scale;
        wrong |= !(difference <= tolerance) && !(isnan(x[i]) && isnan(expected[i]));
        *largest = difference > *largest ? difference : *largest;
    }
    return wrong;
}
"""

_SEARCH = """\
static int test_@short@(void)
{
    const @name@_options options = @name@_defaults();
    @real@ q[@nq@], again[@nq@], no_pose[16 * @k@];
    @name@_report report;
    int i, j, met = 0, near = 0, wrong = 0;
    for (i = 0; i < @count@; i++) {
        const int status = @name@(@short@_goals[i], NULL, NULL, q, &report);
        met += status == @NAME@_MET;
        for (j = 0; status == @NAME@_MET && j < @k@; j++) {
            wrong += !(report.position_error[j] <= options.position_tolerance);
            wrong += !(report.rotation_error[j] <= options.rotation_tolerance * (@real@)1.001);
        }
        near += @name@(@short@_goals[i], q, &options, again, NULL) == status;
    }
    for (i = 0; i < 16 * @k@; i++) {
        no_pose[i] = 2 * @short@_goals[0][i];
    }
    wrong += @name@(no_pose, NULL, NULL, q, NULL) != @NAME@_NOT_A_POSE;
    wrong += met < @count@ || near < @count@;
    printf("@short@: %d of @count@ goals met, %d again from their solutions%s\\n", met, near, wrong ? ", WRONG" : "");
    return wrong;
}
"""
