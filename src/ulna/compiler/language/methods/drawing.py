"""Draws the graph of a function as an SVG picture, layered by depth: inputs at the left, outputs at the right.

Constants are written inside the node that uses them. A graph of more than `LIMIT` nodes is drawn in summary, one
box for all operations of one kind in one range of depths, with their number.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from html import escape
from pathlib import Path
from typing import Any

from ulna.compiler.language.graph import Graph, Loop
from ulna.compiler.language.ops import TABLE, Op
from ulna.compiler.language.ports import Port, element_names
from ulna.errors import InputError
from ulna.system.storage import replacing

LIMIT = 400
"""The most nodes that are drawn one by one."""

_COLUMNS = 36  # of a summary
_WIDTH, _HEIGHT = 96, 24  # of a box
_STEP_X, _STEP_Y = 150, 34  # from box to box
_SWEEPS = 8  # over the layers, to bring boxes near to what they are connected with

_COLOURS = {
    "input": "#bfdbfe",
    "output": "#bbf7d0",
    "sum": "#fef3c7",
    "product": "#fed7aa",
    "function": "#fbcfe8",
    "choice": "#ddd6fe",
    "loop": "#fecaca",
    "constant": "#e5e7eb",
}


@dataclass
class _Box:
    """One node, or in a summary all nodes of one kind and depth."""

    kind: str
    label: str
    depth: int
    sources: Counter[Any] = field(default_factory=Counter)  # keys of boxes, with the number of edges
    count: int = 1
    y: float = 0.0


def draw(
    title: str,
    graph: Graph,
    inputs: Sequence[Port],
    outputs: Sequence[Port],
    results: Sequence[int],
    path: str | None = None,
) -> str:
    """The graph as the text of an SVG picture; written to `path` when one is given.

    Args:
        title: The text above the picture.
        graph: The graph; `results` are its nodes for all numbers of the `outputs`, one after the other.
        inputs: Names and shapes of the inputs.
        outputs: Names and shapes of the outputs.
        results: The output nodes.
        path: A file name that ends in .svg.

    Returns:
        The text of the picture.

    Raises:
        InputError: If `path` has another ending.
    """
    boxes = _boxes(graph, inputs, outputs, results)
    nodes = len(boxes)
    if nodes > LIMIT:
        boxes = _summary(boxes)
        title += f", drawn in summary because the graph has {nodes} nodes (more than {LIMIT})"
    text = _svg(boxes, title)
    if path is not None:
        if Path(path).suffix.lower() != ".svg":
            raise InputError(f"The picture would go to {str(path)!r}; expected a name that ends in .svg.")
        with replacing(path) as place:
            place.write_text(text, encoding="utf-8")
    return text


def _boxes(
    graph: Graph, inputs: Sequence[Port], outputs: Sequence[Port], results: Sequence[int]
) -> dict[Any, _Box]:
    """A box for each node that is neither a constant nor a part of a loop's result, and one for each output."""
    names = dict(zip(graph.inputs, element_names(inputs), strict=False))
    live = set(graph.live(results))
    boxes: dict[Any, _Box] = {}
    for index in sorted(live | set(graph.inputs)):
        op, args = graph.op[index], graph.args[index]
        if op in (Op.CONST, Op.BOOL, Op.ITEM):
            continue
        sources: Counter[Any] = Counter(_shown_node(graph, a) for a in args if not _is_constant(graph, a))
        depth = 1 + max((boxes[s].depth for s in sources), default=0) if op != Op.INPUT else 0
        label = names[index] if op == Op.INPUT else _label(graph, index)
        boxes[index] = _Box(TABLE[op].kind, label, depth, sources)
    last = 1 + max((box.depth for box in boxes.values()), default=0)
    for number, (name, node) in enumerate(zip(element_names(outputs), results, strict=True)):
        constant = _is_constant(graph, node)
        label = f"{name} = {graph.data[node]:.6g}" if constant else name
        sources = Counter() if constant else Counter([_shown_node(graph, node)])
        boxes["out", number] = _Box("output", label, last, sources)
    return boxes


def _is_constant(graph: Graph, index: int) -> bool:
    return graph.op[index] in (Op.CONST, Op.BOOL)


def _shown_node(graph: Graph, index: int) -> int:
    return graph.args[index][0] if graph.op[index] == Op.ITEM else index


def _label(graph: Graph, index: int) -> str:
    op, args, data = graph.op[index], graph.args[index], graph.data[index]
    if isinstance(data, Loop):
        return f"loop of {len(data.graph.live([data.condition, *data.following]))} nodes"
    sign = TABLE[op].sign
    word = TABLE[op].op.name.lower()
    if not sign:
        constants = [f"{graph.data[a]:.4g}" for a in args if graph.op[a] == Op.CONST]
        return f"{word}({', '.join(constants)})" if constants else word
    left, right = (f"{graph.data[a]:.4g} " if _is_constant(graph, a) else "" for a in args)
    return f"{left}{sign} {right}".strip()


