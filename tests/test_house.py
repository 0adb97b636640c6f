"""The laws of the house: imports go downward, files stay small, names are true, no path of one machine is tracked."""

from __future__ import annotations

import ast
import re
import subprocess
from importlib import import_module
from pathlib import Path

import pytest

import mocurve

PACKAGE = Path(mocurve.__file__).parent
FILES = sorted(PACKAGE.rglob("*.py"))

# A module may import what stands in a line above its own, and modules of its own line. A folder counts as one.
LAYERS = [
    "errors",
    "_jit progress data",
    "rotation hermite bspline planar whittaker",
    "skeleton",
    "motion",
    "keyed",
    "spline",
    "kinematics",
    "info feet measure",
    "denoising",
    "reduction",
    "fitting",
    "formats",
    "path",
    "edit",
    "recipe",
    "report draw",
    "commands",
    "cli",
]
LATE = {("measure", "report")}  # Report.save loads the page writer when a page is asked for
LEVEL = {name: level for level, line in enumerate(LAYERS) for name in line.split()}


def room(path: Path) -> str:
    """The line of LAYERS that a file belongs to: its folder, or its name without what follows an underscore."""
    inside = path.relative_to(PACKAGE)
    name = inside.parts[0].removesuffix(".py")
    return name if name in LEVEL else name.split("_")[0]


def imported(path: Path) -> set[str]:
    """Rooms that a file imports anywhere in it, but not what only the type checker reads."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    only_typed = {
        inner
        for node in ast.walk(tree)
        if isinstance(node, ast.If) and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING"
        for inner in ast.walk(node)
    }
    depth = len(path.relative_to(PACKAGE).parts)
    rooms: set[str] = set()
    for node in ast.walk(tree):
        if node in only_typed or not isinstance(node, ast.ImportFrom):
            continue
        if node.level == depth:  # from .. import x, from ..x import y, counted from the package's root
            names = [node.module.split(".")[0]] if node.module else [alias.name for alias in node.names]
            rooms |= {
                room(PACKAGE / f"{name}.py")
                for name in names
                if (PACKAGE / name).exists() or (PACKAGE / f"{name}.py").exists()
            }
        elif node.level == 0 and (node.module or "").split(".")[0] == "mocurve":
            pytest.fail(f"{path.name}: inside the package imports are relative")
    return rooms


@pytest.mark.parametrize(
    "path", [p for p in FILES if p != PACKAGE / "__init__.py"], ids=lambda p: str(p.relative_to(PACKAGE))
)
def test_imports_go_only_downward(path: Path) -> None:
    own = room(path)
    assert own in LEVEL, f"{path.name} stands in no layer of this test"
    upward = {name for name in imported(path) if LEVEL[name] > LEVEL[own] and (own, name) not in LATE}
    assert not upward, f"{own} imports {upward}"


def test_the_layers_are_the_rooms_that_exist() -> None:
    assert set(LEVEL) == {room(path) for path in FILES if path != PACKAGE / "__init__.py"}


@pytest.mark.parametrize("name", ["errors", "skeleton", "keyed"])
def test_the_import_law_sees_imports(name: str) -> None:
    assert {"errors": set(), "skeleton": {"errors"}, "keyed": {"errors", "hermite", "motion", "skeleton"}}[
        name
    ] == imported(PACKAGE / f"{name}.py")


def test_no_file_is_longer_than_400_lines(repository: Path) -> None:
    scripts = [
        p for folder in ("tests", "examples", "benchmarks", "scripts") for p in (repository / folder).rglob("*.py")
    ]
    long = {
        p.name: lines for p in [*FILES, *scripts] if (lines := len(p.read_text(encoding="utf-8").splitlines())) > 400
    }
    assert not long


def test_no_module_is_called_after_nothing() -> None:
    assert not {path.stem.strip("_") for path in FILES} & {
        "utils",
        "util",
        "core",
        "base",
        "types",
        "helpers",
        "misc",
        "common",
    }


def test_every_module_says_what_it_is() -> None:
    silent = [
        str(p.relative_to(PACKAGE))
        for p in FILES
        if ast.get_docstring(ast.parse(p.read_text(encoding="utf-8"))) is None
    ]
    assert not silent


@pytest.mark.parametrize("name", [n for n in mocurve.__all__ if n != "__version__"])
def test_every_public_name_is_there_and_is_explained(name: str) -> None:
    assert (getattr(mocurve, name).__doc__ or "").strip()


def test_an_unknown_public_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="no attribute 'redcue'"):
        mocurve.redcue  # noqa: B018


@pytest.mark.parametrize(
    "module", [p for p in FILES if "__all__" in p.read_text(encoding="utf-8")], ids=lambda p: p.stem
)
def test_all_lists_only_what_exists(module: Path) -> None:
    dotted = ".".join(["mocurve", *module.relative_to(PACKAGE).with_suffix("").parts]).removesuffix(".__init__")
    loaded = import_module(dotted)
    assert not [name for name in loaded.__all__ if not hasattr(loaded, name)]


def tracked(repository: Path) -> list[Path]:
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=repository, capture_output=True, text=True, check=False)
    if listed.returncode:
        pytest.skip("not a git work tree")
    return [repository / name for name in listed.stdout.split("\0") if name and (repository / name).is_file()]


def test_no_tracked_file_knows_the_machine_it_was_written_on(repository: Path) -> None:
    homes = re.compile(r"(?<![\w.])/(?:work|root|home|opt|farm)/\w")
    known = []
    for path in tracked(repository):
        text = path.read_bytes().decode("utf-8", "replace")
        known += [f"{path.name}: {found[0]}" for found in homes.finditer(text)]
    assert not known


def test_tests_stand_where_the_modules_stand(repository: Path) -> None:
    tests = repository / "tests"
    lost = [
        str(test.relative_to(tests))
        for test in tests.rglob("*/test_*.py")
        if not (PACKAGE / test.parent.relative_to(tests)).is_dir()
    ]
    assert not lost


def test_the_changelog_tells_this_version(repository: Path) -> None:
    assert f"\n## {mocurve.__version__}" in (repository / "CHANGELOG.md").read_text(encoding="utf-8")


def test_the_version_is_the_packaged_one(repository: Path) -> None:
    assert f'version = "{mocurve.__version__}"' in (repository / "pyproject.toml").read_text(encoding="utf-8")
