"""The names of other libraries, and what to write instead of each, as text."""

from __future__ import annotations

from ulna.idioms import IDIOMS
from ulna.idioms.module_names import KEYWORDS as MODULE_KEYWORDS
from ulna.idioms.scene_names import KEYWORDS as SCENE_KEYWORDS


def test_names_of_other_libraries(golden):
    rows = [
        f"{subject} | {idiom.library} | {name} | {idiom.use} | {idiom.why}"
        for subject, names in IDIOMS.items()
        for name, idiom in names.items()
    ]
    for table in (MODULE_KEYWORDS, SCENE_KEYWORDS):
        rows += [f"keyword | {name} | {use}" for name, use in table.items()]
    golden("names.txt", "\n".join(rows) + "\n")
