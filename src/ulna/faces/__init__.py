"""Faces: drop-in packages over Ulna that carry the names of others, so that scripts written for those run unmodified.

A face is a folder on a shelf beside this file. Nothing is replaced until a shelf goes on the path: `ulna run script.py`
does so for one process and its children, `wear("pinocchio")` for a notebook.
"""

from ulna.faces.shelves import SHELVES as SHELVES
from ulna.faces.shelves import modules as modules
from ulna.faces.shelves import shelf_of as shelf_of
from ulna.faces.shelves import wear as wear
