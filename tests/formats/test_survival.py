"""The tables of what survives in docs/formats.md are true, and have a line for every format and profile."""

from __future__ import annotations

import re
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import mocurve as mc
from mocurve import kinematics, rotation
from mocurve.formats import FORMATS, format_of

PAGE = (Path(__file__).resolve().parents[2] / "docs" / "formats.md").read_text(encoding="utf-8")
BOTH, WRITTEN, READ = "Written and read", "Written only", "Read only"
FPS = 60.0
TOLERANCE = 2  # mm
ASKED_FOR = {".glb", ".gltf"}  # their profile baked is asked for by name, as the page says


def table(title: str) -> dict[tuple[str, str], dict[str, str]]:
    """The lines of the table under a heading, {(extension, profile): {column: cell}}; code marks are taken off."""
    section = PAGE.partition(f"\n### {title}\n")[2].partition("\n#")[0]
    lines = [
        [cell.strip().strip("`") for cell in line.split("|")[1:-1]] for line in section.splitlines() if "|" in line
    ]
    head, _, *rows = lines
    named = [dict(zip(head, row, strict=True)) for row in rows]
    return {(row["format"], row.get("profile", "")): row for row in named}


TABLES = {title: table(title) for title in (BOTH, WRITTEN, READ)}
LINES = [(title, *line) for title, lines in TABLES.items() for line in lines]


def profiles(extension: str) -> list[str]:
    """The profiles of a format that is written, "" where it has but one way."""
    return list(getattr(format_of(extension), "PROFILES", [""]))


def channels(order: str) -> tuple[str, ...]:
    return tuple(f"{axis}rotation" for axis in order)


def keyed(body: mc.Skeleton) -> mc.KeyedMotion:
    """Some seconds of a clip with few keys, whose tangents are broken at the second one."""
    rng = np.random.default_rng(7)
    times = np.array([0, 40, 90, 120]) / FPS
    curves = []
    for turns in body.rotation_channels:
        size = 20.0 if turns else 0.2 * np.abs(body.offsets).max()
        values, slopes = rng.uniform(-size, size, (2, 4))
        curves.append(mc.HermiteCurve(times, values, slopes, slopes * [1, -0.5, 1, 1]))
    return mc.KeyedMotion(body, tuple(curves), 1 / FPS, 121, ({"verb": "reduce", "tolerance": f"{TOLERANCE}mm"},))


@pytest.fixture(scope="module")
def clip() -> mc.KeyedMotion:
    """Three joints with unlike orders, names with blanks and accents, a unit that was said, an end site."""
    kinds = (("Xposition", "Yposition", "Zposition", *channels("YXZ")), channels("X"), channels("XZ"), ())
    offsets = [[0, 90, 0], [0, -40.5, 1], [0, -42.25, 0], [0, -3, 12]]
    names = ("Hips", "Left Knee", "Knöchel", "Knöchel_End")
    return keyed(mc.Skeleton(names, [-1, 0, 1, 2], offsets, kinds, [False, False, False, True], 0.01))


@pytest.fixture(scope="module")
def smpl(tmp_path_factory) -> mc.KeyedMotion:
    """A body that AMASS knows, in inches and with another rotation order."""
    path = tmp_path_factory.mktemp("smpl") / "rest.npz"
    np.savez(path, poses=np.zeros((1, 66)), trans=np.zeros((1, 3)), mocap_framerate=np.array(FPS))
    with pytest.warns(UserWarning, match="mean body"):
        body = mc.read(path).skeleton
    kinds = tuple(names and (*names[:-3], *channels("YXZ")) for names in body.channels)
    return keyed(replace(body, channels=kinds, unit=0.0254, offsets=body.offsets / 0.0254))


