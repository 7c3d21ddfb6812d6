"""Data is frozen: every data class of the library, but for those listed here, refuses assignments."""

from __future__ import annotations

import ast
from pathlib import Path

import ulna

SOURCE = Path(ulna.__file__).parents[1]  # what is imported: also where a copy of the sources is tried
CHANGING = {
    "compiler/codegen/node_writer.py: Module",
    "compiler/language/methods/drawing.py: _Box",
    "compat/for-pinocchio/pinocchio/_geometry/materials.py: GeometryNoMaterial",  # as Pinocchio has it
    "compat/for-roboticstoolbox/roboticstoolbox/_ets/ik_solution.py: IKSolution",  # as the toolbox has it
    "model/records.py: BuilderState",
    "system/forks.py: _Fork",
    "viewer/page/viser_nodes.py: ViserNode",
}


def data_classes() -> dict[str, bool]:
    """Whether each data class is frozen, by file and name."""
    found = {}
    for path in sorted(SOURCE.rglob("*.py")):
        text = path.read_text(encoding="utf-8")
        for node in ast.walk(ast.parse(text)) if "dataclass" in text else ():
            for decorator in node.decorator_list if isinstance(node, ast.ClassDef) else ():
                if ast.unparse(decorator).split("(")[0] in ("dataclass", "dataclasses.dataclass"):
                    keywords = decorator.keywords if isinstance(decorator, ast.Call) else []
                    frozen = any(k.arg == "frozen" and ast.unparse(k.value) == "True" for k in keywords)
                    found[f"{path.relative_to(SOURCE / 'ulna').as_posix()}: {node.name}"] = frozen
    return found


def test_data_classes_are_frozen() -> None:
    found = data_classes()
    assert len(found) > 150
    assert {name for name, frozen in found.items() if not frozen} == CHANGING
