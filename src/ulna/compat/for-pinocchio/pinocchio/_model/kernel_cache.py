"""The compiled kernels of a model: parameters are constants first, and inputs once they keep changing."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

import numpy as np

from pinocchio._containers.arrays import not_applicable
from pinocchio._model.compiled_model import COMPILING, CompiledModel
from pinocchio._model.first_calls import FirstCalls
from pinocchio._model.kernel_parameters import PARAMETERS
from pinocchio._model.live_parameters import LiveParameters
from ulna.compiler.runtime.repeated_calls import forget
from ulna.typing import Array

_MAX_VARIANTS = 3
"""How many states of a model have kernels compiled for them; what differs among more becomes an input of kernels."""

_MAX_STRUCTURES = 32
"""How many kinds of trees have their kernels kept for other models."""
_STRUCTURES: dict[Any, CompiledModel] = {}

Dependence = Literal[
    "structure",
    "placements",
    "inertias",
    "masses",
    "parameters",
    "frame",
    "frames on joints",
    "frames",
]


def parameters_of(on: Dependence) -> Sequence[str]:
    """The names of the parameters, out of `PARAMETERS`, that something depends on, placements at least.

    Args:
        on: What it depends on.

    Returns:
        The names.
    """
    if on == "masses":
        return [name for name in PARAMETERS if name != "gravity"]
    return PARAMETERS if on == "parameters" else ("inertias",) if on == "inertias" else ("placements",)


class KernelCache(LiveParameters):
    """The compiled kernels of a Model."""

    _variants: dict[tuple[bytes, ...], CompiledModel]
    _version: Array
    _with_inputs: CompiledModel | None = None
    _compiled_for: Any = ()
    _newest: CompiledModel | None = None
    _structure: CompiledModel | None = None
    _integrate = _difference = _distance = _normalize = _interpolate = staticmethod(not_applicable)
    _squared_distance = _is_same = _random = _random_within_own_limits = staticmethod(not_applicable)
    _tangent_map = _compact_tangent_map = staticmethod(not_applicable)
    _is_normalized = _is_normalized_within = staticmethod(not_applicable)
    _integrate_derivatives = _difference_derivatives = (not_applicable,) * 3
    """By the first argument, by the second, and by both."""
    _total_mass: Any = staticmethod(not_applicable)
    first_calls: FirstCalls
    """How often its functions were called before they were compiled."""
    _joint_table: Any = None
    """Its `JointTable`, made when first needed."""

    def _changed(self) -> None:
        """Joints were added: kernels compiled before no longer apply, and Data made before do not fit."""
        self._layout = tuple((j.shortname(), j.idx_q, j.idx_v) for j in self.joints)
        self._store_joints()
        self._forget_kernels()
        self._frames_changed()

    def _joint_added(self) -> None:
        """One joint was added at the end; see `_changed`."""
        last = self.joints[-1]
        self._layout = (*self._layout, (last.shortname(), last.idx_q, last.idx_v))
        self._store_last_joint()
        self._forget_kernels()
        self._count_joint()

    def _forget_kernels(self) -> None:
        self._version[0] += 1
        forget(self)
        for name in _OF_KERNELS:
            self.__dict__.pop(name, None)

    def _compiled(self) -> CompiledModel:
        """Ulna's model of the present parameters, and its kernels.

        Kernels are compiled anew when a parameter has changed, but not again and again: then they take it as an input.
        """
        state = tuple(
            b"".join(block.tobytes() for block in self._parameter_blocks(name)) for name in PARAMETERS
        )
        if state == self._compiled_for and self._newest is not None:
            return self._newest
        with COMPILING:
            newest = self._variants.get(state) or self._variant(state)
            self._compiled_for, self._newest = state, newest
        return newest

    def _variant(self, state: tuple[bytes, ...]) -> CompiledModel:
        """The kernels for a state that none are compiled for."""
        general, names = self._with_inputs, ()
        if general is None:
            self._variants = {key: variant for key, variant in self._variants.items() if variant.cache}
            if len(self._variants) < _MAX_VARIANTS:
                variant = self._variants[state] = CompiledModel(self, (), self._newest)
                return variant
            states = [*self._variants, state]
        else:
            names, states = general.parameter_names, [self._compiled_for, state]
        changing = {name for name, *values in zip(PARAMETERS, *states, strict=True) if len({*values}) > 1}
        if general is None or not changing <= {*names}:
            self._variants = {}
            chosen = tuple(name for name in PARAMETERS if name in {*names, *changing})
            general = self._with_inputs = CompiledModel(self, chosen, self._newest)
        return general.with_values(tuple(block.copy() for block in general.live_parameters))

    def _compiled_structure(self) -> CompiledModel:
        """Kernels that depend on the kinds of joints alone; models with the same joints share them."""
        if self._structure is None:
            key = tuple((j.kind, j.idx_q, j.idx_v, j.mimic) for j in list(self.joints)[1:])
            self._structure = _STRUCTURES.pop(key, None) or CompiledModel(self)
            _STRUCTURES[key] = self._structure  # the newest last
            while len(_STRUCTURES) > _MAX_STRUCTURES:
                _STRUCTURES.pop(next(iter(_STRUCTURES)), None)
        return self._structure

    def _watched(self, on: Dependence, frame: Any = None) -> Any:
        """Pairs of an array that kernels depend on and a copy of it.

        Args:
            on: The kinds of joints ("structure"); these and placements, inertias, all parameters but gravity
                ("masses"), or all; the kinds and one frame, or all frames; placements and all frames.
            frame: The index of that one frame.

        Returns:
            Pairs of arrays (...).

        Raises:
            InputError: They depend on gravity, which has an angular part.
        """
        self._check_gravity(on)
        if "frame" in on:
            self._frame_state()
        if on == "structure":
            live: list[Array] = [self._version]
        elif on == "frames on joints":
            live = [self._frame_changes, *self._parameter_blocks("frames")]
        elif on == "frame":
            live = [self._frame_changes, self.frames[frame].placement._m]
        else:
            live = [self._version, *(x for name in parameters_of(on) for x in self._parameter_blocks(name))]
        if on == "parameters":
            live.append(
                self._gravity._v[3:]
            )  # kernels may read the others at every call; these must stay zero
        if on == "frames":
            live += [self._frame_changes, *self._parameter_blocks("frames")]
        return [(block, block.copy()) for block in live]


_BOUND = (
    *(
        "_integrate",
        "_difference",
        "_distance",
        "_normalize",
        "_interpolate",
        "_squared_distance",
        "_is_same",
        "_tangent_map",
        "_compact_tangent_map",
        "_is_normalized",
        "_is_normalized_within",
        "_integrate_derivatives",
        "_difference_derivatives",
    ),
    *("_random", "_random_within_own_limits", "_total_mass"),
)
"""Kernels that are bound to a model when they are first called."""
_OF_KERNELS = (
    *("_variants", "_with_inputs", "_compiled_for", "_newest", "_structure", "_new_neutral", "_joint_table"),
    *_BOUND,
)
"""What belongs to the kernels of a model."""
KernelCache._made_when_needed = LiveParameters._made_when_needed | {
    "_variants": lambda _: {},
    "_version": lambda _: np.zeros(1, np.int64),
    "first_calls": lambda _: FirstCalls(),
}
