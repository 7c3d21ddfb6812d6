"""Two worker processes map where a UR5 reaches, and solve inverse kinematics of Dask arrays.

You should see the volume that the tool reaches, and that all goals are met, in some seconds.
"""

import dask.array as da
from distributed import Client, LocalCluster

import ulna
from ulna import scale


def main(samples: int = 400_000) -> None:
    robot = ulna.load("ur5")
    cluster = LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0")
    with cluster, Client(cluster) as client:
        found = scale.reach(robot, samples, voxel=0.1, chunk=100_000, scheduler=client, progress=False)
        print(found)
        print(f"seen from at most {found.directions.max():.0%} of all directions; {found.volume:.2f} m^3")
        Q = da.from_array(robot.random_configuration(20_000, seed=0), chunks=(5_000, 6))
        solution = robot.ik(robot.fk(Q))  # lazy: nothing is computed yet
        print(solution)
        print(f"{solution.success.mean().compute():.2%} of {len(Q):,} goals are met")


if __name__ == "__main__":
    main()
