"""The pages of the site and what stands in them: code blocks, links, pictures."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"

_BLOCK = re.compile(r"^```python\n(.*?)^```$", re.DOTALL | re.MULTILINE)
_FENCE = re.compile(r"^(`{3,}).*?^\1\s*?$", re.DOTALL | re.MULTILINE)
_LINK = re.compile(r"(!?)\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^()\s]+)\)")


@dataclass(frozen=True)
class Block:
    """A block of Python that runs.

    Args:
        code: Its text.
        line: The line of the page on which the code begins.
        end: Where the closing fence ends in the text of the page.
    """

    code: str
    line: int
    end: int


@dataclass(frozen=True)
class Link:
    """A link or a picture.

    Args:
        text: What stands in brackets.
        target: A path, an address, or an anchor.
        is_picture: Whether it is shown in the page.
        start: Where it begins in the text of the page.
        end: Where it ends.
    """

    text: str
    target: str
    is_picture: bool
    start: int
    end: int

    @property
    def path(self) -> str:
        """The target without its anchor; empty for addresses and anchors of the same page."""
        return "" if "://" in self.target or self.target.startswith("mailto:") else self.target.split("#")[0]


def pages() -> list[Path]:
    """All pages, sorted."""
    return sorted(DOCS.rglob("*.md"))


def blocks(text: str) -> list[Block]:
    """The blocks of Python in a page, in order.

    Args:
        text: The text of the page.

    Returns:
        The blocks; those in folded solutions count, indented text does not.
    """
    return [
        Block(found[1], text.count("\n", 0, found.start(1)) + 1, found.end())
        for found in _BLOCK.finditer(text)
    ]


def links(text: str) -> list[Link]:
    """The links and pictures of a page that stand outside of code.

    Args:
        text: The text of the page.

    Returns:
        Links, in order.
    """
    code = [found.span() for found in _FENCE.finditer(text)]
    return [
        Link(found[2], found[3], found[1] == "!", *found.span())
        for found in _LINK.finditer(text)
        if not any(a <= found.start() < b for a, b in code) and not _is_inside_code(text, found.start())
    ]


def _is_inside_code(text: str, position: int) -> bool:
    """Whether a place is within back quotes, or in an indented block."""
    line = text[text.rfind("\n", 0, position) + 1 : position]
    return line.count("`") % 2 == 1 or line.startswith("    ")


def anchors(text: str) -> set[str]:
    """The anchors of a page: its headings in small letters, with hyphens, as forges and Sphinx make them.

    Args:
        text: The text of the page.

    Returns:
        The anchors.
    """
    titles = re.findall(r"^#+ +(.*)$", _FENCE.sub("", text), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}


def broken_links(page: Path) -> list[str]:
    """The links of a page that lead nowhere in the repository; addresses elsewhere are not looked up.

    Args:
        page: The page.

    Returns:
        Their targets.
    """
    text = page.read_text(encoding="utf-8")
    return [link.target for link in links(text) if not link.is_picture and not _leads_somewhere(page, link)]


def _leads_somewhere(page: Path, link: Link) -> bool:
    if "://" in link.target or link.target.startswith("mailto:"):
        return True
    end = page.parent / link.path if link.path else page
    anchor = link.target.partition("#")[2]
    return end.exists() and (
        not anchor or end.suffix != ".md" or anchor in anchors(end.read_text(encoding="utf-8"))
    )


def missing_pictures(page: Path, written: Iterable[str]) -> list[str]:
    """Pictures of a page that are neither files of the repository nor written by the page's code.

    Args:
        page: The page.
        written: Names of the files that its code wrote.

    Returns:
        Their paths.
    """
    made = set(written)
    return [
        link.path
        for link in links(page.read_text(encoding="utf-8"))
        if link.is_picture and link.path and link.path not in made and not (page.parent / link.path).exists()
    ]
