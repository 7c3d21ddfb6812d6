"""Where a job keeps what it has found so far, so that it can be continued: a folder beside its result."""

from __future__ import annotations

import json
import os
import shutil
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any, final

import numpy as np

from ulna.errors import InputError
from ulna.scale.job import State
from ulna.system.storage import replacing

_DONE = "parts_done"


@final
class Store:
    """The progress of one job in the folder `TO.job`, which is removed once the result is in `TO`.

    Args:
        to: Where the result will be.
        description: What `Job.description` returned.

    Raises:
        InputError: If there is the progress or result of another job, or another process works on this one.
        OSError: If the folder cannot be written.
    """

    def __init__(self, to: Path, description: Mapping[str, Any]) -> None:
        self.to, self.folder = to, job_folder(to)
        self._description = json.loads(json.dumps(description))
        self._lock: int | None = None
        self.folder.mkdir(parents=True, exist_ok=True)
        self._take()
        try:
            self._check()
        except BaseException:
            self.close()
            raise

    def load(self) -> tuple[State, int] | None:
        """The state, and how many parts are in it; None where there is none.

        Raises:
            InputError: If the file is damaged.
        """
        path = self.folder / "state.npz"
        if not path.exists():
            return None
        try:
            with np.load(path, allow_pickle=False) as file:
                state = {name: file[name] for name in file.files}
            return state, int(state.pop(_DONE))
        except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile) as error:
            raise self._damaged(path, error) from error

    def _damaged(self, path: Path, error: Exception) -> InputError:
        return InputError(f"{str(path)!r} is damaged ({error}); remove {str(self.folder)!r} to begin anew.")

    def save(self, state: State, done: int) -> None:
        """Writes the state, whole or not at all.

        Args:
            state: The arrays.
            done: How many parts are in them.

        Raises:
            OSError: It cannot be written; what was there stays.
        """
        with replacing(self.folder / "state.npz") as place, place.open("wb") as file:
            np.savez(file, allow_pickle=False, **state, **{_DONE: np.array(done)})
            file.flush()
            os.fsync(file.fileno())

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
            if known is not None and known[1] > 0:
                folder = str(self.folder)
                remedy = (
                    f"Give the same arguments to continue it, or `to` another name, or remove {folder!r}."
                )
                check_same(there, self._description, self.to, remedy)
            (self.folder / "state.npz").unlink(missing_ok=True)
        with replacing(path) as place:
            place.write_text(json.dumps(self._description, indent=1), "utf-8")


def job_folder(to: Path) -> Path:
    """Where the progress of a job is whose result will be in `to`."""
    return to.with_name(to.name + ".job")


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
