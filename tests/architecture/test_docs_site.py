"""The tools that build the documentation site: blocks, links, outputs, notebooks, and what is wrong with a built site."""

from __future__ import annotations

import importlib
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ulna

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "scripts"))
from docs_site import built, docstrings, execution, names, pages, reference, staging  # noqa: E402

PAGE = """# A page

See [there](other.md#a-part) and [the rest](https://example.org).

```python
x = 2
print(x)
```

    y = 1/0    # indented: does not run

:::{dropdown} Solution
```python
from pathlib import Path
Path("a.png").write_bytes(b"picture")
print(x + 1)
```
:::

![A picture](a.png)
"""


@pytest.fixture
def page(tmp_path: Path) -> Path:
    """A page beside another one."""
    (tmp_path / "docs").mkdir()
    (tmp_path / "docs" / "other.md").write_text("# Other\n\n## A part\n")
    path = tmp_path / "docs" / "page.md"
    path.write_text(PAGE)
    return path


def test_blocks_run_in_order_and_their_outputs_are_kept(page: Path, tmp_path: Path) -> None:
    outputs = execution.run(page, tmp_path / "made")
    assert [o.text for o in outputs] == ["2\n", "3\n"]
    assert [o.files for o in outputs] == [(), ("a.png",)]
    assert pages.missing_pictures(page, ["a.png"]) == []
    assert pages.missing_pictures(page, []) == ["a.png"]


def test_a_block_that_fails_is_named_by_its_line(page: Path, tmp_path: Path) -> None:
    page.write_text(PAGE.replace("print(x)", "print(unknown)"))
    with pytest.raises(execution.PageError, match=r"page.md: the block at line 6.*unknown"):
        execution.run(page, tmp_path / "made")


@pytest.mark.parametrize(
    ("was", "becomes"), [("other.md#a-part", "other.md#none"), ("other.md#a-part", "no.md")]
)
def test_links_and_anchors_that_lead_nowhere_are_found(page: Path, was: str, becomes: str) -> None:
    assert pages.broken_links(page) == []
    page.write_text(PAGE.replace(was, becomes))
    assert pages.broken_links(page) == [becomes]


def test_links_within_code_are_no_links() -> None:
    assert pages.links("`[a](b.md)`\n\n    [c](d.md)\n\n```text\n[e](f.md)\n```\n") == []


def test_a_page_becomes_a_notebook_with_its_outputs(page: Path, tmp_path: Path) -> None:
    pytest.importorskip("nbformat")
    from docs_site import notebooks

    made = tmp_path / "made"
    book = json.loads(notebooks.notebook(PAGE, execution.run(page, made), made))
    code = [cell for cell in book["cells"] if cell["cell_type"] == "code"]
    assert [cell["source"][0].strip() for cell in code] == ["x = 2", "from pathlib import Path"]
    folded = [cell["metadata"].get("jupyter", {}).get("source_hidden", False) for cell in code]
    assert folded == [False, True]
    kinds = [[output["output_type"] for output in cell["outputs"]] for cell in code]
    assert kinds == [["stream"], ["stream", "display_data"]]
    words = "".join("".join(cell["source"]) for cell in book["cells"] if cell["cell_type"] == "markdown")
    assert "**Solution**" in words and ":::" not in words and "other.md" not in words


def test_the_built_site_is_examined(tmp_path: Path) -> None:
    (tmp_path / "b.html").write_text('<p id="here">b</p>')
    (tmp_path / "a.html").write_text(
        '<a href="b.html#here">1</a><a href="b.html#gone">2</a><a href="c.html">3</a>'
        '<a href="https://example.org">4</a><script src="https://example.org/x.js"></script><img src="no.png">'
    )
    assert sorted(built.problems(tmp_path)) == [
        "a.html: b.html#gone leads nowhere",
        "a.html: c.html leads nowhere",
        "a.html: loads https://example.org/x.js from elsewhere; the site must work offline",
        "a.html: no.png leads nowhere",
    ]


def test_pictures_of_pages_that_did_not_run_may_be_missing(tmp_path: Path) -> None:
    (tmp_path / "a.html").write_text('<img src="_made/b/c.png"><a href="d.html">d</a>')
    assert len(built.problems(tmp_path)) == 2
    assert built.problems(tmp_path, missing_pictures=True) == ["a.html: d.html leads nowhere"]


