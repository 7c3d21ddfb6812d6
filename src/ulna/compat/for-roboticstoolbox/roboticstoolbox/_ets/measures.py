"""Measures of manipulability by the toolbox's names, of a Jacobian or of a configuration."""

from __future__ import annotations

from typing import Any

import numpy as np

from roboticstoolbox._common.errors import UnknownOption, WrongShape
from ulna import algorithms
from ulna.algorithms.kinematics.manipulability import chosen_rows
from ulna.typing import Floats

_MEASURES = {
    "yoshi": "yoshikawa",
    "asa": "asada",
    "mins": "minimum_singular_value",
    "invc": "inverse_condition",
}
MEASURES_OF_CHAINS = ("yoshikawa", "minsingular", "invcondition")
_NAMES = (*MEASURES_OF_CHAINS, "asada")


def measure_name(method: str) -> Any:
    """Ulna's name of a measure; its first letters are enough, in upper or lower case.

    Raises:
        UnknownOption: There is no such measure.
    """
    for letters, name in _MEASURES.items():
        if str(method).lower().startswith(letters):
            return name
    raise UnknownOption("measure of manipulability", method, _NAMES)


def axes_of(axes: Any) -> Any:
    """The axes "all", "trans" or "rot" in full, or six truth values, one for each row of the Jacobian.

    Raises:
        UnknownOption: There are no such axes.
        WrongShape: They are not six.
    """
    if isinstance(axes, str):
        for name in ("all", "trans", "rot"):
            if axes.startswith(name):
                return name
        raise UnknownOption("choice of axes", axes, ("all", "trans", "rot", "both"))
    rows = np.asarray(axes)
    if rows.shape != (6,):
        raise WrongShape("axes", rows.shape, "'all', 'trans', 'rot', or six truth values")
    return [bool(row) for row in rows]


def measure_of(J: Floats, measure: Any, axes: Any) -> Any:
    """A measure of a Jacobian (..., 6, n); singular values are those that it has, fewer than six for fewer joints.

    Args:
        J: Jacobian (..., 6, n).
        measure: "yoshikawa" or "minimum_singular_value"; else the inverse condition number.
        axes: Which rows count.

    Returns:
        The measure (...).
    """
    if measure == "yoshikawa":
        return algorithms.measure_of(J, measure, axes)
    s = np.linalg.svd(J[..., chosen_rows(axes), :], compute_uv=False)
    least = s[..., -1][()]  # a number, not an array without axes
    return least if measure == "minimum_singular_value" else least / s[..., 0][()]
