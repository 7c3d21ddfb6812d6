"""`python -m ulna`: the same as the command `ulna`."""

from __future__ import annotations

import sys

from ulna.cli import main

if __name__ == "__main__":
    sys.exit(main())
