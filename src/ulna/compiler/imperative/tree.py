"""The typed tree of a procedure: the output of the reader, the input of the interpreter and of code generation.

Every expression has a type, every node the line of the source it comes from. All names are resolved, and
the only Python objects in it are numbers.
"""

from __future__ import annotations

from ulna.compiler.imperative.types import ArrayType, KernelType, Lanes, Number, Type
from ulna.data_classes import dataclass


@dataclass(frozen=True)
class Constant:
    """A number known when the code is compiled."""

    value: bool | int | float
    type: Number
    line: int
    is_literal: bool = True  # takes the type of the other operand


@dataclass(frozen=True)
class Local:
    """The value of a variable or parameter."""

    name: str
    type: Type
    line: int


@dataclass(frozen=True)
class Operation:
    """An operation of `operations.TABLE` on numbers or lanes."""

    name: str
    arguments: tuple[Expression, ...]
    type: Type
    line: int


@dataclass(frozen=True)
class Convert:
    """A number or lanes in another type."""

    value: Expression
    type: Type
    line: int


@dataclass(frozen=True)
class Broadcast:
    """A number in every lane."""

    value: Expression
    type: Lanes
    line: int


@dataclass(frozen=True)
class Choice:
    """`a if condition else b`, a short-circuit `and`/`or` or a chain of comparisons: one of the two is evaluated."""

    condition: Expression
    if_true: Expression
    if_false: Expression
    type: Number | Lanes
    line: int


@dataclass(frozen=True)
class Field:
    """A field of a record."""

    record: Expression
    name: str
    type: Type
    line: int


@dataclass(frozen=True)
class Extent:
    """How long an axis of an array is."""

    array: Expression
    axis: int
    type: Number
    line: int


@dataclass(frozen=True)
class View:
    """The part of an array with the first indices fixed: an array of lower rank, in place."""

    array: Expression
    indices: tuple[Expression, ...]
    type: ArrayType
    line: int


@dataclass(frozen=True)
class Element:
    """An element of an array; with indices in lanes as last index, the elements of all lanes."""

    array: Expression
    indices: tuple[Expression, ...]
    type: Number | Lanes
    line: int


@dataclass(frozen=True)
class Slice:
    """Consecutive elements along the last axis, as many as the type has lanes."""

    array: Expression
    indices: tuple[Expression, ...]  # the last one is where they begin
    type: Lanes
    line: int


@dataclass(frozen=True)
class LaneItem:
    """The number in one lane."""

    value: Expression
    index: Expression
    type: Number
    line: int


@dataclass(frozen=True)
class Call:
    """A call of another procedure; its type is that of its one result."""

    instance: Instance
    arguments: tuple[Expression, ...]
    type: Type
    line: int


Expression = (
    Constant | Local | Operation | Convert | Broadcast | Choice | Field | Extent | View | Element | Slice
    | LaneItem | Call
)  # fmt: skip


@dataclass(frozen=True)
class Assign:
    """`name = value`."""

    name: str
    value: Expression
    line: int


@dataclass(frozen=True)
class CallStatement:
    """A call whose results go to variables; to none where their tuple is empty."""

    instance: Instance
    arguments: tuple[Expression, ...]
    names: tuple[str, ...]
    line: int


@dataclass(frozen=True)
class KernelCall:
    """A call of a kernel on arrays."""

    kernel: Expression
    arrays: tuple[Expression, ...]
    type: KernelType
    line: int


@dataclass(frozen=True)
class NewArray:
    """`name = np.empty(shape, element)`, or `np.zeros`: storage for as long as the procedure runs."""

    name: str
    shape: tuple[int, ...]
    type: ArrayType
    is_zero: bool
    line: int


@dataclass(frozen=True)
class Store:
    """An assignment to an `Element` or a `Slice`."""

    place: Element | Slice
    value: Expression
    line: int


@dataclass(frozen=True)
class If:
    """`if condition: body else: otherwise`."""

    condition: Expression
    body: tuple[Statement, ...]
    otherwise: tuple[Statement, ...]
    line: int


@dataclass(frozen=True)
class While:
    """`while condition: body`."""

    condition: Expression
    body: tuple[Statement, ...]
    line: int


@dataclass(frozen=True)
class For:
    """`for name in range(start, stop, step): body`; the step is a constant other than zero."""

    name: str
    start: Expression
    stop: Expression
    step: int
    body: tuple[Statement, ...]
    line: int


@dataclass(frozen=True)
class Break:
    """Leaves the innermost loop."""

    line: int


@dataclass(frozen=True)
class Continue:
    """Begins the next pass of the innermost loop."""

    line: int


@dataclass(frozen=True)
class Return:
    """Leaves the procedure with its results."""

    values: tuple[Expression, ...]
    line: int


Statement = (
    Assign | CallStatement | KernelCall | NewArray | Store | If | While | For | Break | Continue | Return
)


@dataclass(frozen=True, eq=False)
class Instance:
    """A procedure for arguments of certain types: parameters without annotation take the types of the call.

    Attributes:
        name: Unique within a program.
        parameters: Names and types.
        variables: Names and types of the variables that are assigned to, local arrays among them.
        results: The types of what it returns.
        body: Its statements.
        file: The file of the source.
        contract: Whether its products and sums may be fused.
    """

    name: str
    parameters: tuple[tuple[str, Type], ...]
    variables: tuple[tuple[str, Type], ...]
    results: tuple[Number | Lanes, ...]
    body: tuple[Statement, ...]
    file: str
    contract: bool
