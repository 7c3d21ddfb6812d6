"""What code is generated for: the processor, and what follows from it for the layout of the code."""

from __future__ import annotations

from dataclasses import dataclass

from ulna.compiler.codegen.ir_text import BYTES, DType


@dataclass(frozen=True)
class Target:
    """A processor that code is generated for.

    Attributes:
        triple: Architecture, vendor and system, as LLVM names them.
        cpu: The processor, as LLVM names it.
        features: Its extensions, as LLVM lists them: "+avx2,-avx512f".
        llvm: The version of LLVM.
        register_bytes: Width of the widest SIMD register [byte].
        fused_multiply_add: Whether a product and a sum may become one instruction that rounds once.
        packed_sines: In code for one sample, how many angles share one vector of sines and cosines.
    """

    triple: str
    cpu: str
    features: str
    llvm: str
    register_bytes: int
    fused_multiply_add: bool = True
    packed_sines: int = 8

    def lanes(self, element: DType) -> int:
        """How many values of a type the widest register holds, at least two."""
        return max(self.register_bytes // BYTES[element], 2)


def register_bytes(features: str) -> int:
    """Width of the widest SIMD register of a processor with these extensions [byte]."""
    enabled = {name[1:] for name in features.split(",") if name.startswith("+")}
    return 64 if "avx512f" in enabled else 32 if "avx2" in enabled else 16