def written(path: Path, clip: mc.KeyedMotion, profile: str) -> str:
    """Write a clip; what the warnings said."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        mc.write(path, clip, **({"profile": profile} if profile else {}))
    return "; ".join(str(warning.message) for warning in caught)


def read_back(path: Path) -> mc.Motion | mc.KeyedMotion:
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "(.*: )?(no bones in the file|a table does not say how)")  # AMASS, CSV
        return mc.read(path)


# -- what is measured ----------------------------------------------------------------------------
def said(kept: bool) -> str:
    return "kept" if kept else "lost"


def found(clip: mc.KeyedMotion, back: mc.Motion | mc.KeyedMotion | mc.SplineMotion, told: str) -> dict[str, str]:
    """What survived, in the words of the table."""
    body, other = clip.skeleton, back.skeleton
    inner = ~other.end_sites
    ends = [body.names[i] for i in np.flatnonzero(body.end_sites)]
    same_ends = (other.names, other.end_sites.tolist()) == (body.names, body.end_sites.tolist())
    same_ends &= len(other.names) == len(body.names) and np.allclose(other.offsets, body.offsets, rtol=1e-6, atol=1e-6)
    metres = other.unit == 1.0 and body.unit != 1.0
    return {
        **found_keys(clip, back, told),
        "rotation order": said(other.channel_names == body.channel_names),
        "names": said([other.names[i] for i in np.flatnonzero(inner)] == [n for n in body.names if n not in ends]),
        "unit": "metres" if metres else said(other.unit == body.unit),
        "fps": said(back.frame_time == clip.frame_time and back.frames == clip.frames),
        "end sites": said(same_ends),
        "history": said(back.history == clip.history),
    }


def found_keys(clip: mc.KeyedMotion, back: mc.Motion | mc.KeyedMotion, told: str) -> dict[str, str]:
    if isinstance(back, mc.SplineMotion):
        return {"keys": "splines", "tangents": "splines"}
    if not isinstance(back, mc.KeyedMotion):
        lost = "anew" if "straight" in told else "sampled"
        return {"keys": lost, "tangents": "lost"}
    pairs = list(zip(clip.curves, back.curves, strict=True))
    keys = all(np.array_equal(a.times, b.times) and np.array_equal(a.values, b.values) for a, b in pairs)
    slopes = all(np.array_equal(a.slopes, b.slopes) and np.array_equal(a.in_slopes, b.in_slopes) for a, b in pairs)
    return {"keys": said(keys), "tangents": said(slopes)}


def check_values(clip: mc.Motion, back: mc.Motion, claim: str) -> None:
    """Samples are as near as the table says: degrees of each joint's rotation, and length units of its place."""
    if claim == "exact":
        assert back.values.tobytes() == clip.values.tobytes()
        return
    scale = back.skeleton.unit / clip.skeleton.unit if back.skeleton.unit else 1.0
    if claim == "tolerance":
        away = np.linalg.norm(kinematics.world(back) * scale - kinematics.world(clip), axis=2)
        assert away.max() <= TOLERANCE * 0.001 / clip.skeleton.unit * (1 + 1e-5)  # float32
        return
    places = [clip.skeleton.joint(name) for name in back.skeleton.names]
    turned = rotation.angle(kinematics.rotations(back), kinematics.rotations(clip)[:, places])
    moved = back.values[:, ~back.skeleton.rotation_channels] * scale
    shifts = np.abs(moved - clip.values[:, ~clip.skeleton.rotation_channels])
    off = max(float(turned.max()), float(shifts.max()))
    assert off <= float(claim)
    assert off > 0, "exact"


# -- the laws ------------------------------------------------------------------------------------
@pytest.mark.parametrize("extension", FORMATS)
def test_every_format_and_profile_has_a_line_in_one_table(extension):
    lines = [(title, profile) for title, known, profile in LINES if known == extension]
    assert sorted(profile for _, profile in lines) == sorted([""] if lines[0][0] == READ else profiles(extension))
    assert len({title for title, _ in lines}) == 1


def test_the_tables_know_no_format_that_is_not_there():
    assert {extension for _, extension, _ in LINES} == set(FORMATS)


def test_the_overview_lists_every_format_with_its_profiles():
    overview = PAGE.partition("\n## ")[0]
    for extension in FORMATS:
        row = next(line for line in overview.splitlines() if line.startswith("|") and f"`{extension}`" in line)
        assert all(f"`{profile}`" in row for profile in profiles(extension) if profile), extension


def test_every_link_of_the_page_leads_to_a_heading():
    titles = [line.lstrip("# ").lower() for line in PAGE.splitlines() if line.startswith("#")]
    headings = {re.sub(r"[^\w -]", "", title).replace(" ", "-") for title in titles}
    assert set(re.findall(r"\]\(#([^)]+)\)", PAGE)) <= headings


