"""Data: what algorithms write their results into; its entries are live references into arrays of one model's sizes."""

from __future__ import annotations

import copy
from array import array
from typing import TYPE_CHECKING, Any, final

import numpy as np

from pinocchio._arrays import StdVec, views
from pinocchio._inertia import Inertia
from pinocchio._runs import ALGORITHMS, Runs
from pinocchio._saved import Saved
from pinocchio._se3 import SE3
from pinocchio._states import STATES, States, Waiting, engine_for, frames_fit
from pinocchio._vectors import Force, Motion
from ulna.typing import Floats

if TYPE_CHECKING:
    from pinocchio._engine import Engine
    from pinocchio._model import Model


__all__ = ["Data", "engine_for", "frames_fit"]


class _PerJoint(StdVec[Any]):
    """Values of the joints, which are computed when they are read; that of the universe may be there before."""

    def __init__(self, data: Data, name: str, entries: Any) -> None:
        super().__init__(entries)
        self._data, self._name = data, name

    def __getitem__(self, key: Any) -> Any:
        if key != 0 or self._name == "mass":
            self._data.read(self._name)
        return super().__getitem__(key)

    def __iter__(self) -> Any:
        return (self[i] for i in range(len(self)))


_MATRICES = {
    "M": "vv",
    "Minv": "vv",
    "C": "vv",
    "J": "6v",
    "dJ": "6v",
    "Ag": "6v",
    "dAg": "6v",
    "Jcom": "3v",
    "tau": "v",
    "nle": "v",
    "g": "v",
    "ddq": "v",
    "dtau_dq": "vv",
    "dtau_dv": "vv",
    "ddq_dq": "vv",
    "ddq_dv": "vv",
    "ddq_dtau": "vv",
    "dHdq": "6v",
    "dFdq": "6v",
    "dFdv": "6v",
    "dFda": "6v",
    "kineticEnergyRegressor": "p",
    "potentialEnergyRegressor": "p",
    "jointTorqueRegressor": "vp",
    "staticRegressor": "3s",
    "bodyRegressor": "6t",
    "dq_after": "v",
    "osim": "00",
    "lambda_c": "0",
    "impulse_c": "0",
    "dlambda_dq": "00",
    "dlambda_dv": "00",
    "dlambda_dtau": "00",
    "dac_da": "00",
}
"""Those of constraints are empty until an algorithm knows how many rows there are."""
_POSES = ("oMi", "liMi")
_FORCES = ("f", "h", "of", "oh")
_MOTIONS = ("v", "a", "a_gf", "ov", "oa", "oa_gf")
_CENTRES = ("com", "vcom", "acom")
_KEPT = ("kinetic_energy", "potential_energy", "mechanical_energy")
_WHOLE = {"hg": Force, "dhg": Force, "Ig": Inertia}
_LISTS = ("liMi", *_MOTIONS, *_FORCES, *_CENTRES, "mass")
_FIELDS = (*_MATRICES, *_WHOLE, *_LISTS)


