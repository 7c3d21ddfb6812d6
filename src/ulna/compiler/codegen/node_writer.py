"""Writes the nodes of a graph as LLVM instructions, one each, in any layout: numbers, SIMD lanes, or a loop's region.

Names `%v12` are graph indices, so IR, graph and profile can be read side by side.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache

import numpy as np

from ulna.compiler.codegen.arithmetic import Arithmetic
from ulna.compiler.codegen.comparisons import extreme, least_by_comparisons
from ulna.compiler.codegen.elementary import OPERATIONS, elementary_ir
from ulna.compiler.codegen.instructions import Instructions
from ulna.compiler.codegen.ir_text import IRFunction, Lanes, local_array, truth
from ulna.compiler.codegen.loops import write_loop
from ulna.compiler.codegen.sincos import sincos_ir
from ulna.compiler.codegen.step_writer import Tape
from ulna.compiler.language.graph import Graph
from ulna.compiler.language.ops import TABLE, Op

_sincos_ir, _elementary_ir = cache(sincos_ir), cache(elementary_ir)  # the same text for every node


_IS_CONDITION = [row.is_condition for row in TABLE]
_CONST = int(Op.CONST)
_ARITHMETIC = (int(Op.ADD), int(Op.SUB), int(Op.MUL), int(Op.DIV))


@dataclass
class Module:
    """Function definitions and the declarations they need, each once, in order."""

    definitions: dict[str, str] = field(default_factory=dict)
    declarations: dict[str, None] = field(default_factory=dict)

    def declare(self, line: str) -> None:
        """Notes a declaration."""
        self.declarations[line] = None

    def use(self, function: IRFunction) -> None:
        """Notes a function and what it needs."""
        for part in function.declarations:
            self.declare(part)
        self.definitions.setdefault(function.name, function.text)

    def text(self) -> str:
        """The module's text."""
        return "\n".join([*self.declarations, "", *self.definitions.values()]) + "\n"


def _number(layout: Lanes, value: float) -> str:
    """The literal of a constant, rounded to the format."""
    if layout.dtype == "float":
        with np.errstate(over="ignore"):
            value = float(np.float32(value))
    return layout.constant(value)


