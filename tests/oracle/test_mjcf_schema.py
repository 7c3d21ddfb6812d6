"""Every element and attribute of MuJoCo's schema against the table: what is honoured equals MuJoCo, what is not is warned of."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from support import mjcf_documents as doc
from support.mjcf_compare import differences
from support.mjcf_physics import compiled, free_state, loaded, of_mujoco, same, schema
from support.mjcf_sample import Sample
from support.mjcf_table import table

TABLE = table()
TETRA = ["v 0 0 0", "v .3 0 .1", "v 0 .4 0", "v .1 .1 .5", "f 1 3 2", "f 1 2 4", "f 2 3 4", "f 3 1 4"]
EFFECTIVE = [s for s in TABLE if s.source is not None and s.verdict != "irrelevant"]
QUICK = [
    s for s in EFFECTIVE if s.path == "option/flag" or (s.path == "body/joint" and s.verdict == "warned")
]
# In one order, because pytest-xdist compares what its processes collect; the table is made from sets.
SWEEP = sorted((s for s in TABLE if s.source is not None and s not in QUICK), key=lambda s: (s.name, repr(s)))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the files that the samples name."""
    found = tmp_path_factory.mktemp("mjcf")
    (found / "parts").mkdir()
    (found / "tetra.obj").write_text("\n".join(TETRA))
    (found / "parts" / "small.obj").write_text("\n".join(TETRA).replace(".5", ".2"))
    (found / "other.xml").write_text(doc.OTHER)
    return found


def test_the_table_knows_the_whole_schema() -> None:
    known = {(sample.path, sample.attribute) for sample in TABLE}
    there = {(path, name) for path, names in schema().items() for name in names}
    assert sorted(there - known) == [], "attributes of MuJoCo without a verdict"
    assert sorted(known - there) == [], "verdicts about attributes that MuJoCo does not have"


def check(sample: Sample, folder: Path) -> None:
    assert sample.source is not None
    source = _placed(sample.source, folder)
    warnings = loaded(source)[1]
    assert len(warnings) <= 1
    said = "".join(warnings)
    if sample.verdict == "warned":
        assert sample.words in said
        if (
            sample.without is not None and "fluid" not in sample.attribute
        ):  # of fluids the warning names <option>
            assert sample.words not in "".join(loaded(_placed(sample.without, folder, "before.xml"))[1])
        return
    if sample.verdict == "honoured":
        assert not said
        assert differences(source) == []
    if sample.without is None:
        return
    m = compiled(source)
    before = compiled(_placed(sample.without, folder, "before.xml"))
    theirs = (of_mujoco(x, *free_state(x, np.random.default_rng(1))) for x in (before, m))
    assert same(*theirs) == (sample.verdict == "irrelevant"), "MuJoCo's results do not bear out the verdict"


def _placed(text: str, folder: Path, name: str = "model.xml") -> str | Path:
    """The text; or, if it names other files, a file of it beside them."""
    if "file=" not in text:
        return text
    path = folder / name
    path.write_text(text)
    return path


@pytest.mark.parametrize("sample", QUICK, ids=lambda s: s.name)
def test_flags_and_joints(sample: Sample, folder: Path) -> None:
    check(sample, folder)


@pytest.mark.slow
@pytest.mark.parametrize("sample", SWEEP, ids=lambda s: s.name)
def test_every_attribute(sample: Sample, folder: Path) -> None:
    check(sample, folder)
