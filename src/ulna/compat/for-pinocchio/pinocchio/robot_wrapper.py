"""RobotWrapper: a model, its data, its geometries and a visualizer in one object, with short calls."""

from __future__ import annotations

from typing import Any, NoReturn

import numpy as np

from pinocchio._algorithms import center_of_mass, configurations, dynamics, model_editing
from pinocchio._containers.documentation import describe_arguments
from pinocchio._containers.former_names import replacement_message
from pinocchio._geometry.geometry_model import GeometryModel
from pinocchio._model.model import Model
from pinocchio._robot_wrapper.kinematics import Kinematic
from pinocchio._robot_wrapper.viewer import Viewed
from pinocchio._spatial.motion_force import Force
from pinocchio.shortcuts import buildModelsFromMJCF, buildModelsFromUrdf, createDatas
from ulna.errors import InputError, UnknownName
from ulna.typing import Floats


@describe_arguments
class RobotWrapper(Kinematic, Viewed):
    """A robot as tutorials use it.

    Args:
        model: The model.
        collision_model: What it collides with.
        visual_model: What it looks like.
        constraint_models: Kept for whoever asks.
        verbose: Not needed.
    """

    def __init__(
        self,
        model: Model | None = None,
        collision_model: GeometryModel | None = None,
        visual_model: GeometryModel | None = None,
        constraint_models: Any = None,
        verbose: bool = False,
    ) -> None:
        self.model = Model() if model is None else model
        """The kinematic tree."""
        self.collision_model, self.visual_model = collision_model, visual_model
        self.constraint_models = constraint_models
        self.viz: Any = None
        """The visualizer, after `initViewer`."""
        self.rebuildData()
        self.v0 = np.zeros(self.nv)
        """No velocity (nv,)."""
        self.q0 = configurations.neutral(self.model)
        """The neutral configuration (nq,)."""

    @staticmethod
    def BuildFromURDF(filename: Any, *args: Any, **kwargs: Any) -> RobotWrapper:
        """The robot of a URDF file.

        Args:
            filename: The file.
            *args: See `buildModelsFromUrdf`: folders of packages, a root joint such as JointModelFreeFlyer(), ...
            **kwargs: The same by their names.

        Returns:
            The robot.

        Raises:
            FormatError: The file is missing or broken; says where and how to fix it. A missing mesh only warns.
        """
        robot = RobotWrapper.__new__(RobotWrapper)
        robot.initFromURDF(filename, *args, **kwargs)
        return robot

    def initFromURDF(self, filename: Any, *args: Any, **kwargs: Any) -> None:
        """Makes this the robot of a URDF file; see `BuildFromURDF`.

        Args:
            filename: The file.
            *args: See `buildModelsFromUrdf`.
            **kwargs: See `buildModelsFromUrdf`.
        """
        models = buildModelsFromUrdf(filename, *args, **kwargs)
        RobotWrapper.__init__(self, *_robot_of(models, 3))

    @staticmethod
    def BuildFromSDF(*_: Any, **__: Any) -> NoReturn:
        """Not offered.

        Args:
            *_: Accepted and ignored.
            **__: Accepted and ignored.

        Raises:
            InputError: Always: SDF files are not read.
        """
        raise InputError("SDF files are not read. Convert the file to URDF, and use BuildFromURDF.")

    def initFromSDF(self, *_: Any, **__: Any) -> NoReturn:
        """Not offered; see `BuildFromSDF`.

        Args:
            *_: Accepted and ignored.
            **__: Accepted and ignored.
        """
        RobotWrapper.BuildFromSDF()

    @staticmethod
    def BuildFromMJCF(filename: Any, *args: Any, **kwargs: Any) -> RobotWrapper:
        """The robot of an MJCF file; see `pinocchio.buildModelsFromMJCF`.

        Args:
            filename: The file.
            *args: See `buildModelsFromMJCF`.
            **kwargs: See `buildModelsFromMJCF`.

        Returns:
            The robot.
        """
        robot = RobotWrapper.__new__(RobotWrapper)
        robot.initFromMJCF(filename, *args, **kwargs)
        return robot

    def initFromMJCF(self, filename: Any, *args: Any, **kwargs: Any) -> None:
        """Makes this the robot of an MJCF file; see `BuildFromMJCF`.

        Args:
            filename: The file.
            *args: See `buildModelsFromMJCF`.
            **kwargs: See `buildModelsFromMJCF`.
        """
        model, constraints, *geometries = _robot_of(buildModelsFromMJCF(filename, *args, **kwargs), 4)
        RobotWrapper.__init__(self, model, *geometries, constraint_models=constraints)

    # sizes and names ------------------------------------------------------------------------------------

    @property
    def nq(self) -> int:
        """How many numbers a configuration has."""
        return self.model.nq

    @property
    def nv(self) -> int:
        """How many numbers a velocity has."""
        return self.model.nv

    def index(self, name: str) -> int:
        """The index of the joint of that name. Raises UnknownName with the nearest one."""
        return self.model.getJointId(name)

    def rebuildData(self) -> None:
        """Makes new data, after joints, frames or geometries were added."""
        self.data, self.collision_data, self.visual_data = createDatas(
            self.model, self.collision_model, self.visual_model
        )
        if self.viz is not None:
            self.viz.rebuildData()

    # the centre of mass and momenta ---------------------------------------------------------------------

    def com(self, q: Any = None, v: Any = None, a: Any = None) -> Any:
        """The centre of mass, with v also its velocity, with a its acceleration.

        Args:
            q: Configuration (nq,) [rad or m]; None for the state that the data holds.

        Returns:
            (3,) [m], or a tuple with (3,) [m/s] and (3,) [m/s^2].
        """
        if q is None:
            return center_of_mass.centerOfMass(self.model, self.data)
        state = [x for x in (q, v, a) if x is not None]
        center_of_mass.centerOfMass(self.model, self.data, *state)
        results = (self.data.com[0], self.data.vcom[0], self.data.acom[0])[: len(state)]
        return results[0] if len(results) == 1 else results

    def vcom(self, q: Any, v: Any) -> Floats:
        """The velocity of the centre of mass.

        Returns:
            Velocity (3,) [m/s].
        """
        return self.com(q, v)[1]

    def acom(self, q: Any, v: Any, a: Any) -> Floats:
        """The acceleration of the centre of mass.

        Returns:
            Acceleration (3,) [m/s^2].
        """
        return self.com(q, v, a)[2]

    def Jcom(self, q: Any) -> Floats:
        """The Jacobian of the centre of mass (3, nv)."""
        return center_of_mass.jacobianCenterOfMass(self.model, self.data, q)

    def centroidalMomentum(self, q: Any, v: Any) -> Force:
        """The momentum about the centre of mass.

        Returns:
            Force (6,) [kg m/s] and [kg m^2/s], in world axes.
        """
        return center_of_mass.computeCentroidalMomentum(self.model, self.data, q, v)

    def centroidalMap(self, q: Any) -> Floats:
        """The matrix (6, nv) from velocities to the momentum about the centre of mass."""
        return center_of_mass.computeCentroidalMap(self.model, self.data, q)

    def centroidal(self, q: Any, v: Any) -> tuple[Any, Any, Any]:
        """The momentum about the centre of mass, its matrix, and the inertia of the whole as one body.

        Returns:
            Momentum, its matrix (6, nv), and the inertia.
        """
        center_of_mass.ccrba(self.model, self.data, q, v)
        return self.data.hg, self.data.Ag, self.data.Ig

    def centroidalMomentumVariation(self, q: Any, v: Any, a: Any) -> Force:
        """The time derivative of the momentum about the centre of mass.

        Returns:
            Force (6,) [N] and [N m], in world axes.
        """
        return center_of_mass.computeCentroidalMomentumTimeVariation(self.model, self.data, q, v, a)

    # dynamics -------------------------------------------------------------------------------------------

    def mass(self, q: Any) -> Floats:
        """The mass matrix (nv, nv)."""
        return dynamics.crba(self.model, self.data, q)

    def nle(self, q: Any, v: Any) -> Floats:
        """Coriolis, centrifugal and gravity torques.

        Returns:
            Torques (nv,) [N m or N].
        """
        return dynamics.nonLinearEffects(self.model, self.data, q, v)

    bias = biais = nle
    """Historic names of `nle`."""

    def gravity(self, q: Any) -> Floats:
        """Gravity torques (nv,)."""
        return dynamics.computeGeneralizedGravity(self.model, self.data, q)

    def buildReducedRobot(
        self, list_of_joints_to_lock: Any, reference_configuration: Any = None
    ) -> RobotWrapper:
        """The robot with some joints locked.

        Args:
            list_of_joints_to_lock: Names or indices of the joints.
            reference_configuration: Configuration (nq,) [rad or m] in which they are locked; neutral by default.

        Returns:
            The robot.
        """
        locked = [self.index(j) if isinstance(j, str) else self._joint(j) for j in list_of_joints_to_lock]
        q = configurations.neutral(self.model) if reference_configuration is None else reference_configuration
        geometries = [g for g in (self.visual_model, self.collision_model) if g is not None]
        model, reduced = model_editing.buildReducedModel(self.model, geometries, locked, q)
        left = iter(reduced)
        visual = None if self.visual_model is None else next(left)
        collision = None if self.collision_model is None else next(left)
        return RobotWrapper(model, collision, visual)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_") or name in ("viz", "model"):
            raise AttributeError(name)
        offered = [n for n in (*dir(type(self)), *self.__dict__) if n[0] != "_"]
        replaced = replacement_message("RobotWrapper", name)
        kind = "attribute of a RobotWrapper"
        text = f"No {kind} named {name!r}. {replaced}" if replaced else str(UnknownName(kind, name, offered))
        raise AttributeError(text, name=name, obj=self)

    def __repr__(self) -> str:
        return f"<RobotWrapper of {self.model.name!r}: nq={self.nq}, nv={self.nv}>"


__all__ = ["RobotWrapper"]


def _robot_of(models: tuple[Any, ...], count: int) -> tuple[Any, ...]:
    """What was built of a file, if a robot can be made of it.

    Raises:
        InputError: It lacks the geometries of one kind.
    """
    if len(models) != count:
        raise InputError(
            f"A RobotWrapper holds the collision and the visual geometries; {len(models) - count + 2} of 2 were asked "
            "for. Leave `geometry_types` out, or build the models alone: buildModelsFromUrdf."
        )
    return models
