"""Data: what algorithms write their results into; its entries are live references into arrays of one model's sizes."""

from __future__ import annotations

import contextlib
import weakref
from array import array
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar, final

import numpy as np

from pinocchio._containers.arguments import OMITTED, WrongShape
from pinocchio._containers.arrays import ArrayRows, StdVec, matrix, numbers, real, vector, views
from pinocchio._containers.attributes import (
    AttributeKind,
    CheckedAttributes,
    checked_list,
    computed,
    one_of,
    refused,
)
from pinocchio._containers.files import Saved, register
from pinocchio._containers.watched_lists import CHANGES, READS, watch
from pinocchio._data.algorithm import ALGORITHMS
from pinocchio._data.articulated_bodies import check_articulated
from pinocchio._data.live_joints import live_joints
from pinocchio._data.missing_fields import missing_field_message
from pinocchio._data.states import BoundAlgorithms
from pinocchio._data.storage import (
    ARTICULATED_TERMS,
    CENTRES,
    FORCES,
    MATRICES,
    MATRIX_LISTS,
    MOTIONS,
    UNUSED,
    FieldArrays,
)
from pinocchio._data.tree_fields import TreeFields
from pinocchio._model.building import KinematicTree
from pinocchio._spatial.inertia import Inertia
from pinocchio._spatial.motion_force import Force, Motion
from pinocchio._spatial.se3 import SE3
from ulna.compiler.runtime.repeated_calls import forget
from ulna.errors import InputError
from ulna.typing import Floats


class _PerJoint(ArrayRows):
    """Values of the joints, which are computed when they are read; that of the universe may be there before."""

    _data: Data
    _name: str

    def __new__(cls, *parts: Any) -> Any:
        """A list of its own: what scripts make of the type of such values."""
        return StdVec(*parts)

    @classmethod
    def of(cls, data: Data, name: str, entries: Any) -> _PerJoint:
        """The values of a field.

        Args:
            data: The Data.
            name: The field.
            entries: What is there before it is computed.

        Returns:
            The values, live.
        """
        out = list.__new__(cls)
        list.extend(out, entries)
        out._data, out._name = data, name
        return out

    def __reduce__(self) -> Any:
        return StdVec, ([*self],)

    def __getitem__(self, key: Any) -> Any:
        if key != 0 or self._name == "mass":
            self._data._read(self._name)
        return super().__getitem__(key)

    def __iter__(self) -> Any:
        return (self[i] for i in range(len(self)))


def _before_change(values: _PerJoint) -> None:
    values._data._read(values._name)
    if values._name == "mass":
        values._data._arrays["mass changes"][...] = 1.0


watch(_PerJoint, lambda values: values._data._read(values._name), *READS)
watch(_PerJoint, _before_change, *CHANGES)
_PerJoint.__name__ = "StdVec_Vector3"  # as scripts see it


_ENERGIES = {
    "kinetic_energy": "energy K",
    "potential_energy": "energy P",
    "mechanical_energy": "energy K + P",
}
_READ_ONLY = ("constraint_chol", "contact_chol", "dlambda_dq", "dlambda_dv", "dlambda_dtau")
_SINGLE = {"hg": Force, "dhg": Force, "Ig": Inertia}
_LISTS = ("liMi", *MOTIONS, *FORCES, *CENTRES, *MATRIX_LISTS, "mass")
_ASKED_RARELY = ("Yaba",)
"""Deferred fields that copies compute when they are read there, and that are not compared: they take the longest."""
_FIELDS = (*MATRICES, *_SINGLE, *_LISTS, *_ASKED_RARELY)


@final
class _Lists(dict[str, Any]):
    """Fields with an entry for each joint, and those that are one Motion, Force or Inertia, made when first read.

    They do not keep their Data, so that one which nobody reads any more goes at once, and not with the next collection.
    """

    def __init__(self, data: Data) -> None:
        self._data = weakref.ref(data)
        self.masses: list[float] | None = None
        """What `mass` begins with, where that is not -1 for all."""

    def __missing__(self, name: str) -> Any:
        data: Any = self._data()
        if name == "mass":
            made = _PerJoint.of(data, name, self.masses or [-1.0] * data._arrays["com"].shape[0])
        elif name == "Ycrb":
            made = views(Inertia, data._arrays["composite inertias"])
        elif name in CENTRES:
            made = _PerJoint.of(data, name, data._arrays[name])
        elif name in MATRIX_LISTS:
            made = ArrayRows(data._arrays[name])
        elif name in _SINGLE:
            made = _SINGLE[name]._of(data._arrays[name])
        else:
            made = views(SE3 if name == "liMi" else Force if name in FORCES else Motion, data._arrays[name])
        return self.setdefault(name, made)  # another thread may have made it meanwhile

    def present_masses(self) -> list[float] | None:
        """The entries of `mass` as they are; None where nothing made them yet."""
        return [*list.__iter__(self["mass"])] if "mass" in self else self.masses


