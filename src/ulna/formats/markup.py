"""Reads XML files safely; hands out attributes as checked values, every complaint with file and line."""

from __future__ import annotations

import difflib
import os
import re
import warnings
from collections.abc import Collection, Iterator, Sequence
from pathlib import Path
from typing import Any, NoReturn, final

from lxml import etree  # pyright: ignore[reportAttributeAccessIssue]

from ulna.errors import FormatError, ModelWarning

MAX_BYTES = 64 * 1024 * 1024
"""Model files above this size [bytes] are refused; the largest known robots are below one megabyte."""

MAX_NUMBER = 1e50
"""Numbers above this magnitude are refused: their products would leave the range of a double."""

MAX_CHOICES = 2000
"""Among more names than this no look-alike is searched for: it would cost more than reading the file."""

_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)


@final
class Node:
    """An element of a model file: its attributes as checked values, and the means to complain about it."""

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

    def has(self, attribute: str) -> bool:
        """Whether the attribute is written down."""
        return self._element.get(attribute) is not None

    def children(self, tag: str | None = None) -> Iterator[Node]:
        """The child elements (of that name), in file order; comments and foreign namespaces are left out."""
        for element in self._element.iterchildren(tag=etree.Element):
            node = Node(element, self.file, self._namespace)
            # A tag with a namespace of its own, declared or not, belongs to somebody else.
            if not _is_foreign(node.tag) and (tag is None or node.tag == tag):
                yield node

    def foreign(self) -> Iterator[tuple[str, int | None]]:
        """The tags, at any depth, with a namespace of their own, and their lines."""
        for element in self._element.iterdescendants(tag=etree.Element):
            tag = _local(element.tag, self._namespace)
            if _is_foreign(tag):
                yield tag, element.sourceline

    def child(self, tag: str) -> Node | None:
        """The child element of that name, or None; of several the first, with a warning."""
        found = list(self.children(tag))
        if len(found) > 1:
            found[1].warn(f"a second <{tag}>; the first one, of line {found[0].line}, is used")
        return found[0] if found else None

    def required_child(self, tag: str, mend: str) -> Node:
        """The child element of that name; FormatError when there is none."""
        node = self.child(tag)
        if node is None:
            self.fail(f"<{self.tag}> has no <{tag}>.", mend)
        return node

    def name(self, attribute: str = "name") -> str:
        """A required attribute that holds a name."""
        value = (self._element.get(attribute) or "").strip()
        if not value:
            found = ", ".join(str(a) for a in self._element.attrib) or "none"
            self.fail(
                f'<{self.tag}> has no attribute "{attribute}" (attributes: {found}).',
                f'Write <{self.tag} {attribute}="...">.',
            )
        return value

    def string(self, attribute: str, default: str | None = None) -> str | None:
        """An optional attribute, stripped; an empty one counts as absent."""
        return (self._element.get(attribute) or "").strip() or default

    def number(self, attribute: str, default: float | None = None, *, infinite: bool = False) -> float:
        """A number; required without a default; infinity passes only where it has a meaning."""
        value = self._element.get(attribute)
        if value is None:
            if default is None:
                self.fail(
                    f'<{self.tag}> has no attribute "{attribute}".', f'Write <{self.tag} {attribute}="...">.'
                )
            return default
        words = value.split()
        if len(words) != 1:
            self.fail(f'{attribute}="{_short(value)}" is not one number.')
        return self._parse(attribute, words[0], infinite)

    def vector(self, attribute: str, count: int, default: Sequence[float] | None = None) -> tuple[float, ...]:
        """`count` numbers separated by blanks; without a default the attribute is required."""
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
                f'{attribute}="{_short(value)}" holds {len(words)} value{"s" * (len(words) != 1)}; '
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
            self.fail(f'{attribute}="{word}" is not a number (nan); expected a finite number.')
        if not _NUMBER.fullmatch(word):
            mend = "Write a decimal number such as 0.5 or 1e-3."
            if "{" in word or "$" in word:
                mend = "This is xacro that was not expanded; name the file *.xacro, or run xacro on it first."
            self.fail(f'{attribute}="{_short(word)}" is not a number.', mend)
        value = float(word)
        if abs(value) > MAX_NUMBER and not infinite:
            self.fail(f'{attribute}="{_short(word)}" is too large to compute with (above {MAX_NUMBER:g}).')
        return value

    def describe(self) -> str:
        """The element and the nearest named one around it, for messages."""
        parts = []
        element = self._element
        while element is not None:
            tag = _local(element.tag, self._namespace)
            name = element.get("name")
            if tag in ("link", "joint", "group", "group_state", "material") and name:
                parts.append(f"{tag} {_short(name)!r}")
                break
            parts.append(f"<{tag}>")
            element = element.getparent()
            if element is None or element.getparent() is None:
                break
        return " of ".join(parts)

    def fail(self, message: str, mend: str = "") -> NoReturn:
        """Raise FormatError about this element."""
        raise FormatError(message, file=self.file, line=self.line, element=self.describe(), mend=mend)

    def warn(self, message: str) -> None:
        """Warn about this element; the file stays usable."""
        place = f"{self.file or '<string>'}:{self.line}"
        warnings.warn(f"{place}: {message} (in {self.describe()}).", ModelWarning, stacklevel=2)

    def warn_of_strangers(self, known: Sequence[str]) -> None:
        """Warn about child elements that look like a misspelling of a known one."""
        for node in self.children():
            if node.tag not in known:
                near = difflib.get_close_matches(node.tag, known, n=1, cutoff=0.8)
                if near:
                    node.warn(f"<{node.tag}> is not known and is ignored; did you mean <{near[0]}>?")


