"""Inverse kinematics in C: the search of one lane as a static function, and a function around it that checks."""

from __future__ import annotations

import re
from typing import Any

import numpy as np

from ulna.exporting.c.expressions import number, wrapped
from ulna.exporting.c.header import comment, plain, real_of
from ulna.exporting.c.source import definition
from ulna.exporting.record import Export, ExportedSearch
from ulna.ik.goal import squared_tolerances
from ulna.ik.search import ATTEMPT_STEPS, DESCENT, MEAN_STEPS
from ulna.typing import Floats

TOLERANCE = {"double": 1e-6, "float": 1e-4}
"""Default tolerances of positions [m] and angles [rad]."""

ATTEMPTS = 400
"""Default number of starting points."""


def declaration(export: Export, search: ExportedSearch) -> str:
    """The types and the function of a search, for the header.

    Args:
        export: The export.
        search: The search.

    Returns:
        The text.
    """
    return _filled(_DECLARATION, export, search)


def source(export: Export, search: ExportedSearch) -> str:
    """The source of a search.

    Args:
        export: The export.
        search: The search.

    Returns:
        The text.
    """
    real, name = real_of(export), f"{export.name}_{search.name}"
    function = search.function(1)
    return "\n".join(
        [
            comment([f"Inverse kinematics. {function.operations} operations. Written by Ulna; do not edit."]),
            f'#include "{export.name}.h"',
            f'#include "{export.name}_support.h"',
            "",
            definition(
                function,
                function.outputs,
                f"{name}_search",
                real,
                export.name,
                f"{export.name.upper()}_PART ",
            ),
            _filled(_DEFINITION, export, search),
        ]
    )


def _filled(template: str, export: Export, search: ExportedSearch) -> str:
    """A template with what is known of a search in place of @word@."""
    real, problem = real_of(export), search.problem
    k, nq = len(problem.frames), problem.model.nq
    tolerance = TOLERANCE[real]
    frames = ", ".join(f.name for f in problem.frames)
    order = ", in this order" if k > 1 else ""
    counts = "".join(f" {key}: {value}." for key, value in search.choices.items() if key != "frame")
    values: dict[str, Any] = {
        "name": f"{export.name}_{search.name}",
        "NAME": f"{export.name}_{search.name}".upper(),
        "real": real,
        "frames": plain(f"{'frames' if k > 1 else 'frame'} {frames}{order}.{counts}"),
        "k": k,
        "nq": nq,
        "goal": 16 * k,
        "shape": f"({k}, 4, 4)" if k > 1 else "(4, 4)",
        "tolerance": number(tolerance, real),
        "attempts": ATTEMPTS,
        "start": _array(search.start, real),
        "shift": _array(search.shift, real),
        "d": max(len(search.shift), 1),
        "evaluations": DESCENT,
        "descent": number(-float(DESCENT), real),
        "mean": MEAN_STEPS,
        "first": ATTEMPT_STEPS,
        "length": number(squared_tolerances(np.inf, 1.0)[0] ** 0.5, real),
        "chord": number(squared_tolerances(1.0, np.inf)[1] ** 0.5, real),
        "sin": "sinf" if real == "float" else "sin",
        "pi": number(np.pi, real),
        "half": number(0.5, real),
    }
    return re.sub("@([A-Za-z]+)@", lambda match: str(values[match[1]]), template)


def _array(values: Floats, real: str) -> str:
    """Numbers as the content of an initialiser."""
    words = [f"{number(x, real)}," for x in values] or [f"{number(0.0, real)},"]
    return "\n".join(wrapped(words, "        ")).rstrip(",")


