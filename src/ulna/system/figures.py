"""Figures of Matplotlib that notebooks display, whether or not one of its backends was chosen before."""

from __future__ import annotations

import io
from functools import partial
from typing import Any


def displayed(figure: Any) -> Any:
    """The figure, which IPython displays now also where pyplot was not imported.

    Args:
        figure: A `matplotlib.figure.Figure`.

    Returns:
        The same figure.
    """
    figure._repr_png_ = partial(_png, figure)
    return figure


def _png(figure: Any) -> bytes:
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", bbox_inches="tight")
    return buffer.getvalue()
