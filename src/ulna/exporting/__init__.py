"""Compiled functions for other programs: as C, and for other processors.

Read in this order:

| module | content |
|---|---|
| `record.py` | what is exported, as the targets receive it: functions, searches, their documentation |
| `targets.py` | the table of targets; a new one is one entry and one module with a function `write` |
| `selection.py` | names of quantities, and compiled functions, as records |
| `folder.py` | a folder that is whole or absent |
| `sensitivity.py` | how much results may differ from recorded ones |
| `export.py` | the function `ulna.export` |
| `c`, `objects`, `wasm` | targets |
"""

from ulna.exporting.export import export as export
from ulna.exporting.record import Argument as Argument
from ulna.exporting.record import Export as Export
from ulna.exporting.record import ExportedFunction as ExportedFunction
from ulna.exporting.record import ExportedSearch as ExportedSearch
from ulna.exporting.record import ExportTarget as ExportTarget
from ulna.exporting.record import Option as Option
from ulna.exporting.targets import TARGETS as TARGETS

__all__ = [
    "TARGETS",
    "Argument",
    "Export",
    "ExportTarget",
    "ExportedFunction",
    "ExportedSearch",
    "Option",
    "export",
]
