"""The findings of denoising: as JSON there and back, and in words that a person understands."""

import json
from dataclasses import replace

import numpy as np
import pytest

from mocurve.measure import Report, compare
from mocurve.measure_noise import KINDS, Artefact, ChannelNoise, Noise
from mocurve.motion import Motion
from mocurve.skeleton import Skeleton

TURNS = ("Zrotation", "Yrotation", "Xrotation")
BODY = Skeleton(("Hips",), [-1], [[0, 9, 0]], (("Yposition", *TURNS),))
CHANNELS = (
    ChannelNoise("Hips.Yposition", "units", 0.03, True, 6.0),
    ChannelNoise("Hips.Zrotation", "degrees", 0.25, True, 9.5),
    ChannelNoise("Hips.Yrotation", "degrees", 0.75, True, 11.25),
    ChannelNoise("Hips.Xrotation", "degrees", 0.5, True),
)
SPIKE = Artefact("Hips", ("Hips.Zrotation",), "spike", 7, 7)
BURST = Artefact("Hips", ("Hips.Zrotation", "Hips.Xrotation"), "run", 20, 24)
GAP = Artefact("Hips", ("Hips.Yposition",), "lost", 30, 37)
SWAP = Artefact("Hips", ("Hips.Yrotation",), "offset", 10, 49, by=12.5)


def found(**changes):
    return replace(Noise(CHANNELS, (SPIKE, SWAP, BURST, GAP), samples=19), **changes)


def still(frames=60, frame_time=1 / 50):
    return Motion(BODY, np.zeros((frames, 4)), frame_time)


def line(text, label):
    (told,) = [line for line in text.splitlines() if line.startswith(label)]
    return told


# -- JSON --------------------------------------------------------------------------------------------------------------


def test_the_json_reads_back_the_same():
    noise = found(marked=True, dropped=1)
    told = json.loads(json.dumps(noise.to_json()))
    assert Noise.from_json(told) == noise
    assert told["artefacts"][1] == {
        "joint": "Hips",
        "channels": ["Hips.Yrotation"],
        "kind": "offset",
        "first": 10,
        "last": 49,
        "by": 12.5,
    }


def test_the_captured_clip_is_not_part_of_the_json():
    assert found(captured=still()).to_json().keys() == {"channels", "artefacts", "samples", "marked", "dropped"}


def test_a_report_carries_the_findings_through_its_json():
    report = replace(compare(still(), still()), noise=found())
    assert Report.from_json(json.loads(json.dumps(report.to_json()))).noise == found()


# -- text --------------------------------------------------------------------------------------------------------------


def test_the_noise_is_told_as_median_and_most_of_each_unit():
    text = str(found())
    assert line(text, "noise") == "noise      0.5 degrees (median of 3 channels), most 0.75 in Hips.Yrotation"
    assert "           0.03 units (median of 1 channel), most 0.03 in Hips.Yposition\n" in text


def test_artefacts_are_counted_by_kind_with_what_became_of_them():
    assert line(str(found()), "artefacts") == (
        "artefacts  1 lost run, 1 spike, 1 run filled in; 1 offset moved back; 19 samples, offsets not counted"
    )
    marked = line(str(found(marked=True)), "artefacts")
    assert marked == (
        "artefacts  1 lost run filled in; 1 spike, 1 run, 1 offset marked and kept; 19 samples, offsets not counted"
    )
    twice = found(artefacts=(SPIKE, replace(SPIKE, first=9, last=9)), samples=2)
    assert line(str(twice), "artefacts") == "artefacts  2 spikes filled in; 2 samples"
    assert line(str(found(artefacts=(), samples=0)), "artefacts") == "artefacts  none"


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_is_told(kind):
    assert kind in line(str(found(artefacts=(replace(SPIKE, kind=kind),))), "artefacts")


def test_the_longest_artefacts_come_first_with_joint_frames_and_seconds():
    rows = [" ".join(line.split()) for line in found(captured=still()).rows() if line.startswith("Hips ")]
    assert rows == [
        "Hips Yrotation offset by 12.5 degrees 10-49 0.20 for 0.800",
        "Hips Yposition lost 30-37 0.60 for 0.160",
        "Hips Zrotation Xrotation run 20-24 0.40 for 0.100",
        "Hips Zrotation spike 7 0.14 for 0.020",
    ]


def test_without_the_captured_clip_there_are_frames_and_no_seconds():
    rows = [" ".join(line.split()) for line in found().rows() if line.startswith("Hips ")]
    assert rows[1] == "Hips Yposition lost 30-37"


def test_channels_without_a_floor_are_named_and_what_helps():
    shaky = tuple(replace(row, floor=False) for row in CHANNELS)
    assert found().no_floor() == ""
    assert "no floor" not in str(found())
    assert found(channels=(*CHANNELS[:2], shaky[2], shaky[3])).no_floor() == (
        "no white noise floor found in Hips.Yrotation and Hips.Xrotation: what shakes there cannot be told from "
        "motion; a higher strength or a limit in Hz takes it out"
    )
    many = tuple(replace(shaky[0], name=f"J{i}.Xrotation") for i in range(30))
    assert "in 30 channels, such as J0.Xrotation, J1.Xrotation, J2.Xrotation and J3.Xrotation: " in line(
        str(found(channels=many)), "no floor"
    )


def test_a_dropped_t_pose_is_told():
    assert line(str(found(dropped=1)), "T-pose") == "T-pose     1 frame taken away at the start"
    assert "T-pose" not in str(found())


def test_a_clip_in_which_nothing_moves_has_words_too():
    assert str(Noise(())) == "noise      no channel moves and has the samples that would tell\nartefacts  none"


def test_the_report_of_a_clean_clip_tells_the_noise_first_and_speaks_of_no_keys():
    values = np.zeros((60, 4))
    values[5, 2] = 3.0
    plain = compare(still(), replace(still(), values=values))
    text = str(replace(plain, noise=found()))
    assert text.startswith("noise      0.5 degrees")
    assert "changed    from the captured clip to the clean one:" in text
    assert "noisiest channels" in text
    assert "keys" not in text
    assert str(plain).startswith("keys ")