@final
class _Placements:
    """References to placements, made when first read; then an attribute as quick as others, which `__dict__` is not."""

    def __init__(self, name: str, doc: str) -> None:
        self._name, self.__doc__ = name, doc

    def __get__(self, data: Data | None, _: type) -> Any:
        if data is None:
            return self
        placements = views(SE3, data._arrays[self._name])
        data._keep(**{self._name: placements})
        return placements


def _placements(data: Data, name: str, value: Any) -> Any:
    """The kind of `oMi` and `oMf`: what is assigned is copied into the placements that they are."""
    present = getattr(data, name)
    for entry, one in zip(present, _checked_entries(data, name, value, SE3), strict=True):
        entry._assign(one)
    return present


def _checked_entries(data: Data, name: str, value: Any, cls: type) -> list[Any]:
    """The entries of a list that is assigned to a field: one for each joint, or frame."""
    count = len(data._layout) if name != "oMf" else data.nframes
    expected = f"a list of {count} {cls.__name__}"
    found = checked_list(name, value, cls, expected)
    if len(found) != count:
        raise refused(name, value, expected)
    return found


@final
class Data(CheckedAttributes, Saved, TreeFields):
    """Working memory of algorithms for one model: `model.createData()`."""

    _kinds: ClassVar[Mapping[str, AttributeKind]] = {"oMi": _placements, "oMf": _placements}

    if TYPE_CHECKING:  # made below, by their names
        M: Floats
        Minv: Floats
        C: Floats
        J: Floats
        dJ: Floats
        Ag: Floats
        dAg: Floats
        Jcom: Floats
        tau: Floats
        nle: Floats
        g: Floats
        ddq: Floats
        dtau_dq: Floats
        dtau_dv: Floats
        ddq_dq: Floats
        ddq_dv: Floats
        ddq_dtau: Floats
        dHdq: Floats
        dFdq: Floats
        dFdv: Floats
        dFda: Floats
        dAdq: Floats
        dAdv: Floats
        B: StdVec[Floats]
        Fcrb: StdVec[Floats]
        oL: StdVec[Floats]
        oK: StdVec[Floats]
        oYaba_augmented: StdVec[Floats]
        of_augmented: StdVec[Force]
        kineticEnergyRegressor: Floats
        potentialEnergyRegressor: Floats
        jointTorqueRegressor: Floats
        staticRegressor: Floats
        bodyRegressor: Floats
        liMi: StdVec[SE3]
        v: StdVec[Motion]
        a: StdVec[Motion]
        a_gf: StdVec[Motion]
        ov: StdVec[Motion]
        oa: StdVec[Motion]
        oa_gf: StdVec[Motion]
        f: StdVec[Force]
        h: StdVec[Force]
        of: StdVec[Force]
        oh: StdVec[Force]
        com: StdVec[Floats]
        vcom: StdVec[Floats]
        acom: StdVec[Floats]
        mass: StdVec[float]
        hg: Force
        dhg: Force
        Ig: Inertia
        kinetic_energy: float
        potential_energy: float
        mechanical_energy: float
        constraint_chol: Any  # from here on made in the folder _constraints
        contact_chol: Any

    _empty_model: ClassVar[type[KinematicTree]]
    """The class of the model of a Data() that is to be loaded from a file; set where the class of models is."""
    _model: KinematicTree
    _known_states: set[str]
    _marks: array[float]
    _lists: _Lists

    def __init__(self, model: KinematicTree = OMITTED) -> None:
        model = self._empty_model() if model is OMITTED else model
        own = self.__dict__  # attributes that are set are checked, which would take half as long again
        own["_model"], own["_layout"], own["nframes"] = model, model._layout, model.nframes
        own["_arrays"], own["_known_states"] = FieldArrays(model), set()
        own["_constraint_solution"] = own["_damped"] = own["_compiled"] = None
        self._bind_to_arrays()

    def _bind_to_arrays(self) -> None:
        """Creates what refers to these very arrays."""
        own = self.__dict__
        own["_marks"] = marks = array("d", bytes(8 * len(_FIELDS)))
        own["_mark_array"], own["_lists"] = np.frombuffer(marks), _Lists(self)
        own["_bound"], own["_waiting"], own["_bound_at"], own["_bound_reads"] = BoundAlgorithms(), {}, {}, {}
        own["_parameters_of"], own["_constraint_sets"], own["_evaluator"] = {}, [], None

    oMi = _Placements("oMi", "For each joint its placement in the world, live references.")
    oMf = _Placements("oMf", "For each frame its placement in the world, live references.")

    @property
    def joints(self) -> StdVec[Any]:
        """For each joint its placement, subspace, velocity and bias at the state of the last algorithm; live."""
        joints = self.__dict__.get("_live_joints")
        if joints is None:
            joints = self.__dict__["_live_joints"] = live_joints(self)
        return joints

    @property
    def Yaba(self) -> StdVec[Floats]:
        """For each joint its articulated inertia (6, 6) in its frame, at the configuration of the last algorithm.

        It is of the numbers that the model had then, after kinematics of those it has when this is first read. For
        joints not on the universe it is that of the other side, which the joint's own motion does not feel.
        """
        return self._articulated("Yaba")

    @property
    def oYaba(self) -> StdVec[Floats]:
        """The same in the world; see `Yaba`."""
        return self._articulated("oYaba")

    def _articulated(self, name: str) -> StdVec[Floats]:
        self._require(self._q_of_joints, "aba(model, data, q, v, tau)")
        check_articulated(self._model)
        self._read("Yaba")
        return ArrayRows(self._arrays[name])

    def _settle(self, name: str) -> None:
        """Makes a field ready to be assigned to: what is to be computed with it later must not overwrite it."""
        slot = self._slots[name]
        if self._marks[slot]:
            with contextlib.suppress(InputError):
                self._read(name)
            self._marks[slot] = 0.0

    def copy(self) -> Data:
        """A copy."""
        return self._copied()

    def __getattr__(self, name: str) -> Any:
        raise AttributeError(missing_field_message(name, dir(type(self))), name=name, obj=None)

    def __deepcopy__(self, memo: Any) -> Data:
        return self._copied()

    def _copied(self) -> Data:
        self._compute_deferred(but=_ASKED_RARELY)
        self._keep_factors()
        out = object.__new__(Data)
        out.__dict__.update(self.__dict__)
        for name in ("oMi", "oMf", "_live_joints"):
            out.__dict__.pop(name, None)
        out._arrays = self._arrays.copied()
        out._known_states = set(self._known_states)
        solution = self._constraint_solution
        out._constraint_solution = solution and solution.copied()
        out._bind_to_arrays()
        out._mark_array[...] = self._mark_array
        for field in _ASKED_RARELY:
            if self._marks[self._slots[field]]:
                deferred, compiled, state = self._as_waiting(field)
                out._defer(deferred, (field,), compiled, *state)
        out._lists.masses = self._lists.present_masses()
        return out

    __copy__ = copy

    def __getstate__(self) -> dict[str, Any]:
        self._compute_deferred()
        self._keep_factors()
        energies = {name: getattr(self, name) for name in _ENERGIES}
        invalid = {
            name: ALGORITHMS[int(self._marks[k]) - 1].name
            for name, k in self._slots.items()
            if self._marks[k]
        }
        mass = list(list.__iter__(self._lists["mass"]))
        arrays = self._arrays.whole()
        states = sorted(self._known_states)
        return {
            "model": self._model, "blocks": arrays, "mass": mass, "spoilt": invalid, "states": states, **energies
        }  # fmt: skip

    def __setstate__(self, state: dict[str, Any]) -> None:
        values = dict(state)
        forget(self)  # kernels that are bound to the arrays before
        self.__dict__.clear()
        self.__init__(values.pop("model"))
        self._known_states = set(values.pop("states", ()))
        self._arrays.update(values.pop("blocks"))
        self._bind_to_arrays()
        list.__setitem__(self._lists["mass"], slice(None), values.pop("mass"))
        numbers = {algorithm.name: algorithm.number for algorithm in ALGORITHMS}
        for name, algorithm in values.pop("spoilt").items():
            self._marks[self._slots[name]] = float(numbers.get(algorithm, 0))
        for name, value in values.items():
            setattr(self, name, value)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Data):
            return NotImplemented
        for data in (self, other):
            data._compute_deferred(but=_ASKED_RARELY)
        mine, theirs = self._arrays.whole(), other._arrays.whole()
        compared = [name for name in mine if " " not in name and name not in ARTICULATED_TERMS]
        same = all(np.array_equal(mine[name], theirs[name]) for name in compared)
        return same and all(getattr(self, name) == getattr(other, name) for name in _ENERGIES)

    __hash__ = object.__hash__

    def __repr__(self) -> str:
        return f"<Data of {self._model.name!r}: nv={self._model.nv}, {len(self.oMi)} joints, {self.nframes} frames>"


