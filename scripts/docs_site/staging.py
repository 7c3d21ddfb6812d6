"""The pages as Sphinx reads them: with the outputs, pictures, films and notebooks that their code made.

A page may show any file that its code writes: `![A Panda](arm.png)`. Pictures become pictures, `.mp4` a film, `.html`
a frame with the page in it: a click on the picture of the same name, where there is one, starts it.
"""

from __future__ import annotations

import hashlib
import html
import json
import re
import shutil
from collections.abc import Sequence
from pathlib import Path

from docs_site import execution
from docs_site.pages import DOCS, ROOT, Link, anchors, blocks, links

PICTURES = (".png", ".gif", ".svg", ".jpg", ".webp")
GALLERY = ("robots", "kinematics", "motion", "dynamics")
GUIDES = Path("guides.md")
NOTEBOOKS = ("tutorials", "start")


def stage(
    pages: Sequence[Path], folder: Path, only: set[Path] | None = None, keep: bool = False
) -> list[str]:
    """Run the pages and write the folder that Sphinx reads.

    Args:
        pages: The pages.
        folder: The folder of the staged pages; what is there is removed.
        only: Pages whose code runs, also where they did not change; all when not given. Other pages have the outputs of
            the last build, where they did not change since.
        keep: Whether outputs of unchanged pages are taken from the last build.

    Returns:
        What went wrong: blocks that failed, pictures that no block made.
    """
    results = folder.parent / "results"
    if only is None and not keep:
        shutil.rmtree(results, ignore_errors=True)
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(DOCS / "_static", folder / "_static")
    shutil.copy(DOCS / "conf.py", folder / "conf.py")
    (folder / "_extra").mkdir()
    problems: list[str] = []
    for page in [*pages, ROOT / "CONTRIBUTING.md", ROOT / "CHANGELOG.md"]:
        name = page.relative_to(DOCS) if page.is_relative_to(DOCS) else Path(page.name.lower())
        made = results / name.with_suffix("")
        try:
            runs = only is None or page in only
            if only is not None and runs:
                shutil.rmtree(made, ignore_errors=True)
            outputs = _outputs(page, made) if runs else _kept(page, made) or []
        except execution.PageError as error:
            problems.append(str(error))
            continue
        staged = _Staged(page, name, made, folder)
        text = staged.page(outputs)
        problems += staged.problems if runs else []
        target = folder / name
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(text, encoding="utf-8")
    return problems


def _outputs(page: Path, made: Path) -> list[execution.Output]:
    """Runs a page, or takes what was kept of it."""
    if (kept := _kept(page, made)) is not None:
        return kept
    shutil.rmtree(made, ignore_errors=True)
    if not blocks(page.read_text(encoding="utf-8")):
        return []
    outputs, seconds = execution.run_timed(page, made)
    print(f"{seconds:6.1f} s  {page.relative_to(ROOT)}", flush=True)
    content = {"key": _key(page), "outputs": [(o.text, o.files) for o in outputs]}
    (made / ".outputs.json").write_text(json.dumps(content))
    return outputs


def _kept(page: Path, made: Path) -> list[execution.Output] | None:
    """What the page did in the last build; None where it did not run then or was changed since."""
    record = made / ".outputs.json"
    if not record.exists() or (kept := json.loads(record.read_text()))["key"] != _key(page):
        return None
    return [execution.Output(text, tuple(files)) for text, files in kept["outputs"]]


def _key(page: Path) -> str:
    return hashlib.sha256(page.read_bytes()).hexdigest()


