"""Writes a function's graph as LLVM IR text: one sample, a block of SIMD lanes, and the loop over a batch.

Names `%v12` are graph indices, so IR, graph and profile can be read side by side. Three layouts come out of the
same node writer: the scalar block (lanes = 1) of a single call, the lane block (lanes = 8, say) of a batch, and, for
a LOOP node, a region that iterates in the lanes. Samples are read and written where they lie, row-major, each lane
from its own row.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cache
from itertools import product

import numpy as np

from ulna.trace.elementary import OPERATIONS, elementary_ir
from ulna.trace.function import Function
from ulna.trace.graph import Graph, Loop
from ulna.trace.irtext import DType, IRFunction, Lanes
from ulna.trace.ops import TABLE, Op
from ulna.trace.sincos import sincos_ir

_BYTES = {"double": 8, "float": 4}
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


class _Body:
    """Writes the nodes of one graph, in order, as instructions of one layout."""

    def __init__(self, module: _Module, graph: Graph, layout: Lanes, prefix: str, contract: bool) -> None:
        self.module, self.graph, self.layout, self.prefix = module, graph, layout, prefix
        self.contract = " contract" if contract else ""
        self.lines: list[str] = []
        self.names: dict[int, str] = {}
        self.block = "entry"  # the basic block being written
        self._fresh = 0

    def fresh(self, hint: str = "t") -> str:
        self._fresh += 1
        return f"%{self.prefix}{hint}{self._fresh}"

    def write(self, line: str) -> None:
        self.lines.append("  " + line)

    def assign(self, index: int, text: str) -> None:
        name = f"%{self.prefix}v{index}"
        self.write(f"{name} = {text}")
        self.names[index] = name

    def open_block(self, label: str) -> None:
        self.lines.append(f"{label}:")
        self.block = label

    def nodes(self, order: Sequence[int]) -> None:
        for index in order:
            if index not in self.names:
                self.node(index)

    def node(self, index: int) -> None:
        g, lay = self.graph, self.layout
        op, args, data = g.op[index], g.args[index], g.data[index]
        if op == Op.CONST:
            self.names[index] = _number(lay, data)
        elif op == Op.BOOL:
            self.names[index] = _truth(lay, data)
        elif op in (Op.SIN, Op.COS):
            self.sincos([args[0]])
        elif op == Op.LOOP:
            self.loop(index, data, args)
        elif op == Op.ITEM:
            self.names[index] = self.names[args[0]].split()[data]
        else:
            self.assign(index, self.instruction(op, [self.names[a] for a in args]))

    def instruction(self, op: int, x: Sequence[str]) -> str:
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

    def loop(self, index: int, loop: Loop, args: Sequence[int]) -> None:
        """Iterates until no lane's condition holds; a lane that is done keeps its state."""
        lay, tag = self.layout, f"{self.prefix}L{index}"
        before, head, body, after = self.block, f"{tag}.head", f"{tag}.body", f"{tag}.after"
        inner = _Body(self.module, loop.graph, lay, f"{tag}.", bool(self.contract))
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
        lines.append(f"%{tag}.alive = phi {lay.truth} [ {_truth(lay, True)}, %{before} ], [ {active}, %{end} ]")
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
    """`void name(ptr in, i64 stride, ..., ptr out, i64 stride, ...)`: lane j reads and writes rows j * stride [bytes]."""
    body = _Body(module, f.graph, layout, "", contract)
    ports = [*((f"i{k}", p) for k, p in enumerate(f.inputs)), *((f"o{k}", p) for k, p in enumerate(f.outputs))]
    parameters = []
    for port, _ in ports:
        if layout.lanes == 1:  # a single call writes to new arrays
            parameters.append(f"ptr noalias %{port}" if port[0] == "o" else f"ptr %{port}")
        else:  # the outputs of a batch may be its inputs, which is sound because all loads come before all stores
            parameters += [f"ptr %{port}", f"i64 %{port}s"]
    live = set(f.graph.live(f.results))
    node = 0
    for k, port in enumerate(f.inputs):
        wanted = [j for j in range(port.size) if f.graph.inputs[node + j] in live]
        for j, value in _load(body, f"i{k}", wanted):
            body.names[f.graph.inputs[node + j]] = value
        node += port.size
    for kind, what in schedule(f.graph, f.results, width):
        if kind == "nodes":
            body.nodes(what)
        else:
            body.sincos(what)
    start = 0
    for k, port in enumerate(f.outputs):
        _store(body, f"o{k}", [body.names[r] for r in f.results[start : start + port.size]])
        start += port.size
    attributes = "nounwind" if layout.lanes == 1 else "noinline nounwind #0"
    module.definitions[name] = (
        f"define internal void @{name}({', '.join(parameters)}) {attributes} {{\nentry:\n"
        + "\n".join(body.lines)
        + "\n  ret void\n}\n"
    )


