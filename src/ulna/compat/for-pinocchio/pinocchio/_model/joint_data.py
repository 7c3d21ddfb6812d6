"""JointData: what one joint does at one configuration: its placement, motion subspace, velocity and bias."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from pinocchio._containers.arguments import OMITTED, ArgumentError
from pinocchio._containers.arrays import StdVec, fixed, vector
from pinocchio._containers.attributes import read_only
from pinocchio._model.joint_base import JointBase, present_names
from pinocchio._model.joint_state import Sizes, filler, parts_of_state, state_size
from pinocchio._spatial.motion_force import Motion
from pinocchio._spatial.se3 import SE3
from ulna.errors import excerpt
from ulna.typing import Floats

_new = object.__new__
_KINDS = (
    *("RX", "RY", "RZ", "RUBX", "RUBY", "RUBZ", "PX", "PY", "PZ", "HX", "HY", "HZ"),
    *(
        "RevoluteUnaligned",
        "RevoluteUnboundedUnalignedTpl",
        "PrismaticUnaligned",
        "HelicalUnaligned",
        "Universal",
        "Ellipsoid",
    ),
    *("FreeFlyer", "Planar", "Spherical", "SphericalZYX", "Translation", "Mimic", "Composite"),
)


class LiveState(Protocol):
    """The state of a joint in the Data of a model."""

    @property
    def has_terms(self) -> bool:
        """Whether the terms of the articulated-body algorithm are defined."""
        ...

    def update(self) -> None:
        """Writes the present state into the data of the joint."""
        ...

    def terms(self, joint_data: JointData) -> tuple[Floats, Floats] | None:
        """U (6, nv) and Dinv (nv, nv) of the present state; None where there are none.

        Args:
            joint_data: The data of the joint, or of a part of it, which has none.

        Returns:
            The terms.
        """
        ...


_SLOTS = ("_block", "_mimic_shortname", "_shortname", "_sizes")


class JointData:
    """The state of one joint: `joint.createData()`, filled by `joint.calc(data, q, v)`; `data.joints` has those of all.

    U, Dinv and UDinv are the terms of the articulated-body algorithm [Featherstone 2008, table 7.1]. Those in
    `data.joints` are in the joint's own axes; others are zero, for nothing fills them. What is in `data.joints` is of
    the last algorithm whenever it is read.
    """

    if TYPE_CHECKING:  # made below, by their names
        M: SE3
        v: Motion
        c: Motion
        joint_q: Floats
        joint_v: Floats

    __slots__ = ("__dict__", "__weakref__", *_SLOTS)
    _block: Floats
    """The state; see `joint_state`."""
    _sizes: Sizes
    _shortname: str
    _mimic_shortname: str
    _views: tuple[Any, ...] | None = None
    """M, v and c, which refer to the state, and views of S, joint_q, joint_v and S as it is read."""
    _live: LiveState | None = None
    _terms: tuple[Floats, Floats] | None = None
    _joints: Sequence[JointData] = ()
    _places: Sequence[SE3] = ()

    def __init__(self, other: JointData | None = None) -> None:
        self._shortname, self._mimic_shortname = type(self).__name__, ""
        self._resize((1, 0, 0))
        if other is not None:
            self._become(other.copy())

    def _become(self, other: JointData) -> None:
        """Takes over all of another one, which nobody else has."""
        self.__dict__.clear()
        self.__dict__.update(other.__dict__)
        for name in _SLOTS:
            setattr(self, name, getattr(other, name))

    def _assign(self, other: JointData) -> None:
        """Takes over what another one is, as an entry of a list does; `data.joints` until the next algorithm."""
        if not isinstance(other, JointData):
            raise ArgumentError(f"A joint's data were given {excerpt(repr(other))}; expected a JointData.")
        self._update()
        live = self._live
        self._become(other.copy())
        self._live = live

    def _resize(self, sizes: Sizes) -> None:
        """Begins a new state of these sizes, at the identity."""
        self._sizes, self._block, self._views = sizes, np.zeros(state_size(sizes)), None
        self._block[:15:5] = 1.0
        self._block[15] = 1.0

    def _parts(self) -> tuple[Any, ...]:
        views = self._views
        if views is None:
            M, v, c, *rest = parts_of_state(self._block, self._sizes)
            one = rest[0][:, 0] if rest[0].shape[1] == 1 else rest[0]
            self._views = views = SE3._of(M), Motion._of(v), Motion._of(c), *rest, one
        return views

    def new_like(self) -> JointData:
        """New data of the same joint, in the same state; they follow none, and have no parts."""
        out = _new(type(self))
        out._block, out._sizes = self._block.copy(), self._sizes
        out._shortname, out._mimic_shortname = self._shortname, self._mimic_shortname
        return out

    def follow(self, live: LiveState) -> None:
        """Has all attributes belong to the state that is there when they are read."""
        self._live = live
        for part in self._joints:
            part.follow(live)

    @property
    def subspace(self) -> Floats:
        """The motion subspace (6, nv), which nothing writes to."""
        self._update()
        return self._parts()[3]

    def _update(self) -> None:
        if self._live is not None:
            self._live.update()

    @property
    def joints(self) -> StdVec[JointData]:
        """Of a composite joint: the data of its parts."""
        self._update()
        return self._joints if isinstance(self._joints, StdVec) else StdVec()

    @joints.setter
    def joints(self, value: Any) -> None:
        read_only(self, "joints", value)

    @property
    def S(self) -> Floats:
        """The motion subspace (6, nv), or (6,) for one column: the velocity is S times the rates."""
        if self._live is not None:
            self._live.update()
        out = (self._views or self._parts())[6].copy()
        out.setflags(False)
        return out

    @property
    def U(self) -> Floats:
        """The articulated inertia times the motion subspace, (6, nv), or (6,) for one column."""
        return self._single_column(self._of_recursion()[0])

    @property
    def Dinv(self) -> Floats:
        """The inverse of S^T U and the armature, (nv, nv); (1,) for one column, of data of the class of its kind."""
        inverse = self._of_recursion()[1]
        return fixed(inverse[0] if inverse.shape == (1, 1) and type(self) is not JointData else inverse)

    @property
    def UDinv(self) -> Floats:
        """U Dinv, (6, nv), or (6,) for one column."""
        terms = self._known_terms()
        if terms is None and self._shortname == "JointDataFreeFlyer":
            return fixed(np.eye(6))
        U, inverse = terms or self._of_recursion()
        return self._single_column(U @ inverse)

    def _known_terms(self) -> tuple[Floats, Floats] | None:
        return self._terms if self._live is None else self._live.terms(self)

    def _of_recursion(self) -> tuple[Floats, Floats]:
        """U (6, nv) and Dinv (nv, nv)."""
        columns = self.subspace.shape[1]
        return self._known_terms() or (np.zeros((6, columns)), np.zeros((columns, columns)))

    def _single_column(self, matrix: Floats) -> Floats:
        return fixed(matrix[:, 0].copy() if matrix.shape[1] == 1 else matrix.copy())

    def shortname(self) -> str:
        """The name of its kind."""
        return self._shortname

    def extract(self) -> JointData:
        """The same data as they are now, of the class of the joint's kind."""
        out = self.copy()
        if type(self) is not JointData or self._shortname not in CLASSES:
            return out
        made = object.__new__(CLASSES[self._shortname])
        made._become(out)
        return made

    def place(self, joint: JointBase, q: Any, v: Any) -> None:
        """Computes the state of the joint; see `JointModel.calc`.

        Args:
            joint: The joint.
            q: Its configuration.
            v: Its velocity; None for none.
        """
        kind = joint.kind
        if kind is None:
            return
        at, rate = vector(q, kind.nq, "q"), None if v is None else vector(v, kind.nv, "v")
        sizes = kind.nv, kind.nq, kind.nv
        if self._sizes != sizes:
            before = self._parts()
            self._resize(sizes)
            for part, old in zip(self._parts()[1:3], before[1:3], strict=True):
                part._assign(old)
        filler(kind, *(joint.mimic or (0, 1.0, 0.0))[1:]).fill(self._block, at, rate)
        start = first = 0
        for part, data in zip(joint.parts, self._joints, strict=True):
            end, last = start + part.nq, first + part.nv
            data.place(part, at[start:end], None if rate is None else rate[first:last])
            start, first = end, last

    def copy(self) -> JointData:
        """A copy; it stays as it is."""
        self._update()
        out = self.new_like()
        out._terms = self._known_terms() if self._live is None or self._live.has_terms else None
        if self._joints:
            out._joints, out._places = StdVec(part.copy() for part in self._joints), self._places
        return out

    __copy__ = copy

    def __getstate__(self) -> dict[str, Any]:
        own = self.copy()
        S, q, v = own._parts()[3:6]
        arrays = {"_M": own.M, "_v": own.v, "_c": own.c, "_subspace": S, "_joint_q": q, "_joint_v": v}
        names = {"_shortname": own._shortname, "_mimic_shortname": own._mimic_shortname}
        rest = {"_terms": own._terms, "_joints": own._joints, "_places": own._places}
        return names | rest | arrays

    def __setstate__(self, state: dict[str, Any]) -> None:
        names = {name: f"_{name}" for name in (*_ATTRIBUTES, "joints")}  # of former versions
        values = {names.get(name, name): value for name, value in present_names(state).items()}
        M, v, c, S, joint_q, joint_v = (
            values.pop(name) for name in ("_M", "_v", "_c", "_subspace", "_joint_q", "_joint_v")
        )
        for name, value in values.items():
            setattr(self, name, value)
        self._live = None
        self._resize((S.shape[1], joint_q.size, joint_v.size))
        parts = self._parts()
        for part, value in zip(parts[:3], (M, v, c), strict=True):
            part._assign(value)
        for part, value in zip(parts[3:6], (S, joint_q, joint_v), strict=True):
            part[...] = value

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, JointData):
            return NotImplemented
        same = (self.M, self.v, self.c) == (other.M, other.v, other.c)
        return same and all(
            np.array_equal(getattr(self, n), getattr(other, n)) for n in ("joint_q", "joint_v", "S")
        )

    __hash__ = object.__hash__

    def __str__(self) -> str:
        if self._shortname == "JointDataComposite":
            return f"{self._shortname} containing following models:\n" + "".join(
                f"  {d.shortname()}\n" for d in self.joints
            )
        return f"{self._shortname}\n" + (
            f"  Mimicking joint data: {self._mimic_shortname}\n" if self._mimic_shortname else ""
        )

    __repr__ = __str__


