"""A worker process of Dask that compiles for an older processor: one of x86-64 with SSE2 alone, without fused products."""

from __future__ import annotations

from typing import Any


def dask_setup(worker: Any) -> None:
    """Called by Dask in the worker before it compiles anything.

    Args:
        worker: The worker.
    """
    from ulna.compiler.runtime.jit import llvm_library

    library = llvm_library()
    present = library.get_host_cpu_features()
    kept = {
        name: bool(on) and name in ("sse", "sse2", "cx8", "fxsr", "cmov", "64bit")
        for name, on in present.items()
    }
    present.update(kept)
    library.get_host_cpu_name = lambda: "x86-64"
    library.get_host_cpu_features = lambda: present
