"""The handle once more, for `from swift.Handle import ...`."""

from swift._handles import AssemblyHandle

__all__ = ["AssemblyHandle"]
