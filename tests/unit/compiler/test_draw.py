"""Pictures of graphs: well-formed, complete, and summed up when large."""

from __future__ import annotations

import re
from itertools import pairwise
from xml.etree import ElementTree

import numpy as np
import pytest

from ulna import numeric as nm
from ulna.compiler import compile, trace
from ulna.compiler.language.methods.drawing import LIMIT
from ulna.errors import InputError

SVG = "{http://www.w3.org/2000/svg}"


def parts(text: str):
    root = ElementTree.fromstring(text)
    return root, [t.text for t in root.iter(f"{SVG}text")], list(root.iter(f"{SVG}path"))


def boxes(root) -> list[tuple[float, float, float, float]]:
    found = [r for r in root.iter(f"{SVG}rect") if r.get("rx") == "6"]
    return [tuple(float(r.get(k)) for k in ("x", "y", "width", "height")) for r in found]  # type: ignore[misc]


def test_a_small_graph_shows_every_node_once(tmp_path):
    f = trace(lambda q, x: (np.sin(q) * 2.5 + q[0] * x, 4.25), q=(2,), x=(), name="f<&>")
    path = tmp_path / "graph.svg"
    text = f.draw(str(path))
    assert path.read_text(encoding="utf-8") == text
    root, words, edges = parts(text)
    assert words[0] == "f<&>(2),()->(2),(): 7 operations"
    for word, count in {
        "q[0]": 1,
        "q[1]": 1,
        "x": 1,
        "sin": 2,
        "× 2.5": 2,
        "+": 2,
        "out0[0]": 1,
        "out0[1]": 1,
    }.items():
        assert words.count(word) == count, word
    assert "out1 = 4.25" in words
    assert len(edges) == 2 + 2 + 2 + 4 + 2
    assert len(boxes(root)) == 3 + f.operations + 3


def test_a_file_of_another_kind_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"graph\.png'; expected a name that ends in \.svg"):
        trace(lambda x: x + 1.0, x=()).draw(str(tmp_path / "graph.png"))
    assert not list(tmp_path.iterdir())


def test_boxes_do_not_overlap_and_lie_in_the_picture():
    f = trace(lambda m, v: m @ m @ v, m=(3, 3), v=(3,))
    root, _, _ = parts(f.draw())
    width, height = float(root.get("width")), float(root.get("height"))
    found = sorted(boxes(root))
    for (x0, y0, w, h), (x1, y1, _, _) in pairwise(found):
        assert x1 >= x0 + w or y1 >= y0 + h - 0.2
        assert x0 >= 0 and x0 + w <= width and y0 >= 0 and y0 + h <= height


def test_edges_run_from_left_to_right():
    f = trace(lambda m, v: (m @ m @ v, v), m=(2, 2), v=(2,))
    for edge in parts(f.draw())[2]:
        start, *_, end = re.findall(r"(-?[\d.]+),-?[\d.]+", edge.get("d"))
        assert float(start) < float(end)


def test_loops_choices_and_kernels():
    def f(x, y):
        r, n = nm.loop(lambda r, n: r < y, lambda r, n: (r * 2.0, n + 1.0), (x, 0.0), 9)
        return nm.where(r < 1.0, nm.minimum(x, n), ~(x < y))

    words = parts(compile(f, x=(), y=()).draw())[1]
    assert {"loop of 8 nodes", "min", "x", "y", "out"} <= set(words)


def test_a_large_graph_is_summed_up_with_a_note():
    f = trace(lambda m: m @ m @ m, m=(8, 8))
    assert len(f.graph.live(f.results)) > LIMIT
    root, words, edges = parts(f.draw())
    assert re.search(rf"drawn in summary because the graph has \d+ nodes \(more than {LIMIT}\)", words[0])
    assert "64 inputs" in words
    assert "64 outputs" in words
    assert len(boxes(root)) < 100
    assert edges


def test_a_function_without_inputs_or_operations():
    assert "out = 1" in parts(trace(lambda: 1.0).draw())[1]
    assert "out = nan" in parts(trace(lambda x: np.nan, x=()).draw())[1]


def test_boxes_stand_beside_those_they_are_computed_from():
    """Two chains from the last inputs to the outputs are drawn about straight; boxes are 26 high."""
    f = trace(lambda a, b: (np.sin(a[3] * 2.0), np.cos(b[3] * 3.0)), a=(4,), b=(4,))
    edges = parts(f.draw())[2]
    ends = [re.findall(r"(-?[\d.]+),(-?[\d.]+)", edge.get("d")) for edge in edges]
    steps = [abs(float(line[-1][1]) - float(line[0][1])) for line in ends]
    assert len(steps) == 6
    assert max(steps) < 40.0, steps
