"""Where a job keeps what it has found so far, so that it can be continued: a folder beside its result."""

from __future__ import annotations

import json
import os
import shutil
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple, final

import numpy as np

from ulna.checks.values import short_repr
from ulna.errors import InputError
from ulna.scale.job import State
from ulna.system.storage import replacing

_DONE = "parts_done"
_EARLY = "early"


class Kept(NamedTuple):
    """What a job has found so far."""

    state: State
    """The state."""
    done: int
    """How many of the first parts are in it."""
    early: dict[int, State]
    """Results of later parts, which wait for those before them."""

    @property
    def count(self) -> int:
        """How many parts are done."""
        return self.done + len(self.early)


@final
class Store:
    """The progress of one job in the folder `TO.job`, which is removed once the result is in `TO`.

    Args:
        to: Where the result will be.
        description: What `Job.description` returned.

    Raises:
        InputError: If there is the progress or result of another job, another process works on this one, or there
            cannot be a folder.
        OSError: If the folder cannot be written.
    """

    def __init__(self, to: Path, description: Mapping[str, Any]) -> None:
        self.to, self.folder = to, job_folder(to)
        self._description = json.loads(json.dumps(description))
        self._lock: int | None = None
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
        except (NotADirectoryError, FileExistsError) as error:
            raise InputError(
                f"The folder {str(self.folder)!r} cannot be made: there is a file in its place or on the way to it. "
                "Give `to` another name."
            ) from error
        self._take()
        try:
            self._check()
        except BaseException:
            self.close()
            raise

    def load(self) -> Kept | None:
        """What was saved last; None where there is nothing.

        Raises:
            InputError: If the file is damaged.
        """
        path = self.folder / "state.npz"
        if not path.exists():
            return None
        try:
            with np.load(path, allow_pickle=False) as file:
                arrays = {name: file[name] for name in file.files}
            done, early = int(arrays.pop(_DONE)), dict[int, State]()
            for path_name in [name for name in arrays if name.startswith(f"{_EARLY}/")]:
                _, part, name = path_name.split("/", 2)
                early.setdefault(int(part), {})[name] = arrays.pop(path_name)
            return Kept(arrays, done, early)
        except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile) as error:
            raise self._damaged(path, error) from error

    def _damaged(self, path: Path, error: Exception) -> InputError:
        return InputError(f"{str(path)!r} is damaged ({error}); remove {str(self.folder)!r} to begin anew.")

    def save(self, kept: Kept) -> None:
        """Writes what was found, whole or not at all.

        Args:
            kept: The state, and results that wait.

        Raises:
            OSError: It cannot be written; what was there stays.
        """
        early = {
            f"{_EARLY}/{part}/{name}": array
            for part, result in kept.early.items()
            for name, array in result.items()
        }
        with replacing(self.folder / "state.npz") as path, path.open("wb") as file:
            np.savez(file, allow_pickle=False, **kept.state, **early, **{_DONE: np.array(kept.done)})
            file.flush()
            os.fsync(file.fileno())

    def describe_result(self) -> None:
        """Writes beside the result of which job it is, in `TO.job.json`.

        Raises:
            OSError: It cannot be written.
        """
        self._write_description(_description_file(self.to))

    def finished(self) -> None:
        """Removes the progress of a job whose result is written."""
        self.close()
        shutil.rmtree(self.folder, ignore_errors=True)

    def close(self) -> None:
        """Lets other processes work on the job."""
        if self._lock is not None:
            os.close(self._lock)
            self._lock = None

    def _take(self) -> None:
        self._lock = os.open(self.folder / "lock", os.O_RDWR | os.O_CREAT, 0o644)
        try:
            import fcntl
        except ImportError:  # Windows: two jobs in one folder are the user's to avoid
            return
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            self.close()
            raise InputError(
                f"Another process works on {str(self.to)!r}; wait for it, or give `to` another name."
            ) from None

    def _check(self) -> None:
        """Compares the job with the one whose progress is there, or writes down this one where nothing is done."""
        path = self.folder / "job.json"
        if path.exists():
            try:
                there = json.loads(path.read_text("utf-8"))
            except ValueError as error:
                raise self._damaged(path, error) from error
            if there == self._description:
                return
            known = self.load()
            if known is not None and known.count > 0:
                folder = str(self.folder)
                remedy = (
                    f"Give the same arguments to continue it, or `to` another name, or remove {folder!r}."
                )
                check_same(there, self._description, self.to, remedy)
            (self.folder / "state.npz").unlink(missing_ok=True)
        self._write_description(path)

    def _write_description(self, path: Path) -> None:
        with replacing(path) as fresh:
            fresh.write_text(json.dumps(self._description, indent=1), "utf-8")


def place(to: str | os.PathLike[str] | None) -> Path | None:
    """Where a result will be, from the root of the disk; None for nowhere.

    Args:
        to: What was passed.

    Returns:
        The path.

    Raises:
        InputError: If it is no path.
    """
    if to is None:
        return None
    if not isinstance(to, str | os.PathLike) or not os.fspath(to):
        raise InputError(f"`to` is {short_repr(to)}; expected a path such as 'result.zarr'.")
    return Path(os.path.abspath(to))


def job_folder(to: Path) -> Path:
    """Where the progress of a job is whose result will be in `to`."""
    return to.with_name(to.name + ".job")


def check_result(to: Path, description: Mapping[str, Any]) -> None:
    """Refuses a result that is not of the job of that description, as `Store.describe_result` wrote it down.

    Args:
        to: The result.
        description: The description of the job.

    Raises:
        InputError: If it is of another job, or nothing says of which.
    """
    path = _description_file(to)
    try:
        there = json.loads(path.read_text("utf-8"))
    except (OSError, ValueError):
        there = None
    if not isinstance(there, dict):
        raise InputError(
            f"{str(to)!r} exists, but {str(path)!r}, which names its job, is absent or "
            f"damaged. Give `to` another name, or remove {str(to)!r}."
        )
    check_same(
        there, json.loads(json.dumps(description)), to, f"Give `to` another name, or remove {str(to)!r}."
    )


def _description_file(to: Path) -> Path:
    return to.with_name(to.name + ".job.json")


def check_same(
    there: Mapping[str, Any], here: Mapping[str, Any], to: Path, remedy: str = "Give `to` another name."
) -> None:
    """Refuses another job than the one that is there.

    Args:
        there: The description of the job in the store.
        here: That of this job.
        to: The store.
        remedy: What to do, for the message.

    Raises:
        InputError: If they differ; names the first difference.
    """
    for name in dict.fromkeys([*here, *there]):
        if there.get(name) != here.get(name):
            raise InputError(
                f"{str(to)!r} holds another job: its {name} is {_short(there.get(name))}, here it is "
                f"{_short(here.get(name))}. {remedy}"
            )


def _short(value: Any) -> str:
    text = repr(value)
    return text if len(text) < 80 else text[:77] + "..."
