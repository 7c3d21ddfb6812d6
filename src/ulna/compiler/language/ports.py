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


def prefixed(prefix: str, ports: Sequence[Port], beside: Sequence[Port] = ()) -> tuple[Port, ...]:
    """The ports with `prefix` before their names, repeated where a port of `beside` has that name.

    Args:
        prefix: Text before each name.
        ports: The ports to rename.
        beside: Ports whose names are taken.

    Returns:
        The renamed ports, of the same shapes.
    """
    taken, renamed = {p.name for p in beside}, []
    for port in ports:
        name = prefix + port.name
        while name in taken:
            name = prefix + name
        taken.add(name)
        renamed.append(Port(name, port.shape))
    return tuple(renamed)
