"""What a whole job is: parts that depend on nothing but their number, and how their results are put together."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, final

import numpy as np

from ulna.checks.values import short_repr
from ulna.errors import InputError
from ulna.typing import Array

if TYPE_CHECKING:
    from ulna.robot import Robot

_EXACT = 2**53  # up to which a float says which whole number is meant

State = dict[str, Array]
"""What a job has found so far: arrays by name."""


class Job(ABC):
    """Work in numbered parts; each part has its own seed, so that any process can do it, again and again, bit for bit.

    Results are put together in the order of their numbers, so that sums of floating-point numbers do not depend on
    which worker was faster.
    """

    kind: ClassVar[str]
    """The name of this kind of job."""

    describes_result: ClassVar[bool] = False
    """Whether `finish` stores the description with the result, and `existing` compares it. Otherwise `run` does both:
    it keeps the description beside the result, in `TO.job.json`."""

    @property
    @abstractmethod
    def parts(self) -> int:
        """How many parts there are."""

    @abstractmethod
    def description(self) -> dict[str, Any]:
        """All that the results depend on, as JSON can write it; jobs of the same description have the same results."""

    @abstractmethod
    def start(self) -> State:
        """The state before the first part."""

    @abstractmethod
    def work(self, part: int, *inputs: Any) -> State:
        """The result of a part; called on a worker.

        Args:
            part: Its number.
            *inputs: What `inputs` returned for it; jobs without inputs need no such argument.

        Returns:
            Arrays by name.
        """

    @abstractmethod
    def fold(self, state: State, part: int, result: State) -> None:
        """Adds the result of a part to the state, in place; parts come in order.

        Args:
            state: The state, which is changed.
            part: The number of the part.
            result: What `work` returned for it.
        """

    @abstractmethod
    def finish(self, state: State, to: Path | None) -> Any:
        """What the job is for, once all parts are done.

        Args:
            state: The final state.
            to: Where to write it; None for nowhere.

        Returns:
            The result for the user.
        """

    @abstractmethod
    def existing(self, to: Path) -> Any:
        """The result that is in `to` already.

        Args:
            to: What is there: a result of a job of the same description, unless `describes_result`.

        Returns:
            The result for the user.

        Raises:
            InputError: If `describes_result`, and it is something else than the result of this job.
        """

    def inputs(self, part: int) -> tuple[Any, ...]:
        """What is sent to a worker for one part, such as the part's rows of arrays; most jobs need nothing.

        Args:
            part: The number of the part.

        Returns:
            Further arguments of `work`.
        """
        return ()

    def for_workers(self) -> Job:
        """The job as it is sent to workers: without the arrays whose rows `inputs` sends."""
        return self

    def prepare(self, to: Path | None) -> None:
        """Makes the files that parts write to, before the first part of a new job; most jobs need none.

        Args:
            to: Where; None for nowhere.
        """
        return


@final
@dataclass(frozen=True)
class Samples:
    """How many samples there are, in parts of which each has its own seed.

    Attributes:
        count: How many.
        chunk: How many a part has; the last has what is left.
        seed: The seed of the whole.
    """

    count: int
    chunk: int
    seed: int

    @property
    def parts(self) -> int:
        """How many parts there are."""
        return -(-self.count // self.chunk)

    def size(self, part: int) -> int:
        """How many samples a part has."""
        return min(self.chunk, self.count - part * self.chunk)

    def generator(self, part: int) -> np.random.Generator:
        """The random numbers of a part: those of no other part, and the same wherever it is done."""
        return np.random.default_rng(np.random.SeedSequence(self.seed, spawn_key=(part,)))


def whole_number(name: str, value: Any, least: int = 1) -> int:
    """A count that may be written as a float, such as 1e8.

    Args:
        name: The name of the argument.
        value: What was passed.
        least: The least value.

    Returns:
        The number.

    Raises:
        InputError: If it is no whole number, below `least`, or a float above 2**53, which may stand for another number.
    """
    try:
        number = int(value)
        is_whole = number == value
    except (TypeError, ValueError, OverflowError):
        is_whole, number = False, least
    is_exact = isinstance(value, int | np.integer) or number <= _EXACT
    if not (is_whole and is_exact) or number < least or isinstance(value, bool):
        most = " to 9e15" if is_whole and not is_exact else ""
        raise InputError(
            f"`{name}` is {short_repr(value)}; expected a whole number from {least}{most}, such as 100_000 or 1e8."
        )
    return number


class SampledJob(Job):
    """A job over samples for one robot; its parts are those of the samples, its result holds its description.

    Attributes:
        robot: The robot.
        samples: The samples.
    """

    describes_result: ClassVar[bool] = True
    robot: Robot
    samples: Samples

    @property
    def parts(self) -> int:
        """How many parts there are."""
        return self.samples.parts

    def subject(self) -> dict[str, Any]:
        """The kind of job, and the robot that it is for: what `description` begins with."""
        return {"kind": self.kind, "robot": self.robot.name, "model": self.robot.model.fingerprint}
