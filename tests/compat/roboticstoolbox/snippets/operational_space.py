"""Dynamics of the end of arms of two, three, six and seven joints, and of arms with a joint that moves no inertia."""

from __future__ import annotations

SNIPPETS: dict[str, str] = {}
_ARMS = {
    "Puma560": "p = models.DH.Puma560(); q = p.qn + 0.1; ",
    "Panda": "p = models.DH.Panda(); q = p.qr + 0.05; ",
    "UR5": "p = models.DH.UR5(); q = p.qr + 0.1; ",
    "TwoLink": "p = models.DH.TwoLink(); q = np.array([0.1, 0.2]); ",
    "three joints": "r = models.DH.Puma560(); p = DHRobot([r[0], r[1], r[2]]); q = np.array([0.1, 0.2, 0.3]); ",
}
_CALLS = (
    "p.inertia_x(q)",
    "p.inertia_x(q, pinv=True)",
    "p.inertia_x(q, representation='eul')",
    "p.gravload_x(q)",
    "p.gravload_x(q, gravity=[1, 2, 3])",
    "p.gravload_x(q, representation='exp')",
    "p.coriolis_x(q, 0.2 * np.ones(p.n))",
    "p.coriolis_x(q, 0.2 * np.ones(p.n), pinv=True)",
    "p.accel_x(q, 0.1 * np.ones(6), np.ones(6))",
    "p.accel_x(q, 0.1 * np.ones(6), np.ones(6), gravity=[1, 2, 3])",
    "p.accel(q, 0.1 * np.ones(p.n), np.ones(p.n))",
)
for _name, _before in _ARMS.items():
    for _i, _call in enumerate(_CALLS):
        if (_name, _call) != ("TwoLink", "p.inertia_x(q, representation='eul')"):
            SNIPPETS[f"{_name} {_i}"] = f"{_before}np.round({_call}, 3) + 0.0"
