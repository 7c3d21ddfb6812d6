"""A kernel inside of PyTorch: a small network learns the inverse kinematics of a region from the derivatives of FK.

You should see the mean distance of the tool from its goals fall from decimetres to a centimetre or two. Needs PyTorch.
"""

import ulna


def main(steps: int = 100) -> None:
    try:
        import torch
    except ImportError:
        print("This example needs PyTorch: pip install torch")
        return
    torch.manual_seed(1)
    robot = ulna.load("panda")
    fk = ulna.interop.to_torch(robot.kernel("fk", dtype="float32"))
    middle = torch.tensor(robot.configurations["qr"], dtype=torch.float32)
    center = fk(middle)[:3, 3]
    network = torch.nn.Sequential(torch.nn.Linear(3, 64), torch.nn.Tanh(), torch.nn.Linear(64, 7))
    optimizer = torch.optim.Adam(network.parameters(), lr=3e-3)
    for step in range(steps + 1):
        offset = 0.3 * (torch.rand(256, 3) - 0.5)  # goals in a box around the tool
        q = middle + network(offset / 0.15)
        distance = (fk(q)[:, :3, 3] - center - offset).norm(dim=-1)
        if step % 50 == 0:
            print(f"  step {step:3d}: {1e3 * float(distance.detach().mean()):6.1f} mm from the goals")
        optimizer.zero_grad()
        (distance**2).mean().backward()  # through the robot, by compiled code
        optimizer.step()
    assert float(distance.detach().mean()) < 0.03


if __name__ == "__main__":
    main()
