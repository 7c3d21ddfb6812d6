"""Python types that are made here through CPython's own type factory, with functions of machine code."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping, Sequence
from typing import Any

from ulna.compiler.runtime import entry_point
from ulna.compiler.runtime.object_layout import WORD, c_function, fast_call_works


class MemberDef(ctypes.Structure):
    """PyMemberDef of CPython."""

    _fields_ = (
        ("name", ctypes.c_char_p),
        ("type", ctypes.c_int),
        ("offset", ctypes.c_ssize_t),
        ("flags", ctypes.c_int),
        ("doc", ctypes.c_char_p),
    )


class _GetSetDef(ctypes.Structure):
    _fields_ = (
        ("name", ctypes.c_char_p),
        ("get", ctypes.c_void_p),
        ("set", ctypes.c_void_p),
        ("doc", ctypes.c_char_p),
        ("closure", ctypes.c_void_p),
    )


class _Slot(ctypes.Structure):
    _fields_ = (("slot", ctypes.c_int), ("pointer", ctypes.c_void_p))


class _Spec(ctypes.Structure):
    _fields_ = (
        ("name", ctypes.c_char_p),
        ("basicsize", ctypes.c_int),
        ("itemsize", ctypes.c_int),
        ("flags", ctypes.c_uint),
        ("slots", ctypes.POINTER(_Slot)),
    )


# Kinds of members: Py_ssize_t, a Python object, and one that need not be there.
_OFFSET, _OBJECT, SLOT_OBJECT = 19, 6, 16
_READ_ONLY = 1  # access to members
# Slots of types: Py_tp_call, Py_tp_descr_get, Py_tp_descr_set, Py_tp_members, Py_tp_getset.
CALL, GET, SET, _MEMBERS, _GETSET = 50, 54, 55, 72, 73
_HAVE_VECTORCALL = 1 << 11
_KEEP: list[Any] = []  # what CPython keeps pointers to

LIKE_A_METHOD = 1 << 17 | 1 << 8
"""Flags of types whose instances are methods of classes (Py_TPFLAGS_METHOD_DESCRIPTOR, IMMUTABLETYPE).

By the first, calls pass the instance and make no bound method; Python specialises code only where the second is set,
which saves 20 ns a call.
"""


def make_type(
    base: type, name: str, flags: int = 0, descriptor: int = 0, members: Mapping[str, int] | None = None
) -> type | None:
    """A subtype of `base` (which has no fields) whose instances are called through a pointer in each instance.

    Args:
        base: The base class, which has no fields.
        name: Name of the new type.
        flags: Further flags of the type.
        descriptor: Address of what `__get__` is to be; 0 for none.
        members: Attributes that are objects, each in a word of the instance: its offset [byte].

    Returns:
        The type, or None where `fast_call_works()` is False.
    """
    if not fast_call_works():
        return None
    rows = [
        ("__vectorcalloffset__", _OFFSET, entry_point.VECTORCALL, _READ_ONLY),
        ("__dictoffset__", _OFFSET, entry_point.DICT, _READ_ONLY),
        ("__weaklistoffset__", _OFFSET, entry_point.WEAKREFS, _READ_ONLY),
        *((name, _OBJECT, offset, _READ_ONLY) for name, offset in (members or {}).items()),
    ]
    get, put = c_function("PyObject_GenericGetDict"), c_function("PyObject_GenericSetDict")
    properties = (_GetSetDef * 2)(_GetSetDef(b"__dict__", get, put, None, None), _GetSetDef())
    _KEEP.append(properties)
    slots = {CALL: c_function("PyVectorcall_Call"), _GETSET: ctypes.addressof(properties)}
    if descriptor:
        slots[GET] = descriptor
    return _made(base, name, entry_point.END, flags | _HAVE_VECTORCALL, slots, rows)


def make_property_type(name: str, get: int, put: int, words: int) -> type | None:
    """A subtype of `property` that reads and assigns by machine code.

    Its instances are made by `make_instance`; `property.__init__` fills the part that properties have. They are not
    to be freed: words of theirs hold no references.

    Args:
        name: Name of the new type.
        get: Address of `ptr get(ptr property, ptr object, ptr owner)`.
        put: Address of `i32 put(ptr property, ptr object, ptr value)`.
        words: How many words instances have behind those of `property`. The first holds their documentation.

    Returns:
        The type, or None where `fast_call_works()` is False.
    """
    if not fast_call_works():
        return None
    size = property.__basicsize__
    return _made(
        property, name, size + WORD * words, 0, {GET: get, SET: put}, [("__doc__", _OBJECT, size, 0)]
    )


def slot_of(kind: type, slot: int) -> int:
    """The address of the function in a slot of a type.

    Args:
        kind: The type.
        slot: `GET` or `SET`.

    Returns:
        The address.
    """
    read = ctypes.pythonapi.PyType_GetSlot
    read.restype, read.argtypes = ctypes.c_void_p, [ctypes.py_object, ctypes.c_int]
    return read(kind, slot) or 0


def _made(
    base: type,
    name: str,
    size: int,
    flags: int,
    slots: Mapping[int, int],
    members: Sequence[tuple[str, int, int, int]],
) -> type:
    """A type of these slots and members, of which Python code makes no instances."""
    names = [member[0].encode() for member in members]
    fields = (MemberDef * (len(members) + 1))()
    for field, text, (_, sort, offset, access) in zip(fields, names, members, strict=False):
        field.name, field.type, field.offset, field.flags = text, sort, offset, access
    filled = {**slots, _MEMBERS: ctypes.addressof(fields)}
    table = (_Slot * (len(filled) + 1))(*[_Slot(*item) for item in filled.items()], _Slot(0, None))
    flags |= (1 << 18) | (1 << 7)  # HAVE_VERSION_TAG (no effect since 3.10), DISALLOW_INSTANTIATION
    called = f"{base.__module__}.{name}".encode()
    spec = _Spec(called, size, 0, flags, table)
    _KEEP.extend((fields, names, table, called, spec))
    factory = ctypes.pythonapi.PyType_FromSpecWithBases
    factory.restype, factory.argtypes = ctypes.py_object, [ctypes.POINTER(_Spec), ctypes.py_object]
    return factory(ctypes.byref(spec), (base,))


def make_instance(kind: type, words: dict[int, int]) -> Any:
    """An instance of a type that is made here.

    Args:
        kind: The type.
        words: By their offset in the instance [byte], the words to fill it with; what they point to must outlive it.

    Returns:
        The instance.
    """
    allocate = ctypes.pythonapi.PyType_GenericAlloc
    allocate.restype, allocate.argtypes = ctypes.py_object, [ctypes.py_object, ctypes.c_ssize_t]
    instance = allocate(kind, 0)
    for offset, word in words.items():
        ctypes.c_void_p.from_address(id(instance) + offset).value = word
    return instance
