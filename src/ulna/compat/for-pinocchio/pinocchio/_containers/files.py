"""Files of models, data and geometries: saveToText, saveToXML, saveToBinary, saveToString, and loading them.

The formats are those of this package: JSON as text, within an element as XML, compressed as binary. Only registered
classes are made from a file, so that no file can run code, as a pickle can.
"""

from __future__ import annotations

import dataclasses
import enum
import json
import os
import zlib
from functools import cache
from html import escape, unescape
from typing import Any

import numpy as np

from pinocchio._containers.arguments import ArgumentError
from pinocchio._containers.arrays import StdVec
from pinocchio._containers.keywords import by_name
from ulna.errors import FormatError, InputError, excerpt
from ulna.files import read_regular
from ulna.system.storage import replacing

_SIGN = b"ulna pinocchio 1\n"
_FIX = "Files of other programs are not read: they belong to the classes of their version. Use URDF between both."


def path_of(file: Any) -> str:
    """The path of a file.

    Args:
        file: Text, or a path.

    Returns:
        The path as text.

    Raises:
        ArgumentError: It is neither.
    """
    try:
        return os.fspath(file)
    except TypeError:
        raise ArgumentError(f"The file is {excerpt(repr(file))}; expected a path or its text.") from None


class Saved:
    """An object that can be saved to files and loaded from them."""

    __slots__ = ()

    def saveToString(self) -> str:
        """Its numbers as JSON."""
        return json.dumps(_plain(self))

    def loadFromString(self, string: str) -> None:
        """Becomes what `saveToString` wrote. FormatError where it is of another kind."""
        self._become(string, None)

    def saveToText(self, filename: Any) -> None:
        """Writes its numbers as JSON, one object in lines."""
        with replacing(filename) as place:
            place.write_text(json.dumps(_plain(self), indent=1), encoding="utf-8")

    def loadFromText(self, filename: Any) -> None:
        """Becomes what `saveToText` wrote. FormatError where the file is missing or of another kind."""
        self._become(_read(filename).decode("utf-8", "replace"), filename)

    def saveToXML(self, filename: Any, tag_name: str) -> None:
        """Writes the object as one XML element with JSON in it.

        Args:
            filename: Name of the file.
            tag_name: Name of the element.
        """
        text = f'<?xml version="1.0"?>\n<{tag_name}>{escape(self.saveToString(), quote=False)}</{tag_name}>\n'
        with replacing(filename) as place:
            place.write_text(text, encoding="utf-8")

    def loadFromXML(self, filename: Any, tag_name: str) -> None:
        """Replaces the object by what `saveToXML` wrote under that name.

        Args:
            filename: Name of the file.
            tag_name: Name of the element.

        Raises:
            FormatError: The file is missing, or of another kind.
        """
        text = _read(filename).decode("utf-8", "replace")
        before, start, rest = text.partition(f"<{tag_name}>")
        inner, end, _ = rest.partition(f"</{tag_name}>")
        if not start or not end or before.strip() != '<?xml version="1.0"?>':
            raise FormatError(
                f"There is no element <{tag_name}> that `saveToXML` wrote.", file=str(filename), fix=_FIX
            )
        self._become(unescape(inner), filename)

    @by_name("filename", "buffer")
    def saveToBinary(self, filename: Any) -> None:
        """Writes its numbers compressed, to a file or into a StreamBuffer or StaticBuffer of `serialization`."""
        content = _SIGN + zlib.compress(self.saveToString().encode("utf-8"))
        if hasattr(filename, "write"):
            filename.write(content)
        else:
            with replacing(filename) as place:
                place.write_bytes(content)

    @by_name("filename", "buffer")
    def loadFromBinary(self, filename: Any) -> None:
        """Becomes what `saveToBinary` wrote. FormatError where the file is missing or of another kind."""
        content = filename.tobytes() if hasattr(filename, "tobytes") else _read(filename)
        if not content.startswith(_SIGN):
            raise FormatError(
                "The file does not begin as `saveToBinary` writes it.", file=str(filename), fix=_FIX
            )
        try:
            text = zlib.decompressobj().decompress(content[len(_SIGN) :]).decode("utf-8")
        except (zlib.error, UnicodeDecodeError) as error:
            raise FormatError(f"The file is damaged: {error}.", file=str(filename)) from None
        self._become(text, filename)

    def _become(self, text: str, filename: Any) -> None:
        file = None if filename is None else str(filename)
        try:
            parsed = json.loads(text)
            name = parsed["#"]
            made = _made(parsed) if name == type(self).__name__ else None
        except (ValueError, TypeError, KeyError, AttributeError, RecursionError) as error:
            raise FormatError(f"It cannot be read: {error}.", file=file, fix=_FIX) from None
        if type(made) is not type(self):
            raise FormatError(f"It holds a {name}; expected a {type(self).__name__}.", file=file)
        if hasattr(self, "__setstate__"):
            self.__setstate__(made.__getstate__())  # pyright: ignore
        else:
            self.__dict__.clear()
            self.__dict__.update(made.__dict__)


