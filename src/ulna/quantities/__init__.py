"""Quantities of a robot, each declared once, by theme; `QUANTITIES` is the table of them by the names of kernels."""

from __future__ import annotations

from ulna.quantities.centroidal import Centroidal
from ulna.quantities.configurations import Configurations, ConfigurationSpace
from ulna.quantities.constrained_dynamics import Constraints
from ulna.quantities.derivatives import Derivatives
from ulna.quantities.dynamics import Dynamics
from ulna.quantities.kinematics import Kinematics
from ulna.quantities.operational_space import OperationalSpace
from ulna.quantities.quantity import Quantity
from ulna.quantities.regressors import Regressors

THEMES = (
    Kinematics,
    Configurations,
    ConfigurationSpace,
    Dynamics,
    Centroidal,
    OperationalSpace,
    Constraints,
    Derivatives,
    Regressors,
)
"""The classes that declare quantities."""

QUANTITIES: dict[str, Quantity] = {
    method.quantity.name: method.quantity
    for theme in THEMES
    for method in vars(theme).values()
    if hasattr(method, "quantity")
}
"""Every quantity of a robot, by the name of its kernel."""

__all__ = ["QUANTITIES", "THEMES", "Quantity"]
