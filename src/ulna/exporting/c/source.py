"""A traced function as the definition of a C function, large ones in parts."""

from __future__ import annotations

from collections.abc import Sequence

from ulna.compiler import Function
from ulna.compiler.language.ops import Op
from ulna.compiler.language.scheduling import Step, parts, scratch_places, used
from ulna.exporting.c.expressions import argument_names
from ulna.exporting.c.writer import PACK, Writer

ONE_PIECE = 1200
"""Operations of a function that stays in one piece."""


def parameters(function: Function, real: str) -> tuple[list[str], list[str]]:
    """The parameters of the C function, inputs and outputs: "const double q[7]".

    Args:
        function: The traced function.
        real: "double" or "float".

    Returns:
        Declarations of the inputs, and of the outputs.
    """
    ports = [*function.inputs, *function.outputs]
    names = argument_names(p.name for p in ports)
    made = [f"{real} {name}[{max(port.size, 1)}]" for name, port in zip(names, ports, strict=True)]
    count = len(function.inputs)
    return [f"const {one}" for one in made[:count]], made[count:]


def definition(function: Function, name: str, real: str, prefix: str, storage: str = "") -> str:
    """The definition of the C function, after those of its parts.

    Args:
        function: The traced function.
        name: The name of the C function.
        real: "double" or "float".
        prefix: What names of functions of the export begin with.
        storage: "static " for a function that no other file calls.

    Returns:
        The text.
    """
    inputs, outputs = parameters(function, real)
    names = argument_names(p.name for p in (*function.inputs, *function.outputs))
    pieces = parts(function, 1, PACK)
    if function.operations <= ONE_PIECE:
        pieces = [[step for piece in pieces for step in piece]]
    if len(pieces) == 1:
        body = _body(function, pieces[0], {}, real, prefix, names)
        return _function(f"{storage}void {name}", [*inputs, *outputs], body)
    places = scratch_places(function.graph, pieces)
    texts, calls = [], []
    for k, steps in enumerate(pieces):
        body = _body(function, steps, places, real, prefix, names)
        used_names = [n for n in names if any(_mentions(line, n) for line in body)]
        declared = [p for p, n in zip([*inputs, *outputs], names, strict=True) if n in used_names]
        part = f"{name}_part{k}"
        texts.append(_function(f"{prefix.upper()}_PART void {part}", [*declared, f"{real} *w"], body))
        calls.append(f"    {part}({', '.join([*used_names, 'w'])});")
    size = max(places.values(), default=0) + 1
    body = [f"    {real} w[{size}];", *calls]
    unused = [n for n in names[: len(inputs)] if not any(_mentions(call, n) for call in calls)]
    body += [f"    (void){n};" for n in unused]
    return "\n".join([*texts, _function(f"{storage}void {name}", [*inputs, *outputs], body)])


def _mentions(line: str, name: str) -> bool:
    """Whether a line has a name as a word, before a bracket, a comma or a parenthesis."""
    return any(sign + name + end in line for sign in " (" for end in "[,)")


def _function(head: str, arguments: Sequence[str], body: Sequence[str]) -> str:
    lead = ",\n" + " " * (len(head) + 1)
    joined = ", ".join(arguments)
    if len(head) + len(joined) > 100:
        joined = lead.join(arguments)
    return "\n".join([f"{head}({joined or 'void'})", "{", *body, "}", ""])


def _body(
    function: Function,
    steps: Sequence[Step],
    places: dict[int, int],
    real: str,
    prefix: str,
    names: Sequence[str],
) -> list[str]:
    """The statements of one part."""
    g, writer = function.graph, Writer(function.graph, real, prefix)
    inputs = [step for step in steps if isinstance(step, int) and g.op[step] == Op.INPUT]
    start, needed = 0, {index for step in steps for index in used(g, step)} | set(places)
    for port, name in zip(function.inputs, names, strict=False):
        nodes = g.inputs[start : start + port.size]
        read = [(j, n) for j, n in enumerate(nodes) if n in inputs and n in needed]
        for j, node in read:
            writer.assign(node, f"{name}[{j}]")
            if node in places:
                writer.write(f"w[{places[node]}] = {writer.names[node]};")
        if not read and not places:
            writer.write(f"(void){name};")
        start += port.size
    rest = [step for step in steps if not (isinstance(step, int) and g.op[step] == Op.INPUT)]
    writer.steps(rest, places, names[len(function.inputs) :])
    return writer.lines
