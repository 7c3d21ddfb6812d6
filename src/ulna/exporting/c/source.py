"""A traced function as the definition of a C function, large ones in parts."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

from ulna.compiler import Function, Port
from ulna.compiler.codegen.scheduling import Step, Store, parts, scratch_places, used
from ulna.compiler.language.ops import Op
from ulna.exporting.c.expressions import argument_names
from ulna.exporting.c.writer import PACK, Writer
from ulna.exporting.record import Argument

Ports = Sequence[Argument] | Sequence[Port]

ONE_PIECE = 1500
"""Operations and results of a function that stays in one piece."""

_FILLED = 16
"""Zeros of an output from which a loop writes them."""


def parameters(inputs: Ports, outputs: Ports, real: str) -> tuple[list[str], list[str]]:
    """The parameters of the C function, inputs and outputs: "const double q[7]".

    Args:
        inputs: The inputs.
        outputs: The outputs.
        real: "double" or "float".

    Returns:
        Declarations of the inputs, and of the outputs.
    """
    ports = [*inputs, *outputs]
    names = argument_names(p.name for p in ports)
    made = [f"{real} {name}[{max(port.size, 1)}]" for name, port in zip(names, ports, strict=True)]
    count = len(inputs)
    return [f"const {one}" for one in made[:count]], made[count:]


def definition(
    function: Function, outputs: Ports, name: str, real: str, prefix: str, storage: str = ""
) -> str:
    """The definition of the C function, after those of its parts.

    Args:
        function: The traced function.
        outputs: Its outputs, with the names that they have in C.
        name: The name of the C function.
        real: "double" or "float".
        prefix: What names of functions of the export begin with.
        storage: "static " for a function that no other file calls.

    Returns:
        The text.
    """
    heads = [*itertools.chain(*parameters(function.inputs, outputs, real))]
    names = argument_names(p.name for p in (*function.inputs, *outputs))
    pieces = parts(function, 1, PACK)
    if function.operations + len(function.results) <= ONE_PIECE:
        pieces = [[step for piece in pieces for step in piece]]
    places = scratch_places(function.graph, pieces)
    filled = _filled(function)
    bodies = [
        _body(function, steps, places, real, prefix, names, filled, not k) for k, steps in enumerate(pieces)
    ]
    if len(pieces) == 1:
        unused = [n for n in names if not any(_mentions(line, n) for line in bodies[0])]
        body = [*bodies[0], *(f"    (void){n};" for n in unused)]
        return _function(f"{storage}void {name}", heads, body)
    texts, calls = [], []
    for k, body in enumerate(one for one in bodies if one):
        declared = dict(zip([*names, "w"], [*heads, f"{real} *w"], strict=True))
        mine = [n for n in declared if any(_mentions(line, n) for line in body)]
        texts.append(
            _function(f"{prefix.upper()}_PART void {name}_part{k}", [declared[n] for n in mine], body)
        )
        calls.append(f"    {name}_part{k}({', '.join(mine)});")
    head = (
        [f"    {real} w[{max(places.values(), default=0) + 1}];"]
        if any(_mentions(c, "w") for c in calls)
        else []
    )
    unused = [n for n in names if not any(_mentions(call, n) for call in calls)]
    body = [*head, *calls, *(f"    (void){n};" for n in unused)]
    return "\n".join([*texts, _function(f"{storage}void {name}", heads, body)])


def _filled(function: Function) -> list[set[int]]:
    """Which entries of each output are zero whatever the inputs, where these are so many that a loop writes them."""
    g, start, filled = function.graph, 0, []
    for port in function.outputs:
        nodes = function.results[start : start + port.size]
        zeros = {k for k, n in enumerate(nodes) if g.op[n] == Op.CONST and g.data[n].hex() == "0x0.0p+0"}
        filled.append(zeros if len(zeros) >= _FILLED else set())
        start += port.size
    return filled


def _mentions(line: str, name: str) -> bool:
    """Whether a line has a name as a word, before a bracket, a comma or a parenthesis."""
    return any(sign + name + end in line for sign in (" ", "(") for end in ("[", ",", ")"))


def prototype(head: str, arguments: Sequence[str]) -> str:
    """The head of a function, with its arguments one below the other where they are long.

    Args:
        head: What stands in front of them: "void panda_fk".
        arguments: Declarations of the arguments.

    Returns:
        The text, without a semicolon.
    """
    lead = ",\n" + " " * (len(head) + 1)
    joined = ", ".join(arguments)
    if len(head) + len(joined) > 100:
        joined = lead.join(arguments)
    return f"{head}({joined or 'void'})"


def _function(head: str, arguments: Sequence[str], body: Sequence[str]) -> str:
    return "\n".join([prototype(head, arguments), "{", *body, "}", ""])


def _body(
    function: Function,
    steps: Sequence[Step],
    places: dict[int, int],
    real: str,
    prefix: str,
    names: Sequence[str],
    filled: Sequence[set[int]],
    is_first: bool,
) -> list[str]:
    """The statements of one part; the first fills outputs with zeros once the inputs are read."""
    g, writer, outputs = function.graph, Writer(function.graph, real, prefix), names[len(function.inputs) :]
    start, needed = 0, {index for step in steps for index in used(g, step)} | set(places)
    for port, name in zip(function.inputs, names, strict=False):
        nodes = g.inputs[start : start + port.size]
        read = [(j, n) for j, n in enumerate(nodes) if is_first and n in needed]
        for j, node in read:
            writer.assign(node, f"{name}[{j}]")
            if node in places:
                writer.write(f"w[{places[node]}] = {writer.names[node]};")
        start += port.size
    if is_first and any(filled):
        writer.write("int i;")
        for name, port, zeros in zip(outputs, function.outputs, filled, strict=True):
            if zeros:
                writer.write(f"for (i = 0; i < {port.size}; i++) {{")
                writer.write(f"    {name}[i] = 0;")
                writer.write("}")
    rest = [step for step in steps if not (isinstance(step, int) and g.op[step] == Op.INPUT)]
    writer.steps([step for step in rest if not _is_filled(step, filled)], places, outputs)
    return writer.lines


def _is_filled(step: Step, filled: Sequence[set[int]]) -> bool:
    """Whether a step stores zeros that a loop has written already."""
    return (
        isinstance(step, Store) and set(range(step.start, step.start + len(step.values))) <= filled[step.port]
    )
