"""Builds the documentation site: runs the pages, adds outputs, pictures and notebooks, calls Sphinx, checks links.

Run: python scripts/build_docs.py [--only PAGE ...] [--keep] [--open]

`--only tutorials/legs.md` runs the code of these pages alone; others are as in the last build, or without outputs.
`--keep` uses the outputs of the last build for pages that did not change. The site is in out/docs/html.
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
import sys
import time
import webbrowser
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

from docs_site import built, reference, staging
from docs_site.pages import DOCS, ROOT, pages

import ulna

OUT = ROOT / "out" / "docs"


def main() -> None:
    """Build the site; the exit status is 1 where a page fails, Sphinx warns or a link leads nowhere."""
    parser = argparse.ArgumentParser(description="Builds the documentation site into out/docs/html.")
    parser.add_argument("--only", nargs="+", metavar="PAGE", help="pages whose code runs, below docs/")
    parser.add_argument("--keep", action="store_true", help="keep the outputs of pages that did not change")
    parser.add_argument("--open", action="store_true", help="open the site in the browser")
    options = parser.parse_args()
    began = time.monotonic()
    source, html = OUT / "source", OUT / "html"
    ulna.compat.use("roboticstoolbox")  # a page has a script of the toolbox, which need not be installed
    only = None if options.only is None else {DOCS / name for name in options.only}
    problems = staging.stage(pages(), source, only=only, keep=options.keep)
    reference.write(source / "reference" / "api")
    print(f"pages: {time.monotonic() - began:.0f} s", flush=True)
    shutil.rmtree(html, ignore_errors=True)
    strict = [] if only else ["--fail-on-warning", "--keep-going"]
    command = [sys.executable, "-m", "sphinx", "--quiet", *strict, "-b", "html", "-d", str(OUT / "doctrees")]
    code = subprocess.run([*command, str(source), str(html)], check=False).returncode
    if code == 0:
        problems += built.problems(html, missing_pictures=only is not None)
    print(*problems, sep="\n", file=sys.stderr)
    print(f"{html / 'index.html'}: {time.monotonic() - began:.0f} s, {len(problems)} problems")
    if options.open:
        webbrowser.open((html / "index.html").as_uri())
    sys.exit(1 if code or problems else 0)


if __name__ == "__main__":
    main()