def test_outputs_of_unchanged_pages_are_kept(
    page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(staging, "ROOT", tmp_path)
    made = tmp_path / "made"
    assert staging._kept(page, made) is None
    outputs = staging._outputs(page, made)
    assert staging._kept(page, made) == outputs
    page.write_text(PAGE.replace("x = 2", "x = 3"))
    assert staging._kept(page, made) is None


def test_signatures_name_arrays() -> None:
    inspect = pytest.importorskip("sphinx.util.typing")
    like = inspect.stringify_annotation(np.typing.ArrayLike, "smart")
    found = docstrings.name_arrays(None, "", "", None, None, f"(q: {like} | None = None, n: int = 1)", None)
    assert found == ("(q: ArrayLike | None = None, n: int = 1)", None)
    text = inspect.stringify_annotation(dict[str, np.typing.NDArray[np.float64]], "smart")
    assert docstrings.name_arrays(None, "", "", None, None, "()", text) == ("()", "dict[str, Floats]")
    text = inspect.stringify_annotation(np.typing.NDArray[Any], "smart")
    assert docstrings.name_arrays(None, "", "", None, None, None, text) == (None, "Array")
    text = "(options: ~typing.Any = <factory>)"  # of a dataclass; no Python otherwise
    assert docstrings.name_arrays(None, "", "", None, None, text, None)[0] == text.replace("<factory>", "...")


@pytest.mark.parametrize(
    ("code", "target"),
    [
        ("ulna.load", "ulna.load"),
        ("robot.fk(q)", "ulna.Robot.fk"),
        ("robot.centroidal.momentum", "ulna.quantities.centroidal.Centroidal.momentum"),
        ("robot.limits.lower", None),
        ("q[0] < 1", None),
        ("robot.fk(q) < 1", None),
    ],
)
def test_names_in_docstrings_are_links(code: str, target: str | None) -> None:
    assert names.target(code) == target
    expected = f"See ``{code}``." if target is None else f"See :py:obj:`{code} <{target}>`."
    assert docstrings.inline(f"See `{code}`.") == expected


def test_names_of_earlier_versions_are_not_listed() -> None:
    old = {"put": ulna.sim.Body.put, "patience": ulna.Simulation.patience}
    listed = {
        "step": ulna.sim.Body.step,
        "q": ulna.sim.Body.q,
        "sin": ulna.numeric.sin,
        "Body": ulna.sim.Body,
    }
    for names_and_values, expected in ((old, True), (listed, None)):
        for name, value in names_and_values.items():
            assert docstrings.skip_former_names(None, "class", name, value, False, None) is expected


def test_examples_in_docstrings_stay_as_they_are_and_fields_of_tuples_say_nothing() -> None:
    lines = ["Doubles *each*.", "", "Example:", "    >>> sizes = [2] * 3 + list_", "    [2, 2, 2]", ""]
    docstrings.process(None, "function", "f", None, None, lines)
    assert lines == [
        r"Doubles \*each\*.",
        "",
        "Example:",
        "    >>> sizes = [2] * 3 + list_",
        "    [2, 2, 2]",
        "",
    ]
    field = ["Alias for field number 3", ""]
    docstrings.process(None, "attribute", "C.field", None, None, field)
    docstrings.keep_attributes(None, "attribute", "C.field", None, None, field)
    assert not any(field)


def test_tables_are_not_wrapped() -> None:
    assert ":class: output drawn\n" in staging._printed("│ a │")
    assert ":class: output columns\n" in staging._printed("joint    before    after\n" * 3)
    assert ":class: output\n" in staging._printed("a")
    assert ":class: output\n" in staging._printed("one    word in a sentence\n" * 3)


def test_the_reference_has_every_public_package() -> None:
    packages = {f"ulna.{name}" for name in ulna._PACKAGES}
    assert packages - reference.INTERNAL <= set(reference.MODULES)


@pytest.mark.parametrize("module", reference.MODULES)
def test_every_public_name_has_a_line_in_the_reference(module: str) -> None:
    home = importlib.import_module(module)
    for name in reference.public_names(module):
        line = reference._summary(module, name, getattr(home, name))
        assert line and line != "See the guides.", f"{module}.{name} has no docstring"


@pytest.mark.slow
def test_the_picture_of_readme_is_what_its_script_draws() -> None:
    pytest.importorskip("PIL")
    script = ROOT / "scripts" / "readme_picture.py"
    done = subprocess.run(
        [sys.executable, str(script), "--check"], capture_output=True, text=True, timeout=600, check=False
    )
    assert done.returncode == 0, done.stderr