@pytest.mark.parametrize(("extension", "profile"), TABLES[BOTH])
def test_what_the_table_says_of_keys_written_and_read_back_is_true(tmp_path, clip, smpl, extension, profile):
    claims = dict(TABLES[BOTH][extension, profile])
    given = smpl if profile == "amass" else clip
    told = written(tmp_path / f"clip{extension}", given, profile)
    back = read_back(tmp_path / f"clip{extension}")
    if claims["keys"] == claims["tangents"] == "in the file":  # told by the tests of the format
        assert not isinstance(back, mc.KeyedMotion)
        claims.update(keys="sampled", tangents="lost")
    measured = found(given, back, told)
    assert {column: claims[column] for column in measured} == measured
    check_values(given.sample(), back.sample(), claims["values"])


@pytest.mark.parametrize(("title", "extension", "profile"), [line for line in LINES if line[0] != READ])
def test_what_is_lost_is_warned_of_and_nothing_else_is(tmp_path, clip, smpl, title, extension, profile):
    claims = TABLES[title][extension, profile]
    given = smpl if profile == "amass" else clip
    names = [re.sub(r"\W", "", name.replace("ö", "oe")) for name in given.skeleton.names]
    plain = replace(given, skeleton=replace(given.skeleton, names=names))
    told = written(tmp_path / f"clip{extension}", plain, profile)
    assert claims["a warning says"] in told
    assert bool(told) == bool(claims["a warning says"])
    lost = {claims["keys"], claims["tangents"]} & {"sampled", "anew", "lost"}
    assert told or not lost or extension in ASKED_FOR


@pytest.mark.parametrize(("title", "extension", "profile"), [line for line in LINES if line[0] != READ])
def test_names_that_a_format_cannot_hold_are_warned_of(tmp_path, clip, title, extension, profile):
    if profile == "amass":
        pytest.skip("AMASS knows its own joints only")
    names = ("a b", "Knie", "Knie", "Ende")
    path = tmp_path / f"clip{extension}"
    told = written(path, replace(clip, skeleton=replace(clip.skeleton, names=names)), profile)
    back = read_back(path).skeleton.names if title == BOTH else ()
    kept = back and back == names[: len(back)]  # an end site has no column in a table
    assert kept or re.search("names? (changed|of their own)", told)
    if TABLES[title][extension, profile]["names"] == "ASCII":
        assert "'a b' is 'a_b'" in told


@pytest.mark.parametrize(("title", "extension", "profile"), [line for line in LINES if line[0] != READ])
def test_a_unit_that_nobody_said_is_not_made_up_in_silence(tmp_path, clip, smpl, title, extension, profile):
    given = smpl if profile == "amass" else clip
    path = tmp_path / f"clip{extension}"
    told = written(path, replace(given, skeleton=replace(given.skeleton, unit=None)), profile)
    unsaid = title == BOTH and read_back(path).skeleton.unit is None
    assert "unit" in told or unsaid


@pytest.mark.parametrize(("extension", "profile"), TABLES[WRITTEN])
def test_names_and_ends_stand_in_files_that_are_only_written_as_the_table_says(tmp_path, clip, extension, profile):
    claims = TABLES[WRITTEN][extension, profile]
    written(tmp_path / f"clip{extension}", clip, profile)
    data = (tmp_path / f"clip{extension}").read_bytes()
    name = {"kept": "Left Knee", "ASCII": "Left_Knee"}[claims["names"]]
    assert name.encode() in data
    ends = {"joints": True, "lost": False}[claims["end sites"]]
    assert ends == (b"chel_End" in data or b"Kno_chel_End" in data)


@pytest.mark.parametrize(("extension", "profile"), TABLES[WRITTEN])
def test_what_is_only_written_says_so_when_it_is_read(tmp_path, clip, extension, profile):
    path = tmp_path / f"clip{extension}"
    written(path, clip, profile)
    with pytest.raises(mc.FileError, match="only written"):
        mc.read(path)


@pytest.mark.parametrize("extension", [extension for extension, _ in TABLES[READ]])
def test_what_is_only_read_says_so_when_it_is_written(tmp_path, clip, extension):
    with pytest.raises(mc.FileError, match="only read"):
        mc.write(tmp_path / f"clip{extension}", clip)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("verb", [mc.read, lambda path: mc.write(path, None)])
def test_an_unknown_extension_lists_the_known_ones(verb):
    with pytest.raises(mc.OptionError, match=r"no format known for 'clip\.c4d'") as caught:
        verb("clip.c4d")
    assert str(caught.value).endswith(", ".join(FORMATS))
