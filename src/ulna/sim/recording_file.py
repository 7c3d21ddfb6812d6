"""Columns of a recording as a .csv file: a header row of names, and a row for each time.

Entries of arrays have titles such as "q_0" and "T_0_3". Where such titles would be read as another array, as those of
two numbers named "force_0" and "force_1", brackets separate the name from the indices: "force_0[]" for a number,
"force_0[2]" for an entry. An array without entries, such as the configuration of a robot without joints, has one title
with its shape, "q[:0]", and zeros below it.
"""

from __future__ import annotations

import csv
import io
import math
import re
from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ulna.errors import InputError
from ulna.files import read_regular
from ulna.system.storage import replacing
from ulna.typing import Floats

_INDEX = "(?:0|[1-9][0-9]{0,8})"
_INDEXED = re.compile(f"(.+?)((?:_{_INDEX}){{1,8}})")
_EMPTY = re.compile(rf"(.*)\[:((?:{_INDEX},)*0(?:,{_INDEX})*)\]", re.DOTALL)
_BRACKETED = re.compile(rf"(.*)\[((?:{_INDEX}(?:,{_INDEX}){{0,7}})?)\]", re.DOTALL)


def write_csv(columns: Mapping[str, Floats], path: str | Path) -> None:
    """Write columns in full precision. An array has a column for each entry: "q_0", "q_1", "T_0_3", ...

    Args:
        columns: Arrays by name, each of shape (n, ...).
        path: The file, .csv.

    Raises:
        InputError: The path does not end in .csv, or there are no rows.
    """
    target = _checked(path)
    if not columns:
        raise InputError("The recording has no rows; there is nothing to save.")
    filled = {name: values for name, values in columns.items() if 0 not in values.shape[1:]}
    empty = {name: values for name, values in columns.items() if name not in filled}
    head = _header(filled) + [f"{name}[:{_place(values.shape[1:])}]" for name, values in empty.items()]
    table = np.column_stack(
        [values.reshape(len(values), -1) for values in filled.values()]
        + [np.zeros(len(values)) for values in empty.values()]
    )
    with replacing(target) as place, open(place, "w", encoding="utf-8", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([head, *table.tolist()])


def read_csv(path: str | Path) -> dict[str, Floats]:
    """The columns of a file that `write_csv` wrote, or of another table with such a header row.

    Args:
        path: The file, .csv.

    Returns:
        Arrays by name, each of shape (n, ...).

    Raises:
        InputError: There is no such file, or it is no such table, or times decrease; the message says where.
    """
    source = _checked(path)
    try:
        text = read_regular(source).decode("utf-8-sig")
        head, *rows = [row for row in csv.reader(io.StringIO(text, newline="")) if row] or [[""]]
    except FileNotFoundError:
        raise InputError(f"There is no file {str(path)!r}.") from None
    except (OSError, ValueError, csv.Error) as error:
        raise InputError(f"The file {str(path)!r} cannot be read: {error}.") from None
    table = _numbers(rows, len(head), source)
    columns = _arrays(head, table, source)
    if not {"t", "q"} <= columns.keys() or columns["t"].ndim != 1:
        raise InputError(
            f"{source} has the columns {', '.join(head[:8])}; expected 't' and 'q_0', 'q_1', ... in the header row. "
            "Read other tables with NumPy or pandas; identification takes arrays."
        )
    _check_order(columns["t"], source)
    return columns


def _check_order(times: Floats, source: Path) -> None:
    unknown = np.flatnonzero(~np.isfinite(times))
    if len(unknown):
        raise InputError(
            f"{source}, row {unknown[0] + 2}, has the time {times[unknown[0]]} s; expected finite ones."
        )
    wrong = np.flatnonzero(np.diff(times) < 0.0)
    if len(wrong):
        before, after = times[wrong[0] : wrong[0] + 2]
        raise InputError(
            f"{source}, row {wrong[0] + 3}, has the time {after:g} s after {before:g} s; expected times that do not "
            "decrease. Write each motion to a file by itself."
        )


def _checked(path: Any) -> Path:
    if not isinstance(path, (str, Path)) or Path(path).suffix.lower() != ".csv":
        raise InputError(f"`path` is {str(path)!r}; expected the name of a file that ends in .csv.")
    return Path(path)


def _place(numbers: tuple[int, ...]) -> str:
    return ",".join(map(str, numbers))


def _title(name: str, place: tuple[int, ...], brackets: bool = False) -> str:
    return f"{name}[{_place(place)}]" if brackets else "_".join([name, *map(str, place)])


def _header(columns: Mapping[str, Floats]) -> list[str]:
    """A title for each entry; names whose entries would be read as another array have brackets."""
    cells = [(name, place) for name, values in columns.items() for place in np.ndindex(values.shape[1:])]
    bracketed: set[str] = set()
    while True:
        head = [_title(name, place, name in bracketed) for name, place in cells]
        wrong = _misread(columns, cells, head) - bracketed
        if not wrong:
            return head
        base = {name: _parsed(name.strip())[0] for name in columns}
        bracketed |= {n for n in base if base[n] != n and wrong & {n, base[n]}} - bracketed or wrong


def _misread(
    columns: Mapping[str, Floats], cells: list[tuple[str, tuple[int, ...]]], head: list[str]
) -> set[str]:
    """The names whose entries are not read back from these titles as they are."""
    counts = Counter(title.strip() for title in head)
    wrong = {name for title, (name, _) in zip(head, cells, strict=True) if counts[title.strip()] > 1}
    if not wrong:
        numbers = dict(zip(cells, range(len(cells)), strict=True))
        read = _arrays(head, np.arange(float(len(cells)))[None], Path())
        for name, values in columns.items():
            places = [numbers[name, place] for place in np.ndindex(values.shape[1:])]
            same = name in read and read[name].shape[1:] == values.shape[1:]
            if not same or read[name].reshape(-1).tolist() != places:
                wrong.add(name)
    return wrong


def _arrays(head: list[str], table: Floats, source: Path) -> dict[str, Floats]:
    """The arrays whose entries are the columns of a table with these titles."""
    parts: dict[tuple[str, bool], dict[tuple[int, ...], Floats]] = {}
    columns: dict[str, Floats] = {}
    for title, values in zip((t.strip() for t in head), table.T, strict=True):
        if match := _EMPTY.fullmatch(title):
            if match[1] in columns:
                raise InputError(f"{source} has two columns {match[1]!r}.")
            columns[match[1]] = np.zeros((len(values), *map(int, match[2].split(","))))
            continue
        name, place, brackets = _parsed(title)
        if place in parts.setdefault((name, brackets), {}):
            raise InputError(f"{source} has two columns {title!r}.")
        parts[name, brackets][place] = values
    for (name, brackets), of_name in parts.items():
        for title, values in _stacked(name, of_name, brackets):
            if title in columns:
                raise InputError(f"{source} has two columns {title!r}.")
            columns[title] = values
    return columns


def _parsed(title: str) -> tuple[str, tuple[int, ...], bool]:
    """The name of an array, the place in it that a title names, and whether the title has brackets."""
    if match := _BRACKETED.fullmatch(title):
        return match[1], tuple(map(int, match[2].split(","))) if match[2] else (), True
    if match := _INDEXED.fullmatch(title):
        return match[1], tuple(map(int, match[2][1:].split("_"))), False
    return title, (), False


def _numbers(rows: list[list[str]], width: int, source: Path) -> Floats:
    for number, row in enumerate(rows, start=2):
        if len(row) != width:
            raise InputError(
                f"{source}, row {number}, has {len(row)} entries; expected {width}, as in the header row."
            )
    try:
        return np.array(rows, dtype=float).reshape(-1, width)
    except ValueError as error:
        raise InputError(f"{source} holds what is no number: {error}.") from None


def _stacked(
    name: str, parts: dict[tuple[int, ...], Floats], brackets: bool = False
) -> list[tuple[str, Floats]]:
    """The columns of one array, in the order of their indices; else those of names that end in a number themselves."""
    shape = tuple(k + 1 for k in max(parts)) if len({len(p) for p in parts}) == 1 else ()
    if math.prod(shape) == len(parts) and set(parts) == set(np.ndindex(shape)):
        return [(name, np.stack([parts[p] for p in np.ndindex(shape)], axis=-1).reshape(-1, *shape))]
    if brackets:
        return [(_title(name, place, brackets), values) for place, values in parts.items()]
    longer: dict[str, dict[tuple[int, ...], Floats]] = {}
    for place, values in parts.items():
        longer.setdefault(_title(name, place[:1]), {})[place[1:]] = values
    return [column for title, rest in longer.items() for column in _stacked(title, rest)]
