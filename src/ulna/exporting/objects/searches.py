"""The function around a search, `int NAME(T, q0, options, q, report)` of the C header, as LLVM IR.

It does what that of `exporting.c.search` does: checks the arguments, searches, and where no goal is met descends to the
nearest configuration.
"""

from __future__ import annotations

import numpy as np

from ulna.compiler.codegen.instructions import Instructions
from ulna.compiler.codegen.ir_text import BYTES, DType, Lanes
from ulna.compiler.codegen.node_writer import Module
from ulna.compiler.codegen.sincos import sincos_ir
from ulna.compiler.codegen.target import Target
from ulna.exporting.c.search import ATTEMPTS, TOLERANCE
from ulna.exporting.record import ExportedSearch
from ulna.ik.goal import ANY_CHORD, ANY_LENGTH
from ulna.ik.search import ATTEMPT_STEPS, DESCENT, MEAN_STEPS
from ulna.typing import Floats

_BAD_ARGUMENT, _NOT_A_POSE, _MOST_ATTEMPTS = -2, -1, 1_000_000


class SearchWriter(Instructions):
    """Writes the function of one search.

    Args:
        name: Its name.
        search: The search.
        target: What code is generated for.
        element: The type of the numbers.
    """

    def __init__(self, name: str, search: ExportedSearch, target: Target, element: DType) -> None:
        super().__init__()
        self.name, self.search, self.target = name, search, target
        self.element: DType = element
        self.nq, self.frames = search.problem.model.nq, len(search.problem.frames)

    def add_to(self, module: Module) -> None:
        """Adds the definition, and what it needs, to a module that has the search as `NAME_search.one`."""
        element, name = self.element, self.name
        tolerance = self.number(TOLERANCE[element])
        for part, values in (("start", self.search.start), ("shift", self.search.shift)):
            module.definitions[f"{name}.{part}"] = self._constant(part, values)
        module.definitions[f"{name}.defaults"] = (
            f"@{name}.defaults = internal constant {self._options} "
            f"{{ {element} {tolerance}, {element} {tolerance}, i32 {ATTEMPTS} }}\n"
        )
        module.use(sincos_ir(1, element, self.target.arithmetic))
        self.begin_function(
            f"define signext i32 @{name}(ptr %T, ptr %q0, ptr %options, ptr %q, ptr %report) nounwind"
        )
        self._choose()
        self._check()
        self._settings()
        self._search()
        self._results()
        self.end_function()
        module.definitions[name] = self.text()

    @property
    def _options(self) -> str:
        return f"{{ {self.element}, {self.element}, i32 }}"

    def number(self, value: float) -> str:
        """The literal of a number, rounded to the type."""
        with np.errstate(over="ignore"):
            rounded = float(np.float32(value)) if self.element == "float" else float(value)
        return Lanes(1, self.element).constant(rounded)

    def _constant(self, part: str, values: Floats) -> str:
        numbers = ", ".join(f"{self.element} {self.number(x)}" for x in values)
        count = len(values)
        content = f"[{numbers}]" if count else "zeroinitializer"
        return f"@{self.name}.{part} = internal constant [{count} x {self.element}] {content}, align 8\n"

    def _choose(self) -> None:
        """The default options and start where none are passed."""
        e = self.element
        self.let("has.q0", "icmp ne ptr %q0, null")
        self.let("has.options", "icmp ne ptr %options, null")
        self.let("home", f"select i1 %has.q0, ptr %q0, ptr @{self.name}.start")
        self.let("chosen", f"select i1 %has.options, ptr %options, ptr @{self.name}.defaults")
        self.let("distance", f"load {e}, ptr %chosen")
        self.field("angle", "%chosen", BYTES[e], e)
        self.field("attempts", "%chosen", 2 * BYTES[e], "i32")
        for name, count in (("settings", 4), ("out", self.nq + 3 + 2 * self.frames), ("nearest", self.nq)):
            self.let(name, f"alloca [{count} x {e}], align 8")

    def _check(self) -> None:
        e, infinity = self.element, self.number(np.inf)
        tests = []
        for name in ("distance", "angle"):
            tests.append(self.let(f"{name}.above", f"fcmp ogt {e} %{name}, {self.number(0.0)}"))
            tests.append(self.let(f"{name}.below", f"fcmp olt {e} %{name}, {infinity}"))
        self.let("attempts.less", "sub i32 %attempts, 1")
        tests.append(self.let("attempts.good", f"icmp ult i32 %attempts.less, {_MOST_ATTEMPTS}"))
        tests.append(self._finite("home", self.nq))
        good = tests[0]
        for k, test in enumerate(tests[1:]):
            good = self.let(f"good{k}", f"and i1 {good}, {test}")
        self.branch(good, "arguments.good", "arguments.bad")
        self._leave("arguments.bad", _BAD_ARGUMENT)
        self.open_block("arguments.good")
        self.branch(self._finite("T", 16 * self.frames), "finite", "no.pose")
        self._leave("no.pose", _NOT_A_POSE)
        self.open_block("finite")

    def _finite(self, array: str, count: int) -> str:
        """Whether numbers are finite: x * 0 is nan for nan and infinities, and nan survives a sum."""
        e, total = self.element, self.number(0.0)
        for k in range(count):
            value = self.item(f"{array}.{k}", f"%{array}", k, e)
            zero = self.let(f"{array}.{k}.zero", f"fmul {e} {value}, {self.number(0.0)}")
            total = self.let(f"{array}.{k}.sum", f"fadd {e} {total}, {zero}")
        return self.let(f"{array}.finite", f"fcmp ord {e} {total}, {total}")

    def _leave(self, block: str, status: int) -> None:
        self.open_block(block)
        self.write(f"ret i32 {status}")

    def _settings(self) -> None:
        """Squares of tolerances, 1 to stay near q0, and the greatest number of steps, in whole rounds of lanes."""
        e, lanes = self.element, self.target.search_lanes
        pair, limit = Lanes(1, e).pair, self.number(ANY_LENGTH)
        self.let("distance.less", f"fcmp olt {e} %distance, {limit}")
        self.let("distance.most", f"select i1 %distance.less, {e} %distance, {e} {limit}")
        self.let("half", f"fmul {e} %angle, {self.number(0.5)}")
        self.let("sincos", f"call {pair} @ulna.sincos.{Lanes(1, e).suffix}({e} %half)")
        self.let("sine", f"extractvalue {pair} %sincos, 0")
        self.let("chord.half.turn", f"fmul {e} %sine, {self.number(2.0)}")
        self.let("angle.less", f"fcmp olt {e} %angle, {self.number(np.pi)}")
        self.let("chord", f"select i1 %angle.less, {e} %chord.half.turn, {e} {self.number(ANY_CHORD)}")
        self.let("rounds.up", f"add i32 %attempts, {lanes - 1}")
        self.let("rounds", f"lshr i32 %rounds.up, {lanes.bit_length() - 1}")
        self.let("steps.mean", f"mul i32 %rounds, {MEAN_STEPS}")
        self.let("steps.most", f"add i32 %steps.mean, {ATTEMPT_STEPS}")
        values = (
            self.let("setting0", f"fmul {e} %distance.most, %distance.most"),
            self.let("setting1", f"fmul {e} %chord, %chord"),
            self.let("setting2", f"uitofp i1 %has.q0 to {e}"),
            self.let("setting3", f"sitofp i32 %steps.most to {e}"),
        )
        for k, value in enumerate(values):
            self._store(value, "settings", k)

    def _store(self, value: str, array: str, k: int, offset: int = 0, kind: str = "") -> None:
        kind = kind or self.element
        place = self.let(f"{array}.place{k}.{offset}", f"getelementptr {kind}, ptr %{array}, i64 {k}")
        self.write(f"store {kind} {value}, ptr {place}")

    def _search(self) -> None:
        """The search, and the descent where it fails."""
        e, nq = self.element, self.nq
        call = (
            f"call void @{self.name}_search.one(ptr %{{}}, ptr @{self.name}.shift, ptr %settings, ptr %out)"
        )
        self.write(call.format("T, ptr %home"))
        status = self.item("status", "%out", nq, e)
        refused = self.let("refused", f"fcmp olt {e} {status}, {self.number(-0.5)}")
        self.branch(refused, "no.rotation", "searched")
        self._leave("no.rotation", _NOT_A_POSE)
        self.open_block("searched")
        for name, k in (("steps", nq + 1), ("number", nq + 2)):
            value = self.item(f"{name}.real", "%out", k, e)
            self.let(name, f"fptosi {e} {value} to i32")
        missed = self.let("missed", f"fcmp olt {e} {status}, {self.number(0.5)}")
        self.branch(missed, "descent", "done")
        self.open_block("descent")
        for k in range(nq):
            self._store(self.item(f"last{k}", "%out", k, e), "nearest", k)
        self._store(self.number(-float(DESCENT)), "settings", 3, 1)
        self.write(call.format("T, ptr %nearest"))
        self.jump("done")

    def _results(self) -> None:
        e, nq = self.element, self.nq
        self.open_block("done")
        for k in range(nq):
            self._store(self.item(f"found{k}", "%out", k, e), "q", k)
        final = self.item("final", "%out", nq, e)
        self.let("met", f"fcmp ogt {e} {final}, {self.number(0.5)}")
        self.let("result", "zext i1 %met to i32")
        self.branch(self.let("wanted", "icmp ne ptr %report, null"), "reported", "end")
        self.open_block("reported")
        self._store("%steps", "report", 0, kind="i32")
        self._store("%number", "report", 1, kind="i32")
        self.let("errors", "getelementptr i8, ptr %report, i64 8")
        for k in range(self.frames):
            for part in (0, 1):
                value = self.item(f"error{k}.{part}", "%out", nq + 3 + 2 * k + part, e)
                self._store(value, "errors", part * self.frames + k)
        self.jump("end")
        self.open_block("end")
        self.write("ret i32 %result")
