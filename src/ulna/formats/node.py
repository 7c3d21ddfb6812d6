"""An element of a model file: its attributes as checked values, every complaint with file and line."""

from __future__ import annotations

import re
import warnings
from collections.abc import Collection, Iterator, Sequence
from typing import Any, NoReturn, final

from lxml import etree  # pyright: ignore[reportAttributeAccessIssue]

from ulna.errors import FormatError, ModelWarning, excerpt
from ulna.errors import nearest as nearest_names
from ulna.system.callers import level_of_caller

MAX_NUMBER = 1e50
"""Numbers above this magnitude are refused: their products would leave the range of a double."""

_NUMBER = re.compile(r"[+-]?(\d+(?:\.\d*)?|\.\d+)([eE][+-]?\d+)?", re.ASCII)


@final
class Node:
    """An element of a model file: its attributes as checked values, and the means to complain about it.

    Args:
        element: The element as lxml holds it.
        file: The file, for messages; None for text.
        namespace: The namespace of its children; empty for none.
    """

    __slots__ = ("_element", "_namespace", "file")

    def __init__(self, element: Any, file: str | None, namespace: str = "") -> None:
        self._element, self.file, self._namespace = element, file, namespace

    @property
    def tag(self) -> str:
        """The name of the element, without the namespace of the file."""
        return _local(self._element.tag, self._namespace)

    @property
    def line(self) -> int | None:
        """The line of the file on which the element starts."""
        return self._element.sourceline

    @property
    def text(self) -> str:
        """The text inside the element, stripped."""
        return (self._element.text or "").strip()

    @property
    def attributes(self) -> tuple[str, ...]:
        """The names of the attributes that are written down, without those of foreign namespaces."""
        return tuple([str(name) for name in self._element.attrib if "{" not in name and ":" not in name])

    @property
    def root(self) -> Node:
        """The root element of the file."""
        return Node(self._element.getroottree().getroot(), self.file, self._namespace)

    def has(self, attribute: str) -> bool:
        """Whether the attribute is written down."""
        return self._element.get(attribute) is not None

    def children(self, tag: str | None = None) -> Iterator[Node]:
        """The child elements (of that name), in file order; comments and foreign namespaces are left out."""
        if tag is not None and not self._namespace and not _is_foreign(tag):
            for element in self._element.iterchildren(tag):
                yield Node(element, self.file)
            return
        for element in self._element.iterchildren(tag=etree.Element):
            node = Node(element, self.file, self._namespace)
            # A tag with a separate namespace, declared or not, belongs to somebody else.
            if not _is_foreign(node.tag) and (tag is None or node.tag == tag):
                yield node

    def foreign(self) -> Iterator[tuple[str, int | None]]:
        """The tags, at any depth, with a namespace, and their lines."""
        for element in self._element.iterdescendants(tag=etree.Element):
            tag = _local(element.tag, self._namespace)
            if _is_foreign(tag):
                yield tag, element.sourceline

    def child(self, tag: str) -> Node | None:
        """The child element of that name, or None; of several the first, with a warning."""
        children = list(self.children(tag))
        if len(children) > 1:
            children[1].warn(f"a second <{tag}>; the first one, of line {children[0].line}, is used")
        return children[0] if children else None

    def required_child(self, tag: str, fix: str) -> Node:
        """The child element of that name.

        Args:
            tag: Its name.
            fix: How to correct the file, for the message.

        Returns:
            The element.

        Raises:
            FormatError: there is none.
        """
        node = self.child(tag)
        if node is None:
            self.fail(f"<{self.tag}> has no <{tag}>.", fix)
        return node

    def name(self, attribute: str = "name") -> str:
        """A required attribute that holds a name."""
        value = (self._element.get(attribute) or "").strip()
        if not value:
            attributes = ", ".join(str(a) for a in self._element.attrib) or "none"
            problem = f'has no attribute "{attribute}" (attributes: {attributes})'
            if self.has(attribute):
                problem = f'has an empty attribute "{attribute}"'
            self.fail(f"<{self.tag}> {problem}.", f'Write <{self.tag} {attribute}="...">.')
        return value

    def string(self, attribute: str, default: str | None = None) -> str | None:
        """An optional attribute, stripped; an empty one counts as absent.

        Args:
            attribute: Its name.
            default: What is returned where it is absent.

        Returns:
            The text, or the default.
        """
        return (self._element.get(attribute) or "").strip() or default

    def number(self, attribute: str, default: float | None = None, *, infinite: bool = False) -> float:
        """An attribute that is a number.

        Args:
            attribute: Its name.
            default: What is returned where it is absent [any]; None where it is required.
            infinite: Whether infinity is valid.

        Returns:
            The number [any].

        Raises:
            FormatError: it is required and absent, or is no such number.
        """
        value = self._element.get(attribute)
        if value is None:
            if default is None:
                self.fail(
                    f'<{self.tag}> has no attribute "{attribute}".', f'Write <{self.tag} {attribute}="...">.'
                )
            return default
        words = value.split()
        if len(words) != 1:
            self.fail(f'{attribute}="{short(value)}" is not one number.')
        return self._parse(attribute, words[0], infinite)

    def vector(self, attribute: str, count: int, default: Sequence[float] | None = None) -> tuple[float, ...]:
        """An attribute of several numbers separated by blanks.

        Args:
            attribute: Its name.
            count: How many numbers.
            default: What is returned where it is absent; None where it is required.

        Returns:
            The numbers.

        Raises:
            FormatError: it is required and absent, or does not hold so many finite numbers.
        """
        value = self._element.get(attribute)
        if value is None:
            if default is None:
                example = " ".join(["0"] * count)
                self.fail(
                    f'<{self.tag}> has no attribute "{attribute}".',
                    f'Write <{self.tag} {attribute}="{example}">.',
                )
            return tuple(default)
        words = value.split()
        if len(words) != count:
            comma = " Separate the numbers with blanks, not commas." if "," in value else ""
            self.fail(
                f'{attribute}="{short(value)}" holds {len(words)} value{"s" * (len(words) != 1)}; '
                f"expected {count} numbers.{comma}"
            )
        return tuple(self._parse(attribute, word) for word in words)

    def _parse(self, attribute: str, word: str, infinite: bool = False) -> float:
        lowered = word.lower().lstrip("+-")
        if lowered in ("inf", "infinity"):
            if infinite:
                return -float("inf") if word.startswith("-") else float("inf")
            self.fail(f'{attribute}="{word}" is infinite; expected a finite number.')
        if lowered == "nan" or "nan(" in lowered:
            self.fail(f'{attribute}="{short(word)}" is not a number (nan); expected a finite number.')
        if not _NUMBER.fullmatch(word):
            fix = "Write a decimal number such as 0.5 or 1e-3."
            if "{" in word or "$" in word:
                fix = "This is xacro that was not expanded; name the file *.xacro, or run xacro on it first."
            self.fail(f'{attribute}="{short(word)}" is not a number.', fix)
        value = float(word)
        if abs(value) > MAX_NUMBER and not infinite:
            self.fail(f'{attribute}="{short(word)}" is too large to compute with (above {MAX_NUMBER:g}).')
        return value

    def describe(self) -> str:
        """The element and the nearest named one around it, for messages."""
        parts = []
        element = self._element
        while element is not None:
            tag = _local(element.tag, self._namespace)
            name = element.get("name")
            if tag in ("link", "joint", "group", "group_state", "material") and name:
                parts.append(f"{tag} {short(name)!r}")
                break
            parts.append(f"<{tag}>")
            element = element.getparent()
            if element is None or element.getparent() is None:
                break
        return " of ".join(parts)

    def fail(self, message: str, fix: str = "") -> NoReturn:
        """Raise FormatError about this element.

        Args:
            message: What is wrong.
            fix: How to correct it.

        Raises:
            FormatError: always.
        """
        raise FormatError(message, file=self.file, line=self.line, element=self.describe(), fix=fix)

    def warn(self, message: str) -> None:
        """Warn about this element; the file stays usable."""
        place = f"{self.file or '<string>'}:{self.line}"
        warnings.warn(
            f"{place}: {message} (in {self.describe()}).", ModelWarning, stacklevel=level_of_caller()
        )

    def warn_of_unknown_children(self, known: Sequence[str]) -> None:
        """Warn about child elements that look like a misspelling of a known one."""
        for node in self.children():
            if node.tag not in known:
                suggestions = nearest_names(node.tag, known, 1, 0.75)
                if suggestions:
                    node.warn(f"<{node.tag}> is not known and is ignored; did you mean <{suggestions[0]}>?")

    def warn_of_unknown_attributes(self, known: Sequence[str]) -> None:
        """Warn about attributes other than the known ones, with the most similar of these that is not there."""
        for name in self.attributes:
            if name not in known:
                missing = [n for n in known if not self.has(n)]
                hint = nearest(name, missing, "; did you mean {}?")
                self.warn(f"the attribute {short(name)!r} is not known and is ignored{hint}")


def _local(tag: Any, namespace: str) -> str:
    text = str(tag)
    if namespace and text.startswith("{" + namespace + "}"):
        return text[len(namespace) + 2 :]
    return text


def _is_foreign(tag: str) -> bool:
    return tag.startswith("{") or ":" in tag


def nearest(name: str, choices: Collection[str], words: str) -> str:
    """A hint at the valid name most like an unknown one, for messages.

    Args:
        name: The unknown name.
        choices: The valid names.
        words: The hint, with {} for the name.

    Returns:
        The hint; empty where no name is similar.
    """
    suggestions = nearest_names(name, choices, 1)
    return words.format(repr(suggestions[0])) if suggestions else ""


def short(text: str, limit: int = 60) -> str:
    """A text on one line, shortened for messages.

    Args:
        text: The text.
        limit: The largest number of characters.

    Returns:
        The line.
    """
    return excerpt(" ".join(text.split()), limit)
