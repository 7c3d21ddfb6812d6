"""The command `ulna`: robots listed, described, shown; a demonstration; scripts of others run; the cache."""

from __future__ import annotations

import argparse
import io
import os
import re
import sys
import warnings
from collections.abc import Callable, Sequence
from typing import Any

from ulna.errors import InputError, UlnaError

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
    chosen = parser.parse_args(options)
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


def _end_output() -> None:
    """Writes what is left of the output; what cannot be written goes nowhere, instead of failing once more at exit."""
    if sys.stdout is None:
        return
    try:
        sys.stdout.flush()
    except OSError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


_ROBOT = "a name from `ulna list`, or the path of a .urdf, .xacro or MJCF (.xml) file"


def _parser() -> argparse.ArgumentParser:
    from ulna import __version__
    from ulna.scale.commands import add_commands

    parser = argparse.ArgumentParser(prog="ulna", description=_ABOUT)
    parser.add_argument("--version", action="version", version=f"ulna {__version__}")
    commands = parser.add_subparsers(title="commands", metavar="COMMAND")

    def command(name: str, run: Any, about: str, more: str = "") -> argparse.ArgumentParser:
        sub = commands.add_parser(
            name, help=about, description=f"{about[0].upper()}{about[1:]}. {more}".strip()
        )
        sub.set_defaults(run=run)
        return sub

    command("list", _list, "list the robots that can be loaded by name").add_argument(
        "words", nargs="*", metavar="WORD", help="only those whose name or description holds all of these"
    )
    _robot_commands(command)
    _script_commands(command)
    add_commands(command)
    cache = command("cache", _cache, "show where compiled kernels are stored, and how many")
    cache.add_argument("--clear", action="store_true", help="remove them; they are compiled anew when needed")
    return parser


