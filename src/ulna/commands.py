"""What the commands of `ulna` do, each with the arguments that its parser chose."""

from __future__ import annotations

import argparse
import os
import re
from collections.abc import Sequence
from typing import Any

from ulna.errors import InputError


def list_robots(chosen: argparse.Namespace) -> None:
    """Prints the robots that can be loaded by name."""
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


def info(chosen: argparse.Namespace) -> int:
    """Prints a robot, or what looks wrong with its description, then returning 1; writes a repaired one."""
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


def show(chosen: argparse.Namespace) -> None:
    """Shows a robot on a page, or writes a picture, film or page."""
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


def export(chosen: argparse.Namespace) -> None:
    """Writes compiled functions of a robot for other programs."""
    from ulna.exporting import export
    from ulna.exporting.selection import identifier
    from ulna.loading import load

    options = _export_options(chosen)
    names = _names(chosen.kernel)
    robot = load(chosen.name)
    prefix = chosen.prefix or identifier(robot.name)
    output = chosen.output or f"{prefix}_{chosen.to}"
    print(export(robot, names, chosen.to, output, name=prefix, dtype=chosen.dtype, **options))


def prepare(chosen: argparse.Namespace) -> None:
    """Compiles kernels of a robot, so that programs find them on the disk."""
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


_WRITTEN = {
    "name": "--prefix",
    "dtype": "--dtype",
    "to": "--to",
    "path": "--output",
    "kernels": "--kernel",
    "robot": "NAME",
}
"""Arguments of `export` that are no options of targets or kernels, and how they are given."""


def _export_options(chosen: argparse.Namespace) -> dict[str, Any]:
    """Options of targets and kernels, from --option, --frame and --triple."""
    options = _options(chosen.option)
    for key, way in _WRITTEN.items():
        if key in options:
            raise InputError(f"--option {key}= is not known; give it as {way}.")
    for key in ("frame", "triple"):
        value = getattr(chosen, key)
        if value is not None and key in options:
            raise InputError(f"--{key} {value} and --option {key}= are given; leave one out.")
        if value is not None:
            options[key] = value
    return options


def _options(words: Sequence[str]) -> dict[str, Any]:
    """Options as typed, OPTION=VALUE: numbers and truth values as such, other values as texts; with commas several."""
    options: dict[str, Any] = {}
    for word in words:
        key, sign, text = word.partition("=")
        if not (sign and key.isidentifier()):
            raise InputError(
                f"--option {word!r} has no value; expected OPTION=VALUE, such as reference=local."
            )
        if key in options:
            raise InputError(f"--option {key}= is given more than once; leave out all but one.")
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


def demo(chosen: argparse.Namespace) -> None:
    """Runs the demonstration."""
    from ulna import demo

    demo.demo(True if chosen.headless else None, chosen.output, chosen.port)


def run(chosen: argparse.Namespace) -> int:
    """Runs a script with the compatibility packages; returns its exit code."""
    from ulna.compat import run

    return run.run(chosen.program, chosen.only)


def doctor(chosen: argparse.Namespace) -> int:
    """Prints what a script uses of other packages, and whether it is offered; returns 1 where something is not."""
    from ulna.compat.doctor import examine, report

    findings = examine(chosen.path)
    print(report(chosen.path, findings))
    return int(any(f.offered is False for f in findings))


def cache(chosen: argparse.Namespace) -> None:
    """Prints where compiled kernels are stored, or removes them."""
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
