"""Arrays in NPZ files that users give to jobs."""

from __future__ import annotations

import os
import zipfile
from collections.abc import Sequence

import numpy as np

from ulna.errors import InputError
from ulna.typing import Array


def read(path: str | os.PathLike[str], names: Sequence[str]) -> dict[str, Array]:
    """Arrays of a file.

    Args:
        path: The file, as `numpy.savez` writes it.
        names: Which arrays must be there; others are left out.

    Returns:
        Arrays (...) by name.

    Raises:
        InputError: If it is no such file, lacks an array, or holds objects.
        OSError: If it cannot be read.
    """
    try:
        with np.load(path, allow_pickle=False) as file:
            if isinstance(file, np.ndarray):
                raise ValueError("it holds one array without a name")
            missing = [name for name in names if name not in file.files]
            if missing:
                raise InputError(f"{os.fspath(path)!r} has no {', '.join(missing)}; it holds {file.files}.")
            return {name: file[name] for name in names}
    except InputError:
        raise
    except (ValueError, TypeError, EOFError, AttributeError, zipfile.BadZipFile) as error:
        raise InputError(
            f"{os.fspath(path)!r} is no NPZ file with the arrays {', '.join(names)}: {error}. numpy.savez writes one."
        ) from error