def read_file(path: str | os.PathLike[str]) -> bytes:
    """The content of a model file; FormatError when it is missing, too large, or not to be read."""
    where = Path(path)
    try:
        size = where.stat().st_size
        if where.is_dir():
            raise FormatError("this is a folder, not a file.", file=str(where))
        if size > MAX_BYTES:
            raise _too_large(size, str(where))
        with open(where, "rb") as stream:
            data = stream.read(MAX_BYTES + 1)
    except (FileNotFoundError, NotADirectoryError):
        raise FormatError("there is no such file.", file=str(where), mend=_neighbours(where)) from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise FormatError(f"the file cannot be read: {reason}.", file=str(where)) from None
    if len(data) > MAX_BYTES:
        raise _too_large(len(data), str(where))
    return data


def parse_markup(data: bytes | str, file: str | None, root_tag: str, kind: str) -> Node:
    """Parse an XML document and check that it is what it should be.

    Entities, external references and the network are off; a document that declares any is refused.

    Args:
        data: the document. Bytes carry their own encoding (XML declaration or byte order mark).
        file: its name, for messages.
        root_tag: the expected name of the root element.
        kind: what the document should be ("URDF"), for messages.

    Returns:
        The root element.

    Raises:
        FormatError: the document is empty, broken, too large, dangerous, or of another kind.
    """
    encoding = None
    if isinstance(data, str):
        data, encoding = data.encode("utf-8", errors="surrogatepass"), "utf-8"
    if len(data) > MAX_BYTES:
        raise _too_large(len(data), file)
    if not data.strip():
        raise FormatError(
            "the file is empty.", file=file, mend=f"Expected a {kind}: <{root_tag}> ... </{root_tag}>."
        )
    root = _parse_tree(data, file, encoding)
    _refuse_entities(root, file)
    tag = str(root.tag)
    namespace = tag[1:].partition("}")[0] if tag.startswith("{") else ""
    if "xacro" in namespace:
        namespace = ""
    node = Node(root, file, namespace)
    if node.tag != root_tag:
        raise FormatError(
            f"the root element is <{node.tag}>; expected <{root_tag}>.",
            file=file,
            line=node.line,
            mend=_other_kind(node.tag, kind),
        )
    return node


