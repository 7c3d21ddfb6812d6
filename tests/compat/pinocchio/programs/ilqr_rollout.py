"""An iterative linear-quadratic regulator for swinging an arm, with analytic derivatives, in the style of crocoddyl's models."""

import numpy as np
import pinocchio as pin


class State:
    def __init__(self, model):
        self.model, self.nx, self.ndx = model, model.nq + model.nv, 2 * model.nv

    def zero(self):
        return np.concatenate([pin.neutral(self.model), np.zeros(self.model.nv)])

    def diff(self, x0, x1):
        nq = self.model.nq
        return np.concatenate([pin.difference(self.model, x0[:nq], x1[:nq]), x1[nq:] - x0[nq:]])

    def integrate(self, x, dx):
        nq, nv = self.model.nq, self.model.nv
        return np.concatenate([pin.integrate(self.model, x[:nq], dx[:nv]), x[nq:] + dx[nv:]])


class ArmAction:
    def __init__(self, state, target, dt):
        self.state, self.target, self.dt = state, target, dt
        self.pinocchio = state.model.createData()
        self.frame = state.model.nframes - 1

    def calc(self, x, u):
        model, data = self.state.model, self.pinocchio
        q, v = x[: model.nq], x[-model.nv :]
        pin.computeAllTerms(model, data, q, v)
        pin.updateFramePlacements(model, data)
        data.M[:] = np.triu(data.M) + np.triu(data.M, 1).T
        self.xout = np.linalg.solve(data.M, u - data.nle)
        self.r = pin.log6(self.target.actInv(data.oMf[self.frame])).vector
        dx = np.concatenate([v + self.xout * self.dt, self.xout]) * self.dt
        self.cost = 5 * self.r @ self.r + 1e-3 * u @ u + 1e-2 * v @ v
        return self.state.integrate(x, dx), self.cost

    def calcDiff(self, x, u):
        model, data, dt = self.state.model, self.pinocchio, self.dt
        nv = model.nv
        q, v = x[: model.nq], x[-nv:]
        pin.computeABADerivatives(model, data, q, v, u)
        Fx = np.block(
            [
                [np.eye(nv) + dt * dt * data.ddq_dq, dt * np.eye(nv) + dt * dt * data.ddq_dv],
                [dt * data.ddq_dq, np.eye(nv) + dt * data.ddq_dv],
            ]
        )
        Fu = np.vstack([dt * dt * data.Minv, dt * data.Minv])
        pin.computeJointJacobians(model, data, q)
        pin.updateFramePlacements(model, data)
        J = pin.Jlog6(self.target.actInv(data.oMf[self.frame])) @ pin.getFrameJacobian(
            model, data, self.frame, pin.LOCAL
        )
        Lx = np.concatenate([10 * J.T @ self.r, 2e-2 * v])
        Lxx = np.zeros((2 * nv, 2 * nv))
        Lxx[:nv, :nv] = 10 * J.T @ J
        Lxx[nv:, nv:] = 2e-2 * np.eye(nv)
        return Fx, Fu, Lx, 2e-3 * u, Lxx, 2e-3 * np.eye(nv)


def backward(action, xs, us):
    n = action.state.ndx
    Vx, Vxx = np.zeros(n), np.zeros((n, n))
    ks, Ks = [], []
    for x, u in reversed(list(zip(xs[:-1], us, strict=False))):
        action.calc(x, u)
        Fx, Fu, Lx, Lu, Lxx, Luu = action.calcDiff(x, u)
        Qx, Qu = Lx + Fx.T @ Vx, Lu + Fu.T @ Vx
        Qxx, Quu, Qux = Lxx + Fx.T @ Vxx @ Fx, Luu + Fu.T @ Vxx @ Fu + 1e-6 * np.eye(len(u)), Fu.T @ Vxx @ Fx
        k, K = np.linalg.solve(Quu, Qu), np.linalg.solve(Quu, Qux)
        Vx, Vxx = Qx - K.T @ Qu, Qxx - Qux.T @ K
        Vxx = 0.5 * (Vxx + Vxx.T)
        ks.append(k), Ks.append(K)
    return ks[::-1], Ks[::-1]


model = pin.buildSampleModelManipulator()
state = State(model)
target = pin.SE3(pin.rpy.rpyToMatrix(0.1, 0.2, -0.3), np.array([0.4, 0.2, 1.2]))
action = ArmAction(state, target, 2e-2)
x0 = state.zero()
us = [
    pin.rnea(model, action.pinocchio, x0[: model.nq], np.zeros(model.nv), np.zeros(model.nv))
    for _ in range(12)
]
for iteration in range(3):
    xs, total = [x0], 0.0
    for u in us:
        x, cost = action.calc(xs[-1], u)
        xs.append(x)
        total += cost
    ks, Ks = backward(action, xs, us)
    for alpha in 2.0 ** -np.arange(8):
        new, x, value = [], x0, 0.0
        for xr, u, k, K in zip(xs, us, ks, Ks, strict=False):
            un = u - alpha * k - K @ state.diff(xr, x)
            x, cost = action.calc(x, un)
            new.append(un)
            value += cost
        if value < total:
            us = new
            break
    print(iteration, round(total, 4), round(value, 4), alpha)
print(np.round(x, 4))
