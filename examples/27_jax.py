"""A kernel inside of JAX: torques that swing an arm to a goal, by the gradient of a whole simulation.

You should see the distance of the tool from its goal fall to some centimetres. Needs JAX.
"""

import ulna


def main(steps: int = 60) -> None:
    try:
        import jax
        import jax.numpy as jnp
    except ImportError:
        print("This example needs JAX: pip install jax")
        return
    robot = ulna.load("panda")
    accelerate = ulna.interop.to_jax(robot.kernel("forward_dynamics"))
    hold = ulna.interop.to_jax(robot.kernel("gravity_forces"))
    fk = ulna.interop.to_jax(robot.kernel("fk"))
    start = jnp.asarray(robot.configurations["qr"])
    goal = fk(start)[:3, 3] + jnp.array([0.0, 0.25, 0.1])
    dt, count = 0.01, 30

    def miss(torques: "jax.Array") -> "jax.Array":
        """How far from the goal the tool is after the motion [m], with a small price for speed at the end."""

        def step(state: tuple, tau: "jax.Array") -> tuple:
            q, v = state
            v = v + dt * accelerate(q, v, tau + hold(q))
            return (q + dt * v, v), None

        (q, v), _ = jax.lax.scan(step, (start, jnp.zeros(7)), torques)
        return ((fk(q)[:3, 3] - goal) ** 2).sum() + 1e-4 * (v**2).sum()

    improve = jax.jit(jax.value_and_grad(miss))
    torques, momentum = jnp.zeros((count, 7)), jnp.zeros((count, 7))
    for k in range(steps + 1):
        value, gradient = improve(torques)
        if k % 15 == 0:
            print(f"  step {k:2d}: cost {float(value):.5f}")
        momentum = 0.8 * momentum - gradient / (1e-9 + jnp.abs(gradient).max()) * 0.2
        torques = torques + momentum
    assert value < 0.01


if __name__ == "__main__":
    main()
