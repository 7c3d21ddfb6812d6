"""The classes of robots, composed of the packages beside this one."""
