"""Functions evaluated on objects of other libraries that have the functions of NumPy as methods, as CasADi's symbols do."""

from __future__ import annotations

import numpy as np

from ulna.compiler import trace


class Text:
    """A symbol that writes down what is computed with it."""

    def __init__(self, text: str) -> None:
        self.text = text

    def __mul__(self, other: object) -> Text:
        return Text(f"({self.text} * {other})")

    __rmul__ = __mul__

    def sin(self) -> Text:
        return Text(f"sin({self.text})")

    def arctan2(self, other: Text) -> Text:
        return Text(f"arctan2({self.text}, {other})")

    def __str__(self) -> str:
        return self.text


def test_methods_of_the_symbols_are_called() -> None:
    f = trace(lambda x: np.stack([np.sin(x[0]), np.arctan2(x[1], x[0]), x[0] * x[1]]), name="f", x=(2,))
    result = f(np.array([Text("a"), Text("b")], dtype=object))
    assert [str(entry) for entry in result] == ["sin(a)", "arctan2(b, a)", "(a * b)"]