def _block(name: str) -> property:
    slot = Data._slots[name]

    def get(self: Data) -> Floats:
        if self._marks[slot]:
            self._read(name)
        return self._arrays[name]

    def put(self: Data, value: Any) -> None:
        array = self._arrays[name]
        if set(MATRICES[name]) == {"0"}:
            values = _of_any_size(name, value, len(MATRICES[name]))
        else:
            values = vector(value, array.size, name) if array.ndim == 1 else matrix(value, array.shape, name)
        self._settle(name)
        _put_array(self, name, values)

    return property(get, put, doc=f"`{name}` as the last algorithm left it, live; assigning copies into it.")


def _of_any_size(name: str, value: Any, axes: int) -> Floats:
    """An array for a field of one or two axes whose size no model decides: constraints do, or programs.

    As in Pinocchio, vectors are taken as columns of a matrix, and matrices of one column are read as vectors.
    """
    if not isinstance(value, (list, tuple, np.ndarray)):
        raise refused(name, value, "numbers")
    values = numbers(value, name)
    if values.ndim not in (1, axes) and not (values.ndim == 2 and (values.size == 0 or 1 in values.shape)):
        raise WrongShape(name, values.shape, "(n,)" if axes == 1 else "(n, m)")
    if axes == 2 and values.size == 1:
        return values.reshape(1, 1)
    return values if axes == 2 and values.ndim == 2 and values.shape[1] != 1 else values.reshape(-1)


