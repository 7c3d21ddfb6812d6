"""Where scripts import names from, and semi-private names that published code uses."""

from __future__ import annotations

SNIPPETS: dict[str, str] = {
    f"import {i}": code
    for i, code in enumerate(
        (
            "from roboticstoolbox.ets.ET import *; str(Rx(1) * tz() * SE3(np.eye(4)))",
            "from roboticstoolbox.ets.ET2 import *; str(R(1) * tx() * ty(2) * SE2(np.eye(3)))",
            "from roboticstoolbox.ets.ETS import *; str(ETS())",
            "import roboticstoolbox.ets.ET as m; sorted(m.__all__)",
            "rtb.tools.types.NDArray.__name__",
            "from roboticstoolbox.tools.types import ArrayLike, NDArray, PyArrayLike; NDArray.__name__",
            "from roboticstoolbox.tools import ArrayLike, NDArray; NDArray.__name__",
            "rtb.tools.plot.xplot.__name__",
            "from roboticstoolbox.tools.plot import plane_view; plane_view('xy'), plane_view('XZ'), plane_view('yz')",
            "from roboticstoolbox.tools.plot import plane_view; plane_view('zx')",
            "rtb.tools.trajectory.jtraj.__name__",
            "rtb.tools.numerical.jacobian_numerical.__name__",
            "from spatialgeometry.geom.CollisionShape import Cuboid; Cuboid([1, 2, 3]).scale",
            "from spatialgeometry.geom.Shape import Axes; Axes(0.1).length",
            "from spatialgeometry.geom.SceneNode import SceneNode; SceneNode().T",
            "from roboticstoolbox.robot.Link import BaseLink; isinstance(Link(), BaseLink)",
            "from roboticstoolbox.backends.Connector import Connector; Connector.supports_teach, Connector.supports_ellipse",
            "from roboticstoolbox.backends.Connector import Connector; Connector()",
            "from roboticstoolbox.backends.PyPlot.PyPlot import PyPlot; PyPlot.__name__",
            "from roboticstoolbox.backends.PyPlot import PyPlot, PyPlot2; PyPlot2.__name__",
            "import roboticstoolbox.bin.rtbtool as m; callable(m.main)",
            "from roboticstoolbox.robot.Robot import _rotation_between_vectors as f; f([0, 0, 1], [0, 2, 0])",
            "from roboticstoolbox.robot.Robot import _rotation_between_vectors as f; f([0, 0, 1], [0, 0, -1])",
            "from roboticstoolbox.ets._ET import _parse_joint_descriptor as f; f('-q3'), f('A1_'), f('a')",
            "from roboticstoolbox.ets._ET import BaseET; isinstance(ET.Rx(), BaseET)",
            "from roboticstoolbox.ets._ETS import BaseETS; isinstance(ETS(), BaseETS)",
            "from roboticstoolbox.ets.fknm import ETS_fkine; p = models.Panda().ets(); ETS_fkine(p._fknm, np.ones(7), None, None, True)",
            "from roboticstoolbox.ets.fknm import ETS_jacob0; p = models.Panda().ets(); ETS_jacob0(p._fknm, np.ones(7), None)",
            "from roboticstoolbox.ets.fknm import ETS_jacobe; p = models.Panda().ets(); ETS_jacobe(p._fknm, np.ones(7), None)",
            "from roboticstoolbox.ets.fknm import ETS_hessian0; p = models.Panda().ets(); ETS_hessian0(p._fknm, np.ones(7), None, None)",
            "from roboticstoolbox.ets.fknm import ETS_init; e = ET.Rx() * ET.tx(1); from roboticstoolbox.ets.fknm import ETS_fkine; ETS_fkine(ETS_init([x.fknm for x in e], 1, 2), [0.3], None, None, True)",
            "from roboticstoolbox.ets.fknm import ET_T; ET_T(ET.Rx().fknm, 0.3)",
            "from roboticstoolbox.ets.fknm import Angle_Axis; Angle_Axis(np.eye(4), SE3.Rx(0.3).A)",
            "from roboticstoolbox.ets.fknm import IK_LM_c; p = models.Panda(); e = p.ets(); s = IK_LM_c(e._fknm, p.fkine(p.qr).A, None, 30, 100, 1e-6, True, None, 1.0, 'chan'); (len(s), s[1])",
            "from roboticstoolbox.robot.ERobot import ERobot, ERobot2; ERobot.__name__",
            "from roboticstoolbox.robot.DHRobot import SerialLink; SerialLink.__name__",
            "import roboticstoolbox.nothing",
            "from roboticstoolbox.tools import nothing",
            "rtb.tools.nothing",
            "rtb.nothing",
        )
    )
}
