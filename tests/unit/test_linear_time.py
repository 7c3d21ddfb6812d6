"""Reading takes time in proportion to its input, whatever the input is: every search for a pattern in `src` is tried.

The cases run in a process of their own, which is ended when it takes more than a minute of a processor: a search whose time grows
with the square of the length would take hours for them.
"""

from __future__ import annotations

import subprocess
import sys

LIMIT = """
try:
    import resource
    resource.setrlimit(resource.RLIMIT_CPU, (60, resource.getrlimit(resource.RLIMIT_CPU)[1]))
except ImportError:  # Windows
    pass
"""
CASES = r"""
import contextlib, os, sys, tempfile, warnings
warnings.simplefilter("ignore")
from ulna.errors import UlnaError, UnknownName
N = 200_000

def case(name, call, *texts):
    print(name, flush=True)
    for text in texts:
        with contextlib.suppress(UlnaError):
            call(text)

from ulna.formats.markup import parse_markup, root_tag
hostile = ["<x>" + "<!--" * N, "<!--" * N, "<!" * N, "<?xml" * N, "<?xml ?>" * N, "<" * N, "<!-->" * N, "<!DOCTYPE" * N,
           "<![CDATA[" * N, "-->" * N, "<?xml " + " version" * N, "<?xml version=" + " " * N, "<a" * N]
case("root_tag", root_tag, *hostile)
case("parse_markup", lambda t: parse_markup(t, None, "robot", "URDF"), *hostile)

from ulna.formats.node import Node
from lxml import etree
def numbers(text):
    Node(etree.fromstring("<a/>"), None)._parse("a", text)
case("number", numbers, "1" * N + "x", "1" * N, "1." + "1" * N + "x", "." * N, "+" * N, "1e" + "1" * N + "x", "nan(" * N)

from ulna.formats.ets import ETS
steps = ["1" * N + "x", "1" * N + "deg!", " " * N, "1" + " " * N + "x", "pi/" + "1" * N + "x", "1" + " *" * N, "q" * N,
         "q" + "1" * N, "-" * N, "deg" * N, " " * N + "deg", "1." * N, "pi" * N, "- " + " " * N + "pi"]
case("ETS", ETS.parse, *(f"Rz({s})" for s in steps), *steps, "* " * N, "Rz" + " " * N, "ab " * N, "(" * N, "Rz(q) " * 2000)

from ulna.formats.resolve import Resolver
folder = tempfile.mkdtemp()
uris = ["package:" + "/" * N, "package://" + "a" * N, "package://a" + "/" * N, "file:" + "/" * N, "http" * N, "/" * N, "C:" * N,
        "a/" * N, "%41" * N, "../" * N, "\\" * N, "model:/" * N]
case("Resolver", Resolver(os.path.join(folder, "a.urdf")).resolve, *uris)

from ulna.formats.mjcf_parse import _refusal
case("refusal", lambda t: _refusal(ValueError(t), None), "line 1" * N, "line " + "1" * N, "id 1" * N, "id " + "1, " * N,
     ", " * N, "Element name ''" * N)
from ulna.formats.xacro import _refusal as refused
case("xacro refusal", lambda t: refused(ValueError(t), "f"), "line 1" * N, "line " + "1" * N)

from ulna.geometry.meshes import _metres
case("units", _metres, " " * N, "1" * N, "1" * N + "*", "1 *" + " " * N, " " * N + "1", "1e * meters")

from ulna.viewer.mesh.mesh_cache import cache_key
def stored(text):
    path = os.path.join(folder, "mesh.obj")
    with open(path, "w") as file:
        file.write(text)
    cache_key(path)
with open(os.path.join(folder, "t.png"), "w") as file:
    file.write("x" * 1_000_000)
case("mesh_store", stored, ".png" * 20_000, ".bin " * 20_000, "\n".join("./" * k + "t.png" for k in range(100)), "'" * N)

from ulna.robots.catalogue import find
case("catalogue", find, " -" * N, "-" * N, "a" * N, ":" * N)
from ulna.cli import main
case("errors", lambda t: UnknownName("joint", t, ["a" * N, *(f"j{i}" for i in range(N))]), "a" * N, "j")
case("same", lambda t: UnknownName("joint", t, ["ab" * N, "b" * N]), "a" * N, "ba" * N)

from ulna.model import Continuous, ModelBuilder
def chain(order):
    builder = ModelBuilder("chain").add_link("l0")
    for i in range(2000):
        leader = {"down": i - 1, "up": i + 1}[order]
        mimic = (f"j{leader}", 1.0, 0.0) if 0 <= leader < 2000 else None
        builder.add_link(f"l{i + 1}")
        builder.add_joint(f"j{i}", Continuous((0, 0, 1)), f"l{i}", f"l{i + 1}", mimic=mimic)
    builder.build()
case("mimic chain", chain, "up", "down")
print("done", flush=True)
"""


def test_no_input_makes_a_reader_slow() -> None:
    done = subprocess.run(
        [sys.executable, "-c", LIMIT + CASES], capture_output=True, text=True, timeout=1800, check=False
    )
    assert done.returncode == 0, (
        f"ended with {done.returncode} after {done.stdout[-200:]!r}: {done.stderr[-2000:]}"
    )
    assert done.stdout.endswith("done\n")
