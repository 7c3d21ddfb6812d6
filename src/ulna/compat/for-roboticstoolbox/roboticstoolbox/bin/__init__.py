"""The console tools of the Toolbox, by the names of their modules."""

from __future__ import annotations

from roboticstoolbox._common.module_aliases import add_module_aliases

add_module_aliases(__name__, ())
