"""Build a robot from its parts: a pendulum on a cart, with a ball joint at the end; then hang a gripper on an arm.

You should see two tables.
"""

import ulna
from ulna.geometry import Box, Geometry, Sphere
from ulna.model import Prismatic, Revolute, Spherical


def main() -> None:
    b = ulna.ModelBuilder("cart")
    b.add_link("rail")
    b.add_link("cart", ulna.Inertia.from_box(2.0, (0.2, 0.1, 0.1)), [Geometry("body", Box((0.2, 0.1, 0.1)))])
    b.add_link("rod", ulna.Inertia.from_cylinder(0.3, radius=0.01, length=0.5))
    b.add_link("bob", ulna.Inertia.from_sphere(0.5, radius=0.05), [Geometry("bob", Sphere(0.05))])
    b.add_joint("slide", Prismatic([1, 0, 0]), "rail", "cart", lower=-1.0, upper=1.0, effort=50.0)
    b.add_joint("swing", Revolute([0, 1, 0]), "cart", "rod", damping=0.01)
    b.add_joint("ball", Spherical(), "rod", "bob", ulna.SE3.trans(0, 0, -0.5))
    cart = ulna.Robot(b.build())
    print(cart)
    print("bob at", cart.fk(cart.neutral, "bob")[:3, 3], "m")

    arm = ulna.load("ur5", visuals="simple")
    hand = ulna.load("panda_fingers", visuals="simple")
    fingers = hand.lock({name: 0.0 for name in hand.joint_names[:7]})
    both = arm.attach(fingers, "tool0", prefix="carried_")
    print(both)


if __name__ == "__main__":
    main()
