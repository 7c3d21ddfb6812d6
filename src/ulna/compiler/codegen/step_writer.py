"""What those who write loops and parts of straight-line code use of a writer of nodes, which writes loops itself."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

from ulna.compiler.codegen.ir_text import Lanes
from ulna.compiler.language.graph import Graph
from ulna.data_classes import dataclass


@dataclass(frozen=True)
class Tape:
    """Where a loop stores its states for derivatives, and how many iterations it made.

    Attributes:
        array: The address of the states, those of one iteration after the other.
        size: How many numbers are stored in an iteration.
        rounds: The name of the number of iterations of the lane that has most.
        counts: The name of the number of iterations in each lane, a floating-point number.
    """

    array: str
    size: int
    rounds: str
    counts: str


class Definitions(Protocol):
    """What is used of a module."""

    definitions: dict[str, str]

    def declare(self, line: str) -> None:
        """Notes a declaration."""
        ...


class StepWriter(Protocol):
    """What is used of a writer of nodes."""

    module: Any
    graph: Graph
    layout: Lanes
    prefix: str
    loop_pack: int
    names: dict[int, str]
    captured_conditions: set[int]
    tapes: dict[int, Tape]
    lines: list[str]
    local_arrays: list[str]
    current_block: str

    def inside(self, tag: str, graph: Graph) -> StepWriter:
        """A writer for the body of a loop, in the same function."""
        ...

    def apart(self) -> StepWriter:
        """A writer for another function, of the same graph and lanes."""
        ...

    def is_condition(self, index: int) -> bool:
        """Whether a node is a truth value."""
        ...

    def kind(self, index: int) -> str:
        """LLVM type of a node in all lanes."""
        ...

    def array(self, name: str, count: int) -> str:
        """A local array of the function."""
        ...

    def node(self, index: int) -> None:
        """Writes one node."""
        ...

    def nodes(self, order: Sequence[int]) -> None:
        """Writes nodes."""
        ...

    def sincos(self, arguments: Sequence[int]) -> None:
        """Writes sine and cosine of each argument."""
        ...

    def assign(self, index: int, text: str) -> None:
        """Appends the instruction whose result is a node."""
        ...

    def in_all_lanes(self, element: str, value: str) -> str:
        """A vector that holds a value in every lane."""
        ...

    def fresh(self, hint: str = "t") -> str:
        """A name that is not in use."""
        ...

    def write(self, *instructions: str) -> None:
        """Appends instructions as they are."""
        ...

    def let(self, name: str, instruction: str) -> str:
        """Appends an instruction with a result."""
        ...

    def branch(self, condition: str, label: str, otherwise: str) -> None:
        """Continues at one of two blocks."""
        ...

    def open_block(self, label: str) -> None:
        """Begins a basic block."""
        ...