def _attribute(name: str, place: int, doc: str) -> property:
    def get(self: JointData) -> Any:
        if self._live is not None:
            self._live.update()
        return (self._views or self._parts())[place].copy()

    def put(self: JointData, value: Any) -> None:
        read_only(self, name, value)

    return property(get, put, doc=doc)


_ATTRIBUTES = {
    "M": (0, "Where the moving frame is in the fixed frame, a copy."),
    "v": (1, "The velocity of the moving frame, in its own axes, a copy."),
    "c": (2, "The bias (dS/dt) v, a copy."),
    "joint_q": (4, "The joint's entries of q, a copy."),
    "joint_v": (5, "The joint's entries of v, a copy."),
}
"""Where they are among the parts of the state, and what they are."""
for _name, (_place, _doc) in _ATTRIBUTES.items():
    setattr(JointData, _name, _attribute(_name, _place, _doc))


def _product(data: JointData) -> Floats:
    inverse: Floats = data._of_recursion()[1]
    if not inverse.any():
        return fixed(inverse.copy())
    return fixed(np.linalg.inv(inverse).astype(float))


def _placements_of_parts(data: JointData) -> StdVec[SE3]:
    return StdVec(place * part.M for place, part in zip(data._places, data.joints, strict=True))


def _placements_of_last(data: JointData) -> StdVec[SE3]:
    out: list[SE3] = []
    for place in reversed(_placements_of_parts(data)):
        out.insert(0, place * out[0] if out else place)
    return StdVec(out)


