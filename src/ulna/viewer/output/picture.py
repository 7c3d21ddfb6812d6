"""Pictures that notebooks display."""

from __future__ import annotations

from typing import Any, final

import numpy as np

from ulna.typing import Array
from ulna.viewer.output.png import encode_png


@final
class Picture(np.ndarray):
    """A picture (height, width, 3), uint8: an array that a notebook displays as what it shows."""

    def _repr_png_(self) -> bytes | None:
        is_picture = self.ndim == 3 and self.shape[2] in (3, 4) and self.dtype == np.uint8 and self.size
        return encode_png(np.asarray(self)) if is_picture else None

    def __repr__(self) -> str:
        if self.ndim != 3:
            return repr(np.asarray(self))
        height, width = self.shape[:2]
        return f"<picture of {width} x {height} pixels: array {self.shape}, {self.dtype}>"

    def __array_wrap__(self, array: Any, context: Any = None, return_scalar: bool = False) -> Any:
        # results of arithmetic are plain arrays and numbers
        return array[()] if return_scalar else np.asarray(array)


def as_picture(image: Array) -> Picture:
    """The same pixels as a `Picture`."""
    return image.view(Picture)
