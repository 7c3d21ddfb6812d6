"""Reads indices, slices and extents of arrays, and lanes, into the typed tree."""

from __future__ import annotations

import ast
from collections.abc import Sequence

from ulna.compiler.imperative import tree as t
from ulna.compiler.imperative.conversions import literal
from ulna.compiler.imperative.types import (
    INT,
    ArrayType,
    Lanes,
)  # fmt: skip
from ulna.compiler.imperative.values import MOST_LANES, ValueReader


class IndexReader(ValueReader):
    """Reads expressions in a scope: those without calls."""

    def _subscript(self, node: ast.Subscript) -> t.Expression:
        if isinstance(node.value, ast.Attribute) and node.value.attr == "shape":
            array = self.read(node.value.value)
            if isinstance(array.type, ArrayType):
                return self._extent(node, array, self.constant(node.slice, "an axis"))
        value = self.read(node.value)
        indices = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
        if isinstance(value.type, Lanes) and len(indices) == 1:
            index = self.integer(indices[0], "a lane")
            return t.LaneItem(value, index, value.type.element, node.lineno)
        if not isinstance(value.type, ArrayType):
            self.fail(node, f"{value.type} cannot be indexed")
        return self._indexed(node, value, value.type, indices)

    def _extent(self, node: ast.expr, array: t.Expression, axis: int) -> t.Expression:
        assert isinstance(array.type, ArrayType)
        if not -array.type.rank <= axis < array.type.rank:
            self.fail(node, f"{array.type} has no axis {axis}")
        return t.Extent(array, axis % array.type.rank, INT, node.lineno)

    def _indexed(
        self, node: ast.expr, array: t.Expression, kind: ArrayType, indices: Sequence[ast.expr]
    ) -> t.Expression:
        if len(indices) > kind.rank:
            self.fail(node, f"{kind} takes {kind.rank} indices, not {len(indices)}")
        *first, last = indices
        fixed = tuple(self.integer(i, "an index") for i in first)
        if isinstance(last, ast.Slice):
            return self._lane_slice(node, array, kind, fixed, last)
        index = self.read(last)
        if isinstance(index.type, Lanes) and index.type.element == INT and len(indices) == kind.rank:
            lanes = Lanes(kind.element, index.type.count)
            return t.Element(array, (*fixed, index), lanes, node.lineno)
        if index.type != INT:
            self.fail(node, f"an index must be an integer, not {index.type}", "Convert it: int(x).")
        if len(indices) < kind.rank:
            view = ArrayType(kind.element, kind.rank - len(indices))
            return t.View(array, (*fixed, index), view, node.lineno)
        return t.Element(array, (*fixed, index), kind.element, node.lineno)

    def _lane_slice(
        self,
        node: ast.expr,
        array: t.Expression,
        kind: ArrayType,
        fixed: tuple[t.Expression, ...],
        part: ast.Slice,
    ) -> t.Expression:
        if part.step is not None or part.upper is None or len(fixed) + 1 != kind.rank:
            self.fail(node, "a slice is `start : start + count` along the last axis, with all others fixed")
        start = self.read(part.lower) if part.lower is not None else literal(0, node.lineno)
        if start.type != INT:
            self.fail(node, f"a slice begins at an integer, not {start.type}")
        count = self._slice_width(start, part)
        if count is None or not 1 <= count <= MOST_LANES or count & (count - 1):
            self.fail(
                node,
                f"a slice has a constant power of two of lanes, from 1 to {MOST_LANES}, not {count}",
                "Write it as a[i : i + 8].",
            )
        if count == 1:
            return t.Element(array, (*fixed, start), kind.element, node.lineno)
        return t.Slice(array, (*fixed, start), Lanes(kind.element, count), node.lineno)

    def _slice_width(self, start: t.Expression, part: ast.Slice) -> int | None:
        assert part.upper is not None
        upper = self.read(part.upper)
        if isinstance(upper, t.Constant) and isinstance(start, t.Constant):
            return int(upper.value) - int(start.value)
        if not (isinstance(part.upper, ast.BinOp) and isinstance(part.upper.op, ast.Add)):
            return None
        begins = part.lower is not None and ast.dump(part.upper.left) == ast.dump(part.lower)
        width = self.read(part.upper.right)
        return int(width.value) if begins and isinstance(width, t.Constant) and width.type == INT else None
