"""Compatibility packages: scripts written for the Robotics Toolbox or Pinocchio run unmodified on Ulna.

A compatibility package has the name of the library it stands in for, and lies in a folder that is on no path. Nothing
is replaced until that folder is put on the path: `ulna run script.py` does so for one process and its children,
`ulna.compat.use("pinocchio")` for a notebook.
"""

from ulna.compat.packages import FOLDERS as FOLDERS
from ulna.compat.packages import environment as environment
from ulna.compat.packages import library_of as library_of
from ulna.compat.packages import modules as modules
from ulna.compat.packages import use as use
