"""Which models have accelerations: what inverts the mass matrix refuses or warns of the others, by name."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable
from functools import lru_cache, wraps
from typing import Any, NamedTuple

import numpy as np

from ulna.algorithms.dynamics import conditioning
from ulna.algorithms.dynamics.conditioning import Conditioning
from ulna.algorithms.dynamics.pivots import ZeroPivot, conditioning_by_pivots
from ulna.errors import ModelError, ModelWarning
from ulna.model import Model
from ulna.numeric import is_symbolic
from ulna.quantities.deferred_algorithms import algorithms
from ulna.typing import Floats

MASS_PARAMETERS = frozenset({"placement", "shift", "offset", "inertia", "armature"})
"""Parameters of a model (see `ulna.model.parameters`) that the inverse of its mass matrix depends on."""
_MIN_DIGITS = {"float64": 4, "float32": 2}
"""Decimal digits of accelerations below which a warning is due."""


def with_mass(build: Callable[..., Callable[..., Any]]) -> Callable[..., Callable[..., Any]]:
    """A function of a model that divides by the inertia each joint moves, and refuses models where one moves none.

    `build(model, **options)` returns the function of arrays, and so does what is returned.

    Raises:
        ModelError: If a joint, or a motion of several, moves no inertia and its drives have none; names such joints.
    """

    @wraps(build)
    def checked(model: Model, *args: Any, **options: Any) -> Callable[..., Any]:
        check_mass(model)
        function = build(model, *args, **options)

        def run(*arrays: Any) -> Any:
            try:
                return function(*arrays)
            except ZeroPivot as error:
                raise _no_inertia_error(model, [error.index]) from None

        return run

    return checked


def check_mass(model: Model, dtype: str = "float64") -> None:
    """Refuses a model some motion of which moves no inertia, and warns once of one that is close to that.

    Args:
        model: The model. Where it is large, single joints are examined; where what the mass matrix depends on is
            traced, only masses.
        dtype: The type to compute in, "float64" or "float32".

    Raises:
        ModelError: If a motion moves no inertia; names the joints.
    """
    masses = [inertia.mass for inertia in model.inertias]
    if is_symbolic(*masses, model.armature):  # given when the kernel is called
        return
    idle = _joints_without_mass(model, masses)
    if idle:
        raise _no_inertia_error(model, idle)
    if _is_known(model):
        report = _worst(model) if model.nv <= conditioning.LARGEST else _by_pivots(model)
        if report.everywhere.loose:
            raise _no_inertia_error(model, report.everywhere.loose)
        _warn(model, report, dtype)


def _is_known(model: Model) -> bool:
    """Whether no parameter of the model is traced."""
    try:
        return bool(model.fingerprint)
    except TypeError:  # TraceError, too
        return False


class _Conditioning(NamedTuple):
    everywhere: Conditioning
    """Where every joint is at a generic position."""
    worst: Conditioning
    place: str
    """At which configuration that is."""


@lru_cache(maxsize=32)
def _worst(model: Model) -> _Conditioning:
    """The conditioning at the neutral, the named, and a generic configuration."""
    generic = conditioning.conditioning(model, _generic_configuration(model))
    candidates = [(generic, "")]
    if not generic.loose:
        places = {"the neutral configuration": model.neutral}
        places |= {f"the configuration {name!r}": q for name, q in list(model.configurations.items())[:8]}
        candidates += [(conditioning.conditioning(model, q), f" at {place}") for place, q in places.items()]
    worst, place = max(candidates, key=lambda pair: pair[0].kappa)
    return _Conditioning(generic, worst, "" if worst.kappa < 100.0 * generic.kappa else place)


@lru_cache(maxsize=32)
def _by_pivots(model: Model) -> _Conditioning:
    """The conditioning of a large model at a generic configuration, estimated from its pivots."""
    estimate = conditioning_by_pivots(model, _generic_configuration(model))
    return _Conditioning(estimate, estimate, "")


def _generic_configuration(model: Model) -> Floats:
    """A configuration (nq,) [rad, m] off the neutral one, each joint by another number from -1 to 1.

    These are no random numbers, since `numpy.random` takes 10 ms to import.
    """
    return algorithms.integrate(model, model.neutral, np.cos(np.arange(1.0, model.nv + 1.0) ** 2))


_warned: set[tuple[str, str]] = set()


def _warn(model: Model, report: _Conditioning, dtype: str) -> None:
    digits = -np.log10(np.finfo(dtype).eps) - np.log10(report.worst.kappa)
    if digits >= _MIN_DIGITS[dtype] or (model.fingerprint, dtype) in _warned:
        return
    _warned.add((model.fingerprint, dtype))
    named = _listed(model, report.worst.weak)
    size = (
        f"has the condition number {report.worst.kappa:.1e}" if report.worst.kappa < np.inf else "is singular"
    )
    accuracy = (
        f"about {digits:.0f} digits of them are right" if digits >= 1.0 else "none of their digits are right"
    )
    better = ", compute in float64" if dtype == "float32" else ""
    warnings.warn(
        f"The mass matrix of {model.name!r} {size}{report.place}: {named} can move almost without inertia. "
        f"Accelerations, its inverse and derivatives are computed, but there {accuracy} in {dtype}. Give their links "
        f"inertia, give them armature (robot.with_parameters({{'armature': ...}})), lock them (robot.lock([{named}]))"
        f"{better}; robot.mass_matrix and robot.inverse_dynamics are not affected.",
        ModelWarning,
        stacklevel=2,
    )


def _no_inertia_error(model: Model, entries: Iterable[int]) -> ModelError:
    entries = list(entries)
    named = _listed(model, entries)
    loose = [joint for joint in model.joints if joint.mimic is None and joint.name in _names(model, entries)]
    masses = [inertia.mass for inertia in model.inertias]
    has_mass = not is_symbolic(*masses) and any(masses[i] for joint in loose for i in _moved(model, joint))
    if not has_mass:
        cause = "nothing they move has mass, and their drives have no armature"
    elif len(loose) == 1 and loose[0].nv == 1:
        cause = (
            "what it moves has mass but no inertia about its axis (the centre of mass is on the axis, and the "
            "rotational inertia about it is zero), and its drive has no armature"
        )
    else:
        cause = (
            "what is moved has mass, but some motion of all together, or of one alone, meets no inertia (point masses "
            "on the axes, or joints on one axis with nothing between them), and the drives have no armature"
        )
    return ModelError(
        f"Forces would accelerate {named} of {model.name!r} without bound: {cause}. Lock them (robot.lock([{named}])), "
        "give their links inertia, or give them armature (robot.with_parameters({'armature': ...}))."
    )


def _names(model: Model, entries: Iterable[int]) -> list[str]:
    wanted = set(entries)
    return [
        joint.name
        for joint in model.joints
        if joint.mimic is None and wanted & set(range(joint.idx_v, joint.idx_v + joint.nv))
    ]


def _listed(model: Model, entries: Iterable[int]) -> str:
    return ", ".join(map(repr, _names(model, entries)))


def _moved(model: Model, joint: Any) -> set[int]:
    """The bodies that a joint and its followers move."""
    movers = [k for k, j in enumerate(model.joints) if j.idx_v == joint.idx_v]
    return {i for k in movers for i in model.subtree(k)}


def _joints_without_mass(model: Model, masses: list[Any]) -> list[int]:
    """Entries of v that move neither mass nor inertia and have no armature."""
    has_mass = [
        bool(mass) or bool(body.inertia.any()) for mass, body in zip(masses, model.inertias, strict=True)
    ]
    for i in reversed(range(len(has_mass))):
        parent = model.joints[i].parent
        if parent >= 0:
            has_mass[parent] = has_mass[parent] or has_mass[i]
    has_inertia = np.asarray(model.armature) != 0.0
    for joint, carries in zip(model.joints, has_mass, strict=True):
        has_inertia[joint.idx_v : joint.idx_v + joint.kind.nv] |= carries
    idle = []
    for joint in (j for j in model.joints if j.mimic is None):
        entries = range(joint.idx_v, joint.idx_v + joint.nv)
        if entries and not any(has_inertia[k] for k in entries):
            idle.append(joint.idx_v)
    return idle
