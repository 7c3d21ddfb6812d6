"""Ulna compiles your robot: kinematics of articulated robots, traced from the textbook into machine code.

>>> import ulna
>>> robot = ulna.load("panda")
>>> T = robot.fk(robot.configurations["qr"])
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from ulna import errors as errors
from ulna import numeric as numeric
from ulna.idioms import unknown_attribute
from ulna.loading import load as load
from ulna.loading import load_model as load_model
from ulna.methods.pages import register_page_writer as _register_page_writer
from ulna.model import Model as Model
from ulna.model import ModelBuilder as ModelBuilder
from ulna.robot import Robot as Robot
from ulna.robot import compile as compile
from ulna.robot import set_notebook_display
from ulna.spatial import SE3 as SE3
from ulna.spatial import SO3 as SO3
from ulna.spatial import Force as Force
from ulna.spatial import Inertia as Inertia
from ulna.spatial import Motion as Motion
from ulna.system import process_end as _process_end  # noqa: F401  it registers before programs do
from ulna.version import __version__ as __version__

if TYPE_CHECKING:
    from ulna.control import p_servo as p_servo
    from ulna.exporting import export as export
    from ulna.sim import Simulation as Simulation
    from ulna.viewer.show import show as show
    from ulna.viewer.viewer import Viewer as Viewer

_LATER = {
    "export": "ulna.exporting",
    "p_servo": "ulna.control",
    "show": "ulna.viewer.show",
    "Simulation": "ulna.sim",
    "Viewer": "ulna.viewer.viewer",
}
"""The packages of names that are imported when first used, so that `import ulna` stays light."""

_PACKAGES = (
    "collision",
    "compat",
    "control",
    "diagnosis",
    "exporting",
    "identification",
    "ik",
    "interop",
    "planning",
    "scale",
    "sim",
    "trajectory",
    "viewer",
)
"""Packages that `ulna.NAME` imports when first used."""

_FORMER_PACKAGES = ("faces",)
"""The same under former names."""

_OWN = ("disk_cache",)
"""What our own files import from here; without it, each would look for similar names first."""

__all__ = [
    "SE3",
    "SO3",
    "Force",
    "Inertia",
    "Model",
    "ModelBuilder",
    "Motion",
    "Robot",
    "Simulation",
    "Viewer",
    "__version__",
    "compile",
    "errors",
    "export",
    "load",
    "load_model",
    "numeric",
    "p_servo",
    "show",
]


def _robot_html(robot: Robot) -> str:
    return importlib.import_module("ulna.viewer.notebook").robot_html(robot)


set_notebook_display(_robot_html)


def _write_page(*arguments: Any, **options: Any) -> Any:
    return importlib.import_module("ulna.viewer.live").save_html(*arguments, **options)


_register_page_writer(_write_page)


def __getattr__(name: str) -> Any:
    if name in _LATER:
        return getattr(importlib.import_module(_LATER[name]), name)
    if name in _PACKAGES or name in _FORMER_PACKAGES or name in _OWN:
        return importlib.import_module(f"ulna.{name}")
    raise unknown_attribute("module ulna", name, __dir__())


def __dir__() -> list[str]:
    return [*__all__, *_PACKAGES]
