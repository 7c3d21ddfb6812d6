"""A graph as statements of C99: each node a constant, each loop a `for`, sines together.

Names `v12` (numbers) and `c12` (conditions) are indices of the graph, so that source, graph and profile can be read
side by side. With `L3_` in front they are those of the loop that node 3 is.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from ulna.compiler.codegen.scheduling import Sines, Step, Store, made, ordered, used
from ulna.compiler.language.graph import Graph, Loop
from ulna.compiler.language.ops import TABLE, Op
from ulna.exporting.c.expressions import expression, number

PACK = 8
"""How many angles share one call of sines and cosines."""


class Writer:
    """Writes the nodes of one graph as statements.

    Args:
        graph: The graph.
        real: "double" or "float".
        prefix: What names of functions of the export begin with.
        tag: What the names of values begin with.
        depth: How deep the statements are indented.
    """

    def __init__(self, graph: Graph, real: str, prefix: str, tag: str = "", depth: int = 1) -> None:
        self.graph, self.real, self.prefix, self.tag = graph, real, prefix, tag
        self.lines: list[str] = []
        self.names: dict[int, str] = {}
        self._indent = "    " * depth
        self._depth = depth
        self._packs = 0
        self._iterations: dict[int, str] = {}  # how often loops iterated

    def write(self, line: str) -> None:
        """Appends a line."""
        self.lines.append(self._indent + line)

    def is_condition(self, index: int) -> bool:
        """Whether a node is a condition."""
        return TABLE[self.graph.op[index]].is_condition

    def assign(self, index: int, text: str) -> None:
        """Appends the constant that a node is.

        Args:
            index: The node.
            text: The right side.
        """
        kind, letter = ("int", "c") if self.is_condition(index) else (self.real, "v")
        self.names[index] = f"{self.tag}{letter}{index}"
        self.write(f"const {kind} {self.names[index]} = {text};")

    def name_of(self, index: int) -> str:
        """The name of a node that is written already, or the literal of a constant."""
        op, data = self.graph.op[index], self.graph.data[index]
        if op == Op.CONST:
            return number(data, self.real)
        if op == Op.BOOL:
            return "1" if data else "0"
        return self.names[index]

    def steps(self, steps: Iterable[Step], slots: Mapping[int, int], outputs: Sequence[str] = ()) -> None:
        """Writes steps; the scratch `w` has what they need of earlier parts, and takes what later parts need.

        Args:
            steps: The steps.
            slots: Where in the scratch nodes lie.
            outputs: The names of the outputs.
        """
        for step in steps:
            for index in used(self.graph, step):
                if index in slots and index not in self.names:
                    place = f"w[{slots[index]}]"
                    self.assign(index, f"{place} != 0" if self.is_condition(index) else place)
            if isinstance(step, Sines):
                self.sines(step.arguments)
            elif isinstance(step, Store):
                for k, value in enumerate(step.values):
                    self.write(f"{outputs[step.port]}[{step.start + k}] = {self.name_of(value)};")
            for index in made(self.graph, step):
                if index not in self.names:
                    self.node(index)
                if index in slots:
                    cast = f"({self.real})" if self.is_condition(index) else ""
                    self.write(f"w[{slots[index]}] = {cast}{self.name_of(index)};")

    def _is_constant(self, index: int) -> bool:
        return self.graph.op[index] in (Op.CONST, Op.BOOL)

    def node(self, index: int) -> None:
        """Writes one node; its arguments are written already."""
        g = self.graph
        op, args, data = g.op[index], g.args[index], g.data[index]
        if op in (Op.CONST, Op.BOOL):
            return
        if op == Op.LOOP:
            self.loop(index, data, args)
        elif op == Op.ITEM:
            self.names[index] = f"{self.tag}L{args[0]}_x{data}"
        else:
            self.assign(index, expression(op, [self.name_of(a) for a in args], self.real, self.prefix))

    def sines(self, arguments: Sequence[int]) -> None:
        """Writes sine and cosine of some nodes, in one call."""
        g, count = self.graph, 1 << (len(arguments) - 1).bit_length()
        wanted = [(op, k, g.find(op, a)) for k, a in enumerate(arguments) for op in (Op.SIN, Op.COS)]
        new = [(op, k, node) for op, k, node in wanted if node is not None and node not in self.names]
        if not new:
            return
        self._packs += 1
        angles, s, c = (f"{self.tag}{letter}{self._packs}" for letter in ("a", "s", "k"))
        self.write(f"{self.real} {angles}[{count}], {s}[{count}], {c}[{count}];")
        values = [self.name_of(argument) for argument in arguments]
        for k, value in enumerate(values + values[-1:] * (count - len(values))):
            self.write(f"{angles}[{k}] = {value};")
        self.write(f"{self.prefix}_sincos({count}, {angles}, {s}, {c});")
        for op, k, node in new:
            self.names[node] = f"{s if op == Op.SIN else c}[{k}]"

    def loop(self, index: int, loop: Loop, args: Sequence[int]) -> None:
        """Writes a loop; its state are the variables `L<index>_x<number>`, its tape the array `L<index>_r`.

        Args:
            index: The LOOP node.
            loop: Condition and body.
            args: Nodes of the initial state, then of the values that the loop captures, then of the loops that it
                reads.
        """
        tag = f"{self.tag}L{index}_"
        live = set(loop.graph.live([loop.condition, *loop.following]))
        inner = Writer(loop.graph, self.real, self.prefix, tag, self._depth + 1)
        state = [f"{tag}x{k}" for k in range(loop.size)]
        for name, node in zip(state, args, strict=False):
            self.write(f"{self.real} {name} = {self.name_of(node)};")
        if loop.is_taped:
            self.write(f"{self.real} {tag}r[{loop.limit * len(loop.following)}];")
            self.write(f"(void){tag}r;")  # where the derivatives need nothing of it
        self.write(f"long {tag}n;")
        outside = args[loop.size : len(args) - loop.reads]
        for node, other in zip(loop.graph.inputs[loop.size :], outside, strict=False):
            inner.names[node] = self.name_of(other)
            if node not in live and not self._is_constant(other):  # captured, but simplified away in the loop
                self.write(f"(void){inner.names[node]};")
        rounds = self._rounds(loop, args)
        self.write(f"for ({tag}n = 0; {tag}n < {rounds}; {tag}n++) {{")
        for node, name in zip(loop.graph.inputs, state, strict=False):
            if node in live:
                inner.assign(node, name)
            else:
                inner.write(f"(void){name};")
        number = self._begin_round(inner, tag, loop, args)
        inner.steps(self._without_inputs(loop.graph, [loop.condition, *loop.following]), {})
        if loop.is_taped:
            for k, node in enumerate(loop.following[loop.size :], loop.size):
                inner.write(f"{tag}r[{number} * {len(loop.following)} + {k}] = {inner.name_of(node)};")
        for name, node in zip(state, loop.following, strict=False):
            if inner.name_of(node) != name:
                inner.write(f"{name} = {inner.name_of(node)};")
        self.lines += inner.lines
        self.write("}")
        self.names[index] = tag
        self._iterations[index] = rounds if loop.reads else f"{tag}n"

    def _rounds(self, loop: Loop, args: Sequence[int]) -> str:
        """How often a loop iterates at most."""
        return self._iterations[args[len(args) - loop.reads]] if loop.reads else f"{loop.limit}L"

    def _begin_round(self, inner: Writer, tag: str, loop: Loop, args: Sequence[int]) -> str:
        """Ends the loop, or reads and keeps the states before this iteration; returns its number."""
        number = f"{tag}n"
        if not loop.reads:
            inner.steps(self._without_inputs(loop.graph, [loop.condition]), {})
            inner.write(f"if (!({inner.name_of(loop.condition)})) {{")
            inner.write("    break;")
            inner.write("}")
        elif loop.is_backward:
            number = f"({self._rounds(loop, args)} - 1 - {number})"
        if loop.is_taped:
            for k in range(loop.size):
                inner.write(f"{tag}r[{number} * {len(loop.following)} + {k}] = {tag}x{k};")
        read = args[len(args) - loop.reads :]
        sizes = [len(self.graph.data[owner].following) for owner in read]
        nodes = iter(loop.graph.inputs[len(loop.graph.inputs) - sum(sizes) :])
        live = set(loop.graph.live(loop.following))
        for owner, size in zip(read, sizes, strict=True):
            for k in range(size):
                if (node := next(nodes)) in live:
                    inner.assign(node, f"{self.names[owner]}r[{number} * {size} + {k}]")
        return number

    @staticmethod
    def _without_inputs(graph: Graph, results: Sequence[int]) -> list[Step]:
        return [s for s in ordered(graph, results, PACK) if isinstance(s, tuple) or graph.op[s] != Op.INPUT]
