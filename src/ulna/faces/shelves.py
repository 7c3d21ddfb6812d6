"""The former name of `ulna.compat.packages`."""

from ulna.compat.packages import FOLDERS as SHELVES
from ulna.compat.packages import environment, modules
from ulna.compat.packages import library_of as shelf_of
from ulna.compat.packages import use as wear

__all__ = ["SHELVES", "environment", "modules", "shelf_of", "wear"]
