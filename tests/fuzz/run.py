"""Gives damaged documents to a reader; every one is read and computed with, or refused with an error of Ulna.

    cd tests && python -m fuzz.run urdf --count 100000 --seed 7 --keep /somewhere

The document under test lies in the folder `--keep`, so that one which crashes or never ends can be looked at. Prints
how many were read and how many refused; exits with 1 at the first that does neither.
"""

from __future__ import annotations

import argparse
import collections
import faulthandler
import random
import sys
import tempfile
import time
import traceback
import warnings
from pathlib import Path


def main() -> int:
    """Run one reader; see the head of the file."""
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("reader")
    arguments.add_argument("--count", type=int, default=200)
    arguments.add_argument("--seed", type=int, default=0)
    arguments.add_argument("--first", type=int, default=0, help="number of the first document")
    arguments.add_argument("--keep", default="")
    chosen = arguments.parse_args()
    faulthandler.enable()
    warnings.simplefilter("ignore")
    _limit_memory()
    from fuzz.readers import reader
    from ulna.errors import UlnaError

    tested = reader(chosen.reader)
    folder = Path(chosen.keep or tempfile.mkdtemp())
    path = folder / f"mutant{tested.ending}"
    outcomes: collections.Counter[str] = collections.Counter()
    slowest = (0.0, 0)
    for k in range(chosen.first, chosen.first + chosen.count):
        path.write_bytes(tested.mutant(random.Random(f"{chosen.reader} {chosen.seed} {k}")))
        print(f"document {k}", file=sys.stderr, flush=True)
        start = time.perf_counter()
        try:
            tested.use(path)
            outcomes["read"] += 1
        except UlnaError as error:
            outcomes["refused"] += 1
            if len(str(error)) > 4200:
                print(f"document {k}: a message of {len(str(error))} characters", path)
                return 1
        except BaseException:
            print(f"document {k} of seed {chosen.seed}, {path}:\n{path.read_bytes()[:3000]!r}")
            print(traceback.format_exc())
            return 1
        slowest = max(slowest, (time.perf_counter() - start, k))
    print(dict(outcomes), f"slowest: document {slowest[1]}, {slowest[0]:.2f} s")
    return 0


def _limit_memory() -> None:
    """So that a document which asks for too much memory is found, and the machine stays usable."""
    try:
        import resource
    except ImportError:
        return
    resource.setrlimit(resource.RLIMIT_AS, (8 * 2**30, resource.getrlimit(resource.RLIMIT_AS)[1]))


if __name__ == "__main__":
    sys.exit(main())