def _read(filename: Any) -> bytes:
    try:
        return read_regular(os.fspath(filename))
    except OSError as error:
        raise FormatError(f"The file cannot be read: {error.strerror}.", file=str(filename)) from None


_REGISTERED: dict[str, type] = {}


def register(*classes: type) -> None:
    """Lets files hold objects of some classes, under the names of the classes."""
    _REGISTERED.update((cls.__name__, cls) for cls in classes)


def registered(name: str) -> Any:
    """The class that files hold under a name. KeyError where there is none."""
    return _REGISTERED.get(name) or _core_classes()[name]


@cache
def _name_of(cls: type) -> str | None:
    if _REGISTERED.get(cls.__name__) is cls:
        return cls.__name__
    return next((name for name, other in _core_classes().items() if other is cls), None)


@cache
def _core_classes() -> dict[str, type]:
    """Classes of Ulna that files may hold: poses, shapes, kinds of joints."""
    from ulna import geometry, model, spatial

    names = [
        "Box",
        "Capsule",
        "Cone",
        "Cylinder",
        "Ellipsoid",
        "Mesh",
        "Sphere",
        "Plane",
        "Points",
        "Surface",
    ]
    classes = [k for k in vars(model).values() if isinstance(k, type) and issubclass(k, model.JointKind)]
    classes += [getattr(geometry, name) for name in names if hasattr(geometry, name)]
    named = {cls.__name__: cls for cls in classes}  # a shape and a joint are called Ellipsoid
    return {"Pose": spatial.SE3, "EllipsoidJoint": model.Ellipsoid, **named}


def _plain(x: Any) -> Any:
    """A value as dictionaries, lists, numbers and texts."""
    if x is None or type(x) in (bool, int, float, str):
        return x
    if isinstance(x, np.ndarray):
        return {"#": "array", "shape": x.shape, "entries": x.ravel().tolist()}
    if isinstance(x, dict):
        return {"#": "dict", "items": [[_plain(k), _plain(v)] for k, v in x.items()]}
    if isinstance(x, (np.number, np.bool_)):
        return x.item()
    name = _name_of(type(x))
    if isinstance(x, (list, tuple)):
        kind = "list" if isinstance(x, list) else name or "tuple"
        return {"#": kind, "items": [_plain(entry) for entry in x]}
    if name is None:
        raise InputError(
            f"A {type(x).__name__} that was made in memory is not written to files. Write a mesh to a separate file, "
            "and name it as meshPath; or use pickle, which keeps all that there is."
        )
    if isinstance(x, enum.Enum):
        return {"#": name, "value": int(x.value)}
    if dataclasses.is_dataclass(x):
        state: Any = {f.name: getattr(x, f.name) for f in dataclasses.fields(x)}
    elif hasattr(x, "_of"):
        state = getattr(x, x.__slots__[0] if x.__slots__ else "_v")
    else:
        state = list(x.__reduce__()[1]) if name == "Frame" else x.__getstate__()
    return {"#": name, "state": _plain(state)}


def _made(x: Any) -> Any:
    """What `_plain` was given."""
    if not isinstance(x, dict):
        return x
    name = x["#"]
    if name == "array":
        return np.array(x["entries"], dtype=float if x["entries"] else None).reshape(x["shape"])
    if name == "dict":
        return {_made(k): _made(v) for k, v in x["items"]}
    if name in ("list", "tuple"):
        entries = [_made(entry) for entry in x["items"]]
        return StdVec(entries) if name == "list" else tuple(entries)
    cls = registered(name)
    if "items" in x:
        return cls(*(_made(entry) for entry in x["items"]))
    if "value" in x:
        return cls(x["value"])
    state = _made(x["state"])
    if isinstance(state, dict) and dataclasses.is_dataclass(cls):
        make: Any = cls
        return make(**state)
    if hasattr(cls, "_of"):
        return cls._of(state)
    if name == "Frame":
        return cls(*state)
    made = object.__new__(cls)
    if hasattr(made, "__setstate__"):
        made.__setstate__(state)
    else:
        made.__dict__.update(state)
    return made
