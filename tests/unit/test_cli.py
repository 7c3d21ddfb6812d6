"""The command `ulna`: what it says, what it writes, and errors of one line."""

import os
import subprocess
import sys
from importlib.machinery import PathFinder
from pathlib import Path

import numpy as np
import pytest

import ulna
from ulna import commands
from ulna.cli import main
from ulna.errors import InputError
from ulna.viewer.robot.joint_sweep import joint_sweep

NEEDS_VISER = pytest.mark.skipif(
    PathFinder.find_spec("viser") is None, reason="viser, which serves the page, is not installed"
)


@pytest.fixture
def headless(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    monkeypatch.setenv("ULNA_HEADLESS", "1")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def small_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    import ulna.viewer.export
    import ulna.viewer.live.poster
    import ulna.viewer.notebook  # noqa: F401  modules that take the function when they are first imported
    from ulna.viewer.render import renderer as raster

    render = raster.render
    monkeypatch.setattr(raster, "render", lambda scene, *_, theme="light": render(scene, 64, 40, theme=theme))


def test_help_of_every_command(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "400")
    for command, arguments in {
        "list": ["[WORD ...]"],
        "info": [
            "[--check]",
            "[--repair FILE]",
            "[--from-shapes LINK [LINK ...]]",
            "[--density DENSITY]",
            "[--package-dirs FOLDER [FOLDER ...]]",
            "NAME",
        ],
        "show": [
            *("[-q VALUE [VALUE ...]]", "[--show WHAT]", "[--theme THEME]", "[--film FILE]", "[--html FILE]"),
            *("[--live FILE]", "[--headless]", "[--output PNG]", "[--port PORT]", "NAME"),
        ],
        "demo": ["[--headless]", "[--output PNG]", "[--port PORT]"],
        "cache": ["[--clear]"],
    }.items():
        with pytest.raises(SystemExit) as end:
            main([command, "--help"])
        assert end.value.code == 0
        usage = capsys.readouterr().out.splitlines()[0]
        assert usage == " ".join(["usage: ulna", command, "[-h]", *arguments])


def test_without_a_command_all_are_listed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([]) == 0
    said = capsys.readouterr().out
    for command in (
        "list",
        "info",
        "show",
        "demo",
        "reach",
        "dataset",
        "plans",
        "sweep",
        "identify",
        "cache",
    ):
        assert command in said


def test_list(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["list"]) == 0
    assert "panda" in capsys.readouterr().out
    assert main(["list", "universal", "UR5"]) == 0
    said = capsys.readouterr().out
    assert "ur5" in said
    assert "Franka" not in said


def test_info(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["info", "panda"]) == 0
    said = capsys.readouterr().out
    for words in ("panda_joint4", "panda_hand_tcp", "qr"):
        assert words in said


def test_show_writes_a_picture(
    headless: Path, small_pictures: None, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["show", "panda", "--headless", "--output", "x/p.png", "--q", "qz"]) == 0
    assert (headless / "x" / "p.png").read_bytes().startswith(b"\x89PNG")
    assert main(["show", "ur5", "--headless", "--q", "0", "-1", "1", "0", "0", "-.5"]) == 0
    assert (headless / "ulna-ur5.png").is_file()
    assert str(Path("ulna-ur5.png")) in capsys.readouterr().out


def test_show_takes_a_theme_and_what_to_show(headless: Path, small_pictures: None) -> None:
    pictures = []
    for k, words in enumerate(([], ["--theme", "dark"], ["--show", "skeleton"], ["-q", "qz"])):
        assert main(["show", "panda", "--headless", "--output", f"{k}.png", *words]) == 0
        pictures.append((headless / f"{k}.png").read_bytes())
    assert len(set(pictures)) == 4


def test_show_writes_a_film_and_a_page(
    headless: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("PIL")
    pytest.importorskip("viser")
    from ulna.viewer import export as studio

    monkeypatch.setattr(studio, "render", lambda *_: np.zeros((8, 8, 3), dtype=np.uint8))
    words = ["show", "ur5", "--headless", "--film", "a.gif", "--html", "a.html", "--theme", "dark"]
    assert main([*words, "--show", "skeleton"]) == 0
    assert (headless / "a.gif").read_bytes().startswith(b"GIF")
    assert "<html" in (headless / "a.html").read_text(encoding="utf-8")[:2000]
    assert capsys.readouterr().out.split() == ["a.gif", "a.html"]
    assert list(headless.glob("*.png")) == []


def test_a_tour_goes_through_the_range_of_every_joint_and_back() -> None:
    robot = ulna.load("panda", visuals="simple")
    start = robot.configurations["qr"]
    rows = joint_sweep(robot, start)
    np.testing.assert_array_equal(rows.q[0], start)
    np.testing.assert_array_equal(rows.q[-1], start)
    low, high = robot.model.lower_position, robot.model.upper_position
    assert (rows.q >= low).all() and (rows.q <= high).all()
    assert (np.ptp(rows.q, axis=0) > 0.5).all()
    moving = np.abs(np.diff(rows.q, axis=0)) > 1e-9
    assert moving.sum(axis=1).max() == 1
    assert 5.0 < rows.t[-1] < 15.0


def test_show_does_not_wait_without_a_screen(headless: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("viser")
    assert main(["show", "ur5", "--port", "0"]) == 0
    said = capsys.readouterr().out
    assert "There is no screen" in said
    assert "--headless" in said


def test_the_cache_is_described_and_cleared(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("ULNA_CACHE", str(tmp_path / "kernels"))
    assert main(["cache"]) == 0
    assert "0 kernels" in capsys.readouterr().out
    assert main(["cache", "--clear"]) == 0
    assert "Removed 0 kernels" in capsys.readouterr().out
    monkeypatch.setenv("ULNA_CACHE", "0")
    assert main(["cache"]) == 0
    assert "off" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["info", "pandda"], "'panda'"),
        (["info", "nowhere.urdf"], "nowhere.urdf"),
        (["list", "zzzz"], "zzzz"),
        (["show", "panda", "--headless", "--q", "1", "2"], "expected (7,)"),
        (["show", "panda", "--headless", "--q", "qx"], "'qr'"),
        (["show", "panda", "--headless", "--q", "1", "x", "2"], "'x'"),
        (["show", "panda", "--headless", "--q", "nan", *"000000"], "nan"),
        pytest.param(["show", "panda", "--port", "99999"], "99999", marks=NEEDS_VISER),
        (["show", "panda", "--theme", "drak"], "'dark'"),
        (["show", "panda", "--show", "visuals"], "'visual'"),
        (["show", "panda", "--film", "a.avi"], ".gif"),
        (["show", "panda", "--output", "a.bmp"], ".png"),
        (["show", "panda", "--headless", "--output", "/dev/null/a.png"], "a.png"),
    ],
)
def test_errors_are_one_line_with_the_fix(
    headless: Path, capsys: pytest.CaptureFixture[str], words: list[str], expected: str
) -> None:
    assert main(words) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("ulna: ")
    assert err.count("\n") == 1
    assert expected in err


def test_an_unknown_command_is_a_usage_error(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as end:
        main(["dance"])
    assert end.value.code == 2
    assert "dance" in capsys.readouterr().err


def test_an_unknown_option_names_the_one_that_reads_alike(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as end:
        main(["info", "panda", "--chek"])
    err = capsys.readouterr().err
    assert end.value.code == 2 and err.startswith("usage: ulna info")
    assert err.endswith("ulna info: error: unrecognized arguments: --chek; did you mean --check?\n")


def test_ctrl_c_ends_quietly(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    def interrupt(_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(commands, "list_robots", interrupt)
    assert main(["list"]) == 130
    assert "Traceback" not in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "value"),
    [
        (None, None),
        (["qr"], "qr"),
        (["1", "-2.5", "3e-1"], [1.0, -2.5, 0.3]),
        (["1,2, -3"], [1.0, 2.0, -3.0]),
        (["7"], [7.0]),
    ],
)
def test_configurations_as_typed(words: list[str] | None, value: object) -> None:
    assert commands._values(words) == value


@pytest.mark.parametrize(
    ("name", "picture"),
    [
        ("so101", "ulna-so101.png"),
        ("robots/arm.urdf.xacro", "ulna-arm.png"),
        ("../strange name!.urdf", "ulna-strange_name.png"),
        ("ulna:panda", "ulna-ulna_panda.png"),
    ],
)
def test_pictures_are_named_by_what_was_typed(name: str, picture: str) -> None:
    assert commands._picture_of(name) == picture


def test_configurations_mistyped() -> None:
    with pytest.raises(InputError, match="'b'"):
        commands._values(["1", "b"])


def test_the_module_runs_and_a_closed_pipe_is_no_accident() -> None:
    command = f"{sys.executable!r} -m ulna list | head -n 1"
    done = subprocess.run(command, shell=True, capture_output=True, text=True, check=True, timeout=600)
    assert done.stdout == "ulna:\n"
    assert done.stderr == ""


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is always full")
def test_a_full_disk_is_reported_in_one_line() -> None:
    command = f"{sys.executable!r} -m ulna info panda >/dev/full"
    done = subprocess.run(command, shell=True, capture_output=True, text=True, check=False, timeout=600)
    assert done.returncode == 2
    assert done.stderr == "ulna: No space left on device\n"


def test_without_an_output_it_still_runs() -> None:
    command = f"{sys.executable!r} -m ulna list >&-"
    done = subprocess.run(command, shell=True, capture_output=True, text=True, check=False, timeout=600)
    assert (done.returncode, done.stderr) == (0, "")


def test_tables_do_not_fail_where_their_signs_are_unknown() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "ulna", "info", "panda"],
        env={**os.environ, "PYTHONIOENCODING": "ascii"},
        capture_output=True,
        text=True,
        check=True,
        timeout=600,
    )
    assert "? 3 ? panda_joint4" in done.stdout


def test_importing_ulna_imports_nothing_heavy() -> None:
    code = "import sys, ulna, ulna.cli; print(sorted({'viser', 'trimesh', 'collada', 'ulna.viewer'} & set(sys.modules)))"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=600
    )
    assert done.stdout == "[]\n"