def _rows(body: _Body, port: str) -> list[str]:
    """Pointers to each lane's row."""
    rows = [f"%{port}"]
    for lane in range(1, body.layout.lanes):
        name = f"%{port}.r{lane}"
        body.write(f"{name} = getelementptr i8, ptr {rows[-1]}, i64 %{port}s")
        rows.append(name)
    return rows


def _load(body: _Body, port: str, wanted: Sequence[int]) -> Iterator[tuple[int, str]]:
    element, lanes = body.layout.dtype, body.layout.lanes
    if not wanted:
        return
    rows = _rows(body, port)
    for j in wanted:
        vector = "poison"
        for lane, row in enumerate(rows):
            at, value = body.fresh("p"), f"%{port}.{j}.{lane}"
            body.write(f"{at} = getelementptr {element}, ptr {row}, i64 {j}")
            body.write(f"{value} = load {element}, ptr {at}, align {_BYTES[element]}")
            if lanes == 1:
                vector = value
            else:
                name = body.fresh()
                body.write(f"{name} = insertelement {body.layout.real} {vector}, {element} {value}, i32 {lane}")
                vector = name
        yield j, vector


def _store(body: _Body, port: str, values: Sequence[str]) -> None:
    """Writes `values[j]` of every lane to element j of the lane's row."""
    element, lanes = body.layout.dtype, body.layout.lanes
    if not values:
        return
    rows = _rows(body, port)
    if lanes == 1:
        for j, value in enumerate(values):
            at = body.fresh("p")
            body.write(f"{at} = getelementptr {element}, ptr {rows[0]}, i64 {j}")
            body.write(f"store {element} {value}, ptr {at}, align {_BYTES[element]}")
        return
    # Transpose in registers, a power of two of columns at a time, so that each row is written in wide stores.
    j = 0
    while j < len(values):
        columns = lanes
        while columns > len(values) - j:
            columns //= 2
        wide = f"<{columns} x {element}>" if columns > 1 else element
        for row, chunk in zip(rows, _transpose(body, values[j : j + columns]), strict=True):
            at = body.fresh("p")
            body.write(f"{at} = getelementptr {element}, ptr {row}, i64 {j}")
            body.write(f"store {wide} {chunk}, ptr {at}, align {_BYTES[element]}")
        j += columns


