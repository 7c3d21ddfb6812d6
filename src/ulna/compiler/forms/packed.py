"""Forms of functions whose matrices are packed: matrices are computed whole, and their stored entries copied."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ulna.compiler.language.ports import Entries, Port, SecondForm
from ulna.data_classes import dataclass

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ulna.compiler.language.methods.packing import Pattern


@dataclass(frozen=True, eq=False)
class PackedForm:
    """A second form of a function with packed matrices.

    Attributes:
        whole: The form of the function with whole matrices.
        outputs: The outputs: a vector in place of each matrix.
        places: For each output the places of its entries in the whole matrix, row by row; None for one that stays.
    """

    whole: SecondForm
    outputs: tuple[Port, ...]
    places: tuple[tuple[int, ...] | None, ...]

    @property
    def inputs(self) -> tuple[Port, ...]:
        """The inputs of the function."""
        return self.whole.inputs

    @property
    def operations(self) -> int:
        """How many operations are written out."""
        return self.whole.operations

    @property
    def serves_batches(self) -> bool:
        """Whether samples of a batch are computed in this form, too."""
        return self.whole.serves_batches

    @property
    def entries(self) -> tuple[Entries | None, ...]:
        """What is known of matrices; there are none."""
        return (None,) * len(self.outputs)


def packed_form(form: SecondForm, patterns: Sequence[Pattern | None]) -> PackedForm:
    """A form with its matrices packed.

    Args:
        form: The form with whole matrices.
        patterns: Which entries of each output are stored; None for outputs that are no matrices.

    Returns:
        The form.
    """
    outputs, places = [], []
    for port, pattern in zip(form.outputs, patterns, strict=True):
        outputs.append(port if pattern is None else Port(port.name, (pattern.count,)))
        places.append(None if pattern is None else tuple(map(int, pattern.places)))
    return PackedForm(form, tuple(outputs), tuple(places))
