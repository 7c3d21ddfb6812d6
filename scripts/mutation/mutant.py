"""A mutant: one small change of one source file."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Mutant:
    """One change: the text between two places of a file (bytes of UTF-8) becomes another.

    `place` is its line's text, column and number among the equal lines of its file, so that results stay valid when
    other lines change. `function_lines` are the lines of the innermost function around it, none at module or class
    level or in a signature; there, `signature_of` are the lines of that signature's function.
    """

    path: str
    line: int
    last_line: int
    place: str
    start: int
    end: int
    kind: str
    before: str
    after: str
    function_lines: tuple[int, int] | None
    signature_of: tuple[int, int] | None

    @property
    def name(self) -> str:
        """Where it is now and what it changes."""
        return f"{self.path}:{self.line} {self.change}"

    @property
    def key(self) -> str:
        """What identifies the mutant in the results."""
        return f"{self.path} | {self.place} | {self.change}"

    @property
    def change(self) -> str:
        """What it changes, wherever its line may move to."""
        return f"{self.kind}: {_short(self.before)} -> {_short(self.after)}"

    def applied(self, source: bytes) -> bytes:
        """The mutated source."""
        return source[: self.start] + self.after.encode() + source[self.end :]


def _short(text: str) -> str:
    line = " ".join(text.split())
    return line if len(line) <= 90 else line[:87] + "..."
