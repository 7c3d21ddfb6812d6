"""Robots read from URDF and xacro files, and those that are known by a name."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from roboticstoolbox._common.errors import UnknownOption
from roboticstoolbox._robots.from_model import from_model, read_model
from roboticstoolbox._robots.robot import Robot
from ulna.errors import InputError


class URDFRobot(Robot):
    """A robot read from a URDF or xacro file, or by a name that Ulna knows."""

    URDFRobot: Any

    def __init__(
        self,
        urdf_path: Any,
        manufacturer: str = "",
        gripper_link_index: int | None = None,
        gripper_link_name: str | Sequence[str] | None = None,
        patch: Any = None,
        extra_packages: dict[str, str] | None = None,
    ) -> None:
        """A robot from a file, or from the catalogue.

        Args:
            urdf_path: A path, also of a description in the package `rtb-data`, or a name such as "ur5".
            manufacturer: Who makes it.
            gripper_link_index: Number of the first link of its gripper, as they stand in the file.
            gripper_link_name: Its name, or names of which the first that there is counts.
            patch: Not supported; raises InputError.
            extra_packages: Folders of ROS packages, also in the package `rtb-data`, by name.

        Raises:
            InputError: `patch` is given.
            UnknownOption: There is no such link.
        """
        if patch is not None:
            raise InputError("`patch` is not offered; fix the file, or pass its fixed text.")
        model, path = read_model(urdf_path, extra_packages)
        names = [link.name for link in model.links]
        gripper = None if gripper_link_index is None else names[gripper_link_index]
        if gripper_link_name is not None:
            wanted = [gripper_link_name] if isinstance(gripper_link_name, str) else list(gripper_link_name)
            gripper = next((name for name in wanted if name in names), None)
            if gripper is None:
                raise UnknownOption("link of a gripper", wanted[0], names)
        self._filled(from_model(Robot, model, gripper, manufacturer=manufacturer, urdf_filepath=path))

    def _filled(self, like: Robot) -> None:
        self.__dict__.update(like.__dict__)
        for link in self.link_dict.values():
            link.robot = self


def URDF_file(
    file: Any, patch: Any = None, extra_packages: dict[str, str] | None = None
) -> tuple[list[Any], str, Any]:
    """The links in a URDF or xacro file, as arguments of `Robot`; see `URDFRobot`.

    Args:
        file: A path, or a name such as "ur5".
        patch: Not supported; raises InputError.
        extra_packages: Folders of ROS packages, also in the package `rtb-data`, by name.

    Returns:
        The links, the name of the robot, and the path of the file.
    """
    robot = URDFRobot(file, patch=patch, extra_packages=extra_packages)
    return [link.copy() for link in robot.links], robot.name, robot.urdf_filepath


def URDF_read(urdf_path: Any, patch: Any = None) -> tuple[list[Any], str, Any]:
    """The links in a file; see `URDF_file`.

    Args:
        urdf_path: A path, or a name such as "ur5".
        patch: Not supported; raises InputError.

    Returns:
        The links, the name of the robot, and the path of the file.
    """
    return URDF_file(urdf_path, patch)


URDFRobot.URDFRobot = URDFRobot  # the toolbox's module of that name is asked for it
