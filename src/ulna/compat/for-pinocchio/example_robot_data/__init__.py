"""The loaders of example-robot-data for the installed data: `load("ur5")` returns a RobotWrapper."""

from example_robot_data.robots_loader import ROBOTS as ROBOTS
from example_robot_data.robots_loader import getModelPath as getModelPath
from example_robot_data.robots_loader import load as load
from example_robot_data.robots_loader import load_full as load_full
from example_robot_data.robots_loader import loadUR as loadUR
from example_robot_data.robots_loader import readParamsFromSrdf as readParamsFromSrdf
