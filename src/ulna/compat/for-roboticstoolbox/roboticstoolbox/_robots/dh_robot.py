"""Arms of links by Denavit and Hartenberg's parameters."""

from __future__ import annotations

import math
import re
import warnings
from typing import Any

import numpy as np

from roboticstoolbox._common.documentation import describe_arguments
from roboticstoolbox._common.errors import WrongType
from roboticstoolbox._common.numbers import numbers, vector
from roboticstoolbox._common.poses import matrix, pose
from roboticstoolbox._dynamics.base_wrench import moved_wrench, wrench_on_base
from roboticstoolbox._dynamics.dynamics import vector3
from roboticstoolbox._ets.compiled_chain import known_angles
from roboticstoolbox._ets.elementary_transform import ET
from roboticstoolbox._ets.ets import ETS
from roboticstoolbox._ets.ik_solution import IKSolution
from roboticstoolbox._ik.analytic import Analytic
from roboticstoolbox._links.ulna_model import model_of
from roboticstoolbox._robots.dh_links import DHLink
from roboticstoolbox._robots.dh_text import DHText
from roboticstoolbox._robots.robot import BaseRobot, Robot
from roboticstoolbox.tools.data import rtb_path_to_datafile
from ulna.algorithms.kinematics.analytical_jacobian import rate_matrix
from ulna.errors import InputError, ModelError
from ulna.robot import Robot as Body
from ulna.typing import Floats


