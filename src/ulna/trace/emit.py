"""Writes a function's graph as LLVM IR text: one sample, a block of SIMD lanes, and the loop over a batch.

Names `%v12` are graph indices, so IR, graph and profile can be read side by side. Three layouts come out of the
same node writer: the scalar block (lanes = 1) of a single call, the lane block (lanes = 8, say) of a batch, and, for
a LOOP node, a region that iterates in the lanes. `memory` writes how rows get into lanes, `batch` the loop around.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache

import numpy as np

from ulna.trace.batch import batch_loop
from ulna.trace.elementary import OPERATIONS, elementary_ir
from ulna.trace.function import Function
from ulna.trace.graph import Graph, Loop
from ulna.trace.irtext import BYTES, DType, IRFunction, Lanes
from ulna.trace.memory import load, store
from ulna.trace.ops import TABLE, Op
from ulna.trace.sincos import sincos_ir

_sincos_ir, _elementary_ir = cache(sincos_ir), cache(elementary_ir)  # the same text for every node


@dataclass
class _Module:
    """Function definitions and the declarations they need, each once, in order."""

    definitions: dict[str, str] = field(default_factory=dict)
    declarations: dict[str, None] = field(default_factory=dict)

    def declare(self, line: str) -> None:
        self.declarations[line] = None

    def use(self, function: IRFunction) -> None:
        for part in function.declarations:
            self.declare(part)
        self.definitions.setdefault(function.name, function.text)

    def text(self) -> str:
        return "\n".join([*self.declarations, "", *self.definitions.values()]) + "\n"


def _number(lay: Lanes, value: float) -> str:
    """The literal of a constant, rounded to the format."""
    if lay.dtype == "float":
        with np.errstate(over="ignore"):
            value = float(np.float32(value))
    return lay.constant(value)


def _truth(lay: Lanes, value: bool) -> str:
    word = "true" if value else "false"
    return word if lay.lanes == 1 else f"splat (i1 {word})"


class Writer:
    """Writes the nodes of one graph, in order, as instructions of one layout."""

    def __init__(
        self, module: _Module, graph: Graph, layout: Lanes, prefix: str, contract: bool, is_race: bool = False
    ) -> None:
        self.module, self.graph, self.layout, self.prefix = module, graph, layout, prefix
        self.is_race = is_race  # whether all lanes work on one sample
        self.contract = " contract" if contract else ""
        self.lines: list[str] = []
        self.names: dict[int, str] = {}
        self.block = "entry"  # the basic block being written
        self._fresh = 0

    def fresh(self, hint: str = "t") -> str:
        """A name that is not in use."""
        self._fresh += 1
        return f"%{self.prefix}{hint}{self._fresh}"

    def write(self, line: str) -> None:
        """Appends an instruction."""
        self.lines.append("  " + line)

    def assign(self, index: int, text: str) -> None:
        """Appends the instruction whose result is node `index`."""
        name = f"%{self.prefix}v{index}"
        self.write(f"{name} = {text}")
        self.names[index] = name

    def open_block(self, label: str) -> None:
        """Begins a basic block."""
        self.lines.append(f"{label}:")
        self.block = label

    def nodes(self, order: Sequence[int]) -> None:
        """Writes the nodes that are not written yet."""
        for index in order:
            if index not in self.names:
                self.node(index)

    def node(self, index: int) -> None:
        """Writes one node; its arguments are written already."""
        g, lay = self.graph, self.layout
        op, args, data = g.op[index], g.args[index], g.data[index]
        if op == Op.CONST:
            self.names[index] = _number(lay, data)
        elif op == Op.BOOL:
            self.names[index] = _truth(lay, data)
        elif op in (Op.SIN, Op.COS):
            self.sincos([args[0]])
        elif op == Op.LANE:
            self.names[index] = lay.numbers()
        elif op == Op.ANY:
            self.any_lane(index, self.names[args[0]])
        elif op == Op.LEAST:
            self.least_lane(index, self.names[args[0]])
        elif op == Op.LOOP:
            self.loop(index, data, args)
        elif op == Op.ITEM:
            self.names[index] = self.names[args[0]].split()[data]
        else:
            self.assign(index, self.instruction(op, [self.names[a] for a in args]))

    def instruction(self, op: int, x: Sequence[str]) -> str:
        """The instruction of an operation on named values."""
        lay, word = self.layout, TABLE[op].llvm
        if op == Op.NOT:
            return f"xor {lay.truth} {x[0]}, {_truth(lay, True)}"
        if op == Op.NEG:
            return f"fneg {lay.real} {x[0]}"
        if op == Op.SELECT:
            return f"select {lay.truth} {x[0]}, {lay.real} {x[1]}, {lay.real} {x[2]}"
        if op in (Op.AND, Op.OR):
            return f"{word} {lay.truth} {x[0]}, {x[1]}"
        if (name := TABLE[op].op.name.lower()) in OPERATIONS:
            code = _elementary_ir(name, lay.lanes, lay.dtype)
            self.module.use(code)
            return f"call {lay.real} @{code.name}({', '.join(f'{lay.real} {v}' for v in x)})"
        if word.startswith("@"):
            name = f"@llvm.{word[1:]}.{lay.suffix}"
            self.module.declare(f"declare {lay.real} {name}({', '.join([lay.real] * len(x))})")
            return f"call {lay.real} {name}({', '.join(f'{lay.real} {v}' for v in x)})"
        flags = "" if word.startswith("fcmp") else self.contract
        return f"{word}{flags} {lay.real} {x[0]}, {x[1]}"

    def sincos(self, arguments: Sequence[int]) -> None:
        """Sine and cosine of each argument, named for every SIN and COS node; several at once where scalar."""
        packed = self.layout.lanes == 1 and len(arguments) > 1
        width = self.layout.lanes if not packed else 1 << (len(arguments) - 1).bit_length()
        lay = Lanes(width, self.layout.dtype)
        code = _sincos_ir(width, lay.dtype)
        self.module.use(code)
        if packed:
            x = "poison"
            for lane in range(width):
                name = self.fresh()
                value = self.names[arguments[min(lane, len(arguments) - 1)]]
                self.write(f"{name} = insertelement {lay.real} {x}, {lay.dtype} {value}, i32 {lane}")
                x = name
        else:
            x = self.names[arguments[0]]
        result, s, c = self.fresh(), self.fresh("s"), self.fresh("c")
        self.write(f"{result} = call {lay.pair} @{code.name}({lay.real} {x})")
        self.write(f"{s} = extractvalue {lay.pair} {result}, 0")
        self.write(f"{c} = extractvalue {lay.pair} {result}, 1")
        for lane, argument in enumerate(arguments):
            for op, whole in ((Op.SIN, s), (Op.COS, c)):
                node = self.graph._interned.get((op, argument))
                if node is None:
                    continue
                if packed:
                    self.assign(node, f"extractelement {lay.real} {whole}, i32 {lane}")
                else:
                    self.names[node] = whole

    def any_lane(self, index: int, condition: str) -> None:
        """Whether the condition holds in any lane, in all lanes."""
        lay, found = self.layout, self.fresh("any")
        self.module.declare(f"declare i1 @llvm.vector.reduce.or.v{lay.lanes}i1({lay.truth})")
        self.write(f"{found} = call i1 @llvm.vector.reduce.or.v{lay.lanes}i1({lay.truth} {condition})")
        self.names[index] = self.in_all_lanes("i1", found)

    def least_lane(self, index: int, value: str) -> None:
        """The smallest number of all lanes, in all lanes."""
        lay, found = self.layout, self.fresh("least")
        name = f"@llvm.vector.reduce.fmin.{lay.suffix}"
        self.module.declare(f"declare {lay.dtype} {name}({lay.real})")
        self.write(f"{found} = call {lay.dtype} {name}({lay.real} {value})")
        self.names[index] = self.in_all_lanes(lay.dtype, found)

    def in_all_lanes(self, element: str, value: str) -> str:
        """A vector that holds a value in every lane."""
        kind, first, everywhere = self.layout.of(element), self.fresh("one"), self.fresh("all")
        self.write(f"{first} = insertelement {kind} poison, {element} {value}, i64 0")
        zeros = f"<{self.layout.lanes} x i32> zeroinitializer"
        self.write(f"{everywhere} = shufflevector {kind} {first}, {kind} poison, {zeros}")
        return everywhere

    def loop(self, index: int, loop: Loop, args: Sequence[int]) -> None:
        """Iterates until no lane's condition holds; a lane that is done keeps its state."""
        lay, tag = self.layout, f"{self.prefix}L{index}"
        before, head, body, after = self.block, f"{tag}.head", f"{tag}.body", f"{tag}.after"
        inner = Writer(self.module, loop.graph, lay, f"{tag}.", bool(self.contract))
        state = [f"%{tag}.x{k}" for k in range(loop.size)]
        following = [f"%{tag}.y{k}" for k in range(loop.size)]
        self.write(f"br label %{head}")
        self.open_block(head)
        end = f"%{tag}.end"  # the block the back edge comes from, known after the body is written
        phis = len(self.lines)
        self.lines.append("")
        names = [*state, *(self.names[a] for a in args[loop.size :])]
        for node, name in zip(loop.graph.inputs, names, strict=True):
            inner.names[node] = name
        inner.block = head
        # Condition and body are one region: lanes that are done compute along and are masked out.
        inner.nodes(loop.graph.live([loop.condition]))
        active, go = f"%{tag}.active", f"%{tag}.go"
        inner.write(f"{active} = and {lay.truth} %{tag}.alive, {inner.names[loop.condition]}")
        if lay.lanes == 1:
            anyone = active
        else:
            anyone = f"%{tag}.any"
            self.module.declare(f"declare i1 @llvm.vector.reduce.or.v{lay.lanes}i1({lay.truth})")
            inner.write(f"{anyone} = call i1 @llvm.vector.reduce.or.v{lay.lanes}i1({lay.truth} {active})")
        inner.write(f"%{tag}.more = icmp ult i64 %{tag}.n, {loop.limit}")
        inner.write(f"{go} = and i1 {anyone}, %{tag}.more")
        inner.write(f"br i1 {go}, label %{body}, label %{after}")
        inner.open_block(body)
        inner.nodes(loop.graph.live([loop.condition, *loop.following]))
        for k, node in enumerate(loop.following):
            inner.write(
                f"{following[k]} = select {lay.truth} {active}, {lay.real} {inner.names[node]}, {lay.real} {state[k]}"
            )
        inner.write(f"%{tag}.n1 = add i64 %{tag}.n, 1")
        inner.write(f"br label %{head}")
        end = inner.block
        self.lines += inner.lines
        lines = [f"%{tag}.n = phi i64 [ 0, %{before} ], [ %{tag}.n1, %{end} ]"]
        lines.append(
            f"%{tag}.alive = phi {lay.truth} [ {_truth(lay, True)}, %{before} ], [ {active}, %{end} ]"
        )
        for k in range(loop.size):
            start = self.names[args[k]]
            lines.append(f"{state[k]} = phi {lay.real} [ {start}, %{before} ], [ {following[k]}, %{end} ]")
        self.lines[phis] = "\n".join("  " + line for line in lines)
        self.open_block(after)
        self.names[index] = " ".join(state)


