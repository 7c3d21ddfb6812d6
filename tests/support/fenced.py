"""Arrays that end or begin at a page without access: a read or write too far ends the process."""

from __future__ import annotations

import ctypes
import mmap
from typing import Any

import numpy as np

_PROTECTED = 0  # PROT_NONE


def fenced(count: int, dtype: Any, at_end: bool) -> np.ndarray:
    """An array of `count` numbers whose last (or first) byte lies beside a page without access."""
    page = mmap.PAGESIZE
    size = count * np.dtype(dtype).itemsize
    pages = max((size + page - 1) // page, 1)
    block = mmap.mmap(-1, (pages + 2) * page)
    whole = np.frombuffer(block, np.uint8)
    libc = ctypes.CDLL(None, use_errno=True)
    for k in (0, pages + 1):
        address = ctypes.c_void_p(whole.ctypes.data + k * page)
        assert libc.mprotect(address, ctypes.c_size_t(page), ctypes.c_int(_PROTECTED)) == 0
    start = page + pages * page - size if at_end else page
    return whole[start : start + size].view(dtype)
