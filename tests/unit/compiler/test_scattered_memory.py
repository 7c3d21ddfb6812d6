"""Code is loaded where large libraries, such as PyTorch, leave only small gaps in the address space, far apart."""

from __future__ import annotations

import platform
import subprocess
import sys

import pytest

SCRIPT = """
import ctypes, mmap
import numpy as np
from ulna.compiler import compile

def made(scale):
    # Its code takes several pages, and its constants one.
    def f(x):
        for k in range(12):
            x = np.sin(x + scale) * 0.3 + np.sqrt(1.7 + np.cos(k * x[::-1]))
        return x
    return compile(f, x=(3,))

kernels = [made(0.1)]
libc = ctypes.CDLL(None)
libc.mmap.restype = ctypes.c_void_p
libc.mmap.argtypes = [ctypes.c_void_p, ctypes.c_size_t] + 3 * [ctypes.c_int] + [ctypes.c_long]
libc.munmap.argtypes = [ctypes.c_void_p, ctypes.c_size_t]
PRIVATE, ANONYMOUS, NORESERVE, PAGE = 0x2, 0x20, 0x4000, mmap.PAGESIZE
def reserve(place, size):
    return libc.mmap(place, size, 0, PRIVATE | ANONYMOUS | NORESERVE, -1, 0)
reserve(None, 3 * 2**30)  # the lowest mapping from now on
with open("/proc/self/maps") as file:
    maps = [[int(x, 16) for x in line.split()[0].split("-")] for line in file if line.startswith("7f")]
for (_, end), (start, _) in zip(maps, maps[1:]):  # gaps between libraries become gaps of one page
    if start - end > 2 * PAGE:
        reserve(end + PAGE, start - end - PAGE)
for _ in range(20):  # below them blocks of 3 GB with gaps of one page
    start = reserve(None, 3 * 2**30)
    assert libc.munmap(start + 3 * 2**30 - PAGE, PAGE) == 0
for k in range(3):
    kernels.append(made(k + 2.0))
    assert np.isfinite(kernels[-1](np.ones(3))).all() and np.isfinite(kernels[-1](np.ones((9, 3)))).all()
print("loaded")
"""


@pytest.mark.skipif(
    sys.platform != "linux" or platform.machine() != "x86_64", reason="maps memory by Linux's numbers"
)
def test_code_and_constants_are_loaded_side_by_side() -> None:
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT], capture_output=True, text=True, timeout=600, check=False
    )
    assert done.stdout.strip() == "loaded", done.stderr[-500:]
