"""Inverse kinematics: from poses of a frame to configurations."""

from ulna.ik.differential import AccelerationLimit as AccelerationLimit
from ulna.ik.differential import AxisTask as AxisTask
from ulna.ik.differential import ComTask as ComTask
from ulna.ik.differential import DampingTask as DampingTask
from ulna.ik.differential import DifferentialIK as DifferentialIK
from ulna.ik.differential import FrameTask as FrameTask
from ulna.ik.differential import Interval as Interval
from ulna.ik.differential import JointCouplingTask as JointCouplingTask
from ulna.ik.differential import Limit as Limit
from ulna.ik.differential import LinearLimit as LinearLimit
from ulna.ik.differential import LinearTask as LinearTask
from ulna.ik.differential import ManipulabilityTask as ManipulabilityTask
from ulna.ik.differential import OrientationTask as OrientationTask
from ulna.ik.differential import PlaneLimit as PlaneLimit
from ulna.ik.differential import PositionLimit as PositionLimit
from ulna.ik.differential import PositionTask as PositionTask
from ulna.ik.differential import PostureTask as PostureTask
from ulna.ik.differential import Problem as Problem
from ulna.ik.differential import RelativeFrameTask as RelativeFrameTask
from ulna.ik.differential import Rows as Rows
from ulna.ik.differential import Strip as Strip
from ulna.ik.differential import Task as Task
from ulna.ik.differential import VelocityLimit as VelocityLimit