@describe_arguments
class DHRobot(DHText, Analytic, Robot):
    """A serial arm of DH links; its base and its tool are part of its transforms."""

    def __init__(self, links: Any, meshdir: Any = None, **more: Any) -> None:
        """An arm of DH links.

        Args:
            links: DH links of one convention, or a DH robot.
            meshdir: Folder with the files link0.stl, link1.stl ..., of the user or of the package `rtb-data`. Their
                paths become `basemesh` and `mesh` of the links; as in the toolbox they are not drawn.
            **more: Arguments of `Robot`.

        Raises:
            ModelError: The links are no DH links, or of both conventions.
            FormatError: There is no such folder.
        """
        folder = None if meshdir is None else rtb_path_to_datafile(meshdir)
        dh_links = _dh_links(links)
        if not dh_links:
            raise ModelError("A DHRobot has at least one link; `links` is empty.")
        if len({link.mdh for link in dh_links}) > 1:
            raise ModelError("Some links have standard and some modified parameters; use one convention.")
        for i, (link, name) in enumerate(zip(dh_links, _link_names(dh_links), strict=True)):
            link._parent, link._parent_name = (dh_links[i - 1] if i else None), None
            link.jindex, link.name = i, name
            link.mesh = link.mesh if folder is None else folder / f"link{i + 1}.stl"
        if folder is not None:
            self.meshdir = folder
        self.basemesh = None if folder is None else folder / "link0.stl"
        super().__init__(dh_links, **more)

    @property
    def hasgeometry(self) -> bool:
        """Whether any link has shapes to draw, or a file with its shape."""
        return super().hasgeometry or any(getattr(link, "mesh", None) for link in self._links)

    def ets(self, start: Any = None, end: Any = None) -> ETS:
        """The transforms from `start` to `end`; of the whole arm with base and tool.

        Returns:
            The chain of transforms.
        """
        inner = super().ets(start, end)
        before = [ET("SE3", T=self._base)] if start is None and self._base is not None else []
        after = [ET("SE3", T=self._tool)] if end is None and self._tool is not None else []
        return ETS._from_transforms([*before, *inner.data, *after])

    def _chain(self, end: Any, start: Any, tool: Any = None) -> Any:
        chain = self._chain_between(start, end)
        return chain if tool is None else chain.with_tool(matrix(tool))

    def fkine(
        self, q: Any, end: Any = None, start: Any = None, tool: Any = None, include_base: bool = True
    ) -> Any:
        """The pose of `end` in the world.

        Returns:
            One SE3, with m elements for (m, n).
        """
        T = self._chain(end, start, tool).fk(q)
        if not include_base and self._base is not None:
            T = np.linalg.inv(self._base) @ T
        return pose(T)

    def jacob0(
        self,
        q: Any,
        T: Any = None,
        half: str | None = None,
        start: Any = None,
        end: Any = None,
        tool: Any = None,
    ) -> Floats:
        """The Jacobian in the axes of the start, (6, n).

        Args:
            q: Configuration, (n,) [rad or m].
            T: The pose of the end whose rotation to take, an SE3; None for that at `q`.
            half: "trans" or "rot" for three of the rows.
            start: First link of the chain.
            end: Its last link.
            tool: A tool beyond it.

        Returns:
            Jacobian (6, n), or (3, n) for `half`.
        """
        if T is None:
            return _selected_rows(super().jacob0(q, end, start, tool), half)
        R = matrix(T)[:3, :3]
        J = np.asarray(super().jacobe(q, end, start, tool))
        return _selected_rows(np.concatenate([R @ J[..., :3, :], R @ J[..., 3:, :]], axis=-2), half)

    def jacobe(
        self, q: Any, half: str | None = None, end: Any = None, start: Any = None, tool: Any = None
    ) -> Floats:
        """The Jacobian in the axes of the end.

        Args:
            half: "trans" or "rot" for three of the rows.

        Returns:
            Jacobian (6, n), or (3, n) for `half`.
        """
        return _selected_rows(super().jacobe(q, end, start, tool), half)

    def jacob0_analytical(
        self,
        q: Any,
        representation: str | None = None,
        T: Any = None,
        end: Any = None,
        start: Any = None,
        tool: Any = None,
    ) -> Floats:
        """The Jacobian of position and angles, (6, n).

        Args:
            q: Configuration, (n,) [rad or m].
            representation: "rpy/xyz", "rpy/zyx", "eul" or "exp"; None for `jacob0`.
            T: The pose of the end whose rotation to take, an SE3; None for that at `q`.
            start: Its first link.
            tool: A tool beyond it.

        Returns:
            Jacobian (6, n).
        """
        if representation is None:
            return self.jacob0(q, T, None, start, end, tool)
        known_angles(representation)
        if T is None:
            return super().jacob0_analytical(q, representation, end, start, tool)
        J = np.asarray(self.jacob0(q, T, None, start, end, tool))
        rates: Any = rate_matrix(matrix(T)[:3, :3], representation)  # type: ignore[arg-type]
        return np.concatenate([J[..., :3, :], rates @ J[..., 3:, :]], axis=-2)

    def hessian0(
        self, q: Any = None, J0: Any = None, start: Any = None, end: Any = None, tool: Any = None
    ) -> Floats:
        """The Hessian in the axes of the start: at `q`, or where the Jacobian is `J0`.

        Args:
            q: Configuration (n,) [rad or m]; None for the robot's.

        Returns:
            Hessian (n, 6, n).
        """
        return super().hessian0(q, end, start, J0, tool)

    def ikine_LM(self, Tep: Any, q0: Any = None, **ikargs: Any) -> IKSolution:
        """As `Robot.ikine_LM`, with `q0` as the second argument.

        Args:
            **ikargs: Other arguments of `Robot.ikine_LM`.

        Returns:
            Joint coordinates (n,) or (m, n), success, and figures of the search.
        """
        return super().ikine_LM(Tep, q0=q0, **ikargs)

    def __add__(self, other: Any) -> DHRobot:
        """This arm, and after its last link that of another one, or one more link; base and tool are this one's."""
        more = [other] if isinstance(other, DHLink) else getattr(other, "_links", None)
        if more is None or not all(isinstance(link, DHLink) for link in more):
            return NotImplemented
        return DHRobot(
            [self, *more],
            name=self.name,
            manufacturer=self.manufacturer,
            base=self._base,
            tool=self._tool,
            gravity=self._gravity,
        )

    def _on_base_or_tool_change(self) -> None:
        self._discard_compiled()

    @property
    def mdh(self) -> int:
        """1 for modified parameters, 0 for standard ones."""
        return int(self._column("mdh")[0])

    def _column(self, name: str) -> list[float]:
        return [getattr(link, name) for link in self._links]

    theta = property(lambda self: self._column("theta"), doc="Angles about z of the links.")
    d = property(lambda self: self._column("d"), doc="Distances along z of the links.")
    a = property(lambda self: self._column("a"), doc="Distances along x of the links.")
    alpha = property(lambda self: self._column("alpha"), doc="Angles about x of the links.")
    offset = property(lambda self: self._column("offset"), doc="What is added to the joint coordinates.")

    @property
    def r(self) -> Floats:
        """Centres of mass of the links, (3, n)."""
        return np.array([link.r for link in self._links]).T

    def A(self, j: Any, q: Any = None) -> Any:
        """The pose of a link, or of one link seen from before another; base and tool do not count.

        Args:
            j: Number of the link, or first and last number.
            q: Configuration (n,) [rad or m]; None for the robot's.

        Returns:
            One SE3.

        Raises:
            InputError: There is no such link.
        """
        at = self.q if q is None else np.atleast_1d(q)
        first, last = (0, j) if np.ndim(j) == 0 else (j[0], j[1])
        if max(first, last) >= self.n:
            raise InputError(
                f"`j` is {j!r}; expected the number of a link, 0 to {self.n - 1}, or the first and last."
            )
        T = np.eye(4)
        for k in range(first, last + 1):
            T = T @ self._links[k].A(at[k]).A
        return pose(T)

    def fkine_all(self, q: Any = None, old: bool = True) -> Any:
        """Poses of the base and of all links, as one SE3; the tool does not count.

        Args:
            q: Configuration (n,) [rad or m]; None for the robot's.
            old: Plays no part, as in the toolbox.

        Returns:
            One SE3 with n + 1 elements.
        """
        return super().fkine_all(self.q if q is None else q)

    def fkine_path(self, q: Any, old: Any = None) -> Any:
        """Poses of the base and of all links in the world.

        Args:
            q: Configuration (n,) [rad or m].
            old: Plays no part, as in the toolbox.

        Returns:
            One SE3 with n + 1 elements: the base, then all links, without the tool.
        """
        return self.fkine_all(q)

    def isspherical(self) -> bool:
        """Whether the last three joints' axes meet in a point."""
        wrist = self._links[-3:]
        if len(wrist) < 3 or any(link.sigma for link in wrist):  # type: ignore[attr-defined]
            return False
        a, b, c = wrist
        turns = sorted([abs(a.alpha), abs(b.alpha)])  # type: ignore[attr-defined]
        close = all(abs(x) < 1e-9 for x in (a.a, b.a, b.d))  # type: ignore[attr-defined]
        return close and c is not None and bool(np.allclose(turns, math.pi / 2))

    def rne(
        self,
        q: Any,
        qd: Any = None,
        qdd: Any = None,
        gravity: Any = None,
        fext: Any = None,
        base_wrench: bool = False,
    ) -> Any:
        """The joint torques of a motion, (n,) or (m, n).

        Args:
            q: Configuration, (n,) or (m, n) [rad or m]; or q, qd, qdd side by side, (3 n,).
            qd: Velocity.
            qdd: Acceleration.
            gravity: Acceleration of free fall, (3,); None for the robot's.
            fext: A wrench that the last link exerts, in the axes of its frame, (6,) [N, N m].
            base_wrench: Whether the wrench that the base exerts on the arm is returned, too.

        Returns:
            Torques (n,) or (m, n) [N m or N]; with `base_wrench` the wrench, (6,) or (m, 6) [N, N m], after them.
        """
        if qd is None and qdd is None and np.shape(q)[-1:] == (3 * self.n,) and self.n:
            q, qd, qdd = np.split(numbers("q", q), 3, axis=-1)
        tau = super().rne(q, qd, qdd, gravity=gravity)
        if fext is not None:
            fext = vector("fext", fext, 6)
            J = self._chain(self._links[-1].name, None).jacobe(q)
            tau = tau + np.swapaxes(J, -1, -2) @ fext
        return (tau, self._base_wrench(q, qd, qdd, gravity, fext)) if base_wrench else tau

    def _base_wrench(self, q: Any, qd: Any, qdd: Any, gravity: Any, fext: Any) -> Floats:
        """The wrench of the base on the arm, in the axes of the base, about its origin, (6,) or (m, 6)."""
        still = np.zeros(self.n)
        motion = [numbers("q", q), *(still if x is None else numbers("qd", x) for x in (qd, qdd))]
        fall = self._gravity if gravity is None else vector3(gravity)
        base = np.eye(4) if self._base is None else self._base
        body = Body(model_of(self.name, self._links, [], fall, base, moving=False))
        wrench = wrench_on_base(body, base, *motion)
        if fext is None:
            return wrench
        end = self._chain(self._links[-1].name, None).fk(q)
        return wrench + moved_wrench(fext, np.linalg.inv(base) @ end)

    def rne_python(
        self,
        Q: Any,
        QD: Any = None,
        QDD: Any = None,
        gravity: Any = None,
        fext: Any = None,
        debug: bool = False,
        base_wrench: bool = False,
    ) -> Any:
        """`rne` by its other name.

        Args:
            Q: Configuration, (n,) or (m, n) [rad or m]; or q, qd, qdd side by side, (3 n,).
            QD: Velocity.
            QDD: Acceleration.
            gravity: Acceleration of free fall, (3,); None for the robot's.
            fext: A wrench that the last link exerts, in the axes of its frame, (6,) [N, N m].
            debug: Whether to print what each step computes; not offered.
            base_wrench: Whether the wrench that the base exerts on the arm is returned, too.

        Returns:
            What `rne` returns.

        Raises:
            InputError: `debug` is True.
        """
        if debug:
            raise InputError("debug=True is not offered: a compiled kernel has no steps to print.")
        return self.rne(Q, QD, QDD, gravity, fext, base_wrench)

    def delete_rne(self) -> None:
        """Discards the arrays of masses and motors; they are computed again when needed."""
        self.dynchanged()


