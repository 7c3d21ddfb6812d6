"""Random procedures: source text with loops, branches, integers, floats, lanes and arrays, for comparisons."""

from __future__ import annotations

import itertools
import linecache
from typing import Any

import numpy as np

from ulna.compiler import procedures

_NAMES = itertools.count()
WIDTH = 8


class _Writer:
    def __init__(self, seed: int) -> None:
        self.random = np.random.default_rng(seed)
        self.variables: dict[str, list[str]] = {
            "int": ["n"],
            "f32": ["s"],
            "f64": ["d"],
            "bool": [],
            "lanes": [],
            "mask": [],
        }
        self.lines: list[str] = []

    def pick(self, choices: Any) -> Any:
        return choices[self.random.integers(len(choices))]

    def number(self, kind: str, depth: int = 2) -> str:
        known = self.variables[kind]
        if depth == 0 or self.random.random() < 0.2:
            if known and self.random.random() < 0.7:
                return self.pick(known)
            return self.leaf(kind)
        return getattr(self, f"_{kind}")(depth - 1)

    def leaf(self, kind: str) -> str:
        return {
            "int": str(self.random.integers(-9, 10)),
            "f32": f"f32({self.pick(['0.5', '-2.25', '3.0', '1e-3', '7e7'])})",
            "f64": self.pick(["0.25", "-1.5", "1e3", "3.0"]),
            "bool": self.pick(["True", "False"]),
            "lanes": f"a[{self.pick(['0', '1', '2'])}, 0:{WIDTH}]",
            "mask": f"(a[0, 0:{WIDTH}] < a[1, 0:{WIDTH}])",
        }[kind]

    def _int(self, depth: int) -> str:
        a, b = self.number("int", depth), self.number("int", depth)
        mask = self.number("mask", depth)
        return self.pick([
            f"({a} + {b})", f"({a} - {b})", f"({a} * {b})", f"({a} // {self.pick(['3', '-4', '7'])})",
            f"({a} % {self.pick(['5', '-3'])})", f"({a} & {b})", f"({a} ^ {b})", f"({a} << 3)", f"({a} >> 2)",
            f"min({a}, {b})", f"abs({a})", f"int({self.number('f64', depth)})", f"count_of({mask})", f"first_of({mask})",
            f"({a} if {self.number('bool', depth)} else {b})", f"k[abs({a}) % 6]", f"(-{a})", f"(~{a})", "len(k)",
            f"int({self.number('bool', depth)})", "a.shape[1]", f"math.floor({self.number('f64', depth)})",
        ])  # fmt: skip

    def _real(self, kind: str, depth: int) -> str:
        a, b = self.number(kind, depth), self.number(kind, depth)
        return self.pick([
            f"({a} + {b})", f"({a} - {b})", f"({a} * {b})", f"({a} / {b})", f"min({a}, {b})", f"max({a}, {b})",
            f"np.sqrt(abs({a}))", f"np.floor({a})", f"(-{a})", f"({a}) ** 2" if "(" not in a else f"({a} * 2)",
            f"({a} if {self.number('bool', depth)} else {b})", f"({a} + {self.random.integers(1, 5)})",
        ])  # fmt: skip

    def _f32(self, depth: int) -> str:
        lanes = self.number("lanes", depth)
        if self.random.random() < 0.4:
            return self.pick([
                f"sum_of({lanes})", f"least_of({lanes})", f"greatest_of({lanes})", f"f32({self.number('f64', depth)})",
                f"f32({self.number('int', depth)})", f"({lanes})[abs({self.number('int', depth)}) % {WIDTH}]",
                f"a[abs({self.number('int', depth)}) % 3, abs({self.number('int', depth)}) % 16]",
            ])  # fmt: skip
        return self._real("f32", depth)

    def _f64(self, depth: int) -> str:
        if self.random.random() < 0.3:
            return self.pick([f"f64({self.number('f32', depth)})", f"f64({self.number('int', depth)})",
                              f"({self.number('int', depth)} + 0.5)", f"({self.number('int', depth)} / 4)"])  # fmt: skip
        return self._real("f64", depth)

    def _bool(self, depth: int) -> str:
        kind = self.pick(["int", "f32", "f64"])
        a, b, mask = self.number(kind, depth), self.number(kind, depth), self.number("mask", depth)
        return self.pick([
            f"({a} < {b})", f"({a} == {b})", f"({a} >= {b})", f"(not {self.number('bool', depth)})",
            f"({self.number('bool', depth)} and {self.number('bool', depth)})", f"any_of({mask})", f"all_of({mask})",
            f"({self.number('bool', depth)} or {self.number('bool', depth)})", f"({a} != {a})",
        ])  # fmt: skip

    def _lanes(self, depth: int) -> str:
        a, b = self.number("lanes", depth), self.number("lanes", depth)
        return self.pick([
            f"({a} + {b})", f"({a} * {b})", f"({a} - {self.number('f32', depth)})", f"({a} / {b})",
            f"np.where({self.number('mask', depth)}, {a}, {b})", f"np.minimum({a}, {b})", f"abs({a})", f"(-{a})",
            f"np.sqrt(abs({a}))", f"broadcast({self.number('f32', depth)}, {WIDTH})", f"(2.0 * {a})",
            f"lane_numbers({WIDTH}, f32)", f"a[1, lane_numbers({WIDTH}) * 2]", f"np.maximum({a}, 0)",
        ])  # fmt: skip

    def _mask(self, depth: int) -> str:
        a, b = self.number("lanes", depth), self.number("lanes", depth)
        m, n = self.number("mask", depth), self.number("mask", depth)
        return self.pick([f"({a} < {b})", f"({a} >= {self.number('f32', depth)})", f"({m} & {n})", f"({m} | {n})",
                          f"(~{m})", f"({m} ^ {n})", f"({a} == {b})"])  # fmt: skip

    def statements(self, indent: str, depth: int, count: int) -> None:
        for _ in range(count):
            form = self.pick(
                ["new", "new", "set", "store", "if", "for", "while"] if depth else ["set", "set", "store"]
            )
            getattr(self, f"_write_{form}")(indent, depth)

    def _write_new(self, indent: str, depth: int) -> None:
        if indent != "    ":
            return self._write_set(indent, depth)
        kind = self.pick(list(self.variables))
        name = f"v{next(_NAMES)}"
        cast = {"int": "int", "f64": "f64", "f32": "f32"}.get(kind)
        value = self.number(kind)
        self.lines.append(f"{indent}{name} = {f'{cast}({value})' if cast else value}")
        self.variables[kind].append(name)
        return None

    def _write_set(self, indent: str, depth: int) -> None:
        kind = self.pick([k for k, names in self.variables.items() if names])
        self.lines.append(f"{indent}{self.pick(self.variables[kind])} = {self.number(kind)}")

    def _write_store(self, indent: str, depth: int) -> None:
        index = f"abs({self.number('int', 1)})"
        self.lines.append(indent + self.pick([
            f"k[{index} % 6] = {self.number('int')}", f"a[{index} % 3, {index} % 16] = {self.number('f32')}",
            f"w[{index} % 4] += {self.number('f64')}", f"a[2, 8:16] = {self.number('lanes')}",
        ]))  # fmt: skip

    def _write_if(self, indent: str, depth: int) -> None:
        self.lines.append(f"{indent}if {self.number('bool')}:")
        self.statements(indent + "    ", depth - 1, 2)
        self.lines.append(f"{indent}else:")
        self.statements(indent + "    ", depth - 1, 1)

    def _write_for(self, indent: str, depth: int) -> None:
        name = f"i{next(_NAMES)}"
        self.lines.append(f"{indent}for {name} in range({self.pick(['3', '1, 6, 2', '4, 0, -1', 'n % 4'])}):")
        self.variables["int"].append(name)
        self.statements(indent + "    ", depth - 1, 2)
        if self.random.random() < 0.4:
            word = self.pick(["break", "continue"])
            self.lines += [f"{indent}    if {self.number('bool', 1)}:", f"{indent}        {word}"]
            self.statements(indent + "    ", 0, 1)
        self.variables["int"].remove(name)

    def _write_while(self, indent: str, depth: int) -> None:
        name = f"c{next(_NAMES)}"
        self.lines += [f"{indent}{name} = 0", f"{indent}while {name} < 5 and {self.number('bool', 1)}:"]
        self.lines.append(f"{indent}    {name} += 1")
        self.statements(indent + "    ", depth - 1, 2)


