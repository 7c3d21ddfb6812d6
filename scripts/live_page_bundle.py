"""Makes the program of the live page: the files in src/ulna/viewer/live/js with three.js, in one minified script.

    python scripts/live_page_bundle.py            # writes src/ulna/viewer/live/bundle
    python scripts/live_page_bundle.py --check    # compares it with what npm's packages and the files make

It needs npm, which installs the packages of `VERSIONS` into a temporary folder.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path

VERSIONS = {"three": "0.187.0", "esbuild": "0.28.2"}
HERE = Path(__file__).resolve().parent.parent / "src" / "ulna" / "viewer" / "live"
SOURCES, BUNDLE = HERE / "js", HERE / "bundle"
NAMES = ("ulna-live.min.js", "three-LICENSE.txt")
OPTIONS = (
    "--bundle", "--minify", "--format=iife", "--target=es2022", "--charset=utf8", "--legal-comments=none",
    "--loader:.css=text", "--log-level=warning",
)  # fmt: skip


def main() -> int:
    """Runs the command."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--check", action="store_true", help="write nothing; exit with 1 where something differs"
    )
    chosen = parser.parse_args()
    made = bundle()
    if not chosen.check:
        BUNDLE.mkdir(exist_ok=True)
        for name, content in made.items():
            (BUNDLE / name).write_text(content, encoding="utf-8")
        print(f"{BUNDLE}: {len(made[NAMES[0]]) / 1000:.0f} kB")
        return 0
    wrong = [name for name in NAMES if _stored(name) != made[name]]
    for name in wrong:
        print(f"{BUNDLE / name} differs; run python scripts/live_page_bundle.py", file=sys.stderr)
    return int(bool(wrong))


def bundle() -> dict[str, str]:
    """The files of the bundle, by name."""
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        (work / "package.json").write_text(json.dumps({"private": True, "dependencies": VERSIONS}))
        _run(["npm", "install", "--no-audit", "--no-fund", "--silent"], work)
        for source in SOURCES.iterdir():
            if source.suffix in (".js", ".css"):
                (work / source.name).write_text(_shortened(source), encoding="utf-8")
        command = ["npx", "--no-install", "esbuild", "main.js", *OPTIONS, "--outfile=out.js"]
        _run(command, work)
        licence = (work / "node_modules" / "three" / "LICENSE").read_text(encoding="utf-8")
        program = (work / "out.js").read_text(encoding="utf-8").strip()
    three = f"three.js {VERSIONS['three']}, MIT licence, Copyright three.js authors."
    head = f"/* Ulna's live page, MIT licence. With {three}"
    return {NAMES[0]: f"{head} Sources: {fingerprint()} */\n{program}\n", NAMES[1]: licence}


def fingerprint() -> str:
    """A hash of what the bundle is made from."""
    out = hashlib.sha256(json.dumps([VERSIONS, OPTIONS]).encode())
    for source in sorted(SOURCES.iterdir()):
        if source.suffix in (".js", ".css"):
            out.update(source.name.encode() + b"\0" + source.read_bytes() + b"\0")
    return out.hexdigest()[:16]


def _shortened(source: Path) -> str:
    """A file without what the minifier leaves: blanks in style sheets that are texts."""
    content = source.read_text(encoding="utf-8")
    return re.sub(r"\s*\n\s*", " ", content) if source.suffix == ".css" else content


def _stored(name: str) -> str | None:
    path = BUNDLE / name
    return path.read_text(encoding="utf-8") if path.is_file() else None


def _run(command: list[str], folder: Path) -> None:
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=300, check=False)
    if done.returncode:
        raise SystemExit(f"{' '.join(command[:3])} failed:\n{done.stdout}{done.stderr}")


if __name__ == "__main__":
    sys.exit(main())
