"""The command `ulna`: its arguments, and how it ends; what its commands do is in `commands`."""

from __future__ import annotations

import argparse
import io
import os
import re
import sys
import warnings
from collections.abc import Callable, Sequence
from typing import Any

from ulna import commands
from ulna.errors import UlnaError, nearest

_ABOUT = "Ulna compiles your robot: kinematics of articulated robots, from the textbook into machine code."


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; returns its exit code: 0 well, 2 for what the user can fix, 130 for Ctrl-C.

    Args:
        arguments: The words after `ulna`; those of the process when not given.
    """
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):  # tables are drawn with signs that not every terminal knows
            stream.reconfigure(errors="replace")
    parser = _parser()
    options, program = _parted(list(sys.argv[1:] if arguments is None else arguments))
    chosen, unknown = parser.parse_known_args(options)
    if unknown:
        _refuse_unknown(getattr(chosen, "parser", parser), unknown)
    chosen.program = program
    if not hasattr(chosen, "run"):
        parser.print_help()
        return 0
    with warnings.catch_warnings():
        warnings.showwarning = _warn
        try:
            code = chosen.run(chosen)
            if sys.stdout is not None:
                sys.stdout.flush()
        except UlnaError as error:
            print(f"ulna: {' '.join(str(error).split())}", file=sys.stderr)
            return 2
        except KeyboardInterrupt:
            print(file=sys.stderr)
            return 130
        except BrokenPipeError:  # the reader of a pipe has seen enough
            _end_output()
            return 0
        except OSError as error:
            _end_output()
            print(
                f"ulna: {error.strerror or error}{f': {error.filename}' if error.filename else ''}",
                file=sys.stderr,
            )
            return 2
    return code or 0


def _refuse_unknown(parser: argparse.ArgumentParser, unknown: Sequence[str]) -> None:
    """Ends the program with the usage of the command, what it does not know, and the options that read alike."""
    known = [word for action in parser._actions for word in action.option_strings]
    options = [word.partition("=")[0] for word in unknown if word.startswith("-")]
    alike = [match for option in options for match in nearest(option, known, 1, 0.6)]
    hint = f"; did you mean {' or '.join(alike)}?" if alike else ""
    parser.error(f"unrecognized arguments: {' '.join(unknown)}{hint}")


def _end_output() -> None:
    """Writes what is left of the output; what cannot be written goes nowhere, instead of failing once more at exit."""
    if sys.stdout is None:
        return
    try:
        sys.stdout.flush()
    except OSError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


_ROBOT = "a name from `ulna list`, or the path of a .urdf, .xacro or MJCF (.xml) file"


_NEGATIVE = re.compile(r"-(\d|\.\d)[-+.,_\de]*", re.IGNORECASE)
"""Where numbers begin with a negative one: no option of a command begins with a digit."""


def _parser() -> argparse.ArgumentParser:
    from ulna import __version__
    from ulna.scale.commands import add_commands

    parser = argparse.ArgumentParser(prog="ulna", description=_ABOUT)
    parser.add_argument("--version", action="version", version=f"ulna {__version__}")
    subparsers = parser.add_subparsers(title="commands", metavar="COMMAND")

    def command(name: str, run: Any, about: str, more: str = "") -> argparse.ArgumentParser:
        sub = subparsers.add_parser(
            name, help=about, description=f"{about[0].upper()}{about[1:]}. {more}".strip()
        )
        sub.set_defaults(run=run, parser=sub)
        sub._negative_number_matcher = _NEGATIVE  # argparse takes -1e-3 and -1,0 for options
        return sub

    command("list", commands.list_robots, "list the robots that can be loaded by name").add_argument(
        "words", nargs="*", metavar="WORD", help="only those whose name or description holds all of these"
    )
    _robot_commands(command)
    _script_commands(command)
    add_commands(command)
    cache = command("cache", commands.cache, "show where compiled kernels are stored, and how many")
    cache.add_argument("--clear", action="store_true", help="remove them; they are compiled anew when needed")
    return parser


def _robot_commands(command: Callable[..., argparse.ArgumentParser]) -> None:
    """Adds info, show, export, prepare and demo."""
    _info_command(command)
    _show_command(command)
    _export_command(command)
    _prepare_command(command)
    demo = command(
        "demo",
        commands.demo,
        "show a Panda servoing its tool to a goal",
        "In the browser where there is a screen; at a terminal without one the page waits at its address. "
        "Elsewhere, and with --headless, it is a report and a picture.",
    )
    _picture_options(demo, "ulna-demo.png")


def _info_command(command: Callable[..., argparse.ArgumentParser]) -> None:
    """Adds info."""
    info = command(
        "info",
        commands.info,
        "describe a robot: its joints, links, limits and configurations",
        "With --check it lists what looks wrong instead; the exit status is then 1 where there is an error or a "
        "warning, 0 where there are only notes or nothing.",
    )
    info.add_argument("name", metavar="NAME", help=_ROBOT)
    info.add_argument("--check", action="store_true", help="list what looks wrong, with the file's lines")
    info.add_argument(
        "--repair",
        metavar="FILE",
        help="write a copy of a URDF file whose inertias bodies can have; then list the rest",
    )
    info.add_argument(
        "--from-shapes",
        nargs="+",
        default=(),
        metavar="LINK",
        help="with --repair: links whose inertias are computed from their shapes and masses",
    )
    info.add_argument("--density", type=float, help="with --from-shapes: of links that have no mass [kg/m^3]")
    info.add_argument(
        "--package-dirs", nargs="+", default=(), metavar="FOLDER", help="folders to look for packages in"
    )


def _show_command(command: Callable[..., argparse.ArgumentParser]) -> None:
    """Adds show."""
    show = command(
        "show",
        commands.show,
        "show a robot in the browser, with sliders and a target to drag",
        "With --headless it writes a picture instead, and needs neither a browser nor a screen.",
    )
    show.add_argument("name", metavar="NAME", help=_ROBOT)
    configuration = "configuration: a named one of the robot (qr), or a number for each joint [rad or m]"
    show.add_argument("-q", "--q", nargs="+", metavar="VALUE", help=configuration)
    for option, default, about in (
        ("--show WHAT", "visual", "visual (default), collision, both or skeleton"),
        ("--theme THEME", None, "light (default) or dark; with --live that of the browser where not given"),
        ("--film FILE", None, "write a film of its joints, .mp4 or .gif, and no picture"),
        ("--html FILE", None, "write a page of the same that plays offline, and no picture"),
        (
            "--live FILE",
            None,
            "write a page whose tool can be dragged in any browser, offline, and nothing else",
        ),
    ):
        name, metavar = option.split()
        show.add_argument(name, metavar=metavar, default=default, help=about)
    _picture_options(show, "ulna-NAME.png")


def _export_command(command: Callable[..., argparse.ArgumentParser]) -> None:
    """Adds export."""
    export = command(
        "export",
        commands.export,
        "write compiled functions of a robot as sources or objects for other programs",
        "Options of targets and kernels are given as OPTION=VALUE: reference=local.",
    )
    export.add_argument("name", metavar="NAME", help=_ROBOT)
    kernels = "names of quantities and ik, parted by commas: fk,jacobian,ik (default fk)"
    export.add_argument("--kernel", nargs="+", default=["fk"], metavar="KERNEL", help=kernels)
    export.add_argument(
        "--to",
        default="c",
        metavar="TARGET",
        help="what to write: c (default), object, wasm, ...; a wrong one lists all",
    )
    export.add_argument("--output", metavar="DIR", help="the folder to write (default: NAME_TARGET)")
    export.add_argument("--frame", metavar="FRAME", help="the frame, for kernels of one (default: the tool)")
    export.add_argument(
        "--triple", metavar="TRIPLE", help="the processor of an object file: aarch64-linux-gnu, ..."
    )
    export.add_argument("--dtype", metavar="TYPE", help="float64 (default) or float32")
    export.add_argument(
        "--prefix", metavar="PREFIX", help="what names begin with (default: the robot's name)"
    )
    export.add_argument(
        "--option", action="append", default=[], metavar="OPTION=VALUE", help="an option; may be repeated"
    )


def _prepare_command(command: Callable[..., argparse.ArgumentParser]) -> None:
    """Adds prepare."""
    prepare = command(
        "prepare",
        commands.prepare,
        "compile kernels of a robot ahead, in parallel, into the cache",
        "Programs that use them later start without waiting for the compiler.",
    )
    prepare.add_argument("name", metavar="NAME", help=_ROBOT)
    kernels = (
        "names of quantities and ik, parted by commas: fk,jacobian,ik (default: those that are used daily)"
    )
    prepare.add_argument("--kernel", nargs="+", default=[], metavar="KERNEL", help=kernels)
    prepare.add_argument("--frame", metavar="FRAME", help="the frame, for kernels of one (default: the tool)")
    prepare.add_argument(
        "--workers", type=int, metavar="N", help="processes (default: one for each processor)"
    )


def _script_commands(command: Callable[..., argparse.ArgumentParser]) -> None:
    """Adds run and doctor."""
    run = command(
        "run",
        commands.run,
        "run a script written for the Robotics Toolbox or Pinocchio, unmodified, on Ulna",
        "In that Python, `import roboticstoolbox`, `import pinocchio` and their companions find Ulna's packages.",
    )
    run.add_argument(
        "--only", action="append", default=[], metavar="PACKAGE", help="roboticstoolbox or pinocchio"
    )
    run.usage = "%(prog)s [-h] [--only PACKAGE] (SCRIPT | -m MODULE | -c CODE | -) [ARGUMENT ...]"
    doctor = command(
        "doctor", commands.doctor, "list what a script uses of those packages that Ulna does not offer"
    )
    doctor.add_argument("path", metavar="SCRIPT")


def _picture_options(parser: argparse.ArgumentParser, file: str) -> None:
    parser.add_argument("--headless", action="store_true", help="no page: write a picture and end")
    parser.add_argument("--output", metavar="PNG", help=f"file of the picture (headless: {file})")
    parser.add_argument(
        "--port", type=int, help="port of the page (default $ULNA_PORT or 8080; 0: any free one)"
    )


def _parted(arguments: list[str]) -> tuple[list[str], list[str]]:
    """What the parser of the command reads, and the program that `ulna run` is to run."""
    if arguments[:1] != ["run"]:
        return arguments, []
    from ulna.compat.run import split

    options, program = split(arguments[1:])
    return ["run", *options], program


def _warn(message: Warning | str, *_: Any, **__: Any) -> None:
    print(f"ulna: warning: {' '.join(str(message).split())}", file=sys.stderr)
