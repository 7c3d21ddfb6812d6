"""The record of an algorithm whose results lie in a Data: its inputs, its kernel, and the fields it fills."""

from __future__ import annotations

from collections.abc import Callable, Container, Mapping
from dataclasses import dataclass, field
from typing import Any, final

from pinocchio._model.kernel_cache import Dependence

STATES = {
    "placements": "q",
    "joints": "q",
    "joint_velocities": "qv",
    "velocities": "qv",
    "accelerations": "qva",
    "jacobians": "q",
    "jacobian_rates": "qv",
    "derivatives": "qva",
    "forward_dynamics": "qva",
    "articulated": "q",
    "centers": "q",
    "center_velocities": "qv",
    "center_jacobian": "q",
    "center_columns": "q",
    "momenta": "qv",
    "accelerations_with_gravity": "qva",
}
"""The states that results in a Data belong to, with a letter for each array.

They are those of `oMi`, of `liMi` and `Data.joints`, of the velocities there, of `v`, of `a`, of `J`, of `dJ`, of
derivatives of inverse dynamics, of the last forward dynamics, whose accelerations are computed ones, of the articulated
inertias that inverted the mass matrix last, of `com` and `vcom` of subtrees when they were read, of `Jcom`, of
`dFdq` and the like where they are about the centre of mass (else nan), and of `oh` and `oa_gf` when they were read.
"""
STATES_READ = (
    ("velocities", "v"),
    ("accelerations", "a"),
    ("centers", "com"),
    ("center_velocities", "vcom"),
    ("momenta", "oh"),
    ("accelerations_with_gravity", "oa_gf"),
)
"""States, and the field that each is of from when the field is computed, nan where it depends on less."""
_STATE_OF = {
    "oMi": "placements",
    "v": "velocities",
    "a": "accelerations",
    "J": "jacobians",
    "dJ": "jacobian_rates",
    "Jcom": "center_jacobian",
}
"""The state that is stored with a field."""
PARAMETER_NAMES = {"q": "q", "v": "v", "a": "a", "t": "tau"}
"""The names of arguments by their letters in `Algorithm.inputs`."""
ALGORITHMS: list[Algorithm] = []
"""All of them; a field of a Data is marked with the number of the one that left it, the first being 1."""


@final
@dataclass(frozen=True, eq=False)
class Deferred:
    """How fields are computed when they are read.

    Attributes:
        inputs: A letter for each input: q, v, a, and at the end f for forces on the joints.
        fill: Called with a Data, compiled kernels, the names of the fields to fill, and the inputs.
        bind: Called with the same and the number of the algorithm: makes a kernel without arguments that fills them and
            their marks, and answers NotImplemented where not all of them were left by that algorithm; None for none.
    """

    inputs: str
    fill: Callable[..., None]
    bind: Callable[..., Any] | None = None


@final
@dataclass(frozen=True, eq=False)
class Algorithm:
    """An algorithm whose results lie in a Data.

    Attributes:
        name: Its name, an attribute of `BoundAlgorithms`.
        inputs: A letter for each input: q, v, a, t (torques), and at the end f (a force for every joint).
        fills: The arrays of a Data that its outputs are written into; see `FieldStates._target`.
        kernel: Makes of Ulna's model (and its frames, where `depends_on` says so) a function of the inputs.
        returns: The indices of the outputs that a call returns, as copies.
        depends_on: What its results depend on; see `KernelCache._watched`.
        deferred: Fields that are computed when read, of its inputs (or of what it writes to `<name> a`).
        invalidates: Fields that hold an intermediate result after it in Pinocchio, and nothing here.
        states: Names of states that its inputs, or what it fills, are stored as, besides those of the fields it fills.
        title: The name of the public function.
        number: What marks the fields that it left.
    """

    name: str
    inputs: str
    fills: tuple[str, ...]
    kernel: Callable[..., Any]
    returns: tuple[int, ...] = ()
    depends_on: Dependence = "parameters"
    deferred: Mapping[str, Deferred] = field(default_factory=dict)
    invalidates: tuple[str, ...] = ()
    states: tuple[str, ...] = ()
    title: str = ""
    number: int = field(init=False)

    def __post_init__(self) -> None:
        ALGORITHMS.append(self)
        object.__setattr__(self, "number", len(ALGORITHMS))

    def stored_inputs(self) -> dict[str, str]:
        """Which input is stored under which name, for states, and for fields that are computed when they are read."""
        needed = {letter for deferred in self.deferred.values() for letter in deferred.inputs}
        stored = {f"{self.name} {letter}": letter for letter in self.inputs if letter in needed}
        states = [*self.states, *(_STATE_OF[name] for name in self.fills if name in _STATE_OF)]
        if "liMi" in self.deferred:
            states.append("joints")
            if "v" in self.inputs and {"v", "ov"} & {*self.deferred, *self.fills}:
                states.append("joint_velocities")
        parts = {f"{state} {letter}": letter for state in states for letter in STATES[state]}
        return stored | {name: letter for name, letter in parts.items() if name not in self.fills}

    def has_fields_in(self, names: Container[str]) -> bool:
        """Whether all that it fills is among some fields, or is a state that it stores."""
        return all(name in names or (" " in name and name[-2] == " ") for name in self.fills)

    def known_states(self) -> set[str]:
        """The names of the states that it stores."""
        return {name.split()[0] for name in (*self.fills, *self.stored_inputs()) if " " in name}
