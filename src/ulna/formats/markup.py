"""Reads XML files safely: no entities, no network, limits on size and depth, and a fix for each refusal."""

from __future__ import annotations

import os
import warnings
from pathlib import Path
from typing import Any, NoReturn

from lxml import etree  # pyright: ignore[reportAttributeAccessIssue]

from ulna.errors import FormatError, ModelWarning, nearest
from ulna.files import read_regular
from ulna.formats.comments import line_of_double_hyphen, without_comments
from ulna.formats.node import Node, short
from ulna.formats.prolog import prolog_of, with_plain_declaration
from ulna.system.callers import level_of_caller

MAX_BYTES = 64 * 1024 * 1024
"""Model files above this size [bytes] are refused; the largest known robots are below one megabyte."""


def read_file(path: str | os.PathLike[str]) -> bytes:
    """The content of a model file; FormatError when it is missing, too large, or not to be read."""
    where = Path(path)
    try:
        size = where.stat().st_size
        if where.is_dir():
            raise FormatError("this is a folder, not a file.", file=str(where))
        if size > MAX_BYTES:
            raise _too_large(str(where))
        data = read_regular(where, MAX_BYTES + 1)
    except FormatError:  # which is a ValueError, too
        raise
    except (FileNotFoundError, NotADirectoryError):
        raise FormatError("there is no such file.", file=str(where), fix=_neighbours(where)) from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise FormatError(f"the file cannot be read: {reason}.", file=str(where)) from None
    if len(data) > MAX_BYTES:
        raise _too_large(str(where))
    return data


def root_tag(data: bytes | str) -> str:
    """The name of a document's root element, without parsing the rest; "" when there is none."""
    return prolog_of(data.encode("utf-8", errors="replace") if isinstance(data, str) else data).root


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
        raise _too_large(file)
    if not data.strip():
        raise FormatError(
            "the file is empty.", file=file, fix=f"Expected a {kind}: <{root_tag}> ... </{root_tag}>."
        )
    data, oddity = with_plain_declaration(data)
    if oddity:
        words = f"{file or '<string>'}:1: {oddity}; it is read as XML 1.0."
        warnings.warn(words, ModelWarning, stacklevel=level_of_caller())
    root = _parse_tree(data, file, encoding)
    _reject_entities(root, file)
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
            fix=_other_kind(node.tag, kind),
        )
    return node


def _parse_tree(data: bytes, file: str | None, encoding: str | None) -> Any:
    if line := line_of_double_hyphen(data):
        raise FormatError(
            "this is not well-formed XML: a comment contains two hyphens (--).",
            file=file,
            line=line,
            fix="Between <!-- and --> write other signs, such as == or __.",
        )
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
        f"this is not well-formed XML: {short(message, 200).rstrip('.')}.",
        file=file,
        line=line or None,
        fix=_fix_of_syntax(message),
    ) from None


def _fix_of_syntax(message: str) -> str:
    if "amplification" in message or "entity" in message.lower():
        return "Write the values out instead of using XML entities."
    if message.startswith(("Excessive depth", "Resource limit")) or "XML_PARSE_HUGE" in message:
        return "Elements may nest 256 deep and a text may have 10 MB; a robot needs neither."
    if "ncoding" in message:
        return "Save the file as UTF-8."
    if "invalid char" in message.lower() or "start tag" in message.lower():
        return "Is this a text file that begins with <robot ...>?"
    return (
        "Look at that line and the ones above it for an unclosed tag, a missing quote or a stray character."
    )


def parse_tree(data: bytes, file: str | None) -> Any:
    """The root element of a document with its comments, as lxml has it, to be changed and written again.

    Args:
        data: The document.
        file: Its name, for messages.

    Returns:
        The root element.

    Raises:
        FormatError: The document is broken or declares entities.
    """
    root = _parse_tree(with_plain_declaration(data)[0], file, None)
    _reject_entities(root, file)
    return root


def lenient_tree(data: bytes) -> Any:
    """The root element of what can be read of a document, however broken it is; None where nothing can."""
    try:
        return etree.fromstring(without_comments(data), _parser("utf-8", recover=True))
    except (etree.LxmlError, ValueError):
        return None


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


def _reject_entities(root: Any, file: str | None) -> None:
    info = root.getroottree().docinfo
    entities = [e.name for e in info.internalDTD.iterentities()] if info.internalDTD is not None else []
    if entities or info.system_url or info.public_id:
        what = f"entities ({', '.join(entities[:3])})" if entities else f"an external DTD ({info.system_url})"
        reject_document_type(what, file)


def reject_document_type(what: str, file: str | None) -> NoReturn:
    """Raise FormatError about what the document type of a file declares.

    Args:
        what: The declaration.
        file: The file, for the message; None for text.

    Raises:
        FormatError: always.
    """
    raise FormatError(
        f"the document type declares {short(what, 120)}, which Ulna does not follow.",
        file=file,
        line=1,
        fix="Remove the <!DOCTYPE ...> and write the values out, or use xacro properties.",
    )


def _other_kind(tag: str, kind: str) -> str:
    known = {
        "mujoco": "This is a MuJoCo model (MJCF): ulna.load reads it from a file, or as text.",
        "sdf": "This is an SDF model, which Ulna does not read; convert it to URDF.",
        "COLLADA": "This is a mesh, not a robot.",
        "html": "This is a web page; the download went wrong.",
    }
    return known.get(tag, f"This is no {kind}.")


def _too_large(file: str | None) -> FormatError:
    return FormatError(
        f"the file is too large; expected at most {MAX_BYTES / 1e6:.0f} MB.",
        file=file,
        fix="Meshes belong in separate files.",
    )


def _neighbours(where: Path) -> str:
    folder = where.parent
    if not os.path.isdir(folder):
        return f"There is no folder {str(folder)!r} either; the working directory is {os.getcwd()!r}."
    try:
        names = sorted(os.listdir(folder))
    except OSError:
        return ""
    suggestions = nearest(where.name, names, 2, 0.6)
    return (
        "Did you mean " + " or ".join(repr(str(folder / n)) for n in suggestions) + "?" if suggestions else ""
    )
