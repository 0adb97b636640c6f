"""What the tests share: where the clips are."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings

import mocurve as mc
from mocurve.data import example

settings.register_profile("house", parent=settings.default, deadline=None)  # the first call of a kernel compiles it
settings.load_profile("house")

REPOSITORY = Path(__file__).resolve().parent.parent


@pytest.fixture(scope="session")
def repository() -> Path:
    """The root of the repository."""
    return REPOSITORY


@pytest.fixture(scope="session")
def jump() -> Path:
    """The capture that ships with the package: 420 frames at 120 fps, 96 channels; always there."""
    return example()


@pytest.fixture(scope="session")
def clips() -> Path:
    """Folder of shared clips (cmu, other, awkward, broken): MOCURVE_CLIPS, or shared/clips beside the repository."""
    folder = Path(os.environ.get("MOCURVE_CLIPS") or REPOSITORY.parent / "shared" / "clips")
    if not folder.is_dir():
        pytest.skip("no shared clips: set MOCURVE_CLIPS to their folder")
    return folder


@pytest.fixture(scope="session")
def captured(clips: Path) -> Callable[[str], mc.Motion]:
    """Reads CMU clips by what follows cmu_ in their names."""

    def load(name: str) -> mc.Motion:
        clip = mc.read(clips / "cmu" / f"cmu_{name}.bvh")
        assert isinstance(clip, mc.Motion)
        return clip

    return load


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    """Chromium without a window, as playwright drives it."""
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    path = os.environ.get("MOCURVE_CHROMIUM") or shutil.which("chromium") or shutil.which("chromium-browser")
    if path is None:
        pytest.skip("no chromium on the path; MOCURVE_CHROMIUM names one")
    with playwright.sync_playwright() as running:
        opened = running.chromium.launch(executable_path=path, args=["--no-sandbox", "--enable-unsafe-swiftshader"])
        yield opened
        opened.close()
