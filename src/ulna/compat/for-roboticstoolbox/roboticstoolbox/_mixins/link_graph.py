"""The tree of a robot's links as a graph: text for Graphviz and Mermaid, and a picture."""

from __future__ import annotations

import re
import shutil
import subprocess
import tempfile
import webbrowser
from pathlib import Path
from typing import Any

from roboticstoolbox._mixins.robot_mixin import RobotMixin
from ulna.errors import InputError
from ulna.system.storage import replacing

_HEADS = {
    "R": '"dot", arrowtail="inv", dir="both"',
    "P": '"box", arrowtail="inv", dir="both"',
    "": '"normal"',
}
_END = 'shape="doublecircle", color="blue", fontcolor="blue"'


def _letter(link: Any) -> str:
    return "" if not link.isjoint else "R" if link.isrevolute else "P"


def _quoted(name: str) -> str:
    """A name as Graphviz takes it: in quotes unless it is an identifier."""
    return name if re.fullmatch(r"[A-Za-z_]\w*", name) else f'"{name}"'


class LinkGraph(RobotMixin):
    """Graphs of links."""

    def graph(self, format: str = "dot", filename: Any = None, **options: Any) -> str:
        """The tree of links as text, written to a path or a stream, too, if one is given.

        Args:
            format: "dot" for Graphviz, "mermaid", or "mermaid_fenced" to paste into Markdown.
            filename: A path or a stream to write to.
            **options: Those of `dotfile`, for "dot".

        Returns:
            The text.

        Raises:
            InputError: There is no such format.
        """
        kind = format.lower().replace("-", "_")
        if kind not in ("dot", "mermaid", "mermaid_fenced"):
            raise InputError(f"`format` is {format!r}; expected 'dot', 'mermaid' or 'mermaid_fenced'.")
        text = self._dot(**options) if kind == "dot" else self._mermaid()
        if kind == "mermaid_fenced":
            text = f"```mermaid\n{text}```\n"
        if filename is not None:
            _write(filename, text)
        return text

    def dotfile(self, filename: Any, **options: Any) -> None:
        """Writes the tree of links for Graphviz, to a path or a stream.

        Args:
            filename: The path or the stream.
            **options: `etsbox`, whether transforms are in separate boxes; `ets`, "full" or "brief"; `jtype`,
                whether arrows distinguish revolute from prismatic joints; `static`, whether fixed links are blue.
        """
        _write(filename, self._dot(**options))

    def showgraph(self, display_graph: bool = True, **options: Any) -> str | None:
        """Opens a picture of the tree of links in the browser, or returns its path: a PDF by Graphviz.

        Args:
            display_graph: Whether to open the picture.
            **options: Those of `dotfile`.

        Returns:
            Path of the picture; None where it was opened.

        Raises:
            InputError: Graphviz is not installed.
        """
        dot = shutil.which("dot")
        if dot is None:
            raise InputError(
                "showgraph draws with Graphviz, whose program `dot` is not on the path. Install Graphviz, or take "
                "print(robot.graph('mermaid'))."
            )
        with tempfile.NamedTemporaryFile(suffix=".pdf", delete=False) as picture:
            subprocess.run([dot, "-Tpdf"], input=self._dot(**options).encode(), stdout=picture, check=True)
        if not display_graph:
            return picture.name
        webbrowser.open(Path(picture.name).as_uri())
        return None

    def hierarchy(self) -> None:
        """Prints the tree of links."""

        def show(link: Any, depth: int) -> None:
            print("  " * depth, link.name)
            for child in link.children:
                show(child, depth + 1)

        show(self.base_link, 0)

    def _dot(self, etsbox: bool = False, ets: str = "full", jtype: bool = False, static: bool = True) -> str:
        if ets not in ("full", "brief"):
            raise InputError(f"`ets` is {ets!r}; expected 'full' or 'brief'.")
        ends = {id(link) for link in self.ee_links}
        arm_links = {id(link) for link in self._links}
        lines = ["digraph G {", "graph [rankdir=LR];", "  BASE [shape=square, style=filled, fillcolor=gray]"]
        for link in self.link_dict.values():
            name, before = _quoted(link.name), _quoted(link.parent_name or "BASE")
            style = _END if id(link) in ends else 'shape="circle"' if id(link) in arm_links else "shape=cds"
            blue = ', fontcolor="blue"' if static and not link.isjoint else ""
            arrow = f"arrowhead={_HEADS[_letter(link) if jtype else '']}"
            text = link.ets.__str__("q{0}")
            lines.append(f"  {name} [{style}];")
            if etsbox:
                box = _quoted(f"{link.name}_ets")
                lines.append(f'  {box} [shape=box, style=rounded, label="{text}"{blue}];')
                lines += [f"  {before} -> {box};", f"  {box} -> {name} [{arrow}];"]
                continue
            brief = f"...q{link.jindex}" if link.isjoint else ""
            label = text if ets == "full" else brief
            lines.append(f'  {before} -> {name} [label="{label}", {arrow}{blue}];')
        return "\n".join([*lines, "}"]) + "\n"

    def _mermaid(self) -> str:
        links = self.link_dict.values()
        number = {id(link): f"n{i}" for i, link in enumerate(links)}
        ends = {id(link) for link in self.ee_links}
        arm_links = {id(link) for link in self._links}
        lines = ["flowchart LR", '    BASE["BASE"]']
        for link in links:
            left, right = (
                ("((", "))") if id(link) in ends else ("[", "]") if id(link) in arm_links else ("{{", "}}")
            )
            lines.append(f'    {number[id(link)]}{left}"{link.name}"{right}')
        for link in links:
            label = f"|{_letter(link)}{link.jindex}|" if link.isjoint else ""
            lines.append(f"    {number.get(id(link.parent), 'BASE')} -->{label} {number[id(link)]}")
        return "\n".join(lines) + "\n"


def _write(where: Any, text: str) -> None:
    if hasattr(where, "write"):
        where.write(text)
    else:
        with replacing(where) as place:
            place.write_text(text, encoding="utf-8")
