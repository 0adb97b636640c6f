"""The truth of the surface: what README and docs say is what the package does."""

from __future__ import annotations

import re
import shlex
import shutil
from pathlib import Path

import pytest

import mocurve
from mocurve import cli
from mocurve.commands import COMMANDS

ROOT = Path(__file__).parent.parent
README = ROOT / "README.md"
PAGES = [README, ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]


def blocks(page: Path, language: str) -> list[str]:
    """The code blocks of a page in a language, "" for those that name none."""
    return [
        code
        for told, code in re.findall(r"^```(\w*)\n(.*?)^```$", page.read_text("utf-8"), re.M | re.S)
        if told == language
    ]


def commands(page: Path) -> list[list[str]]:
    """Every `mocurve ...` line in the unnamed code blocks of a page, as arguments, without comments."""
    parts = [part for block in blocks(page, "") for line in block.splitlines() for part in line.split("&&")]
    split = [shlex.split(part, comments=True) for part in parts]
    return [words[1:] for words in split if words and words[0].split("/")[-1] == "mocurve"]


@pytest.fixture
def beside_the_jump(jump: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with jump.bvh in it, to run in."""
    shutil.copy(jump, tmp_path / "jump.bvh")
    monkeypatch.chdir(tmp_path)
    return tmp_path


# -- README --------------------------------------------------------------------------------------
def test_the_readme_python_runs(beside_the_jump: Path) -> None:
    namespace: dict[str, object] = {}
    code = blocks(README, "python")
    assert code
    for block in code:
        exec(block, namespace)


def test_the_readme_commands_run(beside_the_jump: Path, capsys: pytest.CaptureFixture[str]) -> None:
    given = [tuple(words) for words in commands(README)]
    assert ("example",) in given
    for words in dict.fromkeys(given):  # the set-up command and the list share some
        assert cli.main(words) == 0, words
    assert (beside_the_jump / "jump.html").stat().st_size > 0


def test_the_readme_tells_the_test_command_that_ci_runs() -> None:
    command = next(line for block in blocks(README, "") for line in block.splitlines() if "scripts/check" in line)
    steps = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    assert "pip install -e '.[dev]'" in command
    assert "-e '.[dev]'" in steps
    assert "scripts/check" in steps


def test_the_readme_names_every_command_and_every_verb() -> None:
    text = README.read_text(encoding="utf-8")
    verbs = [name for name in mocurve.__all__ if name.islower() and not name.startswith("_")]
    assert not [name for name in COMMANDS if f"mocurve {name}" not in text]
    assert not [name for name in verbs if f"mc.{name}" not in text]


# -- docs ----------------------------------------------------------------------------------------
@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.stem)
def test_links_and_pictures_lead_somewhere(page: Path) -> None:
    for target in re.findall(r"\]\(([^)\s]+)\)", page.read_text(encoding="utf-8")):
        if "://" in target:
            continue
        name, _, anchor = target.partition("#")
        linked = (page.parent / name).resolve() if name else page
        assert linked.exists(), target
        if anchor:
            headings = re.findall(r"^#+ (.+)$", linked.read_text(encoding="utf-8"), re.M)
            assert anchor in [re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-") for heading in headings], target


@pytest.mark.parametrize("page", [p for p in PAGES if commands(p)], ids=lambda p: p.stem)
def test_commands_in_the_docs_have_only_options_that_exist(page: Path) -> None:
    for words in commands(page):
        assert words[0] in COMMANDS, words
        cli.application(words[0]).parse_args(words, print_error=False, exit_on_error=False)


@pytest.mark.parametrize("page", [p for p in PAGES if p != README and blocks(p, "python")], ids=lambda p: p.stem)
def test_python_in_the_docs_runs(page: Path, beside_the_jump: Path) -> None:
    namespace: dict[str, object] = {}
    for block in blocks(page, "python"):
        exec(block, namespace)


def test_every_verb_with_a_command_and_every_paper_has_a_page() -> None:
    assert {"reduce", "denoise", "compare", "formats", "conventions"} <= {page.stem for page in PAGES}
    assert (ROOT / "docs" / "papers" / "onder-2007.md").exists()


def test_every_page_is_found_from_the_readme() -> None:
    text = README.read_text(encoding="utf-8")
    lost = [str(page.relative_to(ROOT)) for page in PAGES if page != README and str(page.relative_to(ROOT)) not in text]
    assert not lost


def test_the_reduce_page_names_every_option_value_and_report_name() -> None:
    from mocurve.reduction import CHOOSERS, METHODS

    for page, names in (("reduce.md", METHODS), ("poses.md", ["optimal", *CHOOSERS])):
        text = (ROOT / "docs" / page).read_text(encoding="utf-8")
        assert not [name for name in names if f"| `{name}`" not in text], page


# -- the shipped capture -----------------------------------------------------------------------------
def test_the_capture_ships_with_its_terms_and_the_acknowledgement(jump: Path) -> None:
    terms = " ".join((jump.parent / "LICENSE.txt").read_text(encoding="utf-8").split())
    assert "The data used in this project was obtained from mocap.cs.cmu.edu." in terms
    assert "The database was created with funding from NSF EIA-0196217." in terms
    assert "The database was created with funding from NSF EIA-0196217." in " ".join(README.read_text("utf-8").split())


def test_the_capture_is_the_cut_that_the_script_makes(jump: Path) -> None:
    import importlib.util

    source = Path("/usr/share/assimp/models/BVH/01_01.bvh")
    if not source.exists():
        pytest.skip("the source of the shipped capture is not here: Debian's package assimp-testmodels")
    spec = importlib.util.spec_from_file_location("cut_example", ROOT / "scripts" / "cut_example.py")
    assert spec is not None
    assert spec.loader is not None
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    assert script.cut(source.read_text(encoding="ascii")) == jump.read_text(encoding="ascii")


def test_the_capture_reads_as_the_readme_says(jump: Path) -> None:
    motion = mocurve.read(jump)
    assert motion.values.shape == (420, 96)
    assert motion.frame_time == 1 / 120
    assert len(motion.skeleton.names) - motion.skeleton.end_sites.sum() == 31