def _transpose(body: _Body, columns: Sequence[str]) -> list[str]:
    """From `columns` (vectors over lanes) the rows (vectors over columns), one for each lane."""
    lanes, element = body.layout.lanes, body.layout.dtype
    if len(columns) == 1:
        rows = []
        for lane in range(lanes):
            name = body.fresh()
            body.write(f"{name} = extractelement {body.layout.real} {columns[0]}, i32 {lane}")
            rows.append(name)
        return rows
    # Interleave halves of the columns: after each round a vector holds twice as many columns of half the lanes.
    vectors, count = list(columns), len(columns)
    width = lanes  # numbers in one vector
    groups: list[list[str]] = [vectors]  # groups[k] covers lanes k * lanes / len(groups) ..., its vectors the columns
    held = 1  # columns in one vector
    while held < count:
        following: list[list[str]] = []
        for group in groups:
            low, high = [], []
            half = len(group) // 2
            for a, b in zip(group[:half], group[half:], strict=True):
                for side, target in ((0, low), (1, high)):
                    target.append(_interleave(body, a, b, width, side))
            following += [low, high]
        groups, held = following, held * 2
    # Each group now has one vector: `width / count` rows of `count` columns each.
    rows = []
    for group in groups:
        for k in range(width // count):
            if width == count:
                rows.append(group[0])
                continue
            name = body.fresh()
            mask = ", ".join(f"i32 {k * count + c}" for c in range(count))
            kind = f"<{width} x {element}>"
            body.write(f"{name} = shufflevector {kind} {group[0]}, {kind} poison, <{count} x i32> <{mask}>")
            rows.append(name)
    return rows


def _interleave(body: _Body, a: str, b: str, width: int, side: int) -> str:
    """Low (0) or high (1) half of a0 b0 a1 b1 ..."""
    start = side * width // 2
    mask = ", ".join(f"i32 {start + i // 2 + (width if i % 2 else 0)}" for i in range(width))
    name = body.fresh()
    kind = f"<{width} x {body.layout.dtype}>"
    body.write(f"{name} = shufflevector {kind} {a}, {kind} {b}, <{width} x i32> <{mask}>")
    return name


def emit_single(f: Function, element: DType = "double", pack: int = 8, contract: bool = True) -> str:
    """IR of one sample: `void one(ptr in0, ..., ptr out0, ...)` on contiguous samples."""
    module = _Module()
    _write_block(module, f, "one", Lanes(1, element), pack, contract)
    return module.text()


def emit_batch(f: Function, element: DType = "double", lanes: int = 8, contract: bool = True) -> str:
    """IR of the inner loop of a generalised ufunc over samples, `lanes` at a time.

    `void batch(ptr args, ptr dimensions, ptr steps, ptr data)` is NumPy's PyUFuncGenericFunction. Samples with
    strides inside go through a scratch copy, one by one. Floating-point flags are cleared at the end, because
    both sides of every `where` are computed.
    """
    module = _Module()
    _write_block(module, f, "block", Lanes(lanes, element), 1, contract)
    module.declare("declare i32 @feclearexcept(i32)")
    module.definitions["batch"] = _batch_loop(f, element, lanes)
    text = module.text()
    return text + f'\nattributes #0 = {{ "prefer-vector-width"="{lanes * _BYTES[element] * 8}" '\
        f'"min-legal-vector-width"="{lanes * _BYTES[element] * 8}" }}\n'


def _batch_loop(f: Function, element: DType, lanes: int) -> str:
    size = _BYTES[element]
    ports = [*f.inputs, *f.outputs]
    inputs = len(f.inputs)
    w: list[str] = []
    w.append("define void @batch(ptr %args, ptr %dims, ptr %steps, ptr %data) nounwind {\nentry:")
    w.append("  %n = load i64, ptr %dims")
    strides: list[str] = []  # one check for each inner stride
    inner = len(ports)  # position of the next inner stride in steps
    inner_at: list[int] = []
    for k, port in enumerate(ports):
        w.append(f"  %a{k}.p = getelementptr ptr, ptr %args, i64 {k}")
        w.append(f"  %a{k} = load ptr, ptr %a{k}.p")
        w.append(f"  %s{k}.p = getelementptr i64, ptr %steps, i64 {k}")
        w.append(f"  %s{k} = load i64, ptr %s{k}.p")
        inner_at.append(inner)
        expected = size
        for axis in reversed(range(len(port.shape))):
            name = f"%c{k}.{axis}"
            w.append(f"  {name}.p = getelementptr i64, ptr %steps, i64 {inner + axis}")
            w.append(f"  {name} = load i64, ptr {name}.p")
            if port.shape[axis] > 1:
                w.append(f"  {name}.ok = icmp eq i64 {name}, {expected}")
                strides.append(f"{name}.ok")
            expected *= port.shape[axis]
        inner += len(port.shape)
    contiguous = "true"
    for number, check in enumerate(strides):
        w.append(f"  %ok{number} = and i1 {contiguous}, {check}")
        contiguous = f"%ok{number}"
    w.append(f"  br i1 {contiguous}, label %dense, label %sparse")

    def block_call(rows: str, tag: str, dense: bool) -> None:
        """Calls the block at row `rows`; `dense` lanes take following rows, else all take the same one."""
        call = []
        for k in range(len(ports)):
            w.append(f"  %{tag}.o{k} = mul i64 {rows}, %s{k}")
            w.append(f"  %{tag}.r{k} = getelementptr i8, ptr %a{k}, i64 %{tag}.o{k}")
            call += [f"ptr %{tag}.r{k}", f"i64 %s{k}" if dense else "i64 0"]
        w.append(f"  call void @block({', '.join(call)})")

    w.append(f"dense:\n  %many = icmp uge i64 %n, {lanes}\n  br i1 %many, label %full, label %few")
    # Whole blocks; the last one is moved back to end at the last row, so it redoes rows, with equal results, unless
    # an output is an input (NumPy then makes no copy if they are the very same array): then row by row.
    w.append("full:")
    shared = "false"
    for number, (i, o) in enumerate(product(range(inputs), range(inputs, len(ports)))):
        w.append(f"  %same{number} = icmp eq ptr %a{i}, %a{o}\n  %shared{number} = or i1 {shared}, %same{number}")
        shared = f"%shared{number}"
    w.append(f"  %last = sub i64 %n, {lanes}\n  br label %step")
    w.append("step:\n  %i = phi i64 [ 0, %full ], [ %j, %move ]")
    block_call("%i", "b", dense=True)
    w.append(f"  %next = add i64 %i, {lanes}")
    w.append("  %end = icmp eq i64 %i, %last\n  br i1 %end, label %done, label %more")
    w.append(f"more:\n  %over = icmp ugt i64 %next, %last\n  %alone = and i1 %over, {shared}")
    w.append("  br i1 %alone, label %row, label %move")
    w.append("move:\n  %j = select i1 %over, i64 %last, i64 %next\n  br label %step")
    # Fewer rows than lanes: one row in all lanes at a time.
    w.append("few:\n  %none = icmp eq i64 %n, 0\n  br i1 %none, label %done, label %row")
    w.append("row:\n  %k = phi i64 [ 0, %few ], [ %next, %more ], [ %k1, %row ]")
    block_call("%k", "f", dense=False)
    w.append("  %k1 = add i64 %k, 1\n  %kend = icmp eq i64 %k1, %n\n  br i1 %kend, label %done, label %row")
    # Strides inside the samples: copy each sample to scratch, work there, copy back.
    w.append("sparse:")
    for k, port in enumerate(ports):
        w.append(f"  %t{k} = alloca {element}, i64 {max(port.size, 1)}")
    w.append("  %empty = icmp eq i64 %n, 0\n  br i1 %empty, label %done, label %gather")
    w.append("gather:\n  %g = phi i64 [ 0, %sparse ], [ %g1, %scattered ]")
    label = "gather"
    for k, port in enumerate(ports[:inputs]):
        label = _copy(w, f"in{k}", f"%a{k}", f"%s{k}", f"%t{k}", [f"%c{k}.{x}" for x in range(len(port.shape))],
                      port.shape, element, "%g", label, gather=True)
    call = [text for k in range(len(ports)) for text in (f"ptr %t{k}", "i64 0")]
    w.append(f"  call void @block({', '.join(call)})")
    for k, port in enumerate(ports[inputs:], inputs):
        label = _copy(w, f"out{k}", f"%a{k}", f"%s{k}", f"%t{k}", [f"%c{k}.{x}" for x in range(len(port.shape))],
                      port.shape, element, "%g", label, gather=False)
    w.append("  br label %scattered\nscattered:\n  %g1 = add i64 %g, 1")
    w.append("  %gend = icmp eq i64 %g1, %n\n  br i1 %gend, label %done, label %gather")
    # The bits of the exceptions differ between processors; C libraries pay heed only to those that exist.
    w.append("done:\n  %flags = call i32 @feclearexcept(i32 -1)\n  ret void\n}\n")
    return "\n".join(w)


def _copy(
    w: list[str], tag: str, base: str, stride: str, scratch: str, strides: Sequence[str], shape: Sequence[int],
    element: str, row: str, label: str, gather: bool,
) -> str:  # fmt: skip
    """Nested loops that copy sample `row` between its strided place and contiguous scratch; returns the last label."""
    w.append(f"  %{tag}.off = mul i64 {row}, {stride}")
    w.append(f"  %{tag}.at = getelementptr i8, ptr {base}, i64 %{tag}.off")
    pointer, flat = f"%{tag}.at", "0"
    if any(n == 0 for n in shape):
        return label
    before = label
    for axis, n in enumerate(shape):
        head = f"{tag}.h{axis}"
        w.append(f"  br label %{head}\n{head}:")
        w.append(f"  %{tag}.k{axis} = phi i64 [ 0, %{before} ], [ %{tag}.n{axis}, %{tag}.l{axis} ]")
        w.append(f"  %{tag}.d{axis} = mul i64 %{tag}.k{axis}, {strides[axis]}")
        w.append(f"  %{tag}.q{axis} = getelementptr i8, ptr {pointer}, i64 %{tag}.d{axis}")
        w.append(f"  %{tag}.m{axis} = mul i64 {flat}, {n}")
        w.append(f"  %{tag}.f{axis} = add i64 %{tag}.m{axis}, %{tag}.k{axis}")
        pointer, flat, before = f"%{tag}.q{axis}", f"%{tag}.f{axis}", head
    w.append(f"  %{tag}.s = getelementptr {element}, ptr {scratch}, i64 {flat}")
    source, target = (pointer, f"%{tag}.s") if gather else (f"%{tag}.s", pointer)
    w.append(f"  %{tag}.v = load {element}, ptr {source}, align {_BYTES[element]}")
    w.append(f"  store {element} %{tag}.v, ptr {target}, align {_BYTES[element]}")
    for axis in reversed(range(len(shape))):
        w.append(f"  br label %{tag}.l{axis}\n{tag}.l{axis}:")
        w.append(f"  %{tag}.n{axis} = add i64 %{tag}.k{axis}, 1")
        w.append(f"  %{tag}.e{axis} = icmp eq i64 %{tag}.n{axis}, {shape[axis]}")
        w.append(f"  br i1 %{tag}.e{axis}, label %{tag}.x{axis}, label %{tag}.h{axis}\n{tag}.x{axis}:")
        before = f"{tag}.x{axis}"
    return before
