"""What scripts do with spatialmath, line by line; prints what comes out of each."""

# ruff: noqa: E402, F401, F403
import sys

import spatialmath as sm
from spatialmath import *

HEAVY = ("sympy", "scipy.interpolate", "scipy.spatial", "matplotlib")
print(*(name for name in HEAVY if name in sys.modules), file=sys.stderr)

import copy
import pickle
import re
from math import pi

import numpy as np
from spatialmath.base import *

np.random.seed(1)  # noqa: NPY002
LINES = """
T = SE3.Trans(0.6, -0.3, 0.1) * SE3.OA([0, 1, 0], [0, 0, -1])
T
T.t, T.R, T.A, T.N, T.shape
T.inv(), T.rpy("deg"), T.eul(), T.angvec(), T.log(), T.Ad()
many = SE3.Rx([0.1, 0.2, 0.3])
many
len(many), many[1], (many * T)[2], [x.t for x in many], many[0] * [1, 2, 3]
many.append(T)
many.extend(SE3.Rz([0.4, 0.5]))
many.insert(0, SE3(1, 2, 3))
many.append("no pose")
many.pop()
many[1:4], many[::-1][0], SE3.Empty(), SE3.Alloc(2), many[0] == many[0], T != many[0]
T.interp(SE3(), 3), T.interp(SE3(), [0, 0.5, 1])
T.interp1(0.3), T ** 3, T / T, T.prod(), many.prod()
SE3.CopyFrom(T.A), SE3.Exp(T.log()), SE3.Delta([0.01, 0, 0, 0, 0.02, 0]), T.delta(many[0])
SE3.Rand() * SE3.Rand(), SE3.Rand(theta_range=(0.1, 0.3))
T + T, T - T, 2 * T, T * np.array([[1, 2], [3, 4], [5, 6]])
SE3.RPY(0.1, 0.2, 0.3, order="xyz"), SE3.Eul([10, 20, 30], unit="deg"), SE3.AngVec(0.3, [0, 1, 0]), SE3.RPY([[1, 2, 3], [4, 5, 6]])
SO3.Rz(90, "deg") * SO3.Rx(pi / 3), SO2(0.3), SE2(1, 2, 0.5), SE2(1, 2, 0.5).SE3(), SO3.EulerVec([0.1, 0, 0])
T.strline(), isinstance(T, sm.BasePoseMatrix), isinstance(T, SO3)
T.printline()
SE3(np.ones((4, 4)))
SE3([1, 2])
T * "x"
q = UnitQuaternion.Rx(0.3) * UnitQuaternion(T)
q, q.R, q.inv(), q.interp(UnitQuaternion(), 3)[1], q * [1, 0, 0], Quaternion([1, 2, 3, 4]).norm(), q.rpy()
UnitDualQuaternion(T), DualQuaternion(Quaternion([1, 0, 0, 0]), Quaternion([0, 1, 2, 3]))
Twist3.UnitRevolute([0, 0, 1], [1, 2, 0]).exp(0.4), Twist3(T), Twist2.UnitPrismatic([1, 0]).SE2(2)
I = SpatialInertia(2.0, [0.1, 0, 0], np.eye(3))
I, I * SpatialAcceleration([1, 2, 3, 4, 5, 6]), I + I
SpatialVelocity([1, 0, 0, 0, 0, 1]).cross(SpatialVelocity([0, 1, 0, 0, 0, 0])), T * SpatialVelocity([1, 0, 0, 0, 0, 1])
line, plane = Line3.Join([0, 0, 0], [1, 2, 3]), Plane3([0, 0, 1, -1])
line, line.intersect_plane(plane).p, line.closest_to_point([1, 1, 1]), line.contains([2, 4, 6])
Line2.Join((0, 0), (1, 1)), Polygon2([(0, 0), (2, 0), (2, 1)]).area()
Ellipse(radii=(1, 2), theta=0.3).area
poly = Polygon2([(0, 0), (2, 0), (2, 2), (0, 2)])
poly.contains([1, 1]), poly.centroid(), poly.transformed(SE2(1, 1, 0.1)).vertices(), poly.moment(1, 1)
BSplineSE3(SE3([SE3.Tx(x) for x in range(5)]))(0.4)
InterpSplineSE3([0, 1, 2], SE3.Rz([0.1, 0.2, 0.4]))(0.7)
trotx(0.3) @ transl(1, 2, 3), tr2rpy(rotx(0.1) @ roty(0.2)), rpy2tr(0.1, 0.2, 0.3), eul2r(0.1, 0.2, 0.3)
tr2angvec(trotz(0.3)), trlog(T.A), trexp(np.zeros(6)), tr2delta(T.A), skew([1, 2, 3]), vexa(skewa([1, 2, 3]))
norm([1, 2, 3]), unitvec([3, 0, 4]), isrot(rotx(0.1)), ishom(T.A), getvector((1, 2)), r2q(T.R), q2r(r2q(T.R))
trinterp(None, T.A, 0.5), trnorm(T.A), angdiff(3.0, -3.0), wrap_0_2pi(-1.0), numjac(np.sin, [0.1, 0.2]), e2h([1, 2])
qslerp([1, 0, 0, 0], r2q(rotx(0.4)), 0.5), sm.base.qeye(), qrand(), trprint(T.A, file=None), trprint2(SE2(1, 2, 3).A, file=None)
from spatialmath.base.symbolic import issymbol, symbol, symtype
a, b = symbol("a b")
S = SE3.Rx(a) * SE3.Tx(b)
S, S * S, issymbol(a), issymbol(1.0), issymbol([a, 1]), isinstance(a, symtype), isscalar(a), isscalar([1])
sm.base.det(np.array([[a, b], [b, a]])), norm([a, b]), sm.base.simplify(a * b / a), sm.base.symbolic.cos(a), sm.base.symbolic.cos(0.3), sm.base.symbolic.pi()
trotz(sm.base.symbolic.sympy.Symbol("x")), rot2(a), transl2(a, b), rpy2r(a, b, 0)
__import__("sympy").Symbol is sm.base.symbolic.sympy.Symbol, isinstance(a, __import__("sympy").Symbol)
same = pickle.loads(pickle.dumps(many))
(same[1] - many[1]).max(), copy.deepcopy(T) == T, type(same) is SE3
__import__("spatialmath.pose3d").pose3d.SE3 is SE3, sm.SE3 is SE3, sm.__file__, sm.__version__, sm.base.graphics.__name__
sorted(dir(sm)), sorted(dir(sm.base))
"""

for text in LINES.strip().splitlines():
    try:
        try:
            print(text, re.sub("0x[0-9a-f]+", "", str(eval(text))), sep="\n")
        except SyntaxError:
            exec(text)
    except Exception as error:
        print(type(error).__name__, error)
