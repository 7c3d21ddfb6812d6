"""The graph of a traced function: append-only, interned, indices in topological order."""

from __future__ import annotations

import struct
from collections.abc import Iterable, Sequence
from typing import Any, SupportsFloat

from ulna.compiler.language.ops import TABLE, Op
from ulna.compiler.language.simplify import PLAIN_FROM, simplify
from ulna.compiler.language.vjp_rule import VjpRule
from ulna.compiler.size_limit import most_operations, raise_too_large
from ulna.data_classes import dataclass
from ulna.errors import TraceError


@dataclass(frozen=True, eq=False)
class Loop:
    """The subgraph that a LOOP node iterates: while `condition`, `state` becomes `following`.

    The subgraph's inputs are the state first, then the captured values of the graph around it. A loop that reads the
    tapes of others repeats the iterations of the first of them, whatever its own condition says; the states before
    each iteration, each with what is kept beside it, are its last inputs, and the LOOP nodes of these loops its last
    arguments.
    """

    graph: Graph
    size: int  # how many numbers the state has
    condition: int
    following: tuple[int, ...]  # the next state, then what the tape has of the iteration beside the state
    limit: int  # iterations after which a lane stops even where its condition still holds
    is_taped: bool = False  # whether a tape keeps the state before each iteration, for other loops
    is_backward: bool = False  # whether it repeats the iterations that it reads from the last to the first
    reads: int = 0  # how many loops it reads the tapes of
    plain: Loop | None = None  # the same from tapes of nothing but states, which has derivatives


_PLAIN = frozenset({int(Op.MUL), int(Op.ADD)})  # no rule simplifies them but beside constants and negatives
_COMMUTING = frozenset(int(row.op) for row in TABLE if row.commutes)
"""Operations of two operands whose order does not matter."""
_bits = struct.Struct("<d").pack
_ZERO = _bits(0.0)
_CONST, _ADD, _SUB, _MUL = int(Op.CONST), int(Op.ADD), int(Op.SUB), int(Op.MUL)


