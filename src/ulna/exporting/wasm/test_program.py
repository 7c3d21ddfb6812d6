"""A script for node that compares the functions with recorded values of the interpreter."""

from __future__ import annotations

import json
from typing import Any

import numpy as np

from ulna.exporting.record import Export, ExportedFunction, ExportedSearch
from ulna.exporting.sensitivity import compared_outputs, tolerance

_MAX_CASES = 3000
"""Recorded numbers of a function."""


def test_program(export: Export) -> str:
    """The text of the script. It prints a line for each function, and exits with 1 if one is wrong.

    Args:
        export: What is exported.

    Returns:
        The text.
    """
    functions = {f.name: _recorded(f, export.dtype.name) for f in export.functions}
    searches = {s.name: _goals(s) for s in export.searches}
    script = _SCRIPT.replace("__NAME__", export.name)
    for word, values in (("__FUNCTIONS__", functions), ("__SEARCHES__", searches)):
        script = script.replace(word, json.dumps(values, separators=(",", ":")))
    return script


def _recorded(f: ExportedFunction, dtype: str) -> dict[str, Any]:
    """Inputs and outputs of some samples, and the largest difference that passes."""
    size = sum(a.size for a in (*f.inputs, *f.outputs))
    count = min(len(f.samples[0]) if f.samples else 1, max(1, _MAX_CASES // max(size, 1)))
    compared, recorded = compared_outputs(f, dtype), []
    for k in range(count):
        values = [np.asarray(s[k]) for s in f.samples]
        results = f.function(*values)
        each = (results,) if f.function.single else results
        outputs = [
            [x if is_compared and np.isfinite(x) else None for x in np.ravel(r).tolist()]
            for r, is_compared in zip(each, compared, strict=True)
        ]
        recorded.append({"inputs": [v.tolist() for v in values], "outputs": outputs})
    samples = [np.asarray(s[:count]) for s in f.samples]
    return {"samples": recorded, "tolerance": tolerance(f, samples, dtype)}


def _goals(s: ExportedSearch) -> list[Any]:
    return s.goals.tolist()


_SCRIPT = """\
// Compares the functions with recorded values of Ulna's interpreter: node test___NAME__.mjs
// Written by Ulna; do not edit.
import { load } from "./__NAME__.js";

const functions = __FUNCTIONS__;
const searches = __SEARCHES__;
const robot = await load();
let failures = 0;

for (const [name, { samples, tolerance }] of Object.entries(functions)) {
  let largest = 0;
  for (const { inputs, outputs } of samples) {
    const results = robot[name](...inputs);
    outputs.forEach((expected, k) => {
      const got = outputs.length === 1 ? results : results[k];
      const scale = Math.max(1, ...expected.map(Math.abs));
      expected.forEach((x, i) => {
        if (x === null) return; // not finite, or not compared
        largest = Math.max(largest, Math.abs((typeof got === "number" ? got : got[i]) - x) / scale);
      });
    });
  }
  const good = largest <= tolerance;
  failures += good ? 0 : 1;
  console.log(`${name}: largest difference ${largest.toExponential(1)}${good ? "" : ", which is too much"}`);
}
for (const [name, goals] of Object.entries(searches)) {
  const found = goals.map((T) => robot[name](T));
  const again = goals.map((T, k) => robot[name](T, found[k].q));
  const met = [found, again].map((list) => list.filter((s) => s.success).length);
  failures += met[0] === goals.length && met[1] === goals.length ? 0 : 1;
  console.log(`${name}: ${met[0]} of ${goals.length} goals met, ${met[1]} again from their solutions`);
}
process.exitCode = failures ? 1 : 0;
"""
