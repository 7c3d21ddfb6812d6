"""Results of identification: parameters, residuals, a report, a picture."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ulna.errors import ModelWarning, needed
from ulna.identification.identifiable_parameters import BaseParameters
from ulna.model import Model, with_dynamic_parameters, with_joint_dynamics
from ulna.system.callers import level_of_caller
from ulna.system.figures import displayed
from ulna.system.storage import save_figure
from ulna.typing import Floats

_WORST_CONDITION = 1e5  # of a log whose fit a report does not doubt


_CONSTANT = (
    1e-12  # what part of the mean square the variance of a torque is at most that varies by rounding only
)


def explained_part(rms: Floats, variance: Floats, mean_square: Floats) -> Floats:
    """What part of the variance of torques a fit explains; a constant torque varies from zero.

    Args:
        rms: Root mean square of the residuals of each joint, (nv,) [N m, N].
        variance: Variance of its torque, (nv,) [(N m)^2, N^2].
        mean_square: Mean of its squared torque, (nv,) [(N m)^2, N^2].

    Returns:
        Parts, (nv,) [-]; at most 1.
    """
    total = np.where(variance > _CONSTANT * mean_square, variance, mean_square)
    return 1.0 - rms**2 / np.where(total > 0.0, total, np.inf)


@dataclass(frozen=True, eq=False, repr=False)
class FittedParameters:
    """The parameters that explain a log best, without the log.

    Attributes:
        model: The model that was started from.
        parameters: Dynamic parameters, ten a body, (10 nbodies,) [kg, kg m, kg m^2].
        armature: Inertia of the drives, (nv,) [kg m^2, kg]; the model's where it was not sought.
        damping: Viscous friction, (nv,) [N m s/rad, N s/m]; likewise.
        friction: Coulomb friction, (nv,) [N m, N]; likewise.
        physical: Whether the bodies are such as can exist.
        base: What the log distinguishes of all that was sought.
        base_values: Those base parameters, (b,).
        base_deviations: Their standard deviations, if the residuals are independent noise, (b,).
        condition: Condition number of the base regressor, its columns made equally long: below 100 is good, and
            far above it the log moves the robot too little or too much alike.
        iterations: Steps of the solver; 1 for the linear one.
    """

    model: Model
    parameters: Floats
    armature: Floats
    damping: Floats
    friction: Floats
    physical: bool
    base: BaseParameters
    base_values: Floats
    base_deviations: Floats
    condition: float
    iterations: int

    @property
    def new_model(self) -> Model:
        """The model with the new parameters. Drives have no negative ones: zeros take their place, with a warning.

        Raises:
            ModelError: a body cannot exist; identify with `physical=True`.
        """
        bodies = with_dynamic_parameters(self.model, self.parameters)
        found = {name: getattr(self, name) for name in ("armature", "damping", "friction")}
        self._warn_of_negatives(found)
        return with_joint_dynamics(
            bodies, **{name: np.maximum(values, 0.0) for name, values in found.items()}
        )

    def _warn_of_negatives(self, drives: dict[str, Floats]) -> None:
        """Warns (ModelWarning) where parameters of drives are negative, beyond rounding."""
        rows = [
            f"{name} of {self.model.velocity_names[k]} ({values[k]:.3g})"
            for name, values in drives.items()
            for k in np.flatnonzero(values < -1e-9 * np.abs(values).max(initial=0.0))
        ]
        if rows:
            warnings.warn(
                f"Zeros take the place of negative parameters that were found: {', '.join(rows)}. So torques of the "
                "new model are not those of the fit. Identify with physical=True, which finds drives that can exist.",
                ModelWarning,
                stacklevel=level_of_caller(),
            )

    def _heading(self, samples: str) -> list[str]:
        """The first lines of a report: what was sought, and how well the log determines it."""
        kind = "physically consistent" if self.physical else "linear"
        deviations = self.base_deviations / np.maximum(np.abs(self.base_values), 1e-12)
        sure = int((deviations < 0.1).sum())
        return [
            f"Identification of {self.model.name!r}: {kind} least squares, {samples}",
            f"  {self.base.count} base parameters of {len(self.base.names)} sought, "
            f"condition {self.condition:.3g}; {sure} known to better than 10 %",
            "",
            *self._condition_warning(sure),
        ]

    def _condition_warning(self, sure: int) -> list[str]:
        """A warning where the log does not determine the parameters, however well they explain it."""
        if self.condition <= _WORST_CONDITION and (sure or not len(self.base_values)):
            return []
        return [
            "  WARNING: the log hardly determines these parameters (a condition below 100 is good). Torques of other",
            "  motions may be far off: record more motion, leave out fewer rows, or seek fewer parameters.",
        ]


@dataclass(frozen=True, eq=False, repr=False)
class Identification(FittedParameters):
    """The parameters that explain a log best, with its torques; the other attributes are those of `FittedParameters`.

    Attributes:
        measured: Torques of the log, (rows, nv) [N m, N].
        fitted: Torques by the new parameters, (rows, nv) [N m, N].
        before: Torques by the model that was started from, (rows, nv) [N m, N].
        unmoved: Names of the joints that did not move in the log: root mean square of the velocity below `width`, the
            velocity within which Coulomb friction passes through zero.
    """

    measured: Floats
    fitted: Floats
    before: Floats
    unmoved: tuple[str, ...] = ()

    @property
    def residuals(self) -> Floats:
        """Measured less fitted torques, (rows, nv) [N m, N]."""
        return self.measured - self.fitted

    @property
    def rms(self) -> Floats:
        """Root mean square of the residuals of each joint, (nv,) [N m, N]."""
        return np.sqrt((self.residuals**2).mean(axis=0))

    @property
    def rms_before(self) -> Floats:
        """The same with the parameters of the model that was started from, (nv,) [N m, N]."""
        return np.sqrt(((self.measured - self.before) ** 2).mean(axis=0))

    @property
    def explained(self) -> Floats:
        """What part of each joint's variance of torque the fit explains, (nv,); at most 1."""
        return explained_part(self.rms, self.measured.var(axis=0), (self.measured**2).mean(axis=0))

    def report(self) -> str:
        """The residuals joint by joint, and how well the log determines the parameters, as text."""
        rows, nv = self.measured.shape
        lines = [
            *self._heading(f"{rows} samples, {nv} joints"),
            f"  {'joint':24s} {'rms before':>12s} {'rms after':>12s} {'max after':>12s} {'explained':>10s}",
        ]
        greatest = np.abs(self.residuals).max(axis=0)
        for k, name in enumerate(self.model.velocity_names):
            lines.append(
                f"  {name:24s} {self.rms_before[k]:12.4g} {self.rms[k]:12.4g} {greatest[k]:12.4g} "
                f"{100 * self.explained[k]:9.2f}%"
            )
        lines += self._drive_table()
        if self.unmoved:
            lines += ["", f"  not moved in this log: {', '.join(self.unmoved)}"]
            lines.append("  (their friction and armature cannot be found from it)")
        return "\n".join(lines)

    def _drive_table(self) -> list[str]:
        """A table of the drives, where any number of them was sought."""
        if not any(name.startswith(("armature(", "damping(", "friction(")) for name in self.base.names):
            return []
        lines = ["", f"  {'joint':24s} {'armature':>12s} {'damping':>12s} {'friction':>12s}"]
        numbers = zip(self.model.velocity_names, self.armature, self.damping, self.friction, strict=True)
        return lines + [f"  {name:24s} {a:12.4g} {b:12.4g} {c:12.4g}" for name, a, b, c in numbers]

    def plot(self, path: str | Path | None = None, t: Any = None) -> Any:
        """Measured and fitted torques with residuals, joint by joint.

        Args:
            path: Where to save the picture (.png, .svg, .pdf); None only makes it.
            t: Times of the samples, (rows,) [s]; None numbers them.

        Returns:
            A `matplotlib.figure.Figure`.

        Raises:
            MissingExtra: Matplotlib is not installed.
        """
        with needed("matplotlib", "plot", "Plotting an identification"):
            from matplotlib.figure import Figure
        rows, nv = self.measured.shape
        x = np.arange(rows) if t is None else np.asarray(t, dtype=float)
        figure = displayed(Figure(figsize=(9.0, 1.6 * nv + 0.6), layout="constrained"))
        panels = figure.subplots(nv, 1, sharex=True, squeeze=False)[:, 0]
        for k, (panel, name) in enumerate(zip(panels, self.model.velocity_names, strict=True)):
            panel.plot(x, self.measured[:, k], color="0.6", linewidth=2.0, label="measured")
            panel.plot(x, self.fitted[:, k], color="tab:blue", linewidth=1.0, label="fitted")
            panel.plot(x, self.residuals[:, k], color="tab:red", linewidth=0.8, label="residual")
            panel.set_ylabel(name, rotation=0, ha="right")
            panel.grid(alpha=0.3)
        panels[0].legend(loc="upper right", ncols=3, fontsize="small")
        panels[0].set_title(f"Torques of {self.model.name} [N m, N]")
        panels[-1].set_xlabel("sample" if t is None else "time [s]")
        if path is not None:
            save_figure(figure, path)
        return figure

    def __repr__(self) -> str:
        return f"<identification of {self.model.name!r}: rms {np.sqrt((self.residuals**2).mean()):.4g}>"
