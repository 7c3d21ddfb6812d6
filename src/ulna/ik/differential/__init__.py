"""Differential inverse kinematics: a language of tasks and limits, compiled into one step."""

from ulna.ik.differential.body import ComTask as ComTask
from ulna.ik.differential.body import ManipulabilityTask as ManipulabilityTask
from ulna.ik.differential.frames import AxisTask as AxisTask
from ulna.ik.differential.frames import FrameTask as FrameTask
from ulna.ik.differential.frames import OrientationTask as OrientationTask
from ulna.ik.differential.frames import PositionTask as PositionTask
from ulna.ik.differential.frames import RelativeFrameTask as RelativeFrameTask
from ulna.ik.differential.joints import DampingTask as DampingTask
from ulna.ik.differential.joints import JointCouplingTask as JointCouplingTask
from ulna.ik.differential.joints import LinearTask as LinearTask
from ulna.ik.differential.joints import PostureTask as PostureTask
from ulna.ik.differential.limits import AccelerationLimit as AccelerationLimit
from ulna.ik.differential.limits import Interval as Interval
from ulna.ik.differential.limits import Limit as Limit
from ulna.ik.differential.limits import PositionLimit as PositionLimit
from ulna.ik.differential.limits import Strip as Strip
from ulna.ik.differential.limits import VelocityLimit as VelocityLimit
from ulna.ik.differential.program import Problem as Problem
from ulna.ik.differential.rows import LinearLimit as LinearLimit
from ulna.ik.differential.rows import PlaneLimit as PlaneLimit
from ulna.ik.differential.solver import DifferentialIK as DifferentialIK
from ulna.ik.differential.task import Rows as Rows
from ulna.ik.differential.task import Task as Task
