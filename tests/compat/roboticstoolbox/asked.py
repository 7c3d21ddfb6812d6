"""Asks probes of whatever `roboticstoolbox` this Python finds: `python asked.py FILE PROBE ...` writes the answers."""

from __future__ import annotations

import importlib
import pickle
import sys
import warnings
from typing import Any

if __name__ == "__main__":
    warnings.simplefilter("ignore")
    import roboticstoolbox
    import spatialmath

    answers: dict[str, Any] = {}
    for name in sys.argv[2:]:
        for part, ask in importlib.import_module(name).PARTS.items():
            answers[part] = ask(roboticstoolbox, spatialmath)
    with open(sys.argv[1], "wb") as file:
        pickle.dump((roboticstoolbox.__file__, answers), file)