class Writer(Instructions):
    """Writes the nodes of one graph, in order, as instructions of one layout.

    Args:
        module: Where declarations go.
        graph: The graph.
        layout: The lanes of the values.
        prefix: What the names of values begin with.
        arithmetic: What the processor computes in one instruction.
        one_sample: Whether all lanes work on one sample.
        stack_space: The address space of local arrays.
        loop_pack: How many sines of one sample are taken at once where the body of a large loop becomes several
            functions; 0 where it stays whole.
    """

    def __init__(
        self,
        module: Module,
        graph: Graph,
        layout: Lanes,
        prefix: str,
        arithmetic: Arithmetic,
        one_sample: bool = False,
        stack_space: int = 0,
        loop_pack: int = 0,
    ) -> None:
        super().__init__()
        self.module, self.graph, self.layout, self.prefix = module, graph, layout, prefix
        self.one_sample, self.arithmetic, self.stack_space = one_sample, arithmetic, stack_space
        self.loop_pack = loop_pack
        self.local_arrays: list[str] = []  # instructions that make them, for the function's first block
        self.tapes: dict[int, Tape] = {}  # of loops
        self.contract = " contract" if arithmetic.fused_multiply_add else ""
        self._real = layout.real
        self._words = {op: f"{TABLE[op].llvm}{self.contract} {self._real}" for op in _ARITHMETIC}
        self.names: dict[int, str] = {}
        self.captured_conditions: set[int] = set()  # inputs of a loop's body that are truth values
        self.rows: dict[str, list[str]] = {}  # pointers to each lane's row of a port, once they are needed
        self._fresh = 0

    def fresh(self, hint: str = "t") -> str:
        """A name that is not in use."""
        self._fresh += 1
        return f"%{self.prefix}{hint}{self._fresh}"

    def binary(self, word: str, a: str, b: str) -> str:
        """Appends an arithmetic instruction.

        Args:
            word: The instruction, such as "fmul".
            a: The name of the first operand.
            b: The name of the second operand.

        Returns:
            The name of the result.
        """
        name = self.fresh()
        self.write(f"{name} = {word}{self.contract} {self.layout.real} {a}, {b}")
        return name

    def assign(self, index: int, text: str) -> None:
        """Appends the instruction whose result is node `index`.

        Args:
            index: The node.
            text: The right side of the instruction.
        """
        self.names[index] = self.let(f"{self.prefix}v{index}", text)

    def nodes(self, order: Sequence[int]) -> None:
        """Writes the nodes that are not written yet."""
        for index in order:
            if index not in self.names:
                self.node(index)

    def node(self, index: int) -> None:
        """Writes one node; its arguments are written already."""
        g, layout = self.graph, self.layout
        op, args = g.op[index], g.args[index]
        word = self._words.get(op)
        if word is not None:  # most nodes are sums and products
            names = self.names
            name = names[index] = f"%{self.prefix}v{index}"
            self.lines.append(f"  {name} = {word} {names[args[0]]}, {names[args[1]]}")
        elif op == _CONST:
            self.names[index] = _number(layout, g.data[index])
        elif op == Op.BOOL:
            self.names[index] = truth(layout, g.data[index])
        elif op in (Op.SIN, Op.COS):
            self.sincos([args[0]])
        elif op == Op.LANE:
            self.names[index] = layout.numbers()
        elif op == Op.ANY:
            self.any_lane(index, self.names[args[0]])
        elif op == Op.LEAST:
            self._least_lane(index, self.names[args[0]])
        elif op == Op.LOOP:
            write_loop(self, index, g.data[index], args)
        elif op == Op.ITEM:
            self.names[index] = self.names[args[0]].split()[g.data[index]]
        else:
            self.assign(index, self.instruction(op, [self.names[a] for a in args]))

    def instruction(self, op: int, x: Sequence[str]) -> str:
        """The instruction of an operation on named values.

        Args:
            op: A member of `Op`.
            x: Names of the operands.

        Returns:
            The right side of the instruction; what it calls is declared in the module.
        """
        layout, word = self.layout, TABLE[op].llvm
        if op == Op.NOT:
            return f"xor {layout.truth} {x[0]}, {truth(layout, True)}"
        if op == Op.NEG:
            return f"fneg {layout.real} {x[0]}"
        if op == Op.SELECT:
            return f"select {layout.truth} {x[0]}, {layout.real} {x[1]}, {layout.real} {x[2]}"
        if op in (Op.AND, Op.OR):
            return f"{word} {layout.truth} {x[0]}, {x[1]}"
        if (name := TABLE[op].op.name.lower()) in OPERATIONS:
            code = _elementary_ir(name, layout.lanes, layout.dtype, self.arithmetic)
            self.module.use(code)
            return f"call {layout.real} @{code.name}({', '.join(f'{layout.real} {v}' for v in x)})"
        if op in (Op.MIN, Op.MAX) and not self.arithmetic.minimum:
            return extreme(self, "olt" if op == Op.MIN else "ogt", x[0], x[1])
        if word.startswith("@"):
            name = f"@llvm.{word[1:]}.{layout.suffix}"
            self.module.declare(f"declare {layout.real} {name}({', '.join([layout.real] * len(x))})")
            return f"call {layout.real} {name}({', '.join(f'{layout.real} {v}' for v in x)})"
        return f"{self._words.get(op) or f'{word} {layout.real}'} {x[0]}, {x[1]}"

    def sincos(self, arguments: Sequence[int]) -> None:
        """Sine and cosine of each argument, named for every SIN and COS node; several at once where scalar."""
        packed = self.layout.lanes == 1 and len(arguments) > 1
        width = self.layout.lanes if not packed else 1 << (len(arguments) - 1).bit_length()
        layout = Lanes(width, self.layout.dtype)
        code = _sincos_ir(width, layout.dtype, self.arithmetic)
        self.module.use(code)
        if packed:
            x = "poison"
            for lane in range(width):
                name = self.fresh()
                value = self.names[arguments[min(lane, len(arguments) - 1)]]
                self.write(f"{name} = insertelement {layout.real} {x}, {layout.dtype} {value}, i32 {lane}")
                x = name
        else:
            x = self.names[arguments[0]]
        result, s, c = self.fresh(), self.fresh("s"), self.fresh("c")
        self.write(f"{result} = call {layout.pair} @{code.name}({layout.real} {x})")
        self.write(f"{s} = extractvalue {layout.pair} {result}, 0")
        self.write(f"{c} = extractvalue {layout.pair} {result}, 1")
        for lane, argument in enumerate(arguments):
            for op, whole in ((Op.SIN, s), (Op.COS, c)):
                node = self.graph.find(op, argument)
                if node is None:
                    continue
                if packed:
                    self.assign(node, f"extractelement {layout.real} {whole}, i32 {lane}")
                else:
                    self.names[node] = whole

    def any_lane(self, index: int, condition: str) -> None:
        """Whether the condition holds in any lane, in all lanes.

        Args:
            index: The node that holds the answer.
            condition: The name of a truth value in each lane.
        """
        layout, reduced = self.layout, self.fresh("any")
        self.module.declare(f"declare i1 @llvm.vector.reduce.or.v{layout.lanes}i1({layout.truth})")
        self.write(
            f"{reduced} = call i1 @llvm.vector.reduce.or.v{layout.lanes}i1({layout.truth} {condition})"
        )
        self.names[index] = self.in_all_lanes("i1", reduced)

    def _least_lane(self, index: int, value: str) -> None:
        """The smallest number of all lanes, in all lanes."""
        if not self.arithmetic.minimum_number:
            self.names[index] = least_by_comparisons(self, value)
            return
        layout, reduced = self.layout, self.fresh("least")
        name = f"@llvm.vector.reduce.fmin.{layout.suffix}"
        self.module.declare(f"declare {layout.dtype} {name}({layout.real})")
        self.write(f"{reduced} = call {layout.dtype} {name}({layout.real} {value})")
        self.names[index] = self.in_all_lanes(layout.dtype, reduced)

    def in_all_lanes(self, element: str, value: str) -> str:
        """A vector that holds a value in every lane.

        Args:
            element: LLVM type of the value, such as "double" or "i1".
            value: The name of the value.

        Returns:
            The name of the vector.
        """
        kind, first, everywhere = self.layout.of(element), self.fresh("one"), self.fresh("all")
        self.write(f"{first} = insertelement {kind} poison, {element} {value}, i64 0")
        zeros = f"<{self.layout.lanes} x i32> zeroinitializer"
        self.write(f"{everywhere} = shufflevector {kind} {first}, {kind} poison, {zeros}")
        return everywhere

    def inside(self, tag: str, graph: Graph) -> Writer:
        """A writer for the body of a loop, in the same function.

        Args:
            tag: What the names of values begin with.
            graph: The graph of the body.

        Returns:
            The writer; its local arrays are those of this one.
        """
        inner = self._of_graph(graph, f"{tag}.", one_sample=False)
        inner.local_arrays = self.local_arrays
        return inner

    def apart(self) -> Writer:
        """A writer for another function, of the same graph and lanes; names begin alike."""
        other = self._of_graph(self.graph, self.prefix, self.one_sample)
        other.captured_conditions = self.captured_conditions
        return other

    def is_condition(self, index: int) -> bool:
        """Whether a node is a truth value.

        Args:
            index: The node.

        Returns:
            Whether it is; also of an input of a loop's body that stands for a condition outside.
        """
        return _IS_CONDITION[self.graph.op[index]] or index in self.captured_conditions

    def kind(self, index: int) -> str:
        """LLVM type of a node in all lanes.

        Args:
            index: The node.

        Returns:
            The type.
        """
        return self.layout.truth if self.is_condition(index) else self._real

    def _of_graph(self, graph: Graph, prefix: str, one_sample: bool) -> Writer:
        return Writer(
            self.module,
            graph,
            self.layout,
            prefix,
            self.arithmetic,
            one_sample,
            self.stack_space,
            self.loop_pack,
        )

    def array(self, name: str, count: int) -> str:
        """A local array of the function, which its first block makes.

        Args:
            name: The name without its sign, the only one of its function.
            count: How many values it holds, each of all lanes.

        Returns:
            The name of its address.
        """
        self.local_arrays += local_array(name, self.layout.real, count, self.stack_space)
        return f"%{name}"
