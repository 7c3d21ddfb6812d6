"""What is exported, as targets receive it, and what a target is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from typing import Any, final

import numpy as np

from ulna.compiler import Function
from ulna.ik.problem import Problem
from ulna.ik.search import multi_start
from ulna.model import Model
from ulna.typing import Floats


@final
@dataclass(frozen=True)
class Argument:
    """An input or output of an exported function.

    Attributes:
        name: Its name, an identifier.
        shape: The shape of one sample; its numbers are in row-major order.
        unit: The units of its numbers, such as "rad or m"; empty where they are not known.
        text: What it is, in a sentence without a full stop; empty where that is not known.
    """

    name: str
    shape: tuple[int, ...]
    unit: str = ""
    text: str = ""

    @property
    def size(self) -> int:
        """How many numbers one sample has."""
        return int(np.prod(self.shape, dtype=int))


@final
@dataclass(frozen=True, eq=False)
class ExportedFunction:
    """A function without a search: a graph, with the documentation of its arguments.

    Attributes:
        name: Its name without the prefix of the export, an identifier: "fk".
        function: The traced function.
        inputs: Its inputs, in order.
        outputs: Its outputs, in order.
        summary: What it computes, in a sentence or two.
        choices: The options it was made with, for its documentation: {"frame": "panda_hand"}.
        samples: Inputs to record results for, one array (n, *shape) for each input.
    """

    name: str
    function: Function
    inputs: tuple[Argument, ...]
    outputs: tuple[Argument, ...]
    summary: str
    choices: Mapping[str, str]
    samples: tuple[Floats, ...]


@final
@dataclass(frozen=True, eq=False)
class ExportedSearch:
    """A search of inverse kinematics.

    Attributes:
        name: Its name without the prefix of the export, an identifier: "ik".
        problem: The frames, what counts of their poses, and the joints that may move.
        start: Configuration where a search without `q0` begins, (nq,) [rad or m].
        shift: Where the sequence of starting points begins, (d,) of [0, 1).
        choices: The options it was made with, for its documentation.
        goals: Goals to record results for, (n, 4, 4), or (n, k, 4, 4) for k frames; all within reach.
    """

    name: str
    problem: Problem
    start: Floats
    shift: Floats
    choices: Mapping[str, str]
    goals: Floats

    def function(self, lanes: int = 1) -> Function:
        """The search as a function of T, q0, shift and settings; see `ulna.ik.search.multi_start`.

        `ulna.ik.solve.search_settings` makes the settings of tolerances. Where no goal is met, the same function with
        the settings of a descent finds the nearest configuration (`ulna.ik.solve.Solver`).

        Args:
            lanes: How many attempts are under way at once, 1, 2, 4 or 8.

        Returns:
            The function, not compiled.
        """
        return multi_start(self.problem, lanes)


@final
@dataclass(frozen=True, eq=False)
class Export:
    """All that a target needs to write its files.

    Attributes:
        name: What names of functions and files begin with, an identifier: "panda".
        model: The robot; None where only functions without a robot are exported.
        functions: The functions.
        searches: The searches.
        dtype: The type to compute in, float64 or float32.
        options: All options of the target: those that were given, and the default values of the others.
    """

    name: str
    model: Model | None
    functions: tuple[ExportedFunction, ...]
    searches: tuple[ExportedSearch, ...]
    dtype: np.dtype[Any]
    options: Mapping[str, Any] = field(default_factory=dict)


@final
@dataclass(frozen=True)
class Option:
    """An option of a target.

    Attributes:
        default: Its value where it is not given; on the command line a value has the type of this one.
        text: What it means, for the documentation and for the command line.
        choices: The values it may have; empty for any.
    """

    default: Any
    text: str
    choices: tuple[Any, ...] = ()


@final
@dataclass(frozen=True)
class ExportTarget:
    """Something that functions can be exported to.

    Attributes:
        name: Its name, as the argument `to`.
        text: What is written, in a few words.
        module: The module whose function `write(export: Export, folder: Path) -> None` writes the files into an
            empty folder. It is imported when first used.
        options: Its options by name.
    """

    name: str
    text: str
    module: str
    options: Mapping[str, Option] = field(default_factory=dict)

    def write(self, export: Export, folder: Path) -> None:
        """Writes the files.

        Args:
            export: What is to be written.
            folder: An empty folder.
        """
        import_module(self.module).write(export, folder)
