"""What stands around the closed form of an arm in generated source code: helpers, and the loop over the branches."""

from __future__ import annotations

PYTHON = '''@head@

import enum
import math
from typing import NamedTuple


class IKStatus(enum.Enum):
    OK = 0  # solutions found
    SINGULAR = 1  # kept for users of the enumeration; singular joints are set to zero here
    UNREACHABLE = 2  # no solution, the pose is outside the workspace


class IKResult(NamedTuple):
    solutions: list[tuple[float, ...]]
    status: IKStatus


_BRANCHES = @branches@
_TURNS = @turns@


def @name@(T, tol: float = 1e-6) -> IKResult:
    """All configurations for which the pose of the end is T, (4, 4), within tol [m and rad]."""
    solutions = []
    for branch in _BRANCHES:
        *q, distance, angle = _branch(T, branch)
        if distance <= tol and angle <= tol and not any(_is_same(q, other) for other in solutions):
            solutions.append(tuple(_wrapped(x) if turns else x for x, turns in zip(q, _TURNS)))
    return IKResult(solutions, IKStatus.OK if solutions else IKStatus.UNREACHABLE)


def _wrapped(x):
    return math.atan2(math.sin(x), math.cos(x))


def _is_same(q, other):
    return all(abs(_wrapped(a - b) if turns else a - b) < 1e-6 for a, b, turns in zip(q, other, _TURNS))


def _divided(a, b):
    return a / b if b else math.nan if a == 0.0 or a != a else math.copysign(math.inf, a) * math.copysign(1.0, b)


def _sqrt(x):
    return math.sqrt(x) if x >= 0.0 else math.nan


def _sin(x):
    return math.sin(x) if math.isfinite(x) else math.nan


def _cos(x):
    return math.cos(x) if math.isfinite(x) else math.nan


def _tan(x):
    return math.tan(x) if math.isfinite(x) else math.nan


def _asin(x):
    return math.asin(x) if -1.0 <= x <= 1.0 else math.nan


def _acos(x):
    return math.acos(x) if -1.0 <= x <= 1.0 else math.nan


def _floor(x):
    return float(math.floor(x)) if math.isfinite(x) else x


def _min(a, b):
    return a if a < b or a != a else b


def _max(a, b):
    return a if a > b or a != a else b


_atan2 = math.atan2


def _branch(T, branch):
@body@
'''

_C_BRANCH = """static const double @name@_branches[@count@][@numbers@] = @branches@;
static const int @name@_turns[@joints@] = @turns@;

static void @name@_branch(const double *T, const double *branch, double *out)
{
@body@
}

static double @name@_wrapped(double x, int turns)
{
    return turns ? atan2(sin(x), cos(x)) : x;
}

static int @name@_is_same(const double *a, const double *b)
{
    int i;
    for (i = 0; i < @joints@; ++i) {
        if (!(fabs(@name@_wrapped(a[i] - b[i], @name@_turns[i])) < 1e-6)) {
            return 0;
        }
    }
    return 1;
}
"""

C = (
    """/*
@head@
 */
#include <math.h>

#define IKINE_DOF @joints@
#define IKINE_MAX_SOLUTIONS @count@

typedef enum {
    IK_OK = 0,         /* solutions found */
    IK_SINGULAR = 1,   /* kept for users of the enumeration; singular joints are set to zero here */
    IK_UNREACHABLE = 2 /* no solution, the pose is outside the workspace */
} ik_status;

"""
    + _C_BRANCH
    + """
/* T is the pose of the end, 4x4, row after row.
 * solutions[0..*count-1] are all configurations that reach it within tol [m and rad]. */
ik_status @name@(const double T[16], double tol, double solutions[IKINE_MAX_SOLUTIONS][IKINE_DOF], int *count)
{
    int b, i, k, known;
    double out[@joints@ + 2];
    *count = 0;
    for (b = 0; b < @count@; ++b) {
        @name@_branch(T, @name@_branches[b], out);
        if (!(out[@joints@] <= tol && out[@joints@ + 1] <= tol)) {
            continue;
        }
        for (known = 0, k = 0; k < *count; ++k) {
            known |= @name@_is_same(out, solutions[k]);
        }
        for (i = 0; !known && i < @joints@; ++i) {
            solutions[*count][i] = @name@_wrapped(out[i], @name@_turns[i]);
        }
        *count += !known;
    }
    return *count > 0 ? IK_OK : IK_UNREACHABLE;
}
"""
)

CPP = (
    """/*
@head@
 */
#include <array>
#include <cmath>
#include <vector>

enum class IkStatus {
    Ok = 0,         // solutions found
    Singular = 1,   // kept for users of the enumeration; singular joints are set to zero here
    Unreachable = 2 // no solution, the pose is outside the workspace
};

struct IkResult {
    std::vector<std::array<double, @joints@>> solutions;
    IkStatus status = IkStatus::Unreachable;
};

using std::atan2;
using std::cos;
using std::fabs;
using std::floor;
using std::sin;
using std::sqrt;

"""
    + _C_BRANCH
    + """
// T is the pose of the end, 4x4, row after row.
// The solutions are all configurations that reach it within tol [m and rad].
inline IkResult @name@(const double *T, double tol = 1e-6)
{
    IkResult result;
    for (const auto &branch : @name@_branches) {
        double out[@joints@ + 2];
        @name@_branch(T, branch, out);
        bool kept = out[@joints@] <= tol && out[@joints@ + 1] <= tol;
        for (const auto &other : result.solutions) {
            kept = kept && !@name@_is_same(out, other.data());
        }
        if (kept) {
            std::array<double, @joints@> q;
            for (int i = 0; i < @joints@; ++i) {
                q[i] = @name@_wrapped(out[i], @name@_turns[i]);
            }
            result.solutions.push_back(q);
        }
    }
    result.status = result.solutions.empty() ? IkStatus::Unreachable : IkStatus::Ok;
    return result;
}
"""
)