@final
class Data(Saved, States):
    """Working memory of algorithms for one model: `model.createData()`."""

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

    def __init__(self, model: Model) -> None:
        self._model = model
        self._layout = model._layout
        self.nframes = model.nframes
        nj, nv, np_ = model.njoints, model.nv, model.njoints - 1
        sizes = {
            "6": 6,
            "3": 3,
            "v": nv,
            "p": 10 * np_,
            "s": 4 * np_,
            "t": 10,
            "0": 0,
            "q": model.nq,
            "a": nv,
        }
        self._blocks: dict[str, Floats] = {k: np.zeros([sizes[c] for c in s]) for k, s in _MATRICES.items()}
        for name in (*_POSES, "oMf"):
            self._blocks[name] = np.tile(np.eye(4), (model.nframes if name == "oMf" else nj, 1, 1))
        for name in (*_MOTIONS, *_FORCES):
            self._blocks[name] = np.zeros((nj, 6))
        for name in _CENTRES:
            self._blocks[name] = np.zeros((nj, 3))
        for name, inputs in STATES.items():
            self._blocks |= {f"{name} {x}": np.zeros(sizes[x]) for x in inputs}
        self._blocks |= {"hg": np.zeros(6), "dhg": np.zeros(6), "Ig": np.zeros(13)}
        self._blocks |= {
            "energy K": np.zeros(()),
            "energy P": np.zeros(()),
            "gravity by q": np.zeros((nv, nv)),
        }
        self._blocks["a_gf"][0] = -model.gravity.vector
        self._known: set[str] = set()
        self._begin()
        self.kinetic_energy = self.potential_energy = self.mechanical_energy = 0.0
        self._bound: Any = None
        self._damped: Any = None
        self._engine: Engine | None = None

    def _begin(self) -> None:
        """What belongs to these very arrays."""
        blocks = self._blocks
        self._marks = array("d", bytes(8 * len(_FIELDS)))
        self._marked = np.frombuffer(self._marks)
        self._waiting: dict[str, Waiting] = {}
        self._run = Runs()
        self._told: dict[int, Engine] = {}
        self._run_at: dict[Any, Any] = {}  # what makes Jacobians of frames, by index and reference
        self._ties: list[Any] = []
        self.oMi: StdVec[SE3] = views(SE3, blocks["oMi"])
        self.oMf: StdVec[SE3] = views(SE3, blocks["oMf"])
        self._lists: dict[str, Any] = {name: cls._of(blocks[name]) for name, cls in _WHOLE.items()}
        self._lists["liMi"] = views(SE3, blocks["liMi"])
        self._lists |= {n: views(Motion, blocks[n]) for n in _MOTIONS}
        self._lists |= {n: views(Force, blocks[n]) for n in _FORCES}
        self._lists |= {n: _PerJoint(self, n, blocks[n]) for n in _CENTRES}
        self._lists["mass"] = _PerJoint(self, "mass", [-1.0] * len(blocks["com"]))
        per_joint = ("oMi", *_LISTS[:-1])
        self._tails = {n: blocks[n][1:] for n in per_joint}
        self._heads = {f"{n}[0]": blocks[n][0] for n in per_joint}

    @property
    def joints(self) -> StdVec[Any]:
        """For each joint its placement, motion subspace, velocity and bias, at the state of the last algorithm."""
        from pinocchio._joint_data import states

        return states(self._model, self._q_of_joints, self._qv_of_joints)

    def copy(self) -> Data:
        """One of its own, with the same numbers."""
        return copy.deepcopy(self)

    def __deepcopy__(self, memo: Any) -> Data:
        self.settle()
        out = object.__new__(Data)
        out.__dict__.update(self.__dict__)
        out._blocks = {k: b.copy() for k, b in self._blocks.items()}
        out._known = set(self._known)
        out._bound = self._bound and self._bound.copied()
        out._begin()
        out._marked[...] = self._marked
        list.__setitem__(out._lists["mass"], slice(None), list.__iter__(self._lists["mass"]))
        return out

    __copy__ = copy

    def __getstate__(self) -> dict[str, Any]:
        self.settle()
        told = {name: getattr(self, name) for name in _KEPT}
        spoilt = {
            name: ALGORITHMS[int(self._marks[k]) - 1].name for name, k in self.slots.items() if self._marks[k]
        }
        mass = list(list.__iter__(self._lists["mass"]))
        return {"model": self._model, "blocks": self._blocks, "mass": mass, "spoilt": spoilt, **told}

    def __setstate__(self, state: dict[str, Any]) -> None:
        told = dict(state)
        self.__init__(told.pop("model"))
        self._blocks = told.pop("blocks")
        self._begin()
        list.__setitem__(self._lists["mass"], slice(None), told.pop("mass"))
        for algorithm in ALGORITHMS:
            for name, by in told["spoilt"].items():
                if by == algorithm.name:
                    self._marks[self.slots[name]] = float(algorithm.number)
        del told["spoilt"]
        for name, value in told.items():
            setattr(self, name, value)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Data):
            return NotImplemented
        mine, theirs = self.__getstate__()["blocks"], other.__getstate__()["blocks"]
        same = all(np.array_equal(b, theirs[n]) for n, b in mine.items() if " " not in n)
        return same and all(getattr(self, name) == getattr(other, name) for name in _KEPT)

    __hash__ = object.__hash__

    @property
    def constraint_chol(self) -> Any:
        """The decomposition of mass matrix and constraints of the last constraintDynamics or impulseDynamics."""
        from pinocchio._constraint_cholesky import cholesky_of

        return cholesky_of(self)

    contact_chol = constraint_chol

    def __repr__(self) -> str:
        return f"<Data of {self._model.name!r}: nv={self._model.nv}, {len(self.oMi)} joints, {self.nframes} frames>"


def _block(name: str) -> property:
    slot = Data.slots[name]

    def get(self: Data) -> Floats:
        if self._marks[slot]:
            self.read(name)
        return self._blocks[name]

    def put(self: Data, value: Any) -> None:
        self._blocks[name][...] = value
        self._marks[slot] = 0.0

    return property(get, put, doc=f"`{name}` as the last algorithm left it, live; assigning copies into it.")


def _entries(name: str) -> property:
    slot = Data.slots[name]
    if name in (*_CENTRES, "mass"):  # which know of themselves what is to be computed
        return property(lambda self: self._lists[name], doc=f"`{name}` of what every joint moves, live.")

    def get(self: Data) -> Any:
        if self._marks[slot]:
            self.read(name)
        return self._lists[name]

    return property(get, doc=f"`{name}` as the last algorithm left it, live references.")


Data.slots = {name: k for k, name in enumerate(_FIELDS)}
for _name in _MATRICES:
    setattr(Data, _name, _block(_name))
for _name in (*_WHOLE, *_LISTS):
    setattr(Data, _name, _entries(_name))