def schedule(graph: Graph, outputs: Sequence[int], width: int) -> list[tuple[str, Sequence[int]]]:
    """The order of work: ("nodes", order) and ("sincos", arguments) steps.

    With `width` > 1 the angles whose sines can be taken together are taken together, `width` at a time, because one
    vector of sines costs a single call about as much as one scalar.
    """
    live = graph.live(outputs)
    if width == 1:
        return [("nodes", live)]
    level: dict[int, int] = {}
    groups: dict[int, dict[int, None]] = {}
    for index in live:
        depth = max((level[a] for a in graph.args[index]), default=0)
        if graph.op[index] in (Op.SIN, Op.COS):
            groups.setdefault(depth, {})[graph.args[index][0]] = None
            depth += 1
        level[index] = depth
    steps: list[tuple[str, Sequence[int]]] = []
    for depth in sorted(groups):
        arguments = list(groups[depth])
        steps.append(("nodes", graph.live(arguments)))
        steps += [("sincos", arguments[k : k + width]) for k in range(0, len(arguments), width)]
    return [*steps, ("nodes", live)]


def _write_block(module: _Module, f: Function, name: str, layout: Lanes, width: int, contract: bool) -> None:
    """`void name(ptr in, i64 stride, ..., ptr out, i64 stride, ...)`: lane j has the rows j * stride [byte]."""
    strided = layout.lanes > 1 or name == "block"
    if f.lanes > 1:
        layout, width = Lanes(f.lanes, layout.dtype), 1
    body = Writer(module, f.graph, layout, "", contract, f.lanes > 1)
    ports = [
        *((f"i{k}", p) for k, p in enumerate(f.inputs)),
        *((f"o{k}", p) for k, p in enumerate(f.outputs)),
    ]
    parameters = []
    for port, _ in ports:
        if not strided:  # a single call writes to new arrays
            parameters.append(f"ptr noalias %{port}" if port[0] == "o" else f"ptr %{port}")
        else:  # the outputs of a batch may be its inputs, which is sound because all loads come before all stores
            parameters += [f"ptr %{port}", f"i64 %{port}s"]
    live = set(f.graph.live(f.results))
    node = 0
    for k, port in enumerate(f.inputs):
        wanted = [j for j in range(port.size) if f.graph.inputs[node + j] in live]
        for j, value in load(body, f"i{k}", port.size, wanted):
            body.names[f.graph.inputs[node + j]] = value
        node += port.size
    for kind, what in schedule(f.graph, f.results, width):
        if kind == "nodes":
            body.nodes(what)
        else:
            body.sincos(what)
    start = 0
    for k, port in enumerate(f.outputs):
        store(body, f"o{k}", [body.names[r] for r in f.results[start : start + port.size]])
        start += port.size
    attributes = "noinline nounwind #0" if strided or f.lanes > 1 else "nounwind"
    module.definitions[name] = (
        f"define internal void @{name}({', '.join(parameters)}) {attributes} {{\nentry:\n"
        + "\n".join(body.lines)
        + "\n  ret void\n}\n"
    )


