"""Trajectories: motions of joints and of poses, as values that are evaluated at any time."""

from ulna.trajectory.blends import blended as blended
from ulna.trajectory.boundary import cubic as cubic
from ulna.trajectory.boundary import quintic as quintic
from ulna.trajectory.boundary import quintic_states as quintic_states
from ulna.trajectory.check import Breach as Breach
from ulna.trajectory.check import Report as Report
from ulna.trajectory.check import check as check
from ulna.trajectory.compose import Chain as Chain
from ulna.trajectory.compose import Retimed as Retimed
from ulna.trajectory.compose import concatenate as concatenate
from ulna.trajectory.files import load as load
from ulna.trajectory.files import save as save
from ulna.trajectory.following import follow as follow
from ulna.trajectory.limited import jerk_limited as jerk_limited
from ulna.trajectory.lines import arc_through as arc_through
from ulna.trajectory.lines import circle as circle
from ulna.trajectory.lines import pose_line as pose_line
from ulna.trajectory.picture import plot as _plot  # noqa: F401  # implements Trajectory.plot
from ulna.trajectory.polynomial import Polynomial as Polynomial
from ulna.trajectory.polynomial import hermite as hermite
from ulna.trajectory.pose_splines import pose_spline as pose_spline
from ulna.trajectory.profiles import s_curve as s_curve
from ulna.trajectory.profiles import trapezoidal as trapezoidal
from ulna.trajectory.straight import straight as straight
from ulna.trajectory.straight import straight_through as straight_through
from ulna.trajectory.time_optimal import time_optimal as time_optimal
from ulna.trajectory.trajectory import Samples as Samples
from ulna.trajectory.trajectory import Trajectory as Trajectory
from ulna.trajectory.waypoints import bspline as bspline
from ulna.trajectory.waypoints import cubic_spline as cubic_spline
from ulna.trajectory.waypoints import minimum_jerk as minimum_jerk
