"""The face of example-robot-data's loaders over the installed data: `load("ur5")` gives a RobotWrapper."""

from example_robot_data.robots_loader import ROBOTS as ROBOTS
from example_robot_data.robots_loader import getModelPath as getModelPath
from example_robot_data.robots_loader import load as load
from example_robot_data.robots_loader import loadUR as loadUR
