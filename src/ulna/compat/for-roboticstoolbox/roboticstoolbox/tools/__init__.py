"""Helpers beside robots: trajectories, servoing, numerical derivatives."""

from __future__ import annotations

from typing import Any

from roboticstoolbox._common.module_aliases import add_module_aliases, name_in

_MODULES = ("null", "p_servo", "Ticker", "numerical", "jsingu", "params", "plot", "trchain")
_NAMES = (
    "TrChainToken", "Ticker", "angle_axis", "angle_axis_python", "ctraj", "hessian_numerical", "jacobian_numerical",
    "jsingu", "jtraj", "mstraj", "mtraj", "null", "p_servo", "quintic", "quintic_func", "rtb_get_param",
    "rtb_load_data", "rtb_load_jsonfile", "rtb_load_matfile", "rtb_path_to_datafile", "rtb_set_param", "trapezoidal",
    "trapezoidal_func", "trchain", "trchain2", "xplot",
)  # fmt: skip
__all__ = list(_NAMES)
add_module_aliases(__name__, _MODULES)


def __getattr__(name: str) -> Any:
    return name_in(__name__, name)
