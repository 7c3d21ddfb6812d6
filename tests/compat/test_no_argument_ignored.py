"""No argument that a public function of a compatibility package accepts is ignored: its body uses each parameter."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

from ulna.compat.packages import FOLDERS

UNUSED = {
    # Parameters that cannot change a result, by the reason.
    "what is discarded does not depend on it": {"Dynamics.dynchanged what"},
    "the Toolbox's method ignores it, too": {"DHRobot.fkine_path old", "DHRobot.fkine_all old"},
    "links are always where the robot's q puts them": {"LinkNode.closest_point skip", "LinkNode.iscollided skip"},
    "joints are numbered by branches in any case": {"BaseRobot.__init__ check_jindex"},
    "nothing is printed while a file is read": {"* verbose"},
    "pictures are Ulna's; ellipsoids are drawn by what they are passed to": {
        "Ellipsoids.vellipse add", "Ellipsoids.fellipse add",
        *(
            f"Ellipsoids.{method} {option}"
            for method in ("plot_ellipse", "plot_vellipse", "plot_fellipse")
            for option in ("jointaxes", "eeframe", "shadow", "name")
        ),
    },
    "a handle knows its chain and how many joints that has": {
        "ETS_init n", "ETS_init m", "ETS_jacob0 _n", "ETS_jacobe _n", "ETS_hessian0 _n", "ETS_hessiane _n",
    },
    "a pose has no settings": {"ET.SE3 _", "ET2.SE2 _"},
    "a fallback that answers for any arguments": {"not_applicable _"},
    "kinds of attributes are given the object, which some do not need": {
        "text target", "number target", "whole target", "flag target",
    },
    "the viewer runs in this process": {
        "Client.__init__ clients", "Client.__init__ host", "Client.__init__ port", "Client.__init__ url",
        "gui_client _", "gui_client __", "start_server _", "start_server __", "Tree.setRefreshIsSynchronous synchronous",
        "GepettoVisualizer.initViewer open", "Visualizer.__init__ zmq_url", "Visualizer.__init__ server_args",
        "MeshcatVisualizer.initViewer zmq_url", "GepettoVisualizer.initViewer more", "MotionPictures.create_video_ctx _",
        "BaseVisualizer.loadViewerModel _",
    },
    "the function warns that it is not offered": {
        "Looks.setTexture filename", "Looks.removeObjectFromCache nodeName", "Looks.addLight wid",
        "Looks.addLight radius", "Looks.addLight RGBAcolor", "RobotWrapper.initFromSDF _", "RobotWrapper.initFromSDF __",
        "MotionPictures.displayFrames axis_width", "AnyConstraint.appendCouplingConstraintInertias model",
        "AnyConstraint.appendCouplingConstraintInertias data",
    },
    "results are the same with and without": {
        "centerOfMass compute_subtree_coms", "StreamBuffer.prepare n",
        "ConstraintCholeskyDecomposition.getInverseOperationalSpaceInertiaMatrix enforce_symmetry",
        "DelassusOperator.matrix enforce_symmetry", "log3 theta", "IterativeSolver.__init__ problem_size",
        "ConstraintSolverResult.resize problem_size",
        "ADMMSolverStats.__init__ max_iterations",
        "computeLargestEigenvector max_it", "computeLargestEigenvector rel_tol", "_BodyParameters.__init__ parts",
    },
    "the objects hold what these would tell": {
        "_Anchor.residualSize sel", "_Anchor.retrieveCompliance sel", "_Anchor.setCompliance sel",
        "_Anchor.set constraint_data", "_Anchor.jacobian data", "PointContactConstraintModel.set constraint_data",
        "ConstraintCholeskyDecomposition.rebuild constraint_datas",
        "ConstraintCholeskyDecomposition.getMassMatrixChoeslkyDecomposition model",
        "ConstraintCholeskyDecomposition.getMassMatrixChoeslkyDecomposition data",
        "FramePair.setBaumgarteCorrectorParameters sel", "_OfJoints.residualSize sel", "_OfJoints.retrieveCompliance sel",
        "_OfJoints.setCompliance sel", "_OfJoints.jacobian data", "_OfJoints.jacobian constraint_data",
        "JointFrictionConstraintModel.calc model", "JointFrictionConstraintModel.calc data",
        "JointLimitConstraintModel.setBaumgarteCorrectorParameters sel", "JointLimitConstraintModel.calc model",
        "JointLimitConstraintModel.set constraint_data", "RigidConstraint.residualSize sel", "RigidConstraint.retrieveCompliance sel", "JointLimitConstraintModel.jacobian data",
        "AnyConstraint.getRowSparsityPattern data", "AnyConstraint.getRowSparsityPattern constraint_data",
    },
    "quantities evaluated on numbers are not kept": {
        f"EvaluatedModel.{method} {parameter}"
        for method in ("compile", "compile_at_frames") for parameter in ("key", "echoed", "shapes")
    },
    "the page is served by this process, which never waits for it": {
        "LaunchedEnvironment.__init__ _dev", "LaunchedEnvironment.launch timeout",
        "LaunchedEnvironment.launch browser_timeout", "LaunchedEnvironment.close clear_cell", "Swift.step render",
        "Swift.hold timeout",
    },
}  # fmt: skip
"""What is not used, with the reason; the docs of the packages say so."""


def functions(tree: ast.AST, outer: tuple[str, ...] = ()) -> Iterator[tuple[str, ast.FunctionDef]]:
    """The functions and methods of a module that are not nested in a function, with the names of their classes."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.ClassDef):
            yield from functions(node, (*outer, node.name))
        elif isinstance(node, ast.FunctionDef):
            yield ".".join((*outer, node.name)), node


def unused(function: ast.FunctionDef) -> list[str]:
    """The parameters of a function that its body does not name; none where it only raises, or is a declaration."""
    a = function.args
    named = [*a.posonlyargs, *a.args, *a.kwonlyargs, *filter(None, (a.vararg, a.kwarg))]
    names = [parameter.arg for parameter in named if parameter.arg not in ("self", "cls")]
    body = function.body[1:] if ast.get_docstring(function) is not None else function.body
    if all(isinstance(part, (ast.Raise, ast.Expr)) and not _calls(part) for part in body):
        return []
    used = {node.id for part in body for node in ast.walk(part) if isinstance(node, ast.Name)}
    return [name for name in names if name not in used]


def is_excused(name: str) -> bool:
    """Whether a parameter, "function parameter", is listed, or the parameter of any function, "* parameter"."""
    excused = {name for names in UNUSED.values() for name in names}
    return name in excused or f"* {name.rpartition(' ')[2]}" in excused


def _calls(part: ast.AST) -> bool:
    return isinstance(part, ast.Expr) and isinstance(part.value, ast.Call)


@pytest.mark.parametrize("package", FOLDERS)
def test_each_parameter_is_used(package: str) -> None:
    count, ignored = 0, []
    for file in sorted(Path(FOLDERS[package]).rglob("*.py")):
        for name, function in functions(ast.parse(file.read_text(encoding="utf-8"))):
            if function.name.startswith("_") and function.name != "__init__":
                continue
            count += 1
            found = [f"{name} {parameter}" for parameter in unused(function)]
            ignored += [f"{file.name}: {one}" for one in found if not is_excused(one)]
    assert count > 300
    assert not ignored, "\n".join(ignored)
