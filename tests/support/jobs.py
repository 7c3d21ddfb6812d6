"""Small jobs for tests of the engine: exact answers, and parts that fail on demand."""

from __future__ import annotations

import errno
import os
import signal
import time
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from support.patience import patient
from ulna.scale import Job, Samples


@dataclass(frozen=True)
class Sums(Job):
    """Sums of random numbers, which depend on the order in which they are added.

    Attributes:
        count: How many parts.
        folder: Where parts leave signs; empty for nowhere.
        trouble: Parts that fail once, and how: "kill", "full" or "raise".
        seconds: How long a part takes [s].
    """

    kind: ClassVar[str] = "sums"
    count: int = 8
    folder: str = ""
    trouble: tuple[tuple[int, str], ...] = ()
    seconds: float = 0.0

    @property
    def parts(self) -> int:
        return self.count

    def description(self) -> dict[str, Any]:
        return {"kind": self.kind, "count": self.count}

    def start(self) -> dict[str, Any]:
        return {"sum": np.zeros(3), "parts": np.zeros(self.count, dtype=np.int64)}

    def work(self, part: int) -> dict[str, Any]:
        time.sleep(self.seconds)
        for number, what in self.trouble:
            if number == part:
                self._fail(part, what)
        return {"sum": np.random.default_rng([7, part]).standard_normal(3) * 1e8}

    def _fail(self, part: int, what: str) -> None:
        sign = Path(self.folder, f"{what}-{part}")
        if what == "full" and not Path(self.folder, "room").exists():
            raise OSError(errno.ENOSPC, "No space left on device", str(self.folder))
        if sign.exists():
            return
        sign.touch()
        if what == "kill":
            os.kill(os.getpid(), signal.SIGKILL)
        if what == "raise":
            raise RuntimeError("a passing fault")

    def fold(self, state: Any, part: int, result: Any) -> None:
        state["sum"] += result["sum"]
        state["parts"][part] += 1

    def existing(self, to: Path) -> Any:
        return np.load(to)

    def finish(self, state: Any, to: Path | None) -> Any:
        assert (state["parts"] == 1).all(), "each part counts once"
        if to is not None:
            with to.open("wb") as file:
                np.save(file, state["sum"])
        return state["sum"]


@dataclass(frozen=True)
class Patient(Job):
    """The numbers of the parts; the first part ends once others are done.

    Attributes:
        count: How many parts.
        folder: Where each part leaves a sign.
        others: How many signs of others the first waits for.
    """

    kind: ClassVar[str] = "patient"
    count: int
    folder: str
    others: int

    @property
    def parts(self) -> int:
        return self.count

    def description(self) -> dict[str, Any]:
        return {"kind": self.kind, "count": self.count}

    def start(self) -> dict[str, Any]:
        return {"numbers": np.zeros(self.count, dtype=np.int64)}

    def work(self, part: int) -> dict[str, Any]:
        if part == 0:
            patient()(lambda: len([*Path(self.folder).iterdir()]) >= self.others)
        Path(self.folder, f"{part}-{os.getpid()}").touch()
        return {"number": np.array(part)}

    def fold(self, state: Any, part: int, result: Any) -> None:
        state["numbers"][part] = result["number"]

    def existing(self, to: Path) -> Any:
        return np.load(to)

    def finish(self, state: Any, to: Path | None) -> Any:
        return state["numbers"]


@dataclass(frozen=True, eq=False)
class Rows(Job):
    """The sum of the rows of an array, of which each part is sent four.

    Attributes:
        rows: The rows, (n, 3); None on workers.
    """

    kind: ClassVar[str] = "rows"
    rows: Any

    @property
    def parts(self) -> int:
        return -(-len(self.rows) // 4)

    def description(self) -> dict[str, Any]:
        return {"kind": self.kind, "count": self.parts}

    def start(self) -> dict[str, Any]:
        return {"sum": np.zeros(3)}

    def inputs(self, part: int) -> tuple[Any, ...]:
        return (self.rows[4 * part : 4 * part + 4],)

    def for_workers(self) -> Rows:
        return replace(self, rows=None)

    def work(self, part: int, *inputs: Any) -> dict[str, Any]:
        (rows,) = inputs
        return {"sum": rows.sum(axis=0)}

    def fold(self, state: Any, part: int, result: Any) -> None:
        state["sum"] += result["sum"]

    def existing(self, to: Path) -> Any:
        return np.load(to)

    def finish(self, state: Any, to: Path | None) -> Any:
        return state["sum"]


@dataclass(frozen=True, eq=False)
class Drawn(Job):
    """The mean of random numbers.

    Attributes:
        samples: The numbers.
    """

    kind: ClassVar[str] = "drawn"
    samples: Samples

    @property
    def parts(self) -> int:
        return self.samples.parts

    def description(self) -> dict[str, Any]:
        return {"kind": self.kind}

    def start(self) -> dict[str, Any]:
        return {"sum": np.zeros(())}

    def work(self, part: int) -> dict[str, Any]:
        return {"sum": self.samples.generator(part).random(self.samples.size(part)).sum()}

    def fold(self, state: Any, part: int, result: Any) -> None:
        state["sum"] += result["sum"]

    def existing(self, to: Path) -> Any:
        return np.load(to)

    def finish(self, state: Any, to: Path | None) -> Any:
        return state["sum"] / self.samples.count
