"""How a recursion is declared: a procedure whose parameters have types and a meaning by their names.

| parameter | meaning | shape |
|---|---|---|
| tree | the table of the steps | |
| storage | working arrays of one block | |
| inputs, outputs | samples in lanes; of matrices one sample a block | (blocks, size, W); (blocks, size, 1) |
| blocks | how many blocks are computed | |
| W | a constant: samples at once; of matrices columns at once | |
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ulna.compiler.procedures import Array3, Procedure, f64, procedure
from ulna.recursions.tree_table import TreeTable


def recursion(*, W: int, **storage: Any) -> Callable[[Callable[..., Any]], Procedure]:
    """Makes a function a procedure with parameters in the order of the table; see `recursions.recursion.Recursion`.

    Args:
        W: The number of lanes unless the procedure is specialized.
        **storage: The types of the parameters that are storage, by name.

    Returns:
        The decorator.
    """
    types = {"tree": TreeTable, "blocks": int, "W": int, "return": None, **storage}

    def declared(function: Callable[..., Any]) -> Procedure:
        names = *function.__code__.co_varnames[: function.__code__.co_argcount], "return"
        function.__annotations__ = {name: types.get(name, Array3[f64]) for name in names}
        return procedure(constants={"W": W}, contract=True)(function)

    return declared
