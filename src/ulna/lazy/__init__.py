"""Functions of arrays on Dask arrays, block by block when asked for, and on labelled arrays of xarray."""

from ulna.lazy.apply import apply, is_dask, is_deferred
from ulna.lazy.collection import Collection
from ulna.lazy.portable import Portable, check_versions, versions
from ulna.lazy.slot import Slot

__all__ = ["Collection", "Portable", "Slot", "apply", "check_versions", "is_dask", "is_deferred", "versions"]
