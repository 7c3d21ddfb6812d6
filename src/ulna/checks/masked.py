"""The check that no entry of an array is masked."""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.errors import InputError


def check_not_masked(name: str, value: Any) -> None:
    """Refuse a masked array, or a list with one, that masks any entry: its numbers would be used as if they counted.

    Args:
        name: What the user calls it.
        value: Whatever was given.

    Raises:
        InputError: Entries of it are masked.
    """
    for part in value if isinstance(value, (list, tuple)) else (value,):
        if (
            isinstance(part, np.ndarray)
            and type(part) is not np.ndarray
            and isinstance(part, np.ma.MaskedArray)
        ):
            count = int(np.ma.count_masked(part))
            if count:
                raise InputError(
                    f"`{name}` is a masked array with {count} masked {'entry' if count == 1 else 'entries'}; expected "
                    "numbers only. Fill them with `.filled(number)`, or select the rows without any: "
                    "x[~np.ma.getmaskarray(x).any(axis=-1)].data."
                )
