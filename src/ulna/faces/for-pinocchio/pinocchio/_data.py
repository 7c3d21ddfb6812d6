"""Data: what algorithms write their results into; its entries are live references into arrays of one model's sizes."""

from __future__ import annotations

import copy
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, final

import numpy as np

from pinocchio._arrays import StdVec, views
from pinocchio._inertia import Inertia
from pinocchio._saved import Saved
from pinocchio._se3 import SE3
from pinocchio._vectors import Force, Motion
from ulna.errors import InputError
from ulna.typing import Floats

if TYPE_CHECKING:
    from pinocchio._engine import Engine
    from pinocchio._model import Model


class _Masses(StdVec[Any]):
    """Per-joint values of which the first is there, and the others are computed when they are asked for."""

    pull: Callable[[], None] | None = None

    def __getitem__(self, key: Any) -> Any:
        if self.pull is not None and key != 0:
            pull, self.pull = self.pull, None
            pull()
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
_MOTIONS = ("v", "a", "a_gf", "ov", "oa", "oa_gf")
_OF_MOTION = ("v", "a_gf", "f", "h")
_FORCES = ("f", "h", "of", "oh")


_KEPT = ("hg", "dhg", "Ig", "kinetic_energy", "potential_energy", "mechanical_energy")


@final
class Data(Saved):
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

    def __init__(self, model: Model) -> None:
        self._model = model
        self._layout = model._layout
        self.nframes = model.nframes
        nj, nv, np_ = model.njoints, model.nv, model.njoints - 1
        sizes = {"6": 6, "3": 3, "v": nv, "p": 10 * np_, "s": 4 * np_, "t": 10, "0": 0}
        self._blocks: dict[str, Floats] = {k: np.zeros([sizes[c] for c in s]) for k, s in _MATRICES.items()}
        for name in (*_POSES, "oMf"):
            self._blocks[name] = np.tile(np.eye(4), (model.nframes if name == "oMf" else nj, 1, 1))
        for name in (*_MOTIONS, *_FORCES):
            self._blocks[name] = np.zeros((nj, 6))
        for name in ("com", "vcom", "acom"):
            self._blocks[name] = np.zeros((nj, 3))
        self._fill_views()
        self.hg, self.dhg, self.Ig = Force(), Force(), Inertia()
        self.kinetic_energy = self.potential_energy = self.mechanical_energy = 0.0
        self._engine: Engine | None = None
        self._due: dict[str, Callable[[], Any]] = {}
        self._due_of_places = self._fill_places
        self._due_of_motion: dict[str, Callable[[], Any]] = dict.fromkeys(_OF_MOTION, self._fill_bodies)
        self._motion: Any = None
        self._mass_of: Engine | None = None
        self._moments: tuple[Floats, ...] = ()
        self._subtrees = {n: self._filler(n) for n in ("com", "vcom", "acom", "mass")}
        self._q: Floats | None = None
        self._qv: tuple[Floats, Floats] | None = None
        self._qva: tuple[Floats, Floats, Floats] | None = None
        self._q_of_jacobians: Floats | None = None
        self._qv_of_jacobians: tuple[Floats, Floats] | None = None
        self._of_derivatives: tuple[Floats, ...] | None = None
        self._has_frames = False
        self._bound: Any = None
        self._damped: Any = None

    def _fill_views(self) -> None:
        blocks = self._blocks
        self.oMi: StdVec[SE3] = views(SE3, blocks["oMi"])
        self.oMf: StdVec[SE3] = views(SE3, blocks["oMf"])
        self._lists: dict[str, Any] = {"liMi": views(SE3, blocks["liMi"])}
        self._lists |= {n: views(Motion, blocks[n]) for n in _MOTIONS}
        self._lists |= {n: views(Force, blocks[n]) for n in _FORCES}
        for name in ("com", "vcom", "acom"):
            self._lists[name] = _Masses(list(blocks[name]))
        self.mass: Any = _Masses([0.0] * len(blocks["com"]))
        self._tails = {n: blocks[n][1:] for n in (*_POSES, *_MOTIONS, *_FORCES)}

    @property
    def joints(self) -> StdVec[Any]:
        """For each joint its placement, motion subspace, velocity and bias, at the state of the last algorithm."""
        from pinocchio._joint_data import states

        moves = self._qv is not None and self._q is not None and np.array_equal(self._qv[0], self._q)
        return states(self._model, self._q, self._qv[1] if moves and self._qv else None)

    def copy(self) -> Data:
        """One of its own, with the same numbers."""
        return copy.deepcopy(self)

    def __deepcopy__(self, memo: Any) -> Data:
        for due in list(self._due):
            self.pull(due)
        out = object.__new__(Data)
        kept = {k: v for k, v in self.__dict__.items() if k not in ("_lists", "_tails", "oMi", "oMf", "mass")}
        out.__dict__.update(kept)
        out._blocks = {k: b.copy() for k, b in self._blocks.items()}
        out.hg, out.dhg, out.Ig = self.hg.copy(), self.dhg.copy(), self.Ig.copy()
        out._due = {}
        out._due_of_places = out._fill_places
        out._due_of_motion = dict.fromkeys(self._due_of_motion, out._fill_bodies)
        out._subtrees = {n: out._filler(n) for n in self._subtrees}
        out._fill_views()
        return out

    __copy__ = copy

    def __getstate__(self) -> dict[str, Any]:
        for due in list(self._due):
            self.pull(due)
        told = {name: getattr(self, name) for name in _KEPT}
        return {"model": self._model, "blocks": self._blocks, "mass": list(self.mass), **told}

    def __setstate__(self, state: dict[str, Any]) -> None:
        told = dict(state)
        self.__init__(told.pop("model"))
        self._blocks = told.pop("blocks")
        self._fill_views()
        self.mass = _Masses(told.pop("mass"))
        for name, value in told.items():
            setattr(self, name, value)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Data):
            return NotImplemented
        mine, theirs = self.__getstate__()["blocks"], other.__getstate__()["blocks"]
        same = mine.keys() == theirs.keys() and all(np.array_equal(b, theirs[n]) for n, b in mine.items())
        return same and all(getattr(self, name) == getattr(other, name) for name in _KEPT)

    __hash__ = object.__hash__

    def keep(self, engine: Engine, q: Floats) -> Floats:
        """Remembers what the placements are of; returns a copy of q."""
        self._engine = engine
        self._q = q = q.copy()
        self._due["liMi"] = self._due_of_places
        return q

    def pull(self, name: str) -> None:
        """Computes what was left to be computed until it is asked for."""
        due = self._due.get(name)
        if due is not None:
            due()

    def _filler(self, field: str) -> Callable[[], None]:
        def fill() -> None:
            from pinocchio._masses import fill_subtrees

            fill_subtrees(self._model, self, field)

        return fill

    def _fill_places(self) -> None:
        from pinocchio._kinematics import own_poses

        engine, q = self._engine, self._q
        assert engine is not None and q is not None  # `keep` left this to do
        kernel = engine.made("liMi", lambda m: lambda q: own_poses(m, q), q=q.shape)
        self._tails["liMi"][...] = kernel(q)
        del self._due["liMi"]

    def _fill_bodies(self) -> None:
        from pinocchio._dynamics import bodies

        for name, found in zip(self._due_of_motion, bodies(*self._motion), strict=True):
            if self._due.pop(name, None) is not None:  # else a later algorithm has filled it
                self._tails[name][...] = found

    @property
    def constraint_chol(self) -> Any:
        """The decomposition of mass matrix and constraints of the last constraintDynamics or impulseDynamics."""
        from pinocchio._constraint_cholesky import cholesky_of

        return cholesky_of(self)

    contact_chol = constraint_chol

    def require(self, what: Any, mend: str) -> Any:
        """`what`, a state that an earlier algorithm leaves.

        Raises:
            InputError: it has not been left yet.
        """
        if what is None:
            raise InputError(f"This Data holds nothing to answer from yet. Call {mend} first.")
        return what

    def __repr__(self) -> str:
        return f"<Data of {self._model.name!r}: nv={self._model.nv}, {len(self.oMi)} joints, {self.nframes} frames>"


