"""Jobs on the command line: `ulna reach`, `ulna dataset`, `ulna plans`, `ulna sweep`, `ulna identify`."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from ulna.errors import InputError


def add_commands(command: Callable[..., argparse.ArgumentParser]) -> None:
    """Adds the commands of jobs to a parser.

    Args:
        command: Makes the parser of a command: `command(name, run, about, more)`.
    """
    more = "The same command continues a job that was stopped. Without --scheduler a cluster of this machine starts."

    def job(name: str, run: Callable[[argparse.Namespace], None], about: str) -> argparse.ArgumentParser:
        parser = command(name, run, about, more)
        help = "a name from `ulna list`, or the path of a robot's file"
        parser.add_argument("name", metavar="NAME", help=help)
        return parser

    _add_reach(job("reach", _reach, "map where a robot's tool can be, on a Dask cluster"))
    _add_data_set(job("dataset", _data_set, "write random states and quantities at them into a Zarr group"))
    _add_plans(job("plans", _plans, "plan many motions among obstacles, on a Dask cluster"))
    _add_sweep(job("sweep", _sweep, "how a quantity changes with masses, payloads, placements"))
    _add_identify(job("identify", _identify, "masses, inertias and friction from a log of any length"))


def _add_reach(reach: argparse.ArgumentParser) -> None:
    reach.add_argument(
        "--samples", type=float, default=1e7, metavar="N", help="how many configurations (default 1e7)"
    )
    reach.add_argument(
        "--voxel", type=float, default=0.05, metavar="M", help="edge of a voxel [m] (default 0.05)"
    )
    reach.add_argument("--frame", metavar="FRAME", help="a frame instead of the tool")
    reach.add_argument(
        "--solutions", type=float, default=0, metavar="N", help="samples whose IK solutions are counted"
    )
    reach.add_argument("--picture", metavar="PNG", help="write a picture of the map")
    reach.add_argument("--page", metavar="HTML", help="write a page of the map that can be turned")
    _job_options(reach, "1e6", "samples", seeds="of the configurations")


def _add_data_set(data: argparse.ArgumentParser) -> None:
    data.add_argument(
        "columns", nargs="*", metavar="COLUMN", help="q, v, a, tau, a kernel, collides (default: q fk)"
    )
    data.add_argument("--samples", type=float, default=1e6, metavar="N", help="how many rows (default 1e6)")
    data.add_argument("--dtype", default="float64", help="float64 (default) or float32")
    _job_options(data, "1e5", "rows", seeds="of the states")


def _add_plans(plans: argparse.ArgumentParser) -> None:
    plans.add_argument("--problems", type=float, metavar="N", help="how many random problems")
    plans.add_argument(
        "--from", dest="problem_file", metavar="NPZ", help="problems instead: arrays `starts` and `goals`"
    )
    plans.add_argument(
        "--box",
        type=float,
        nargs=6,
        action="append",
        default=[],
        metavar=("X", "Y", "Z", "DX", "DY", "DZ"),
        help="an obstacle: its centre and its edges [m]; may be repeated",
    )
    plans.add_argument(
        "--margin", type=float, default=0.0, metavar="M", help="how near everything may come [m]"
    )
    _job_options(plans, "100", "problems", seeds="of problems and searches")


def _add_sweep(sweep: argparse.ArgumentParser) -> None:
    sweep.add_argument("quantity", metavar="QUANTITY", help="the name of a kernel, such as gravity_forces")
    sweep.add_argument(
        "--vary",
        action="append",
        default=[],
        metavar="NAME=RANGE",
        help="what varies: mass=0.1 (to either side), payload=0:3 (from, to) ...; may be repeated",
    )
    sweep.add_argument("--samples", type=float, metavar="N", help="how many (default 1e6)")
    sweep.add_argument("--levels", type=int, metavar="N", help="all combinations of N values each instead")
    sweep.add_argument("--configuration", metavar="NAME", help="a named one of the robot (default: neutral)")
    _job_options(sweep, "1e5", "samples", seeds="of the samples")


def _add_identify(fit: argparse.ArgumentParser) -> None:
    fit.add_argument(
        "log", metavar="LOG", help="a Zarr group, a folder with q.npy ..., or an NPZ file: q, v, a, tau"
    )
    for name in ("armature", "damping", "friction"):
        fit.add_argument(f"--{name}", action="store_true", help=f"seek the {name} of the drives, too")
    fit.add_argument("--physical", action="store_true", help="only bodies that can exist")
    fit.add_argument("--noise", choices=["auto"], help="auto: weigh the joints by the noise of their torques")
    fit.add_argument("--parameters", metavar="NPY", help="write the dynamic parameters that were found")
    _job_options(fit, "5e4", "rows")


def _job_options(parser: argparse.ArgumentParser, chunk: str, rows: str, seeds: str = "") -> None:
    """The options of all jobs: their parts, where they run and where the result is written."""
    add = parser.add_argument
    add("--chunk", type=float, default=chunk, metavar="N", help=f"{rows} of one part (default {chunk})")
    if seeds:
        add("--seed", type=int, default=0, help=f"{seeds} (default 0)")
    add("--to", metavar="ZARR", help="where the result is written, and beside it the progress")
    add("--scheduler", metavar="ADDRESS", help="of a Dask scheduler, such as tcp://host:8786")
    add("--workers", type=int, metavar="N", help="processes of this machine; 0: none but this one")


def _reach(chosen: argparse.Namespace) -> None:
    from ulna.scale.reachability import reach
    from ulna.viewer.output.png import checked_png_path
    from ulna.viewer.page.html_file import checked_html_path

    if not (chosen.to or chosen.picture or chosen.page):
        raise InputError("There is nothing to do: give --to, --picture or --page.")
    if chosen.picture:
        checked_png_path(chosen.picture)  # before the work, which may take hours
    if chosen.page:
        checked_html_path(chosen.page)
    reach_map = reach(
        chosen.name,
        chosen.samples,
        voxel=chosen.voxel,
        frame=chosen.frame,
        solutions=chosen.solutions,
        **_job_arguments(chosen),
    )
    print(reach_map)
    if chosen.picture:
        reach_map.picture(chosen.picture)
        print(chosen.picture)
    if chosen.page:
        print(reach_map.page(chosen.page))


def _data_set(chosen: argparse.Namespace) -> None:
    from ulna.scale.data_sets import data_set

    if not chosen.to:
        raise InputError("A data set needs a place: give --to, such as --to data.zarr.")
    data = data_set(
        chosen.name,
        chosen.samples,
        chosen.columns or ("q", "fk"),
        dtype=chosen.dtype,
        **_job_arguments(chosen),
    )
    if hasattr(data, "schema"):  # of Parquet files
        lines = [f"{column.name}: {column.type}" for column in data.schema] + [f"{data.count_rows()} rows"]
    else:
        lines = [f"{name}: {array.dtype} {array.shape}" for name, array in sorted(data.arrays())]
    print("\n".join(lines))


def _plans(chosen: argparse.Namespace) -> None:
    from ulna.collision import World
    from ulna.geometry import Box
    from ulna.scale import npz
    from ulna.scale.many_plans import plans

    problems: dict[str, Any] = {"problems": chosen.problems}
    if chosen.problem_file:
        problems |= npz.read(chosen.problem_file, ("starts", "goals"))
    world = World()
    for k, numbers in enumerate(chosen.box):
        world = world.add(f"box {k + 1}", Box(tuple(numbers[3:])), tuple(numbers[:3]))
    plan_set = plans(
        chosen.name,
        world=world if chosen.box else None,
        margin=chosen.margin,
        **problems,
        **_job_arguments(chosen),
    )
    print(plan_set)


def _sweep(chosen: argparse.Namespace) -> None:
    from ulna.loading import load
    from ulna.scale.sweeps import sweep

    robot = load(chosen.name)
    at = {} if chosen.configuration is None else {"q": robot.configurations[chosen.configuration]}
    result = sweep(
        robot,
        chosen.quantity,
        _ranges(chosen.vary),
        chosen.samples,
        levels=chosen.levels,
        at=at,
        **_job_arguments(chosen),
    )
    print(result)
    print(f"{'entry':>10s} {'mean':>12s} {'deviation':>12s} {'least':>12s} {'greatest':>12s}")
    arrays = (result.mean, result.deviation, result.least, result.greatest)
    for k, numbers in enumerate(zip(*(array.reshape(-1).tolist() for array in arrays), strict=True)):
        print(f"{k:10d} " + " ".join(f"{number:12.5g}" for number in numbers))


def _identify(chosen: argparse.Namespace) -> None:
    import numpy as np

    from ulna.scale.identifying import identify

    if (
        chosen.parameters and Path(chosen.parameters).suffix != ".npy"
    ):  # before the work, which may take hours
        raise InputError(
            f"--parameters is {chosen.parameters!r}; expected the name of a file that ends in .npy."
        )
    fit = identify(
        chosen.name,
        chosen.log,
        armature=chosen.armature,
        damping=chosen.damping,
        friction=chosen.friction,
        physical=chosen.physical,
        noise=chosen.noise,
        **_job_arguments(chosen),
    )
    if chosen.parameters:
        Path(chosen.parameters).parent.mkdir(parents=True, exist_ok=True)
        np.save(chosen.parameters, fit.parameters)
    print(fit.report())


def _ranges(texts: Sequence[str]) -> dict[str, Any]:
    ranges = [_range(words) for words in texts]
    for name, _ in ranges:
        if sum(other == name for other, _ in ranges) > 1:
            raise InputError(f"`--vary {name}=` is given more than once; leave out all but one.")
    return dict(ranges)


def _range(words: str) -> tuple[str, Any]:
    """A name and its range, of NAME=WIDTH or NAME=LOW:HIGH."""
    name, _, span = words.rpartition("=")
    try:
        ends = tuple(float(end) for end in span.split(":"))
    except ValueError:
        ends = ()
    if not name or len(ends) not in (1, 2):
        raise InputError(f"`--vary` is {words!r}; expected such as mass=0.1 or payload=0:3.")
    return name, ends[0] if len(ends) == 1 else ends


def _job_arguments(chosen: argparse.Namespace) -> dict[str, Any]:
    """What `_job_options` adds, as the functions of jobs take it."""
    names = ("chunk", "seed", "to", "scheduler", "workers")
    return {name: value for name, value in vars(chosen).items() if name in names}