class _Staged:
    """One page on its way.

    Args:
        page: The page.
        name: Its place in the site.
        made: The folder of the files that its code wrote.
        folder: The folder that Sphinx reads.
    """

    def __init__(self, page: Path, name: Path, made: Path, folder: Path) -> None:
        self.source, self.name, self.made, self.folder = page, name, made, folder
        self.problems: list[str] = []

    def page(self, outputs: Sequence[execution.Output]) -> str:
        """The text with outputs and links as Sphinx needs them.

        Args:
            outputs: What the blocks of the page did; empty where they did not run.

        Returns:
            The staged text.
        """
        text = self.source.read_text(encoding="utf-8")
        if self.name == GUIDES:
            text = _with_new_pages(text)
        text = text.replace("<!-- gallery -->", _gallery())
        if self.name.parts[0] in NOTEBOOKS and blocks(text):
            self._write_notebook(text, outputs)
        changes = [(link.start, link.end, self._link(link)) for link in links(text)]
        changes += [
            (block.end, block.end, _printed(output.text))
            for block, output in zip(blocks(text), outputs, strict=False)
            if output.text.strip()
        ]
        for start, end, new in sorted(changes, reverse=True):
            text = text[:start] + new + text[end:]
        return self._with_notebook_link(text)

    def _write_notebook(self, text: str, outputs: Sequence[execution.Output]) -> None:
        target = self.folder / "_extra" / "notebooks" / f"{self.name.stem}.ipynb"
        target.parent.mkdir(parents=True, exist_ok=True)
        from docs_site import notebooks

        target.write_text(notebooks.notebook(text, outputs, self.made), encoding="utf-8")

    def _with_notebook_link(self, text: str) -> str:
        if not (self.folder / "_extra" / "notebooks" / f"{self.name.stem}.ipynb").exists():
            return text
        head, _, body = text.partition("\n")
        address = f"{'../' * (len(self.name.parts) - 1)}notebooks/{self.name.stem}.ipynb"
        return f'{head}\n\n<p class="notebook"><a href="{address}" download>This page as a notebook</a></p>\n{body}'

    def _link(self, link: Link) -> str:
        """A link as Sphinx needs it."""
        path, anchor = link.path, link.target.partition("#")[2]
        if not path:
            return self.source_text(link)
        if (self.made / path).is_file() or (link.is_picture and not (self.source.parent / path).exists()):
            return self._made(link, path)
        target = (self.source.parent / path).resolve()
        if target.is_relative_to(DOCS) and self.source.is_relative_to(DOCS):
            return self.source_text(link)
        if target.is_relative_to(DOCS):  # of CONTRIBUTING, which stands beside the home page
            return f"[{link.text}]({target.relative_to(DOCS)}{'#' + anchor if anchor else ''})"
        if target in (ROOT / "CONTRIBUTING.md", ROOT / "CHANGELOG.md"):
            return f"[{link.text}]({self._up()}{target.name.lower()}{'#' + anchor if anchor else ''})"
        if target.is_dir() or not target.exists():
            return link.text
        if target.suffix == ".md" and not link.is_picture:
            home = target == ROOT / "README.md"
            return f"[{link.text}]({self._up()}index.md)" if home else link.text
        copy = self.folder / "_files" / target.relative_to(ROOT)
        copy.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(target, copy)
        mark = "!" if link.is_picture else ""
        return f"{mark}[{link.text}]({self._up()}_files/{target.relative_to(ROOT)})"

    def source_text(self, link: Link) -> str:
        """The link as it stands in the page."""
        return f"{'!' if link.is_picture else ''}[{link.text}]({link.target})"

    def _up(self) -> str:
        return "../" * (len(self.name.parts) - 1)

    def _made(self, link: Link, path: str) -> str:
        """What shows a file that the page's code wrote."""
        if not (self.made / path).is_file():
            self.problems.append(f"{self.source}: no block of the page writes {path}")
            return f"*{link.text}*"
        place = Path("_made") / self.name.with_suffix("") / path
        suffix = Path(path).suffix
        is_source = link.is_picture and suffix in PICTURES
        target = (self.folder if is_source else self.folder / "_extra") / place
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(self.made / path, target)
        address = f"{self._up()}{place.as_posix()}"
        if is_source:
            return f"![{link.text}]({address})"
        quoted = html.escape(link.text)
        if link.is_picture and suffix == ".mp4":
            options = 'controls loop muted playsinline preload="metadata"'
            return f'<video {options} title="{quoted}" src="{address}"></video>'
        if link.is_picture and suffix == ".html":
            return self._frame(path, address, quoted)
        return f'<a href="{address}" download>{quoted}</a>'

    def _frame(self, path: str, address: str, title: str) -> str:
        """A page in the page: a picture of the same name, where the code made one, until it is clicked."""
        poster = Path(path).with_suffix(".png")
        if not (self.made / poster).is_file():
            return f'<iframe loading="lazy" class="live" title="{title}" src="{address}"></iframe>'
        place = Path("_made") / self.name.with_suffix("") / poster
        target = self.folder / "_extra" / place
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(self.made / poster, target)
        image = f'<img src="{self._up()}{place.as_posix()}" alt="{title}">'
        return f'<a class="live" href="{address}" title="{title}">{image}<span>Move it</span></a>'


def _printed(text: str) -> str:
    """What a block printed, as a block of text below it; tables, drawn with lines or in columns, are not wrapped."""
    columns = re.findall(r"^.*\S {3,}\S.* {3,}\S.*$", text, re.MULTILINE)
    kind = "output drawn" if "│" in text else "output columns" if len(columns) >= 3 else "output"
    return f"\n\n````{{code-block}} text\n:class: {kind}\n\n{text.rstrip()}\n````\n"


def _with_new_pages(guides: str) -> str:
    """The list of guides with the pages directly in docs/ that no list names yet."""
    texts = [page.read_text(encoding="utf-8") for page in DOCS.rglob("*.md")]
    lists = "\n".join(
        found for text in texts for found in re.findall(r"```{toctree}\n(.*?)```", text, re.DOTALL)
    )
    named = {Path(line.strip()).name for line in lists.splitlines()}
    new = sorted(page.stem for page in DOCS.glob("*.md") if page.stem not in named and page.stem != "index")
    end = guides.rindex("```")
    return guides[:end] + "".join(f"{name}\n" for name in new) + guides[end:]


def _gallery() -> str:
    """Cards for the pictures of the gallery's pages: each leads to its section."""
    text = "::::{grid} 2 2 3 3\n:gutter: 2\n\n"
    for page in GALLERY:
        sections = re.split(
            r"^## ", (DOCS / "gallery" / f"{page}.md").read_text(encoding="utf-8"), flags=re.MULTILINE
        )
        for section in sections[1:]:
            title = section.splitlines()[0]
            picture = next(link for link in links(section) if link.is_picture)
            address = f"{page}.html#{anchors('# ' + title).pop()}"
            text += f":::{{grid-item-card}} {title}\n:img-top: ../_made/gallery/{page}/{picture.path}\n"
            text += f":img-alt: {picture.text}\n:link: {address}\n:::\n\n"
    return text + "::::\n"
