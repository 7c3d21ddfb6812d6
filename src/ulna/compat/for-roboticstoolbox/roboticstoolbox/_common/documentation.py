"""What arguments of the same name mean in most functions of the package; docstrings name the others only."""

from __future__ import annotations

from ulna.compat.documentation import documented

ARGUMENTS = {
    "q": "Joint coordinates (n,) or (m, n) [rad or m].",
    "end": "Last link of the chain, a gripper, or a name; the tool by default.",
    "start": "First link of the chain, or its name; the base by default.",
    "tool": "Pose of a tool beyond the end, an SE3 or (4, 4).",
    "include_base": "Whether the pose of the base counts.",
    "Tep": "Pose of the end, an SE3, (4, 4) or (m, 4, 4).",
    "q0": "Where the searches begin, (n,) or (k, n) [rad or m]; None for the neutral configuration.",
    "ilimit": "Greatest number of steps of a search.",
    "slimit": "Greatest number of searches.",
    "tol": "Greatest E = e^T W e / 2 that counts as reached [-].",
    "mask": "Weights of the errors along and about x, y, z, (6,); 1 by default.",
    "joint_limits": "Whether a solution must be within the limits.",
    "seed": "Seed of the random starts.",
    "k": "Damping [-].",
    "method": 'How it is damped: "chan", "wampler" or "sugihara".',
    "pinv": "Whether to take the pseudoinverse of the Jacobian.",
    "pinv_damping": "Damping d of the pseudoinverse, J^T (J J^T + d^2 I)^-1 [-]; 0 for none.",
    "kj": "Cost of joint speeds [-].",
    "ks": "Cost of the remaining error [-].",
    "kq": "Inverse of the gain that keeps joints from their limits in the null space [-]; 0 for none.",
    "km": "Inverse of the gain of manipulability in the null space [-]; 0 for none.",
    "ps": "Distance from a limit at which that gain holds [rad or m].",
    "pi": "Distance from a limit at which avoiding it begins [rad or m].",
    "axes": '"all", "trans", "rot", or six truth values.',
    "J0": "Jacobian in the axes of the start, (6, n).",
    "Je": "Jacobian in the axes of the end, (6, n).",
    "handle": "The chain.",
    "_data": "The transforms of the chain, where `handle` is None.",
    "_n": "Accepted and ignored.",
}
"""For each name what is written in `Args:` where a docstring has no entry of that name."""
describe_arguments = documented(ARGUMENTS)
