"""Parquet files as results of jobs: a folder with one file for each part, and what is known of them."""

from __future__ import annotations

import json
import os
import secrets
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ulna.errors import InputError, needed
from ulna.scale.store import check_same
from ulna.system.storage import replacing
from ulna.typing import Array

_ABOUT = "_ulna.json"  # readers of Parquet leave out names that begin so


def pyarrow() -> Any:
    """The package pyarrow, with its modules for Parquet.

    Raises:
        MissingExtra: If it is not installed.
    """
    with needed("pyarrow", "parquet", "Reading and writing Parquet files"):
        import pyarrow.dataset  # pyright: ignore[reportMissingImports]
        import pyarrow.parquet  # pyright: ignore[reportMissingImports]
    return pyarrow


def create(folder: Path, attributes: Mapping[str, Any]) -> None:
    """A folder for parts, without those of an earlier job.

    Args:
        folder: The folder.
        attributes: What is said of them, as JSON can write it.

    Raises:
        InputError: If the folder holds other files.
    """
    pyarrow()
    folder.mkdir(parents=True, exist_ok=True)
    others = [path for path in folder.iterdir() if path.suffix != ".parquet" and path.name != _ABOUT]
    if others:
        raise InputError(f"{str(folder)!r} holds {others[0].name!r}; expected an empty folder, or none.")
    for path in folder.glob("*.parquet"):
        path.unlink()
    describe(folder, attributes)


def describe(folder: Path, attributes: Mapping[str, Any]) -> None:
    """Writes what is said of the parts.

    Args:
        folder: The folder.
        attributes: What is said, as JSON can write it.
    """
    with replacing(folder / _ABOUT) as place:
        place.write_text(json.dumps(attributes, indent=1), "utf-8")


def write(folder: Path, part: int, columns: Mapping[str, Array]) -> None:
    """Writes the rows of a part, whole or not at all.

    Args:
        folder: The folder.
        part: The number of the part.
        columns: Arrays (n, ...) by name; the entries of a row are one list, with the last axis fastest.
    """
    pa = pyarrow()
    arrays = {}
    for name, values in columns.items():
        flat = pa.array(np.ascontiguousarray(values).reshape(-1))
        width = int(np.prod(values.shape[1:]))
        arrays[name] = flat if values.ndim == 1 else pa.FixedSizeListArray.from_arrays(flat, width)
    place = folder / f"part-{part:06d}.parquet"
    beside = folder / f".{place.name}-{secrets.token_hex(4)}"
    try:
        pa.parquet.write_table(pa.table(arrays), beside)
        os.replace(beside, place)
    finally:
        beside.unlink(missing_ok=True)


def check(folder: Path, description: Mapping[str, Any]) -> Any:
    """The data set in a folder, if it is the result of the job of that description.

    Args:
        folder: The folder.
        description: What `Job.description` returned.

    Returns:
        A `pyarrow.dataset.Dataset`, its rows in order.

    Raises:
        InputError: If it is something else.
    """
    try:
        there = json.loads((folder / _ABOUT).read_text("utf-8"))
    except (OSError, ValueError):
        raise InputError(
            f"{str(folder)!r} is no data set of Ulna in Parquet files; give `to` another name."
        ) from None
    check_same({name: there.get(name) for name in description}, json.loads(json.dumps(description)), folder)
    files = sorted(str(path) for path in folder.glob("part-*.parquet"))
    return pyarrow().dataset.dataset(files, format="parquet")