def _parse_tree(data: bytes, file: str | None, encoding: str | None) -> Any:
    parser = _parser(encoding)
    try:
        return etree.fromstring(data, parser)
    except etree.XMLSyntaxError as error:
        failure: Exception = error
    except (etree.LxmlError, ValueError, LookupError) as error:
        failure = error
    faults = [entry for entry in parser.error_log if "NS_ERR" not in entry.type_name]
    if isinstance(failure, etree.XMLSyntaxError) and not faults:
        # Simulator add-ons such as <controller:gazebo_ros_imu> are often left without their xmlns; other
        # readers let them pass. Nothing but that kind of fault is passed over here.
        root = etree.fromstring(data, _parser(encoding, recover=True))
        if root is not None:
            return root
    message = faults[0].message if faults else str(getattr(failure, "msg", None) or failure)
    line = faults[0].line if faults else getattr(failure, "lineno", None)
    raise FormatError(
        f"this is not well-formed XML: {_short(message, 200).rstrip('.')}.",
        file=file,
        line=line or None,
        mend=_mend_of_syntax(message),
    ) from None


def _mend_of_syntax(message: str) -> str:
    if "amplification" in message or "entity" in message.lower():
        return "Write the values out instead of using XML entities."
    if "depth" in message or "limit" in message:
        return "Elements may nest 256 deep and a text may have 10 MB; a robot needs neither."
    if "ncoding" in message:
        return "Save the file as UTF-8."
    if "invalid char" in message.lower() or "start tag" in message.lower():
        return "Is this a text file that begins with <robot ...>?"
    return (
        "Look at that line and the ones above it for an unclosed tag, a missing quote or a stray character."
    )


def _parser(encoding: str | None, recover: bool = False) -> Any:
    return etree.XMLParser(
        resolve_entities=False,
        no_network=True,
        load_dtd=False,
        dtd_validation=False,
        huge_tree=False,
        remove_pis=True,
        encoding=encoding,
        recover=recover,
    )


def _refuse_entities(root: Any, file: str | None) -> None:
    info = root.getroottree().docinfo
    entities = [e.name for e in info.internalDTD.iterentities()] if info.internalDTD is not None else []
    if entities or info.system_url or info.public_id:
        what = f"entities ({', '.join(entities[:3])})" if entities else f"an external DTD ({info.system_url})"
        raise FormatError(
            f"the document type declares {_short(what, 120)}, which Ulna does not follow.",
            file=file,
            line=1,
            mend="Remove the <!DOCTYPE ...> and write the values out, or use xacro properties.",
        )


def _other_kind(tag: str, kind: str) -> str:
    known = {
        "mujoco": "This is a MuJoCo model (MJCF), which Ulna does not read; convert it to URDF.",
        "sdf": "This is an SDF model, which Ulna does not read; convert it to URDF.",
        "COLLADA": "This is a mesh, not a robot.",
        "html": "This is a web page; the download went wrong.",
    }
    return known.get(tag, f"This is no {kind}.")


def _too_large(size: int, file: str | None) -> FormatError:
    return FormatError(
        f"the file has {size / 1e6:.0f} MB; expected at most {MAX_BYTES / 1e6:.0f} MB.",
        file=file,
        mend="Meshes belong in files of their own.",
    )


def _neighbours(where: Path) -> str:
    folder = where.parent
    if not os.path.isdir(folder):
        return f"There is no folder {str(folder)!r} either; the working directory is {os.getcwd()!r}."
    try:
        names = sorted(os.listdir(folder))
    except OSError:
        return ""
    near = difflib.get_close_matches(where.name, names, n=2, cutoff=0.6)
    return "Did you mean " + " or ".join(repr(str(folder / n)) for n in near) + "?" if near else ""


def _local(tag: Any, namespace: str) -> str:
    text = str(tag)
    if namespace and text.startswith("{" + namespace + "}"):
        return text[len(namespace) + 2 :]
    return text


def _is_foreign(tag: str) -> bool:
    return tag.startswith("{") or ":" in tag


def nearest(name: str, choices: Collection[str], words: str) -> str:
    """`words` with the choice most like `name` for {}; "" where none is, or there are too many to look."""
    if len(choices) > MAX_CHOICES:
        return ""
    near = difflib.get_close_matches(name, choices, n=1, cutoff=0.5)
    return words.format(repr(near[0])) if near else ""


def _short(text: str, limit: int = 60) -> str:
    text = " ".join(text.split())
    return text if len(text) <= limit else text[: limit - 3] + "..."
