"""Zarr groups as results of jobs: whole or absent, with the description of the job."""

from __future__ import annotations

import json
import os
import secrets
import shutil
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any, ClassVar, Self

import numpy as np

from ulna.errors import InputError, needed
from ulna.scale.store import check_same, place
from ulna.typing import Array


def zarr() -> Any:
    """The package zarr.

    Raises:
        MissingExtra: If it is not installed.
    """
    with needed("zarr", "cluster", "Reading and writing Zarr groups"):
        import zarr  # pyright: ignore[reportMissingImports]
    return zarr


_OTHER_FILES = (
    *(".csv", ".feather", ".h5", ".hdf5", ".html", ".json", ".mat", ".npy", ".npz", ".parquet", ".pickle"),
    *(".pkl", ".png", ".txt"),
)


def named(to: str | os.PathLike[str] | None, *also: str) -> str | os.PathLike[str] | None:
    """The place for a Zarr group, unless its name is that of another kind of file, which it would not be.

    Args:
        to: Where; None for nowhere.
        *also: Endings of other kinds of files that this job can write.

    Returns:
        The same.

    Raises:
        InputError: If it is no path, or its name that of another kind of file.
    """
    path = place(to)
    ending = "" if path is None else path.suffix.lower()
    if ending in _OTHER_FILES and ending not in also:
        names = " or ".join(repr(f"result{end}") for end in (".zarr", *also))
        raise InputError(
            f"`to` is {os.fspath(to or '')!r}, but no {ending} file is written; expected the name of a folder such as "
            f"{names}."
        )
    return to


def write(to: Path, arrays: Mapping[str, Array], attributes: Mapping[str, Any]) -> None:
    """Writes arrays as a Zarr group, in place of an older one only when it is whole.

    Args:
        to: The folder.
        arrays: Arrays (...) by name.
        attributes: What is said of them, as JSON can write it.
    """
    beside = to.with_name(f".ulna-{secrets.token_hex(4)}{to.suffix}")
    try:
        group = zarr().create_group(str(beside), attributes=dict(attributes))
        for name, array in arrays.items():
            group.create_array(name, data=np.asarray(array))
        if to.exists():
            shutil.rmtree(to)
        os.replace(beside, to)
    finally:
        shutil.rmtree(beside, ignore_errors=True)


@dataclass(frozen=True, eq=False, repr=False)
class StoredResult:
    """A result of a job that is a Zarr group when saved: one array for each field, `job` as its attributes."""

    KIND: ClassVar[str]
    job: Mapping[str, Any] = field(kw_only=True)

    @classmethod
    def arrays(cls) -> tuple[str, ...]:
        """The names of its arrays."""
        return tuple(f.name for f in fields(cls) if f.name != "job")

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the result as a Zarr group.

        Args:
            path: The folder.
        """
        write(Path(path), {name: getattr(self, name) for name in self.arrays()}, self.job)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Self:
        """Reads a result.

        Args:
            path: The folder.

        Returns:
            The result.

        Raises:
            InputError: If there is none.
        """
        group = opened(path, cls.KIND)
        return cls(**{name: group[name][...] for name in cls.arrays()}, job=group.attrs.asdict())


def check(path: Path, description: Mapping[str, Any]) -> Any:
    """The Zarr group in `path`, if it is the result of the job of that description.

    Args:
        path: The folder.
        description: What `Job.description` returned.

    Returns:
        The group, to read.

    Raises:
        InputError: If it is something else.
    """
    group = opened(path, description["kind"])
    attributes = group.attrs.asdict()
    check_same(
        {name: attributes.get(name) for name in description}, json.loads(json.dumps(description)), path
    )
    return group


def opened(path: str | os.PathLike[str], kind: str) -> Any:
    """A Zarr group that a job of Ulna has written.

    Args:
        path: The folder.
        kind: The kind of job that it must come from.

    Returns:
        The group, to read.

    Raises:
        InputError: If there is none, or it is of another kind.
    """
    try:
        group = zarr().open_group(str(path), mode="r")
    except (FileNotFoundError, ValueError) as error:
        raise InputError(f"{str(path)!r} is no Zarr group: {error}.") from None
    except NotADirectoryError:
        raise InputError(f"{str(path)!r} is a file; expected a Zarr group, which is a folder.") from None
    there = group.attrs.asdict().get("kind")
    if there != kind:
        raise InputError(
            f"{str(path)!r} is the result of {there or 'no job of Ulna'}; expected that of {kind!r}."
        )
    return group