def _about_axis(self: JointData, axis: Any = OMITTED) -> None:
    JointData.__init__(self, *([axis] if isinstance(axis, JointData) else []))
    if axis is OMITTED or isinstance(axis, JointData):
        return
    direction = vector(axis, 3, "axis")
    turns = type(self).__name__ != "JointDataPrismaticUnaligned"
    rows = slice(3, 6) if turns else slice(0, 3)
    self._parts()[3][rows, 0] = direction


_OF_SOME_KINDS: dict[str, tuple[tuple[str, ...], Any]] = {
    "StU": (
        ("Composite", "Planar", "SphericalZYX", "Universal", "Ellipsoid"),
        property(_product, doc="S^T U and the armature, (nv, nv); zero where nothing filled the terms."),
    ),
    "pjMi": (
        ("Composite",),
        property(
            _placements_of_parts, doc="For each part its placement in the frame moved by the part before."
        ),
    ),
    "iMlast": (
        ("Composite",),
        property(
            _placements_of_last, doc="For each part the last part's frame, in the frame before that part."
        ),
    ),
    "__init__": (("HelicalUnaligned", "PrismaticUnaligned", "RevoluteUnaligned"), _about_axis),
}
"""What some kinds have, as in Pinocchio: terms of products, placements of parts, a constructor of an axis."""