class Graph:
    """Nodes of scalar operations. A node is an index into three parallel lists.

    Equal nodes are one node, keyed by operation, arguments and, for constants, by their bits
    (as keys 0.0 == -0.0 and nan != nan would do harm). `relaxed` allows the rewrite rules that hold only for
    finite numbers up to the sign of zero, such as x * 0 -> 0.

    Args:
        relaxed: Whether rewrite rules apply that hold only for finite numbers up to the sign of zero.
        parent: The graph around the body of a loop; None for none.
        lanes: In how many SIMD lanes a sample is evaluated; that of `parent`, if there is one.
    """

    __slots__ = (
        "_captured",
        "_interned",
        "_numbers",
        "args",
        "data",
        "inputs",
        "lanes",
        "most",
        "op",
        "parent",
        "relaxed",
        "rules",
        "zero",
    )

    def __init__(self, *, relaxed: bool = True, parent: Graph | None = None, lanes: int = 1) -> None:
        self.op: list[int] = []
        self.args: list[tuple[int, ...]] = []
        self.data: list[Any] = []
        self.inputs: list[int] = []
        self.relaxed = relaxed
        self.rules: list[VjpRule] = []
        self.parent = parent
        self.lanes = lanes if parent is None else parent.lanes
        self.zero = -1  # the node of 0.0, once there is one
        self._interned: dict[Any, int] = {}
        self._captured: dict[int, int] = {}
        self._numbers: dict[Any, int] = {}  # constants by value, in less time than by their bits
        self.most = most_operations()

    def __len__(self) -> int:
        return len(self.op)

    def __reduce__(self) -> tuple[Any, ...]:
        return _rebuild, (self.op, self.args, self.data, self.inputs, self.relaxed, self.lanes, self.rules)

    def input(self) -> int:
        """A new input; inputs are numbered in the order they are made."""
        index = self._append(Op.INPUT, (), len(self.inputs))
        self.inputs.append(index)
        return index

    def constant(self, value: SupportsFloat) -> int:
        """The node of a number, one for each bit pattern."""
        index = self._numbers.get(value)
        if index is not None:
            return index
        key = _bits(number := float(value))
        index = self._interned.get(key)
        if index is None:
            index = self._interned[key] = self._append(_CONST, (), number)
            if key == _ZERO:
                self.zero = index
        if number:  # 0.0 and -0.0 would be one key
            self._numbers[number] = index
        return index

    def truth(self, value: bool) -> int:
        """The node of a constant condition."""
        return self._leaf(bool(value), Op.BOOL, bool(value))

    def node(self, op: int, *args: int) -> int:
        """The node of `op` on `args`, simplified; an equal one is reused.

        Args:
            op: A member of `Op`.
            *args: Nodes of the operands.

        Returns:
            The node.
        """
        if len(args) == 2:
            return self.pair(op, *args)
        key = (op, *args)
        index = self._interned.get(key)
        if index is None:
            index = simplify(self, op, args)
        if index is None:
            index = self._interned[key] = self._append(op, args, None)
        return index

    def pair(self, op: int, a: int, b: int) -> int:
        """The same as `node` of an operation on two operands, which most are, in less time.

        Args:
            op: A member of `Op`, as a plain number.
            a: The node of the first operand.
            b: The node of the second one.

        Returns:
            The node.
        """
        zero = self.zero
        if (a == zero or b == zero) and self.relaxed:  # noqa: PLR1714 - in less time than `in`
            index = self._beside_zero(op, a, b)
            if index is not None:
                return index
        key = (op, b, a) if a > b and op in _COMMUTING else (op, a, b)
        index = self._interned.get(key)
        if index is not None:
            return index
        kinds = self.op
        if op not in _PLAIN or kinds[a] < PLAIN_FROM or kinds[b] < PLAIN_FROM:
            index = simplify(self, op, (a, b))
            if index is not None:
                return index
        index = self._interned[key] = self._append(op, key[1:], None)
        return index

    def _beside_zero(self, op: int, a: int, b: int) -> int | None:
        """What `simplify` makes of x * 0, x + 0 and x - 0, at once: most of what the trace of a robot asks for."""
        if op == _SUB:
            return a if b == self.zero else None
        if op not in (_MUL, _ADD):
            return None
        other = a if b == self.zero else b
        if self.op[other] == _CONST and other != self.zero:  # -0.0, inf and nan among them
            return None
        return self.zero if op == _MUL else other

    def find(self, op: int, *args: int) -> int | None:
        """The node of `op` on `args`, if there is one already.

        Args:
            op: A member of `Op`.
            *args: Nodes of the operands, in the order in which they are stored.

        Returns:
            The node, or None.
        """
        return self._interned.get((op, *args))

    def loop(self, loop: Loop, args: Sequence[int]) -> list[int]:
        """Appends a LOOP node.

        Args:
            loop: Condition and body.
            args: Nodes of the initial state, then of the values that the loop captures, then of the loops that it
                reads.

        Returns:
            The nodes of the final state, `loop.size` of them.
        """
        if loop.limit < 1:  # no iteration, and no tape to divide
            return list(args[: loop.size])
        index = self._append(Op.LOOP, tuple(args), loop)
        return [self._append(Op.ITEM, (index,), k) for k in range(loop.size)]

    def lane(self, count: int) -> int:
        """The node of the lane's number, 0 to `count` - 1; a single lane has the number 0."""
        if count == 1:
            return self.constant(0.0)
        return self._leaf((Op.LANE, count), Op.LANE, count)

    def capture(self, other: Graph, index: int) -> int:
        """The node that stands here for node `index` of `other`, a graph around this one.

        Args:
            other: The graph of `parent` or of a loop further out.
            index: A node of `other`.

        Returns:
            A constant, or an input of this graph that stands for the node.

        Raises:
            TraceError: If `other` is not around this graph: the value belongs to another trace.
        """
        if self.parent is None:
            raise TraceError("A traced value of another trace is used here; pass it as an argument instead.")
        if other is not self.parent:
            index = self.parent.capture(other, index)
        op = self.parent.op[index]
        if op == Op.CONST:
            return self.constant(self.parent.data[index])
        if op == Op.BOOL:
            return self.truth(self.parent.data[index])
        if op == Op.LANE:
            return self.lane(self.parent.data[index])
        if index not in self._captured:
            self._captured[index] = self.input()
        return self._captured[index]

    @property
    def captured(self) -> list[int]:
        """The nodes of the parent that this graph uses, in the order of its inputs."""
        return list(self._captured)

    def live(self, outputs: Iterable[int]) -> list[int]:
        """The nodes that `outputs` depend on, in topological order."""
        needed = bytearray(len(self))
        for index in outputs:
            needed[index] = 1
        for index in range(len(self) - 1, -1, -1):
            if needed[index]:
                for a in self.args[index]:
                    needed[a] = 1
        return [index for index in range(len(self)) if needed[index]]

    def _leaf(self, key: Any, op: int, data: Any) -> int:
        """The node without arguments of that key, which is made where there is none."""
        index = self._interned.get(key)
        if index is None:
            index = self._interned[key] = self._append(op, (), data)
        return index

    def _append(self, op: int, args: tuple[int, ...], data: Any) -> int:
        index = len(self.op)
        self.op.append(op)
        self.args.append(args)
        self.data.append(data)
        if index >= self.most:
            raise_too_large(f"A function took {index:,} operations so far")
        return index


def _rebuild(
    op: Any, args: Any, data: Any, inputs: Any, relaxed: bool, lanes: int = 1, rules: Any = ()
) -> Graph:
    graph = Graph(relaxed=relaxed, lanes=lanes)
    graph.rules = list(rules)
    graph.op, graph.args, graph.data, graph.inputs = list(op), list(args), list(data), list(inputs)
    for index, (o, a, d) in enumerate(zip(op, args, data, strict=True)):
        if o == Op.CONST:
            graph._interned[_bits(d)] = index
            if _bits(d) == _ZERO:
                graph.zero = index
        elif o == Op.BOOL:
            graph._interned[d] = index
        elif o == Op.LANE:
            graph._interned[(Op.LANE, d)] = index
        elif o not in (Op.INPUT, Op.LOOP, Op.ITEM):
            graph._interned[(o, *a)] = index
    return graph
