"""What holds for every format, and how the format of a file is found."""

from __future__ import annotations

import inspect
import re

import numpy as np
import pytest

import mocurve as mc
from mocurve.formats import FORMATS, format_of, metres
from mocurve.progress import listening

OPTIONS = {"read": {"skeleton", "animation"}, "write": {"profile", "tolerance", "mesh", "lossless"}}


@pytest.mark.parametrize("extension", FORMATS)
@pytest.mark.parametrize(("verb", "first"), [("read", ["path"]), ("write", ["path", "clip"])])
def test_every_format_takes_some_of_the_common_options(extension, verb, first):
    form = format_of(extension)
    names = list(inspect.signature(getattr(form, verb)).parameters)
    assert names[: len(first)] == first
    assert set(names[len(first) :]) <= OPTIONS[verb]
    assert verb == "read" or ("profile" in names) == hasattr(form, "PROFILES")


def test_an_option_that_a_format_has_no_use_for_is_refused(tmp_path, keys):
    with pytest.raises(mc.OptionError, match=r"^\.bvh files have no option profile$"):
        mc.write(tmp_path / "a.bvh", keys, profile="baked")
    with pytest.raises(mc.OptionError, match=r"^\.curves\.json files have no option skeleton$"):
        mc.read(tmp_path / "a.curves.json", skeleton="a.asf")


def test_a_format_of_one_clip_refuses_several(tmp_path, keys):
    with pytest.raises(mc.OptionError, match=r"a \.bvh file holds one clip; write 2 files"):
        mc.write(tmp_path / "a.bvh", {"walk": keys, "run": keys})


@pytest.mark.parametrize("extension", [".bvh", ".curves.json", ".npz"])
def test_formats_of_all_channels_give_back_the_samples_of_keys(tmp_path, keys, extension):
    path = tmp_path / f"A B{extension.upper()}"
    mc.write(str(path), keys if extension == ".curves.json" else keys.sample(), lossless=True)
    back = mc.read(path)
    assert back.sample().values.tobytes() == keys.sample().values.tobytes()
    assert back.frame_time == keys.frame_time
    assert back.skeleton.channel_names == keys.skeleton.channel_names


@pytest.mark.parametrize("extension", FORMATS)
def test_every_format_says_what_is_missing(tmp_path, extension):
    with pytest.raises(mc.FileError) as caught:
        mc.read(tmp_path / f"missing{extension}")
    assert str(caught.value).startswith(str(tmp_path))


@pytest.mark.parametrize("name", ["clip", "clip.obj", "clip.json", "clip.bvh.gz", ""])
def test_an_unknown_extension_names_the_known_ones(name):
    with pytest.raises(mc.OptionError, match=re.escape(f"a file name ends in {', '.join(FORMATS)}")):
        mc.read(name)


def test_long_reading_and_writing_tells_how_far_it_is(tmp_path, bvh):
    motion = mc.read(bvh())
    long = mc.Motion(motion.skeleton, np.tile(motion.values, (40_000, 1)), motion.frame_time)
    told: list[tuple[str, int, int]] = []
    with listening(lambda *step: told.append(step)):
        mc.write(tmp_path / "long.bvh", long)
        mc.read(tmp_path / "long.bvh")
    for label in ("writing", "reading"):
        done = [step[1] for step in told if step[0] == label]
        assert len(done) > 3
        assert done == sorted(done)
        assert all(step[2] >= done[-1] for step in told if step[0] == label)


@pytest.mark.parametrize(
    ("unit", "length"),
    [
        ("mm", 0.001),
        ("CM", 0.01),
        ("m", 1),
        ("in", 0.0254),
        ("inch", 0.0254),
        ("ft", 0.3048),
        (0.056444, 0.056444),
        ("0.5", 0.5),
    ],
)
def test_the_unit_of_a_file_can_be_said(bvh, unit, length):
    assert mc.read(bvh(), unit=unit).skeleton.unit == length
    assert mc.read(bvh()).skeleton.unit is None


@pytest.mark.parametrize("unit", ["yard", 0, -1, float("nan"), float("inf"), "", [1]])
def test_an_odd_unit_is_refused_with_the_known_ones(unit):
    with pytest.raises(mc.OptionError, match="unit is one of mm, cm, m, in, inch, ft or a positive number of metres"):
        metres(unit)