CLASSES: dict[str, type[JointData]] = {
    f"JointData{kind}": type(
        f"JointData{kind}",
        (JointData,),
        {
            "__doc__": f"The state of a joint of the class JointModel{kind.removesuffix('Tpl')}.",
            "__module__": __name__,
            **{name: member for name, (kinds, member) in _OF_SOME_KINDS.items() if kind in kinds},
        },
    )
    for kind in _KINDS
}
"""The classes of joints' data, by their names."""
globals().update(CLASSES)


def data_of(joint: JointBase, of_any_kind: bool = False) -> JointData:
    """Data for a joint, at its neutral position.

    Args:
        joint: The joint.
        of_any_kind: Whether they are a JointData, else of the class of the joint's kind.

    Returns:
        The data.
    """
    shortname = joint.shortname().replace("JointModel", "JointData")
    kind = CLASSES.get(shortname) or CLASSES[f"{shortname}Tpl"]
    cls = JointData if of_any_kind else kind
    data = cls.__new__(cls)
    JointData.__init__(data)
    data._shortname = kind.__name__
    if joint.mimic is not None:
        data._mimic_shortname = (joint._mimic_shortname or type(joint).__name__).replace(
            "JointModel", "JointData"
        )
    if shortname == "JointDataComposite":
        data._joints = StdVec(data_of(part, of_any_kind=True) for part in joint.parts)
        data._places = StdVec(getattr(joint, "jointPlacements", ()))
    if joint.kind is not None:
        data.place(joint, joint.kind.neutral(), np.zeros(joint.kind.nv))
    elif shortname == "JointDataComposite":
        data._resize((0, 0, 0))
    return data


def states(
    joints: Sequence[Any], q: Floats | None, velocity_state: tuple[Floats, Floats] | None
) -> StdVec[JointData]:
    """The data of the joints of a model: placements at one state, velocities and biases at another one.

    Args:
        joints: The joints, the universe first.
        q: Configuration (nq,) [rad or m] for placements; None for none.
        velocity_state: Configuration (nq,) and velocity (nv,) for velocities and biases; None for none.

    Returns:
        The data.
    """
    out = StdVec(data_of(joint) for joint in joints)
    for joint, data in zip(list(joints)[1:], list(out)[1:], strict=True):
        if velocity_state is not None:
            joint.calc(data, *velocity_state)
        if q is not None:
            joint.calc(data, q)
    return out