def _dh_links(items: Any) -> list[DHLink]:
    """The links of a robot, or of a list of links and robots; those of robots are copied.

    Raises:
        WrongType: Something else is in it.
    """
    out: list[DHLink] = []
    for item in [items] if isinstance(items, BaseRobot) else list(items):
        robot = isinstance(item, BaseRobot)
        links: list[Any] = [link.copy() for link in item._links] if robot else [item]
        if not all(isinstance(link, DHLink) for link in links):
            raise WrongType(
                f"{item!r} is no DH link; a DHRobot is made of RevoluteDH, PrismaticDH, RevoluteMDH, PrismaticMDH."
            )
        out += links
    return out


def _link_names(links: list[DHLink]) -> list[str]:
    """Names that differ: those of the links, "link1", "link2" ... for those of that form, missing and repeated ones."""
    numbered = [f"link{i + 1}" for i in range(len(links))]
    old = [link.name or "" for link in links]
    named = [re.fullmatch(r"(link\d+)?", name) is None and old.count(name) == 1 for name in old]
    return [name if keep else number for name, keep, number in zip(old, named, numbered, strict=True)]


def _selected_rows(J: Floats, half: str | None) -> Floats:
    """The rows of linear ("trans") or of angular ("rot") velocities; all of them for None."""
    if half is None:
        return J
    if half not in ("trans", "rot"):
        raise InputError(f"`half` is {half!r}; expected 'trans' or 'rot'.")
    return J[..., :3, :] if half == "trans" else J[..., 3:, :]


class SerialLink(DHRobot):
    """The former name of `DHRobot`."""

    def __init__(self, *arguments: Any, **more: Any) -> None:
        """A DHRobot; see there."""
        warnings.warn("SerialLink is the former name of DHRobot", DeprecationWarning, stacklevel=2)
        super().__init__(*arguments, **more)


__all__ = ["DHRobot", "SerialLink"]