_DECLARATION = """\
/* What @name@ returns. */
enum {
    @NAME@_MET = 1,           /* q meets the goal */
    @NAME@_NOT_MET = 0,       /* no configuration was found; q is the nearest that was */
    @NAME@_NOT_A_POSE = -1,   /* T is no pose: not finite, no rotation, or transposed; q is not written */
    @NAME@_BAD_ARGUMENT = -2  /* q0 or the options are not finite or not above zero; q is not written */
};

/* Options of @name@; @name@_defaults has their default values. */
typedef struct @name@_options {
    @real@ position_tolerance; /* greatest distance that counts as met [m], 1e-6 (float: 1e-4) */
    @real@ rotation_tolerance; /* greatest angle that counts as met [rad], 1e-6 (float: 1e-4) */
    int attempts;              /* about how many starting points are tried, @attempts@ */
} @name@_options;

/* How a search ended. */
typedef struct @name@_report {
    int steps;                  /* steps that were taken */
    int start;                  /* number of the starting point that led to q, 0 for q0 */
    @real@ position_error[@k@]; /* distance of each frame from its goal [m] */
    @real@ rotation_error[@k@]; /* angle of each frame from its goal [rad] */
} @name@_report;

/* The default options. */
@name@_options @name@_defaults(void);

/* Inverse kinematics: a configuration within the joint limits that puts a frame at a goal; the
 * @frames@
 * It takes at most @mean@ attempts + @first@ steps, and at most @evaluations@ more to the nearest configuration where
 * no solution is found.
 *   T        in   @shape@ [m], row after row: the goal, T_world_frame
 *   q0       in   (@nq@) [rad or m]: configuration to stay near; NULL for a start of the robot's, with the
 *                 first solution met as result
 *   options  in   NULL for the default options
 *   q        out  (@nq@) [rad or m]: the solution, or the nearest configuration that was found
 *   report   out  NULL where it is not wanted
 * Returns one of the four numbers above.
 */
int @name@(const @real@ T[@goal@], const @real@ *q0, const @name@_options *options, @real@ q[@nq@],
           @name@_report *report);
"""

_DEFINITION = """\
@name@_options @name@_defaults(void)
{
    @name@_options options;
    options.position_tolerance = @tolerance@;
    options.rotation_tolerance = @tolerance@;
    options.attempts = @attempts@;
    return options;
}

/* Whether n numbers are finite. */
static int @name@_are_finite(const @real@ *x, int n)
{
    int i, finite = 1;
    for (i = 0; i < n; i++) {
        finite &= isfinite(x[i]) != 0;
    }
    return finite;
}

int @name@(const @real@ T[@goal@], const @real@ *q0, const @name@_options *options, @real@ q[@nq@],
           @name@_report *report)
{
    static const @real@ start[@nq@] = {
@start@
    };
    static const @real@ shift[@d@] = {
@shift@
    };
    const @name@_options chosen = options ? *options : @name@_defaults();
    const @real@ distance = chosen.position_tolerance, angle = chosen.rotation_tolerance;
    @real@ settings[4], out[@nq@ + 3 + 2 * @k@], chord;
    int i, steps, number;
    if (!isfinite(distance) || !isfinite(angle) || !(distance > 0) || !(angle > 0) || chosen.attempts < 1 ||
        chosen.attempts > 1000000 || (q0 && !@name@_are_finite(q0, @nq@))) {
        return @NAME@_BAD_ARGUMENT;
    }
    if (!@name@_are_finite(T, @goal@)) {
        return @NAME@_NOT_A_POSE;
    }
    chord = angle < @pi@ ? 2 * @sin@(@half@ * angle) : @chord@;
    settings[0] = distance < @length@ ? distance * distance : @length@ * @length@;
    settings[1] = chord * chord;
    settings[2] = q0 ? 1 : 0;
    settings[3] = (@real@)(@mean@ * chosen.attempts + @first@);
    @name@_search(T, q0 ? q0 : start, shift, settings, out);
    if (out[@nq@] < -@half@) {
        return @NAME@_NOT_A_POSE;
    }
    steps = (int)out[@nq@ + 1];
    number = (int)out[@nq@ + 2];
    if (out[@nq@] < @half@) { /* the nearest configuration, by a descent from where the search ended */
        @real@ nearest[@nq@];
        for (i = 0; i < @nq@; i++) {
            nearest[i] = out[i];
        }
        settings[3] = @descent@;
        @name@_search(T, nearest, shift, settings, out);
    }
    for (i = 0; i < @nq@; i++) {
        q[i] = out[i];
    }
    if (report) {
        report->steps = steps;
        report->start = number;
        for (i = 0; i < @k@; i++) {
            report->position_error[i] = out[@nq@ + 3 + 2 * i];
            report->rotation_error[i] = out[@nq@ + 4 + 2 * i];
        }
    }
    return out[@nq@] > @half@ ? @NAME@_MET : @NAME@_NOT_MET;
}
"""
