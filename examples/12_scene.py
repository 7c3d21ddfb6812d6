"""A scene of robots and things that change, as a picture: no browser, no screen.

You should see the size of the picture, the tool above the table, and how many nodes there are.
With `viewer = ulna.Viewer()` instead, the same scene is in your browser; `viewer.hold()` keeps it there.
"""

import numpy as np

import ulna
from ulna.geometry import Box


def main() -> None:
    viewer = ulna.Viewer(page=False)
    arm = viewer.add(ulna.load("panda", visuals="simple"), q="qr")
    arm.frames(arm.robot.tool)
    arm.manipulability(size=0.1)
    arm.ghosts(arm.q + np.linspace(-0.8, -0.3, 3)[:, None] * np.eye(7)[0])

    viewer.box((0.4, 0.8, 0.02), name="table/top", pose=ulna.SE3.trans(0.6, 0.0, 0.2), color=(0.8, 0.7, 0.55))
    viewer.cylinder(0.03, 0.2, name="table/leg", pose=ulna.SE3.trans(0.6, 0.0, 0.1))
    cubes = np.random.default_rng(1).uniform((0.45, -0.35, 0.23), (0.75, 0.35, 0.23), (40, 3))
    viewer.copies(Box((0.03, 0.03, 0.04)), positions=cubes, colors=(0.9, 0.45, 0.15), name="table/cubes")
    viewer["table"].opacity = 0.9  # a group's look holds for all in it
    viewer.curve([(0.4, -0.4, 0.5), (0.6, 0.0, 0.6), (0.4, 0.4, 0.5)], color=(0.1, 0.6, 0.5))
    push = arm.force(vector=(0.0, 0.0, -0.2))
    push.vector = (0.1, 0.0, -0.15)

    image = viewer.picture(None, 160, 100, samples=1)  # viewer.picture("scene.png") writes a file
    print(f"picture of {image.shape[1]} x {image.shape[0]}; tool at {arm.tool[:3, 3].round(3)} m")
    print(f"{len(viewer.scene.names)} nodes, such as {', '.join(viewer.scene.names[-4:])}")
    assert image.std() > 10.0


if __name__ == "__main__":
    main()
