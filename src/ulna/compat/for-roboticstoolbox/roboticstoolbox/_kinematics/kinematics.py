"""The kinematics of a robot, computed by the compiled chain from `start` to `end`."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np

from roboticstoolbox._common.documentation import describe_arguments
from roboticstoolbox._common.errors import UnknownKey, WrongType
from roboticstoolbox._common.numbers import numbers
from roboticstoolbox._common.poses import matrix, pose, to_spatial
from roboticstoolbox._common.symbols import exact_entries, has_symbols
from roboticstoolbox._ets.compiled_chain import Chain, known_angles
from roboticstoolbox._ets.ets import ETS
from roboticstoolbox._ets.measures import axes_of, measure_name, measure_of
from roboticstoolbox._ets.sequence import limits_of
from roboticstoolbox._kinematics.solver_methods import RobotSolvers
from roboticstoolbox._links.gripper import Gripper
from roboticstoolbox._links.link import Link
from roboticstoolbox._links.link_tree import links_between
from roboticstoolbox._links.ulna_model import model_of
from ulna.errors import InputError, UlnaWarning
from ulna.robot import Robot as Body
from ulna.typing import Floats


@describe_arguments
class Kinematics(RobotSolvers):
    """Poses, Jacobians and inverse kinematics; `end` and `start` are links, grippers or their names.

    Without `end` it is the tool of the gripper, or the last link; without `start` the base.
    """

    _chains: dict[Any, Chain]
    _base: Floats | None
    _tool: Floats | None
    _links: list[Link]
    _grippers: list[Gripper]
    _cached_robot: Body | None
    name: str
    n: int
    q: Floats

    def _chain(self, end: Any, start: Any, tool: Any = None) -> Chain:
        chain = self._chain_between(start, end)
        T = self._tool if tool is None else matrix(tool)
        return chain if T is None else chain.with_tool(T)

    def _chain_between(self, start: Any, end: Any) -> Chain:
        try:
            return self._chains[end, start]
        except (KeyError, TypeError):
            names = tuple(one.name if isinstance(one, Link) else one for one in (end, start))
            if names not in self._chains:
                self._chains[names] = Chain(self.ets(start, end).data)
            return self._chains[names]

    def _link(self, what: Any) -> Link:
        """The link of a name, a link or a gripper."""
        if isinstance(what, Gripper):
            return what.links[0]
        if isinstance(what, Link):
            what = what.name
        links = self.link_dict
        if not isinstance(what, str):
            raise WrongType(f"{what!r} is no link; expected a link, a gripper, or the name of one.")
        if what not in links:
            raise UnknownKey("link", what, links)
        return links[what]

    @property
    def link_dict(self) -> dict[str, Link]:
        """All links by name, those of grippers included."""
        gripper_links = [link for gripper in self._grippers for link in gripper.links]
        return {link.name: link for link in [*self._links, *gripper_links]}

    @property
    def ee_links(self) -> list[Link]:
        """The links that carry a gripper; of an arm without grippers, the last link of each branch."""
        carriers = [gripper.links[0].parent for gripper in self._grippers]
        if carriers:
            return [link for link in carriers if link is not None]
        arm_links = {id(link) for link in self._links}
        return [link for link in self._links if not any(id(child) in arm_links for child in link.children)]

    def _default_end(self) -> tuple[Link, Floats | None]:
        """The link and the tool at which a robot ends by default."""
        ends: list[Any] = list(self._grippers or self.ee_links)
        if len(ends) > 1:
            names = ", ".join(end.name for end in ends)
            text = f"Robot {self.name!r} has several ends, {names}; the first is taken, choose another with end=."
            warnings.warn(text, UlnaWarning, stacklevel=3)
        end = ends[0]
        if isinstance(end, Link):
            return end, None
        return end.links[0], matrix(end.tool)

    def _end_and_tool(self, end: Any) -> tuple[Link, Floats | None]:
        """The link at which a chain ends, and the tool there; of a gripper the link that carries it, and its tool."""
        if not isinstance(end, Gripper):
            return self._link(end), None
        carrier = end.links[0].parent
        return (end.links[0] if carrier is None else carrier), matrix(end.tool)

    def ets(self, start: Any = None, end: Any = None) -> ETS:
        """The transforms from `start` to `end`; to a gripper: to the link that carries it, and its tool.

        Returns:
            The chain of transforms.
        """
        last, tool = self._default_end() if end is None else self._end_and_tool(end)
        upward, downward = links_between(None if start is None else self._link(start), last)
        transforms = [et.inv() for link in upward for et in reversed(link.ets.data)]
        transforms += [et for link in downward for et in link.ets.data]
        return ETS._from_transforms([*transforms, ETS._et("SE3", T=tool)] if tool is not None else transforms)

    def fkine(
        self, q: Any, end: Any = None, start: Any = None, tool: Any = None, include_base: bool = True
    ) -> Any:
        """The pose of `end` in the world.

        Returns:
            One SE3, with m elements for (m, n).
        """
        T = self._chain(end, start, tool).fk(q)
        if self._base is None or not include_base:
            return pose(T)
        return pose((exact_entries(self._base) if T.dtype == object else self._base) @ T)

    def fkine_all(self, q: Any) -> Any:
        """Poses of the base and of all links, those of grippers last, as one SE3."""
        try:
            body, configuration = self._complete_robot(), self._complete_configuration(q)
        except (TypeError, InputError):
            if not has_symbols(q) and not any(
                et._is_symbolic for link in self._links for et in link.ets.data
            ):
                raise
            base = np.eye(4, dtype=int) if self._base is None else exact_entries(self._base)
            links = [self.fkine(q, end=name, tool=np.eye(4)).A for name in self.link_dict]
            return pose(np.array([base, *links], dtype=object))
        return pose(body.fk(configuration, ["base link of the robot", *self.link_dict]))

    def _complete_robot(self) -> Body:
        """Arm and grippers as one robot of Ulna."""
        if self._cached_robot is None:
            base = np.eye(4) if self._base is None else to_spatial(self._base)
            pairs = self.__dict__.get("_disabled", ())
            fall = (0.0, 0.0, -9.81)
            model = model_of(self.name, self._links, self._grippers, fall, base, True, pairs)
            self._cached_robot = Body(model)
        return self._cached_robot

    def _complete_configuration(self, q: Any) -> Floats:
        """The configuration of arm and grippers."""
        gripper_positions = [gripper.q for gripper in self._grippers]
        return np.concatenate([numbers("q", q).ravel(), *gripper_positions])

    def jacob0(self, q: Any, end: Any = None, start: Any = None, tool: Any = None) -> Floats:
        """The Jacobian in the axes of the start, linear rows first.

        Returns:
            Jacobian (6, n) or (m, 6, n).
        """
        return self._chain(end, start, tool).jacob0(q)

    def jacobe(self, q: Any, end: Any = None, start: Any = None, tool: Any = None) -> Floats:
        """The Jacobian in the axes of the end, linear rows first.

        Returns:
            Jacobian (6, n) or (m, 6, n).
        """
        return self._chain(end, start, tool).jacobe(q)

    def jacob0_analytical(
        self, q: Any, representation: str = "rpy/xyz", end: Any = None, start: Any = None, tool: Any = None
    ) -> Floats:
        """The Jacobian of position and angles.

        Args:
            representation: "rpy/xyz", "rpy/zyx", "eul" or "exp".

        Returns:
            Jacobian (6, n) or (m, 6, n).
        """
        known_angles(representation)
        return self._chain(end, start, tool).analytical(q, representation)

    def jacob0_dot(self, q: Any, qd: Any, J0: Any = None, representation: str | None = None) -> Floats:
        """The derivative of `jacob0` (or of `jacob0_analytical`) by time, (6, n).

        Args:
            q: Configuration, (n,); None where `J0` is given.
            qd: Velocity, (n,).
            J0: The Jacobian to take instead of that at `q`, (6, n).
            representation: Angles of the analytical Jacobian; None for `jacob0`.

        Returns:
            Derivative (6, n) [1/s].

        Raises:
            TypeError: `q` is needed and None.
            WrongType: The same, as the class of the error.
        """
        chain = self._chain(None, None)
        if representation is None and J0 is not None:
            return np.tensordot(chain.q(qd), chain.hessian0(None, J0), 1)
        if q is None:
            raise WrongType("`q` is None; expected a configuration, or `J0` and no `representation`.")
        if representation is None:
            return chain.jacob0_dot(q, qd)
        known_angles(representation)
        kernel = chain.arm.kernel("analytical_jacobian", representation=representation).jacobian()
        return kernel(chain.q(q)) @ chain.q(qd)

    def hessian0(
        self, q: Any = None, end: Any = None, start: Any = None, J0: Any = None, tool: Any = None
    ) -> Floats:
        """The Hessian in the axes of the start: at `q`, or where the Jacobian is `J0`.

        Args:
            q: Configuration (n,) [rad or m]; None for the robot's.

        Returns:
            Hessian (n, 6, n).
        """
        at = self.q if q is None and J0 is None else q
        return self._chain(end, start, tool).hessian0(at, J0)

    def hessiane(
        self, q: Any = None, end: Any = None, start: Any = None, Je: Any = None, tool: Any = None
    ) -> Floats:
        """The Hessian in the axes of the end: at `q`, or where the Jacobian is `Je`.

        Args:
            q: Configuration (n,) [rad or m]; None for the robot's.

        Returns:
            Hessian (n, 6, n).
        """
        at = self.q if q is None and Je is None else q
        return self._chain(end, start, tool).hessiane(at, Je)

    def partial_fkine0(self, q: Any, n: int = 3, end: Any = None, start: Any = None) -> Floats:
        """A derivative of the pose in the axes of the start: 1 the Jacobian, 2 the Hessian, and so on.

        Args:
            q: Configuration (n,) [rad or m].
            n: Order of the derivative.

        Returns:
            Array (n, ..., n, 6, n).
        """
        return self._chain(end, start).partial(q, n)

    def manipulability(
        self,
        q: Any = None,
        J: Any = None,
        end: Any = None,
        start: Any = None,
        method: str = "yoshikawa",
        axes: Any = "all",
    ) -> Any:
        """A measure of the distance from singularities, at `q` or of a Jacobian.

        Args:
            q: Configuration, (n,), or (m, n).
            J: The Jacobian to take instead, (6, n).
            start: Its first link.
            method: "yoshikawa", "asada", "minsingular" or "invcondition".
            axes: "all", "trans", "rot", "both" for a pair of measures, or six truth values.

        Returns:
            The measure, () or (m,); a pair of them for "both".

        Raises:
            InputError: Neither `q` nor `J`, or "asada" without `q`.
        """
        from ulna import algorithms

        if isinstance(axes, str) and axes == "both":
            return tuple(self.manipulability(q, J, end, start, method, part) for part in ("trans", "rot"))
        measure, rows = measure_name(method), axes_of(axes)
        if q is None and (J is None or measure == "asada"):
            raise InputError("Neither `q` nor `J` is given; expected one, and `q` for 'asada'.")
        if measure == "asada":
            matrix = np.asarray(self._chain(end, start).jacob0(q) if J is None else J, dtype=float)
            return algorithms.asada(matrix, self.inertia(q), rows)  # type: ignore[attr-defined]
        if J is not None:
            return measure_of(np.asarray(J, dtype=float), measure, rows)
        return self._chain(end, start).manipulability(q, method, rows)

    def jacobm(
        self,
        q: Any = None,
        J: Any = None,
        H: Any = None,
        end: Any = None,
        start: Any = None,
        axes: Any = "all",
    ) -> Floats:
        """The gradient of Yoshikawa's manipulability, (n, 1).

        Args:
            q: Configuration, (n,); None for the robot's.
            J: The Jacobian to take instead of that at `q`, (6, n).
            H: The Hessian to take instead, (n, 6, n); None for that of the Jacobian.
            start: Its first link.

        Returns:
            Gradient (n, 1).
        """
        chain, at = self._chain(end, start), self.q if q is None else q
        if J is None and H is None:
            return chain.jacobm(at, axes)
        return chain.jacobm_of(np.asarray(chain.jacob0(at)) if J is None else J, H, axes)

    @property
    def qlim(self) -> Floats:
        """Joint limits, (2, n); a turn without limits has -pi and pi.

        Raises:
            ValueError: A sliding joint has none.
        """
        joints = sorted((link for link in self._links if link.isjoint), key=lambda link: link.jindex or 0)
        return limits_of(link.v for link in joints if link.v is not None)

    @qlim.setter
    def qlim(self, limits: Any) -> None:
        limits_array = np.asarray(limits, dtype=float)
        if limits_array.shape != (2, self.n):
            raise InputError(f"`qlim` has shape {limits_array.shape}; expected (2, {self.n}).")
        for link in self._links:
            if link.isjoint:
                link.qlim = limits_array[:, link.jindex]

    def random_q(self) -> Floats:
        """A random configuration within the limits, (n,)."""
        low, high = self.qlim
        return np.random.default_rng().uniform(low, high)