def test_numbers_in_a_picture_name_what_is_shown(headless: Path, small_pictures: None) -> None:
    from ulna.viewer import show

    with pytest.MonkeyPatch.context() as patch:
        seen: list[np.ndarray] = []
        original = show.configuration
        patch.setattr(show, "configuration", lambda *a: seen.append(original(*a)) or seen[-1])
        assert main(["show", "panda", "--headless", "--q", "0,-0.3,0,-2.2,0,2,0.5"]) == 0
    np.testing.assert_array_equal(seen[0], [0, -0.3, 0, -2.2, 0, 2, 0.5])


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("--option name=arm", "give it as --prefix"),
        ("--option dtype=float32", "give it as --dtype"),
        ("--option kernels=fk", "give it as --kernel"),
        ("--option test=true --option test=false", "--option test= is given more than once"),
        (
            "--option frame=panda_hand --frame panda_link3",
            "--frame panda_link3 and --option frame= are given",
        ),
    ],
)
def test_options_of_an_export_are_given_once_and_as_the_command_has_them(
    headless: Path, capsys: pytest.CaptureFixture[str], words: str, said: str
) -> None:
    assert main(["export", "panda", *words.split()]) == 2
    assert said in capsys.readouterr().err
    assert not list(headless.iterdir())


@pytest.mark.parametrize("words", ["0.1 -1e-3 0 -1 0 1 0", "-1e-3,.1 0 -1 0 1 0", "-.5,-2E-1,0,-1,0,+1,0"])
@pytest.mark.usefixtures("small_pictures")
def test_configurations_begin_with_negative_numbers_of_any_form(headless: Path, words: str) -> None:
    assert main(["show", "panda", "--headless", "-q", *words.split(), "--output", "arm.png"]) == 0
    assert (headless / "arm.png").exists()


def test_the_file_of_identified_parameters_is_checked_first(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["identify", "panda", "no.npz", "--parameters", "found.txt", "--workers", "0"]) == 2
    assert "a file that ends in .npy" in capsys.readouterr().err
