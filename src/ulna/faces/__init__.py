"""The former name of `ulna.compat`."""

from ulna.compat.packages import FOLDERS as SHELVES
from ulna.compat.packages import library_of as shelf_of
from ulna.compat.packages import modules
from ulna.compat.packages import use as wear

__all__ = ["SHELVES", "modules", "shelf_of", "wear"]
