"""The command line as a person meets it: what it prints, where, and how it ends."""

from __future__ import annotations

import errno
import json
import os
import pty
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from inspect import signature
from pathlib import Path

import pytest
from commands import refused

import mocurve
from mocurve import cli
from mocurve.commands import COMMANDS, _options, _terminal
from mocurve.progress import listening

REPORT_NAMES = {
    "keys",
    "samples",
    "lower_bound",
    "max_error_degrees",
    "max_error_length",
    "max_error_world",
    "seconds",
}


@pytest.fixture
def short(jump: Path, tmp_path: Path) -> Path:
    """The first 30 frames of the shipped capture: enough to reduce in a moment."""
    head, rows = jump.read_text(encoding="ascii").split("Frame Time:")
    time, *frames = rows.splitlines()
    path = tmp_path / "short.bvh"
    path.write_text(head.replace("Frames: 420", "Frames: 30") + "\n".join(["Frame Time:" + time, *frames[:30]]) + "\n")
    return path


# -- help ----------------------------------------------------------------------------------------
def test_without_arguments_it_says_what_it_can_do(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main([]) == 0
    told = capsys.readouterr().out
    assert all(name in told for name in COMMANDS)
    assert "mocurve reduce jump.bvh -o jump.curves.json" in told


@pytest.mark.parametrize("name", COMMANDS)
def test_help_of_every_command_says_what_and_shows_an_example(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main([name, "--help"]) == 0
    told = " ".join(capsys.readouterr().out.split())
    assert COMMANDS[name] in told
    assert f"mocurve {name}" in told.split("For example:", 1)[1]


@pytest.mark.parametrize(
    ("name", "verb"), [("reduce", mocurve.reduce), ("clean", mocurve.denoise), ("render", mocurve.render)]
)
def test_every_option_of_a_verb_is_an_option_of_its_command_and_explained(
    name: str, verb: Callable[..., object], capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main([name, "--help"]) == 0
    told = " ".join(re.sub("[│╭╮╰╯─]", " ", capsys.readouterr().out).split())
    options = [option.name for option in signature(verb).parameters.values() if option.kind is option.KEYWORD_ONLY]
    explained = {option: _options._told(verb.__doc__ or "")[option] for option in options}
    assert options
    assert not [option for option in options if f"--{option.replace('_', '-')} " not in told]
    assert not [text for text in explained.values() if " ".join(text.split()[:6]) not in told or not text]


def test_the_words_after_an_option_name_are_its_help() -> None:
    told = _options._told("Do it.\n\nwidth: in pixels,\n    at most 9.\nview\n    From\n    where.\n\nReturns nothing.")
    assert told == {"width": "in pixels, at most 9.", "view": "From where."}


def test_the_version_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["--version"]) == 0
    assert capsys.readouterr().out == f"mocurve {mocurve.__version__}\n"


@pytest.mark.parametrize("arguments", [["--help"], ["info", "--help"], ["info", "jump.bvh"]])
def test_help_and_info_load_no_kernels_and_no_plots(arguments: list[str], jump: Path) -> None:
    program = (
        "import sys; from mocurve import cli; cli.main(sys.argv[1:]); "
        "print(sorted({'numba', 'scipy', 'plotly', 'PIL', 'matplotlib'} & set(sys.modules)))"
    )
    ran = subprocess.run(
        [sys.executable, "-c", program, *arguments], cwd=jump.parent, capture_output=True, text=True, check=True
    )
    assert ran.stdout.splitlines()[-1] == "[]"


# -- the main job --------------------------------------------------------------------------------
def test_reduce_writes_the_keys_and_tells_what_it_cost(short: Path, capsys: pytest.CaptureFixture[str]) -> None:
    keys = short.with_name("short.curves.json")
    assert cli.main(["reduce", str(short), "-o", str(keys), "--tolerance", "1%height"]) == 0
    out, err = capsys.readouterr()
    assert "keys" in out
    assert str(keys) in out
    assert err == ""
    assert json.loads(keys.read_text())


def test_reduce_prints_exactly_one_json_object(short: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = [
        "--tolerance",
        "2deg",
        "--tolerance",
        "LeftHand=3deg",
        "--method",
        "split",
        "--align",
        "joint",
        "--json",
    ]
    assert cli.main(["reduce", str(short), *arguments]) == 0
    out, err = capsys.readouterr()
    told = json.loads(out)
    assert told.keys() >= REPORT_NAMES
    assert told["samples"] == 30 * 96
    assert 0 < told["keys"] < told["samples"]
    assert told["max_error_degrees"] <= 3.0
    assert (told["method"], told["align"]) == ("split", "joint")
    assert err == ""


@pytest.mark.parametrize("extension", [".bvh", ".csv", ".npz", ".curves.json"])
def test_reduce_writes_every_format(short: Path, extension: str) -> None:
    target = short.with_name("reduced" + extension)
    assert cli.main(["reduce", str(short), "-o", str(target), "--tolerance", "5deg", "--method", "linear"]) == 0
    assert target.stat().st_size > 0


def test_keys_travel_through_all_commands(short: Path, capsys: pytest.CaptureFixture[str]) -> None:
    keys, sampled, picture = (short.with_name(name) for name in ("k.curves.json", "s.bvh", "p.png"))
    assert cli.main(["reduce", str(short), "-o", str(keys), "--tolerance", "2deg", "--method", "linear"]) == 0
    assert cli.main(["convert", str(keys), str(sampled)]) == 0
    assert cli.main(["render", str(keys), "-o", str(picture)]) == 0
    assert picture.read_bytes().startswith(b"\x89PNG")
    capsys.readouterr()
    assert cli.main(["compare", str(short), str(sampled), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert 0 < told["max_error_degrees"] <= 2.001
    assert told["lower_bound"] is None
    assert cli.main(["info", str(keys), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["frames"] == 30


def test_refine_keeps_the_number_of_keys_and_takes_only_keys(short: Path, capsys: pytest.CaptureFixture[str]) -> None:
    keys, better = short.with_name("k.curves.json"), short.with_name("b.curves.json")
    assert cli.main(["reduce", str(short), "-o", str(keys), "--tolerance", "3deg", "--method", "split"]) == 0
    capsys.readouterr()
    assert cli.main(["refine", str(keys), str(short), "-o", str(better), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["keys"] == mocurve.read(keys).keys == mocurve.read(better).keys
    assert "no keys" in refused(capsys, "refine", short, short, "-o", better)


def test_compare_writes_a_page(short: Path, capsys: pytest.CaptureFixture[str]) -> None:
    page = short.with_name("page.html")
    assert cli.main(["compare", str(short), str(short), "--html", str(page)]) == 0
    assert str(page) in capsys.readouterr().out
    assert "<html" in page.read_text(encoding="utf-8")[:2000].lower()


def test_a_unit_can_be_a_name_or_metres(short: Path, capsys: pytest.CaptureFixture[str]) -> None:
    units = []
    for unit in ("cm", "0.01"):
        assert cli.main(["info", str(short), "--unit", unit]) == 0
        units.append(capsys.readouterr().out)
    assert units[0] == units[1]


def test_the_example_is_put_where_asked_and_twice_is_fine(tmp_path: Path, jump: Path) -> None:
    assert cli.main(["example", str(tmp_path)]) == 0
    assert cli.main(["example", str(tmp_path)]) == 0
    assert (tmp_path / "jump.bvh").read_bytes() == jump.read_bytes()


# -- refusals: one line, exit code 2 ---------------------------------------------------------------
def test_an_unknown_command_is_answered_with_the_nearest(capsys: pytest.CaptureFixture[str]) -> None:
    assert refused(capsys, "redcue") == "mocurve: no command 'redcue'. Did you mean 'reduce'?\n"


def test_an_unknown_option_is_answered_with_the_nearest(capsys: pytest.CaptureFixture[str]) -> None:
    line = refused(capsys, "reduce", "a.bvh", "--tolerence", "2mm")
    assert "--tolerence" in line
    assert "Did you mean --tolerance?" in line


def test_a_missing_argument_is_named(capsys: pytest.CaptureFixture[str]) -> None:
    assert "FILE" in refused(capsys, "info")


def test_a_file_that_is_not_there_is_named(capsys: pytest.CaptureFixture[str]) -> None:
    line = refused(capsys, "info", "nowhere.bvh")
    assert "nowhere.bvh" in line
    assert "no such file" in line


def test_an_unknown_extension_lists_the_known_ones(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "walk.fbx").write_bytes(b"")
    line = refused(capsys, "info", tmp_path / "walk.fbx")
    assert ".bvh" in line
    assert ".curves.json" in line


def test_a_broken_file_is_refused_with_its_line(short: Path, capsys: pytest.CaptureFixture[str]) -> None:
    lines = short.read_text().splitlines()
    lines[-1] = lines[-1].rsplit(" ", 2)[0]
    short.write_text("\n".join(lines) + "\n")
    assert f"{short}:{len(lines)}: " in refused(capsys, "info", short)


@pytest.mark.parametrize(
    ("option", "value", "told"),
    [
        ("--tolerance", "2", "a number and a unit"),
        ("--tolerance", "LeftHnd=2mm", "Did you mean 'LeftHand'?"),
        ("--method", "optimul", "optimal"),
        ("--align", "joints", "joint"),
        ("--quality", "bst", "best"),
        ("--unit", "ells", "ells"),
    ],
)
def test_a_wrong_value_is_named(
    option: str, value: str, told: str, short: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert told in refused(capsys, "reduce", short, option, value, "--json")


@pytest.mark.parametrize("command", ["reduce {} -o {}", "convert {} {}", "render {} -o {}", "compare {} {} --html {}"])
def test_the_input_is_never_written_over(command: str, short: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = short.read_bytes()
    assert "is the file that is read" in refused(capsys, *command.replace("{}", str(short)).split(" "))
    assert short.read_bytes() == before


def test_another_jump_is_not_written_over_by_the_example(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "jump.bvh").write_text("mine")
    assert "is another file" in refused(capsys, "example", tmp_path)


def test_a_full_disk_is_one_line(
    short: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), "jump.bvh")

    monkeypatch.setattr(shutil, "copyfile", full)
    assert refused(capsys, "example", short.parent) == "mocurve: jump.bvh: No space left on device\n"


def test_warnings_are_one_line_each_and_no_refusal(short: Path, capsys: pytest.CaptureFixture[str]) -> None:
    short.write_text(short.read_text().replace("Frames: 30", "Frames: 31"))
    assert cli.main(["info", str(short)]) == 0
    err = capsys.readouterr().err
    assert err.startswith("warning: ")
    assert err.count("\n") == 1
    assert "31" in err
    assert "30" in err


def test_the_same_warning_is_told_once(capsys: pytest.CaptureFixture[str]) -> None:
    show = cli._told_once()
    for text in ("odd", "odd", "odder"):
        show(UserWarning(text), UserWarning, "file.py", 1, None, None)
    assert capsys.readouterr().err == "warning: odd\nwarning: odder\n"


# -- how it ends otherwise -------------------------------------------------------------------------
def test_an_interrupt_ends_with_130(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(shutil, "copyfile", interrupted)
    assert cli.main(["example", str(tmp_path)]) == cli.INTERRUPTED


def test_a_closed_pipe_is_quiet(short: Path) -> None:
    reader, writer = os.pipe()
    os.close(reader)
    with os.fdopen(writer, "wb") as pipe:
        ran = subprocess.run(
            [sys.executable, "-m", "mocurve.cli", "info", short], stdout=pipe, stderr=subprocess.PIPE, check=False
        )
    assert ran.stderr == b""
    assert ran.returncode == cli.PIPE_CLOSED


def test_letters_that_the_terminal_lacks_are_no_error() -> None:
    command = [sys.executable, "-m", "mocurve.cli", "reduce", "--help"]
    ran = subprocess.run(
        command, env=os.environ | {"PYTHONIOENCODING": "ascii"}, capture_output=True, text=True, check=False
    )
    assert (ran.returncode, ran.stderr) == (0, "")


# -- progress --------------------------------------------------------------------------------------
def test_progress_is_silent_where_stderr_is_no_terminal(capsys: pytest.CaptureFixture[str]) -> None:
    with _terminal.Bar() as bar:
        bar.born -= 60.0
        bar("reducing", 1, 2)
        bar("compiling", 0, 0)
    assert capsys.readouterr() == ("", "")


def test_progress_shows_on_a_terminal_after_a_second(monkeypatch: pytest.MonkeyPatch) -> None:
    ours, theirs = pty.openpty()
    with os.fdopen(theirs, "w") as terminal:
        monkeypatch.setattr(sys, "stderr", terminal)
        with _terminal.Bar() as bar:
            bar("reading", 1, 3)
            assert bar.progress is None
            bar.born -= 2.0
            bar("reducing", 1, 3)
        monkeypatch.undo()
    shown = ""
    with suppress(OSError):  # what a terminal answers at its end
        while piece := os.read(ours, 10_000):
            shown += piece.decode()
    os.close(ours)
    assert "reducing" in shown
    assert "reading" not in shown


def test_compiling_is_told_until_the_outermost_kernel_is_done_also_from_a_thread() -> None:
    numba = pytest.importorskip("numba")
    inner = numba.njit(lambda x: x + 1)
    outer = numba.njit(lambda x: inner(x) * 2)
    told: list[tuple[str, int, int]] = []
    with listening(lambda *step: told.append(step)), _terminal.told_when_compiling(), ThreadPoolExecutor(1) as pool:
        assert pool.submit(outer, 3).result() == 8
    assert told == [(_terminal.COMPILING, done, 0) for done in (0, 0, 1)]
