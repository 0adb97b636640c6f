"""Mutated files, for some seconds: the reader never crashes, hangs or accepts what a plain reader reads otherwise."""

from __future__ import annotations

import importlib.util
import random

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from mocurve.formats import _bvh_rows


@pytest.fixture
def fuzz(repository, monkeypatch):
    for name in ("CHUNK", "COMPILED_FROM"):  # the fuzzer changes them: they are put back
        monkeypatch.setattr(_bvh_rows, name, getattr(_bvh_rows, name))
    spec = importlib.util.spec_from_file_location("fuzz_bvh", repository / "benchmarks" / "fuzz_bvh.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.integers(0, 2**64))
def test_mutated_files_are_read_right_or_refused(fuzz, clips, tmp_path, seed):
    rng = random.Random(seed)
    small = [path.read_bytes() for path in sorted(clips.glob("awkward/*.bvh"))]
    _, wrong = fuzz.problem(fuzz.mutate(rng.choice(small), rng), tmp_path / "fuzz.bvh", rng)
    assert wrong is None


@pytest.mark.parametrize(
    ("old", "new", "wrong"),
    [
        (b"0.1", b"0.2", "values"),
        (b"Knee", b"Toe", "names"),
        (b"-1 0", b"-2 0", "offsets"),
        (b"Xrotation", b"Zrotation", "channels"),
        (b"Frames: 3", b"Frames: 4", "a wrong frame count without a warning"),
        (b"2 0.1\n", b"2\n0.1\n", None),
    ],
)
def test_the_plain_reader_sees_a_difference(fuzz, bvh, old, new, wrong):
    motion, _ = fuzz.outcome(bvh(), fuzz.CHUNKS[-1], compiled=False)
    assert fuzz.disagreement(bvh().read_bytes().replace(old, new), motion, []) == wrong
