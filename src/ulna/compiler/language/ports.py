"""The named, shaped inputs and outputs of a function."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product
from math import prod

from ulna.data_classes import dataclass

Shape = tuple[int, ...]


@dataclass(frozen=True)
class Port:
    """An input or output: its name and the shape of one sample."""

    name: str
    shape: Shape

    @property
    def size(self) -> int:
        """How many numbers one sample holds."""
        return prod(self.shape)


def element_names(ports: Sequence[Port]) -> Iterator[str]:
    """Names of all numbers of the ports, in order: `q[0]`, `T[1,3]`, `x`."""
    for port in ports:
        for index in product(*(range(n) for n in port.shape)):
            yield port.name + (f"[{','.join(map(str, index))}]" if index else "")
