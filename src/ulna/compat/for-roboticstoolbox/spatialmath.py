"""spatialmath itself, the package of Corke and others, imported without waiting for SciPy, SymPy and matplotlib.

It needs them for splines, symbols and polygons; importing them takes ten times as long as the rest of it.
"""

import importlib.util
import sys
from importlib.machinery import ModuleSpec, PathFinder
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ulna.compat.deferred_imports import deferred_imports

_HEAVY = {
    "sympy": ("Expr", "Symbol", "Matrix"),
    "scipy": (),
    "scipy.interpolate": ("BSpline", "CubicSpline", "interp1d"),
    "scipy.spatial.transform": ("Rotation", "RotationSpline"),
    "matplotlib.path": ("Path",),
    "matplotlib.patches": ("PathPatch",),
    "matplotlib.transforms": ("Affine2D",),
}

if TYPE_CHECKING:

    def __getattr__(name: str) -> Any: ...


def _installed() -> ModuleSpec | None:
    """Where the package is: the next on the path after this file."""
    folder = Path(__file__).resolve().parent
    places = [place for place in sys.path if Path(place or ".").resolve() != folder]
    finders: list[Any] = list(sys.meta_path)
    spec = (f.find_spec(__name__, places if f is PathFinder else None) for f in finders)
    return next((spec for spec in spec if spec is not None and spec.origin != __file__), None)


_spec = _installed()
if _spec is None or _spec.loader is None:
    from ulna.extras import install_command

    raise ModuleNotFoundError(
        f"spatialmath is not installed; it comes with: {install_command('toolbox', 'spatialmath-python')}",
        name=__name__,
    )
_itself = importlib.util.module_from_spec(_spec)
sys.modules[__name__] = _itself  # what `import spatialmath` gives
with deferred_imports(_HEAVY):
    _spec.loader.exec_module(_itself)