def _summary(boxes: dict[Any, _Box]) -> dict[Any, _Box]:
    """Boxes of one kind and one range of depths become one; edges within a box are left out."""
    last = max(box.depth for box in boxes.values())

    def column(box: _Box) -> int:
        if box.kind in ("input", "output"):
            return 0 if box.kind == "input" else _COLUMNS + 1
        return 1 + (box.depth - 1) * _COLUMNS // last

    group = {key: (column(box), box.kind) for key, box in boxes.items()}
    merged: dict[Any, _Box] = {}
    for key, box in boxes.items():
        depth, kind = group[key]
        whole = merged.setdefault(group[key], _Box(kind, "", depth, count=0))
        whole.count += 1
        whole.label = f"{whole.count} {kind}{'s' if whole.count > 1 else ''}"
        for source, number in box.sources.items():
            if group[source] != group[key]:
                whole.sources[group[source]] += number
    return merged


def _place(boxes: dict[Any, _Box]) -> None:
    """Sets the height of each box, near those it is connected with, without overlap in its layer."""
    layers: dict[int, list[_Box]] = {}
    near: dict[int, list[_Box]] = {id(box): [] for box in boxes.values()}
    for box in boxes.values():
        layer = layers.setdefault(box.depth, [])
        box.y = len(layer) * _STEP_Y
        layer.append(box)
        for source in box.sources:
            near[id(box)].append(boxes[source])
            near[id(boxes[source])].append(box)
    for sweep in range(_SWEEPS):
        for depth in sorted(layers, reverse=bool(sweep % 2)):
            layer = layers[depth]
            wanted = {
                id(b): sum(n.y for n in near[id(b)]) / len(near[id(b)]) if near[id(b)] else b.y for b in layer
            }
            if layer[0].kind not in ("input", "output"):  # those keep the order of their numbers
                layer.sort(key=lambda b: wanted[id(b)])
            floor = float("-inf")
            for box in layer:
                box.y = floor = max(wanted[id(box)], floor + _STEP_Y)
            shift = sum(wanted[id(b)] - b.y for b in layer) / len(layer)
            for box in layer:
                box.y += shift
    top = min((box.y for box in boxes.values()), default=0.0)
    for box in boxes.values():
        box.y += 70 - top


def _svg(boxes: dict[Any, _Box], note: str) -> str:
    _place(boxes)
    columns = {depth: k for k, depth in enumerate(sorted({box.depth for box in boxes.values()}))}
    x = {key: 20 + columns[box.depth] * _STEP_X for key, box in boxes.items()}
    width = max(40 + len(columns) * _STEP_X, 40 + 8 * len(note), 700)
    height = max((box.y for box in boxes.values()), default=70.0) + _HEIGHT + 20
    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height:.0f}" '
        f'viewBox="0 0 {width} {height:.0f}" font-family="sans-serif" font-size="12">',
        f"<title>{escape(note, quote=False)}</title>",
        '<rect width="100%" height="100%" fill="white"/>',
        f'<text x="20" y="24" font-size="14">{escape(note, quote=False)}</text>',
    ]
    for k, kind in enumerate(sorted({box.kind for box in boxes.values()}, key=list(_COLOURS).index)):
        out.append(f'<rect x="{20 + 90 * k}" y="34" width="12" height="12" rx="3" fill="{_COLOURS[kind]}" '
                   f'stroke="#6b7280"/><text x="{36 + 90 * k}" y="45">{kind}</text>')  # fmt: skip
    for key, box in boxes.items():
        for source, number in box.sources.items():
            x0, y0 = x[source] + _WIDTH, boxes[source].y + _HEIGHT / 2
            x1, y1 = x[key], box.y + _HEIGHT / 2
            bend = max((x1 - x0) / 2, 20)
            out.append(
                f'<path d="M{x0},{y0:.1f} C{x0 + bend:.1f},{y0:.1f} {x1 - bend:.1f},{y1:.1f} {x1},{y1:.1f}" '
                f'fill="none" stroke="#9ca3af" stroke-width="{min(1 + number / 20, 8) if number > 1 else 1:.3g}"/>'
            )
    for key, box in boxes.items():
        border = ' stroke-width="2"' if box.kind in ("input", "output") else ""
        out.append(
            f'<rect x="{x[key]}" y="{box.y:.1f}" width="{_WIDTH}" height="{_HEIGHT}" rx="6" '
            f'fill="{_COLOURS[box.kind]}" stroke="#4b5563"{border}/>'
            f'<text x="{x[key] + _WIDTH / 2}" y="{box.y + 16:.1f}" text-anchor="middle">'
            f"{escape(box.label, quote=False)}</text>"
        )
    return "\n".join([*out, "</svg>\n"])
