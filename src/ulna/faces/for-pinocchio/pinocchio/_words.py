"""What this face does not offer, and what to use instead."""

from __future__ import annotations

import re

_WORDS = (
    (r"casadi|cppad", "Ulna differentiates and compiles functions itself: ulna.compile(f, robot).jacobian()."),
    (r".*Sdf|WITH_SDF.*", "SDF files are not read; convert them to URDF."),
    (r".*MJCF.*", "MJCF files are not read yet; convert them to URDF."),
    (r".*(Broad|TreeBroad|GeometryPool).*", "Pairs are culled inside robot.collides of Ulna."),
    (r".*InParallel|ModelPool|omp_.*", "Kernels take batches: ulna.Robot(model.ulna()).inverse_dynamics(Q, V, A)."),
    (r".*Constraint.*|.*Delassus.*|.*Contact.*|lcaba|.*Cone|.*Prox.*|(PGS|ADMM).*|impulseDynamics|forwardDynamics|.*KKT.*",
     "Constraints are Ulna's: ulna.Robot(model.ulna()).constrained_dynamics(...), impulse_dynamics(...)."),
    (r"serialization|loadFrom.*|saveTo.*", "Use pickle, or model.saveToText(file)."),
    (r"graph", "Models are put together with appendModel, buildReducedModel, and ulna.model.ModelBuilder."),
    (r".*tangentMap.*|.*TangentMap.*", "Use dIntegrate, which works on tangent spaces."),
    (r".*KinematicRegressor|.*Ellipsoid", "Ask for it: it has not been needed yet."),
)  # fmt: skip


def refusal(name: str) -> str:
    """A word on a name that is not offered."""
    for pattern, word in _WORDS:
        if re.fullmatch(pattern, name):
            return word
    return "Real Pinocchio is `pip install pin`; run the script with plain python to use it."