def _put_array(data: Data, name: str, values: Floats) -> None:
    """Copies values into a field, or has it hold a copy of them where its size changes."""
    array = data._arrays[name]
    if array.shape == values.shape:
        array[...] = values
    else:
        data._arrays[name] = values.copy()
        forget(data)  # kernels that write to the array before


def _entries(name: str) -> property:
    slot = Data._slots[name]
    put = _put_numbers(name) if name in (*CENTRES, *MATRIX_LISTS, "mass") else _put_objects(name)
    if name in (*CENTRES, "mass"):  # which know of themselves what is to be computed
        return property(lambda self: self._lists[name], put, doc=f"`{name}` of what every joint moves, live.")

    def get(self: Data) -> Any:
        if self._marks[slot]:
            self._read(name)
        return self._lists[name]

    return property(get, put, doc=f"`{name}` as the last algorithm left it, live references.")


def _put_objects(name: str) -> Any:
    """What assigns to a field of objects: to the one that it is, or to each in a list."""
    single = _SINGLE.get(name)
    cls = single or (SE3 if name == "liMi" else Force if name in FORCES else Motion)
    kind = one_of(cls)

    def put(self: Data, value: Any) -> None:
        found = [kind(None, name, value)] if single else _checked_entries(self, name, value, cls)
        self._settle(name)
        for entry, one in zip([self._lists[name]] if single else self._lists[name], found, strict=True):
            entry._assign(one)

    return put


def _put_numbers(name: str) -> Any:
    """What assigns to a field of arrays, or of numbers, one for each joint."""

    def put(self: Data, value: Any) -> None:
        if not isinstance(value, (list, tuple)):
            raise refused(name, value, "a list with an entry for each joint")
        shape = np.shape(self._arrays[name]) if name != "mass" else (len(self._layout),)
        values = matrix([*value], shape, name)
        self._settle(name)
        if name == "mass":
            list.__setitem__(self._lists[name], slice(None), values.tolist())
            self._arrays["mass changes"][...] = 1.0
        else:
            self._arrays[name][...] = values

    return put


def _unused(name: str, shape: str) -> property:
    def get(self: Data) -> Any:
        array = self._arrays[name]
        return views(SE3, array) if shape == "n44" else ArrayRows(array) if shape == "n66" else array

    def put(self: Data, value: Any) -> None:
        present = self._arrays[name]
        if present.ndim == 1:
            _put_array(self, name, _of_any_size(name, value, 1))
            return
        if not isinstance(value, (list, tuple)):
            raise refused(name, value, "a list of matrices")
        rows = [x.homogeneous if isinstance(x, SE3) else x for x in value]
        _put_array(
            self,
            name,
            matrix(rows or np.zeros((0, *present.shape[1:])), (len(rows), *present.shape[1:]), name),
        )

    return property(get, put, doc=f"`{name}`: no algorithm reads or writes it; programs may.")


def _number(name: str, block: str) -> property:
    def get(self: Data) -> float:
        return float(self._arrays[block])

    def put(self: Data, value: float) -> None:
        self._arrays[block][...] = real(value, name)

    return property(get, put, doc=f"{name} as the last algorithm left it [J].")


Data._slots = {name: k for k, name in enumerate(_FIELDS)}
for _name in MATRICES:
    setattr(Data, _name, _block(_name))
for _name, _shape in UNUSED.items():
    setattr(Data, _name, _unused(_name, _shape))
for _name, _block_name in _ENERGIES.items():
    setattr(Data, _name, _number(_name, _block_name))
for _name in (*_SINGLE, *_LISTS):
    setattr(Data, _name, _entries(_name))
_computed = [name for name in dir(Data) if isinstance(getattr(Data, name), property) and name[0] != "_"]
_computed = [name for name in _computed if getattr(Data, name).fset is None]
Data._kinds = {**Data._kinds, **dict.fromkeys((*_computed, *_READ_ONLY), computed)}


register(Data)