def emit_single(f: Function, element: DType = "double", pack: int = 8, contract: bool = True) -> str:
    """IR of one sample: `void one(ptr in0, ..., ptr out0, ...)` on contiguous samples."""
    module = _Module()
    _write_block(module, f, "one", Lanes(1, element), pack, contract)
    return module.text() + (_wide_registers(f.lanes, element) if f.lanes > 1 else "")


def emit_batch(f: Function, element: DType = "double", lanes: int = 8, contract: bool = True) -> str:
    """IR of the inner loop of a generalised ufunc over samples, `lanes` at a time.

    `void batch(ptr args, ptr dimensions, ptr steps, ptr data)` is NumPy's PyUFuncGenericFunction. Samples with
    strides inside go through a scratch copy, one by one. Floating-point flags are cleared at the end, because
    both sides of every `where` are computed.
    """
    module = _Module()
    _write_block(module, f, "block", Lanes(lanes, element), 1, contract)
    module.declare("declare i32 @feclearexcept(i32)")
    module.definitions["batch"] = batch_loop(f, element, lanes)
    return module.text() + _wide_registers(max(lanes, f.lanes), element)


def _wide_registers(lanes: int, element: DType) -> str:
    """The attributes that let a function use registers of so many lanes."""
    bits = lanes * BYTES[element] * 8
    return f'\nattributes #0 = {{ "prefer-vector-width"="{bits}" "min-legal-vector-width"="{bits}" }}\n'
