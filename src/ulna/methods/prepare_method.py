"""`robot.prepare`: kernels compiled before they are needed."""

from __future__ import annotations

import pickle
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, final

import numpy as np

from ulna.algorithms.multibody.references import check_reference
from ulna.checks.values import short_repr
from ulna.data_classes import dataclass
from ulna.errors import InputError, UnknownName
from ulna.methods.ik import InverseKinematics
from ulna.model import Model
from ulna.quantities import QUANTITIES
from ulna.quantities.part import frozen
from ulna.version import __version__

if TYPE_CHECKING:
    from ulna.methods.background_compilation import Preparation

DAILY = (
    "fk", "jacobian", "ik", "inverse_dynamics", "forward_dynamics", "mass_matrix", "bias_forces", "gravity_forces",
)  # fmt: skip
"""What is prepared where nothing is named: what people use daily."""


class Preparing(InverseKinematics):
    """Kernels compiled ahead."""

    __slots__ = ()

    def prepare(self, *names: str, workers: int | None = None, **options: Any) -> Preparation:
        """Compiles kernels in the background, in parallel, so that first calls do not wait.

        What methods use is prepared: the single call and the batch, both in float64. Processes beside this one compile
        and store the code in the disk cache; this one then loads it. Where the cache is off, a thread compiles.

        Args:
            *names: Names of quantities (`docs/quantities.md`), and "ik"; those that are used daily where there is none.
            workers: How many processes compile; None for one on each processor, 0 for a thread of this process.
            **options: Options of the quantities, such as `frame`, for those that have them.

        Returns:
            A `Preparation`, with `wait(timeout)`, `done`, `pending`, `errors` and `cancel()`. Nobody has to wait: what
            is not there yet is compiled when it is used. Named kernels that cannot be compiled raise from `wait`.

        Raises:
            UnknownName: If there is no such kernel, frame or option; names the nearest.
            InputError: If `workers` is no whole number, 0 or more, or a name is no string.

        Example:
            >>> robot = ulna.load("panda")
            >>> robot.prepare("fk", "jacobian", frame="panda_hand").wait()
            True
        """
        from ulna import disk_cache
        from ulna.methods.background_compilation import Preparation  # with subprocesses, for few

        if workers is not None and (not isinstance(workers, (int, np.integer)) or workers < 0):
            raise InputError(f"`workers` is {workers!r}; expected a whole number, 0 or more, or None.")
        for name in names:
            if not isinstance(name, str):
                raise InputError(
                    f"`names` holds {short_repr(name)}; expected names one after the other, as in "
                    'robot.prepare("fk", "jacobian").'
                )
        chosen = tuple(dict.fromkeys(names or DAILY))
        for name in chosen:
            if name not in ("ik", *QUANTITIES):
                raise UnknownName(
                    "kernel", name, ("ik", *QUANTITIES), "robot.prepare takes names of quantities."
                )
        known = {key for name in chosen for key in _options_of(name)}
        for key in options:
            if key not in known:
                raise UnknownName(f"option of {', '.join(chosen)}", key, known)
        from ulna.system.processors import processor_count  # here, for few programs need it

        _check(self.model, options)
        text = repr(sorted(options.items(), key=str))
        marks = {n: disk_cache.key("prepared", self.model.fingerprint, n, text, __version__) for n in chosen}
        make, count = _Maker(self, options), processor_count() if workers is None else int(workers)
        return Preparation(marks, make, pickle.dumps(make), count, bool(names))


@final
@dataclass(frozen=True)
class _Maker:
    """Makes what the methods of a robot use."""

    robot: Preparing
    options: Mapping[str, Any]

    def __call__(self, name: str) -> None:
        options = {key: value for key, value in self.options.items() if key in _options_of(name)}
        if name == "ik":
            _solve(self.robot, **options)
            return
        values = [options.get(key, default) for key, default in QUANTITIES[name].options.items()]
        kernel = self.robot._kernel(name, *values)
        neutral = self.robot.model.neutral
        ports = kernel._array_call.function.inputs
        arrays = [neutral if port.name in ("q", "q0", "q1") else np.zeros(port.shape) for port in ports]
        kernel(*arrays)
        kernel(
            *(np.stack([array, array]) for array in arrays)
        )  # the loop over a batch is compiled when first used


def _options_of(name: str) -> Iterable[str]:
    return ("frame",) if name == "ik" else QUANTITIES[name].options


def _check(model: Model, options: Mapping[str, Any]) -> None:
    """Refuses frames and references that do not exist now, instead of later in another thread."""
    frames = options.get("frame")
    for frame in [frames] if isinstance(frames, str) and frames != "all" else frozen(frames) or ():
        model.frame(frame)
    if "reference" in options:
        check_reference(options["reference"])


def _solve(robot: Preparing, frame: Any = None) -> None:
    """Inverse kinematics of one goal and of a batch, which compiles what they need."""
    q = robot.model.neutral
    T = robot._kernel("fk", frame)(q)
    robot.ik(T, q, frame, attempts=1)
    robot.ik(T, None, frame, attempts=1)
    robot.ik(np.stack([T] * 16), None, frame, attempts=1)