def _robot_commands(command: Callable[..., argparse.ArgumentParser]) -> None:
    """Adds info, show, export, prepare and demo."""
    info = command(
        "info",
        _info,
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
    show = command(
        "show",
        _show,
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
    _export_command(command)
    _prepare_command(command)
    demo = command(
        "demo",
        _demo,
        "show a Panda servoing its tool to a goal",
        "In the browser where there is a screen; at a terminal without one the page waits at its address. "
        "Elsewhere, and with --headless, it is a report and a picture.",
    )
    _picture_options(demo, "ulna-demo.png")


def _export_command(command: Callable[..., argparse.ArgumentParser]) -> None:
    """Adds export."""
    export = command(
        "export",
        _export,
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
        _prepare,
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
        _run,
        "run a script written for the Robotics Toolbox or Pinocchio, unmodified, on Ulna",
        "In that Python, `import roboticstoolbox`, `import pinocchio` and their companions find Ulna's packages.",
    )
    run.add_argument(
        "--only", action="append", default=[], metavar="PACKAGE", help="roboticstoolbox or pinocchio"
    )
    run.usage = "%(prog)s [-h] [--only PACKAGE] (SCRIPT | -m MODULE | -c CODE | -) [ARGUMENT ...]"
    doctor = command("doctor", _doctor, "list what a script uses of those packages that Ulna does not offer")
    doctor.add_argument("path", metavar="SCRIPT")


def _picture_options(parser: argparse.ArgumentParser, file: str) -> None:
    parser.add_argument("--headless", action="store_true", help="no page: write a picture and end")
    parser.add_argument("--output", metavar="PNG", help=f"file of the picture (headless: {file})")
    parser.add_argument(
        "--port", type=int, help="port of the page (default $ULNA_PORT or 8080; 0: any free one)"
    )


def _list(chosen: argparse.Namespace) -> None:
    from ulna.robots.catalogue import entries

    words = [w.lower() for w in chosen.words]
    matches = [e for e in entries() if all(w in f"{e.name} {e.about} {e.source}".lower() for w in words)]
    if not matches:
        raise InputError(f"No robot matches {' '.join(chosen.words)!r}. `ulna list` shows all of them.")
    width = max(len(e.name) for e in matches)
    source = ""
    for entry in matches:
        if entry.source != source:
            print(f"{entry.source}:" if not source else f"\n{entry.source}:")
            source = entry.source
        print(f"  {entry.name:<{width}}  {entry.about}".rstrip())


def _info(chosen: argparse.Namespace) -> int:
    if (chosen.from_shapes or chosen.density is not None) and not chosen.repair:
        raise InputError("--from-shapes and --density are for --repair FILE, which names the file to write.")
    if chosen.repair:
        from ulna.diagnosis import repair_inertias

        changed = repair_inertias(
            chosen.name,
            chosen.repair,
            chosen.from_shapes,
            density=chosen.density,
            package_dirs=chosen.package_dirs,
        )
        print(f"{chosen.repair}: {', '.join(changed) or 'nothing'} repaired")
        chosen.name, chosen.check = chosen.repair, True
    if chosen.check:
        from ulna.diagnosis import diagnose, report

        findings = diagnose(chosen.name, package_dirs=chosen.package_dirs)
        print(report(findings))
        return int(any(f.severity != "note" for f in findings))
    from ulna.loading import load_model

    print(load_model(chosen.name, package_dirs=chosen.package_dirs))
    return 0


def _show(chosen: argparse.Namespace) -> None:
    from ulna.loading import load
    from ulna.viewer.graph.theme import theme_of
    from ulna.viewer.output.png import checked_png_path
    from ulna.viewer.output.video import checked_video_path
    from ulna.viewer.page.browser import somebody_can_look
    from ulna.viewer.robot.link_surfaces import checked_display
    from ulna.viewer.show import configuration, show

    if chosen.live:
        _write_live_page(chosen)
        return
    chosen.theme = chosen.theme or "light"
    what, theme = checked_display(chosen.show), theme_of(chosen.theme)
    if chosen.output:
        checked_png_path(chosen.output)
    if chosen.film:
        checked_video_path(chosen.film)
    robot = load(chosen.name)
    q = configuration(robot, _values(chosen.q))
    written = chosen.output or chosen.film or chosen.html
    if written or chosen.headless:
        _write(robot, q, chosen)
    if not chosen.headless:
        with show(robot, q, port=chosen.port, theme=theme, show=what) as page:
            page.hold()
        if not (written or somebody_can_look()):
            print("`ulna show NAME --headless` writes a picture instead.")


def _write_live_page(chosen: argparse.Namespace) -> None:
    """Write the page of `robot.save_html`; with --theme it has that theme, without that of the browser."""
    from ulna.loading import load

    for option in ("output", "film", "html"):
        if getattr(chosen, option):
            raise InputError(
                f"--live writes a page only; expected no --{option}. Run the command once for each file."
            )
    print(
        load(chosen.name).save_html(
            chosen.live, q=_values(chosen.q), show=chosen.show, theme=chosen.theme or "auto"
        )
    )


def _write(robot: Any, q: Any, chosen: argparse.Namespace) -> None:
    """Write what was asked for of a robot without a page: a picture, a film, a page for later."""
    from ulna.viewer.render.renderer import render, write_png
    from ulna.viewer.robot.joint_sweep import joint_sweep
    from ulna.viewer.viewer import Viewer

    viewer = Viewer(page=False, title=robot.name, theme=chosen.theme)
    viewer.add(robot, q, show=chosen.show)
    if chosen.output or not (chosen.film or chosen.html):
        picture = render(viewer.scene, theme=chosen.theme)
        print(write_png(chosen.output or _picture_of(chosen.name), picture))
    if chosen.film:
        print(viewer.film(chosen.film, joint_sweep(robot, q)))
    if chosen.html:
        print(viewer.html(chosen.html, joint_sweep(robot, q)))


def _export(chosen: argparse.Namespace) -> None:
    from ulna.exporting import export
    from ulna.exporting.selection import identifier
    from ulna.loading import load

    options = _options(chosen.option)
    options |= {key: value for key in ("frame", "triple") if (value := getattr(chosen, key)) is not None}
    names = _names(chosen.kernel)
    robot = load(chosen.name)
    prefix = chosen.prefix or identifier(robot.name)
    output = chosen.output or f"{prefix}_{chosen.to}"
    print(export(robot, names, chosen.to, output, name=prefix, dtype=chosen.dtype, **options))


def _prepare(chosen: argparse.Namespace) -> None:
    from ulna import disk_cache
    from ulna.loading import load

    if disk_cache.folder() is None:
        raise InputError(
            "The cache is off (ULNA_CACHE=0); expected a folder, where kernels stay for later programs."
        )
    robot = load(chosen.name)
    options = {} if chosen.frame is None else {"frame": chosen.frame}
    preparation = robot.prepare(*_names(chosen.kernel), workers=chosen.workers, **options)
    try:
        for count, name in enumerate(preparation.as_ready(), 1):
            print(
                f"{count} of {len(preparation.names)}: {name}, {preparation.seconds[name]:.1f} s", flush=True
            )
        for name, error in preparation.errors.items():
            print(f"{name} is left out: {error}")
        preparation.wait()
    finally:
        preparation.cancel()
    print(f"{robot.name!r} is ready; the code is in {disk_cache.folder()}")


def _names(words: Sequence[str]) -> list[str]:
    """Names as typed, parted by blanks or commas."""
    return [name for word in words for name in word.replace(",", " ").split()]


def _options(words: Sequence[str]) -> dict[str, Any]:
    """Options as typed, OPTION=VALUE: numbers and truth values as such, other values as texts; with commas several."""
    options: dict[str, Any] = {}
    for word in words:
        key, sign, text = word.partition("=")
        if not (sign and key.isidentifier()):
            raise InputError(
                f"--option {word!r} has no value; expected OPTION=VALUE, such as reference=local."
            )
        parts = [_option(part) for part in text.split(",") if part]
        options[key] = tuple(parts) if "," in text else _option(text)
    return options


def _option(text: str) -> Any:
    """A truth value, a number, or the text itself."""
    if text.lower() in ("true", "false"):
        return text.lower() == "true"
    if not _is_number(text):
        return text
    return int(text) if text.lstrip("+-").isdecimal() else float(text)


def _picture_of(name: str) -> str:
    """The file, in the working directory, for the picture of a robot of that name or in that file."""
    stem = re.sub(r"[^\w-]+", "_", os.path.basename(name).split(".")[0])
    return f"ulna-{stem.strip('_') or 'robot'}.png"


def _values(words: list[str] | None) -> Any:
    """A configuration as typed: None, a name, or numbers parted by blanks or commas."""
    if words is None:
        return None
    parts = [p for word in words for p in word.replace(",", " ").split()]
    try:
        return [float(p) for p in parts]
    except ValueError:
        if len(parts) == 1:
            return parts[0]
        wrong = next(p for p in parts if not _is_number(p))
        raise InputError(f"--q holds {wrong!r}; expected numbers, or one name such as qr.") from None


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _demo(chosen: argparse.Namespace) -> None:
    from ulna.demo import demo

    demo(True if chosen.headless else None, chosen.output, chosen.port)


def _run(chosen: argparse.Namespace) -> int:
    from ulna.compat.run import run

    return run(chosen.program, chosen.only)


def _parted(arguments: list[str]) -> tuple[list[str], list[str]]:
    """What the parser of the command reads, and the program that `ulna run` is to run."""
    if arguments[:1] != ["run"]:
        return arguments, []
    from ulna.compat.run import split

    options, program = split(arguments[1:])
    return ["run", *options], program


def _doctor(chosen: argparse.Namespace) -> int:
    from ulna.compat.doctor import examine, report

    findings = examine(chosen.path)
    print(report(chosen.path, findings))
    return int(any(f.offered is False for f in findings))


def _cache(chosen: argparse.Namespace) -> None:
    from ulna import disk_cache as cache

    place = cache.folder()
    if place is None:
        print("The cache is off (ULNA_CACHE=0).")
        return
    if chosen.clear:
        count = cache.clear()
        print(f"Removed {count} kernel{'' if count == 1 else 's'} from {place}")
        return
    files = cache.entries(place) if place.is_dir() else []
    size = sum(f.stat().st_size for f in files)
    print(f"{place}\n{len(files)} kernel{'' if len(files) == 1 else 's'}, {size / 2**20:.1f} MiB")


def _warn(message: Warning | str, *_: Any, **__: Any) -> None:
    print(f"ulna: warning: {' '.join(str(message).split())}", file=sys.stderr)