def _block(name: str) -> property:
    def get(self: Data) -> Floats:
        if self._due:
            self.pull(name)
        return self._blocks[name]

    def put(self: Data, value: Any) -> None:
        self._blocks[name][...] = value

    return property(get, put, doc=f"`{name}` as the last algorithm left it, live; assigning copies into it.")


def _list(name: str) -> property:
    def get(self: Data) -> Any:
        if self._due:
            self.pull(name)
        return self._lists[name]

    return property(get, doc=f"`{name}` of every joint as the last algorithm left it, live references.")


for _name in _MATRICES:
    setattr(Data, _name, _block(_name))
for _name in ("liMi", *_MOTIONS, *_FORCES, "com", "vcom", "acom"):
    setattr(Data, _name, _list(_name))


def engine_for(model: Model, data: Data) -> Engine:
    """The kernels of the model's present numbers, when the Data fits the model.

    Raises:
        InputError: joints were added since the Data was made, or it was made for another robot.
    """
    if data._layout is not model._layout and data._layout != model._layout:
        raise InputError(
            f"This Data was made for a model of {len(data._layout)} joints that are not those of the model, which "
            f"now has {model.njoints}. Make a new one: data = model.createData()."
        )
    return model.engine()


def frames_fit(model: Model, data: Data) -> None:
    """Raises InputError when frames were added since the Data was made."""
    if data.nframes != len(model.frames):
        raise InputError(
            f"This Data was made when the model had {data.nframes} frames; now it has {model.nframes}. "
            "Make a new one: data = model.createData() (robot.rebuildData() for a RobotWrapper)."
        )
