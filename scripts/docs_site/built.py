"""What is wrong with the built site: links and anchors that lead nowhere, and anything loaded from elsewhere."""

from __future__ import annotations

from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urldefrag, urlsplit

LOADED = {"script": "src", "link": "href", "img": "src", "video": "src", "iframe": "src", "source": "src"}


class _Page(HTMLParser):
    """The links, anchors and loaded files of a page."""

    def __init__(self) -> None:
        super().__init__()
        self.links: list[str] = []
        self.loaded: list[str] = []
        self.anchors: set[str] = set()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Notes what a tag refers to, and its own name."""
        values = {name: value for name, value in attrs if value}
        self.anchors |= {values[name] for name in ("id", "name") if name in values}
        if tag == "a" and "href" in values:
            self.links.append(values["href"])
        if tag in LOADED and LOADED[tag] in values:
            self.loaded.append(values[LOADED[tag]])


@cache
def _read(path: Path) -> _Page:
    page = _Page()
    page.feed(path.read_text(encoding="utf-8"))
    return page


def problems(site: Path, missing_pictures: bool = False) -> list[str]:
    """Look at every page of the site.

    Args:
        site: The folder of the site.
        missing_pictures: Whether pictures and notebooks may be missing, since not all pages ran.

    Returns:
        A line for each link that leads nowhere and each file that is loaded from another host.
    """
    found = []
    for path in sorted(site.rglob("*.html")):
        if "_made" in path.parts or "_static" in path.parts:
            continue  # pages that the viewer wrote
        page = _read(path)
        for target in page.loaded:
            if urlsplit(target).netloc:
                found.append(
                    f"{path.relative_to(site)}: loads {target} from elsewhere; the site must work offline"
                )
        for target in {*page.links, *page.loaded}:
            may_miss = missing_pictures and ("notebooks/" in target or "_made/" in target)
            if not _leads_somewhere(path, target) and not may_miss:
                found.append(f"{path.relative_to(site)}: {target} leads nowhere")
    return found


def _leads_somewhere(path: Path, target: str) -> bool:
    """Whether a link of a page has an end in the site; addresses elsewhere are not looked up."""
    parts = urlsplit(target)
    if parts.scheme or parts.netloc:
        return True
    address, anchor = urldefrag(target)
    address = unquote(urlsplit(address).path)
    end = (path.parent / address).resolve() if address else path
    if not end.is_file():
        return False
    return not anchor or end.suffix != ".html" or unquote(anchor) in _read(end).anchors
