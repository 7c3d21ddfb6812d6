"""One attribute of MuJoCo's schema with a verdict and a document that shows it, and how such samples are written down."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Literal

from support.mjcf_physics import schema

Verdict = Literal["honoured", "warned", "irrelevant"]
Text = str | tuple[str, str] | tuple[None, str]
"""Attributes to add to those that are always there; or all of them, before and after; None: refused without."""


@dataclass(frozen=True)
class Sample:
    """One attribute with a verdict, and a document that shows it; `source` is None where no document could."""

    path: str
    attribute: str
    verdict: Verdict
    document: str = ""
    before: str | None = None
    after: str | None = None
    words: str = ""
    default: str = ""

    @property
    def name(self) -> str:
        return f"{self.path}@{self.attribute}" + (f" ({self.words})" if self.words else "")

    @property
    def source(self) -> str | None:
        """The document with the attribute."""
        return None if self.after is None else self._filled(self.after)

    @property
    def without(self) -> str | None:
        """The document without it; None where MuJoCo refuses that."""
        return None if self.before is None else self._filled(self.before)

    def _filled(self, text: str) -> str:
        if not self.default:
            return self.document.replace("@", text).replace("%", "").replace("!", "")
        known = schema()[f"default/{self.default}"]
        pairs = re.findall(r'([a-z_0-9]+)="([^"]*)"', text)
        general = " ".join(f'{k}="{v}"' for k, v in pairs if k in known)
        own = " ".join(f'{k}="{v}"' for k, v in pairs if k not in known)
        return self.document.replace("@", own).replace("%", f"<{self.default} {general}/>").replace("!", "")


def rows(
    path: str,
    document: str = "",
    base: str = "",
    *,
    honoured: Mapping[str, Text] | None = None,
    warned: Mapping[str, tuple[Text, str]] | None = None,
    irrelevant: Mapping[str, Text] | None = None,
    without_sample: str = "",
) -> Iterator[Sample]:
    """Samples of one element; `without_sample` lists attributes of no effect for which there is no document."""

    def sample(attribute: str, verdict: Verdict, text: Text, words: str = "") -> Sample:
        before, after = text if isinstance(text, tuple) else (base, f"{base} {text}")
        return Sample(path, attribute.split("#", maxsplit=1)[0], verdict, document, before, after, words)

    for attribute, text in (honoured or {}).items():
        yield sample(attribute, "honoured", text)
    for attribute, (text, words) in (warned or {}).items():
        yield sample(attribute, "warned", text, words)
    for attribute, text in (irrelevant or {}).items():
        yield sample(attribute, "irrelevant", text)
    for attribute in without_sample.split():
        yield Sample(path, attribute, "irrelevant")


TURNS = {
    "quat": 'quat="1 .2 .3 .4"',
    "axisangle": 'axisangle="1 2 3 40"',
    "euler": 'euler="10 20 30"',
    "xyaxes": 'xyaxes="1 2 0 -2 1 .1"',
    "zaxis": 'zaxis="1 2 3"',
}
SOFT_SOLVER = {"solref": 'solref=".1 1"', "solimp": 'solimp=".5 .6 .1 .5 2"'}


def attributes(text: str) -> dict[str, str]:
    return {name: f'{name}="{value}"' for name, value in re.findall(r'(\w+)="([^"]*)"', text)}


def with_defaults(samples: Iterable[Sample], tag: str) -> Iterator[Sample]:
    """The samples, and those of them that can be written as defaults."""
    for sample in samples:
        yield sample
        if sample.attribute in schema()[f"default/{tag}"]:
            yield replace(sample, path=f"default/{tag}", default=tag if sample.after is not None else "")
