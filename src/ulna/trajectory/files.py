"""Trajectories in files: .npz keeps polynomials exactly, .csv holds rows for other programs.

A .npz file holds the knots and coefficients; what was loaded equals what was saved. A .csv file holds a head
line and rows of time, points, velocities and accelerations, with every digit; loading it joins the rows by
quintics that have those very states.
"""

from __future__ import annotations

import csv
import io
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from ulna.checks.values import short_repr
from ulna.errors import InputError
from ulna.files import read_regular
from ulna.system.storage import replacing
from ulna.trajectory.inputs import increasing
from ulna.trajectory.polynomial import Polynomial, hermite
from ulna.trajectory.space import Poses, Vectors
from ulna.trajectory.trajectory import Trajectory, register_operation

_FORMAT = "ulna trajectory 1"
_MAX_POWERS = 64
"""Polynomials of more coefficients are refused: a file with millions would be compiled for hours."""


def save(trajectory: Trajectory, path: str | Path, rate: float | None = None) -> None:
    """Writes a trajectory to a file.

    Args:
        trajectory: What to save; for .npz a polynomial, for .csv any trajectory of joints or poses.
        path: Where to, .npz or .csv.
        rate: Rows a second of a .csv file [1/s]; None for 1000.

    Raises:
        InputError: Another suffix, or a trajectory that is no polynomial in a .npz file.

    Example:
        >>> move = ulna.trajectory.quintic([0.0, 0.0], [1.0, 0.5], duration=2.0)
        >>> ulna.trajectory.save(move, "move.csv", rate=100)
        >>> ulna.trajectory.load("move.csv")(2.0).round(6)
        array([1. , 0.5])
    """
    target = _checked_path(path)
    if target.suffix.lower() == ".npz":
        if not isinstance(trajectory, Polynomial) or not isinstance(trajectory.space, Vectors):
            raise InputError(f"{trajectory!r} is no plain polynomial, which .npz keeps; save it as .csv.")
        names = np.array(trajectory.space.names)
        kind = np.array([_FORMAT, trajectory.kind])
        with replacing(target) as place:
            np.savez(
                place, times=trajectory.times, coefficients=trajectory.coefficients, names=names, kind=kind
            )
    elif target.suffix.lower() == ".csv":
        t, q, v, a = trajectory.sample(rate=1000.0 if rate is None else rate)
        names = trajectory.space.names
        head = ["t", *trajectory.space.columns, *(f"v_{n}" for n in names), *(f"a_{n}" for n in names)]
        table = np.column_stack([t, q.reshape(len(t), -1), v, a])
        with replacing(target) as place, open(place, "w", encoding="utf-8", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows([head, *table.tolist()])
    else:
        raise InputError(f"`path` is {str(path)!r}; expected a file name that ends in .npz or .csv.")


def _checked_path(path: Any) -> Path:
    if not isinstance(path, (str, PathLike)):
        raise InputError(f"`path` is {short_repr(path)}; expected a file name that ends in .npz or .csv.")
    return Path(path)


def load(path: str | Path) -> Polynomial:
    """Reads a trajectory of joints from a file that `save` wrote, or from any table like it.

    A .csv file has a head line that begins with "t", and columns of times [s], positions, velocities and
    accelerations, or of times and positions and velocities.

    Raises:
        InputError: No such file, another suffix, or a file that is no trajectory; says what it lacks.

    Example:
        >>> move = ulna.trajectory.quintic([0.0, 0.0], [1.0, -1.0], duration=2.0)
        >>> move.save("move.csv", rate=100)
        >>> ulna.trajectory.load("move.csv").duration
        2.0
    """
    source = _checked_path(path)
    if source.suffix.lower() not in (".npz", ".csv"):
        raise InputError(f"`path` is {str(path)!r}; expected a file name that ends in .npz or .csv.")
    try:
        data = read_regular(source)
    except FileNotFoundError:
        raise InputError(f"There is no file {str(path)!r}.") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise InputError(f"The file {str(path)!r} cannot be read: {reason}.") from None
    return _from_npz(data, source) if source.suffix.lower() == ".npz" else _from_csv(data, source)


def _from_npz(data: bytes, source: Path) -> Polynomial:
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as archive:
            content: dict[str, Any] = dict(archive)
    except Exception as error:  # zipfile, zlib and NumPy each raise their own kinds
        raise InputError(f"{source} is no .npz file: {error}") from None
    if not _is_ours(content):
        raise InputError(f"{source} holds {sorted(content)}; expected a trajectory that `save` wrote.")
    space = Vectors(tuple(str(n) for n in content["names"]))
    try:
        made = Polynomial.of(content["times"], content["coefficients"], str(content["kind"][1]), space)
    except InputError as error:
        raise InputError(f"{source}: {error}") from None
    if made.coefficients.shape[2] != space.n or made.coefficients.shape[1] > _MAX_POWERS:
        raise InputError(
            f"{source} holds coefficients of shape {made.coefficients.shape} and {space.n} names; "
            f"expected (k, d + 1, {space.n}), with d + 1 at most {_MAX_POWERS}."
        )
    return made


def _is_ours(content: dict[str, Any]) -> bool:
    """Whether all that `save` writes is there, with the names as text."""
    if not {"times", "coefficients", "names", "kind"} <= content.keys():
        return False
    names, kind = content["names"], content["kind"]
    if names.dtype.kind != "U" or names.ndim != 1 or kind.dtype.kind != "U" or kind.shape != (2,):
        return False
    return str(kind[0]) == _FORMAT


def _from_csv(data: bytes, source: Path) -> Polynomial:
    try:
        lines = io.StringIO(data.decode("utf-8-sig"), newline="")
        head, *rows = [row for row in csv.reader(lines) if row] or [[]]
    except (UnicodeDecodeError, csv.Error) as error:
        raise InputError(f"{source} is no table: {error}.") from None
    if not head or head[0] != "t" or len(rows) < 2:
        raise InputError(
            f"{source} has no head line that begins with 't', and at least two rows; nothing was read."
        )
    try:
        table = np.array(rows, dtype=float)
    except ValueError as error:
        raise InputError(f"{source} holds rows that are not {len(head)} numbers: {error}") from None
    if table.shape[1] != len(head):
        raise InputError(f"{source} has {len(head)} names of columns, and rows of {table.shape[1]} numbers.")
    if head[1 : len(Poses().columns) + 1] == list(Poses().columns):
        raise InputError(f"{source} holds poses, which have no polynomials; expected joints.")
    names, *rates = _columns(head, source)
    if not np.isfinite(table).all():
        raise InputError(
            f"{source} holds nan or inf in row {int(np.argwhere(~np.isfinite(table))[0][0]) + 2}."
        )
    t = increasing("t", table[:, 0], len(table))
    q = table[:, 1 : len(names) + 1]
    v, *a = (table[:, places] for places in rates)
    return hermite(t, q, v, a[0] if a else None, "table", Vectors(tuple(names)))


def _columns(head: list[str], source: Path) -> tuple[Any, ...]:
    """The names of the positions, and where their velocities are, and their accelerations where there are any."""
    width = len(head) - 1
    for kinds in (3, 2):
        n, left = divmod(width, kinds)
        names, prefixes = head[1 : n + 1], ("v_", "a_")[: kinds - 1]
        rates = [[f"{prefix}{name}" for name in names] for prefix in prefixes]
        if n and head[n + 1 :] == [rate for of_kind in rates for rate in of_kind]:  # as `save` writes them
            return names, *(list(range(k * n + 1, (k + 1) * n + 1)) for k in range(1, kinds))
        if n and not left and len({*head}) == width + 1 and {*head[n + 1 :]} == {*rates[0], *rates[-1]}:
            return names, *([head.index(rate) for rate in of_kind] for of_kind in rates)
    # other programs call velocities otherwise: v_1 beside q_1
    positions = [h for h in head[1:] if not h.startswith(("v_", "a_"))]
    n, speeds = len(positions), [h for h in head[1:] if h.startswith("v_")]
    if len(speeds) != n or width not in (2 * n, 3 * n):
        raise InputError(
            f"{source} has {n} positions and {len(speeds)} velocities; expected as many of each."
        )
    if not n:
        raise InputError(f"{source} has no columns of positions.")
    if head[1 : n + 1] != positions or head[n + 1 : 2 * n + 1] != speeds:
        raise InputError(
            f"{source} has the columns {', '.join(head[:8])}; expected those of all positions, then of all velocities, "
            "then of all accelerations, each in the same order."
        )
    return positions, *(list(range(k * n + 1, (k + 1) * n + 1)) for k in range(1, width // n))


register_operation("save", save)