def random_procedure(seed: int, statements: int = 8) -> tuple[procedures.Procedure, str]:
    """A random procedure of (n, s, d, k (6,), a (3, 16), w (4,)), and its source; it returns five numbers."""
    writer = _Writer(seed)
    writer.statements("    ", 2, statements)
    returned = ", ".join(writer.number(kind) for kind in ("int", "f32", "f64", "bool", "lanes"))
    head = "def generated(n: int, s: f32, d: float, k: Array1[np.int64], a: Array2[f32], w: Array1[f64]):"
    text = "\n".join([head, *writer.lines, f"    return {returned}", ""])
    file = f"<random procedure {seed}>"
    linecache.cache[file] = (len(text), None, text.splitlines(keepends=True), file)
    import math

    names: dict[str, Any] = {**vars(procedures), "np": np, "math": math}
    exec(compile(text, file, "exec", dont_inherit=True), names)
    return procedures.procedure(names["generated"]), text


def arguments(seed: int) -> tuple[Any, ...]:
    """Arguments of a random procedure, infinities and zeros among them."""
    random = np.random.default_rng(seed)
    a = random.normal(scale=3.0, size=(3, 16)).astype(np.float32)
    a[random.random(a.shape) < 0.1] = 0.0
    a[random.random(a.shape) < 0.03] = np.inf
    n, k = int(random.integers(-50, 50)), random.integers(-1000, 1000, size=6)
    return n, float(random.normal()), float(random.normal()), k, a, random.normal(size=4)
