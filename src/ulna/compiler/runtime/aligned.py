"""Arrays that begin where a line of the processor's cache does.

NumPy's begin at any multiple of 16 bytes. A register of 64 bytes that is loaded from there mostly reaches over two
lines of the cache, which takes twice as long.
"""

from __future__ import annotations

from typing import Any

import numpy as np

LINE = 64
"""The size of a cache line [byte]."""


def aligned(values: Any) -> Any:
    """A copy of an array that begins at the beginning of a cache line.

    Args:
        values: The array.

    Returns:
        A C-contiguous array of the same numbers.

    Example:
        >>> import numpy as np
        >>> from ulna.compiler.procedures import aligned
        >>> aligned(np.zeros((3, 16), np.float32)).ctypes.data % 64
        0
    """
    values = np.asarray(values)
    memory = np.empty(values.nbytes + LINE, np.uint8)
    first = -memory.ctypes.data % LINE
    copy = memory[first : first + values.nbytes].view(values.dtype).reshape(values.shape)
    copy[...] = values
    return copy
