"""Pictures: what is in them, how long a GIF plays, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from mocurve import draw, draw_gif, draw_scene, progress
from mocurve.errors import FileError, OptionError, UnknownName
from mocurve.keyed import HermiteCurve, KeyedMotion
from mocurve.motion import Motion
from mocurve.skeleton import Skeleton

TURNS = ("Zrotation", "Yrotation", "Xrotation")


def pole(frames=50, frame_time=0.02, up=1):
    """A pole of three joints and an end site, 20 units tall, that leans and wanders over the ground."""
    step = np.zeros((4, 3))
    step[1:, up] = 20 / 3
    places = ("Xposition", "Yposition", "Zposition")
    skeleton = Skeleton(("A", "B", "C", "C_End"), [-1, 0, 1, 2], step, (places + TURNS, TURNS, TURNS, ()), [0, 0, 0, 1])
    values = np.zeros((frames, 12))
    values[:, 0] = np.linspace(0, 15, frames)
    values[:, 6] = 20 * np.sin(np.arange(frames) / 8)
    return Motion(skeleton, values, frame_time)


def keyed(motion, every=10):
    frames = np.unique(np.append(np.arange(0, motion.frames, every), motion.frames - 1))
    slopes = np.gradient(motion.values, motion.frame_time, axis=0)
    times = frames * motion.frame_time
    curves = [HermiteCurve(times, motion.values[frames, c], slopes[frames, c]) for c in range(12)]
    return KeyedMotion(motion.skeleton, tuple(curves), motion.frame_time, motion.frames)


def pixels(path):
    with Image.open(path) as image:
        return np.asarray(image.convert("RGB")).astype(int)


def near(picture, colour, within=40):
    return int((np.abs(picture - colour).sum(axis=2) < within).sum())


def test_a_pose_is_drawn_upright_and_fills_the_picture(tmp_path):
    draw.render(pole(), tmp_path / "pose.png", frame=0, view="front", width=400)
    picture = pixels(tmp_path / "pose.png")
    rows, columns = np.nonzero(picture[:, :, 2] - picture[:, :, 0] > 50)  # near and far bones are blue
    assert picture.shape[1] == 400
    assert np.ptp(rows) > 0.7 * picture.shape[0]
    assert np.ptp(rows) > 10 * np.ptp(columns)


def test_a_clip_with_z_up_gives_the_same_picture(tmp_path):
    standing = replace(pole(), values=np.zeros((50, 12)))
    lying = replace(pole(up=2), values=np.zeros((50, 12)))
    draw.render(standing, tmp_path / "y.png", frame=0)
    draw.render(lying, tmp_path / "z.png", frame=0)
    assert (pixels(tmp_path / "y.png") == pixels(tmp_path / "z.png")).all()


@pytest.mark.parametrize("view", ["front", "side", "top", "three-quarter", "behind"])
def test_every_view_looks_along_its_own_axis(view):
    camera = draw_scene.camera(np.eye(3), view, 300, (0.5, 2))
    assert np.allclose(camera.axes @ camera.axes.T, np.eye(3))
    assert np.linalg.det(camera.axes) == pytest.approx(1)
    towards = {
        "front": [0, 0, 1],
        "side": [1, 0, 0],
        "top": [0, 1, 0],
        "three-quarter": [0.5, 0.4, 0.75],
        "behind": [-0.5, 0.4, -0.75],
    }[view]
    assert camera.axes[2] @ towards > 0.95
    assert camera.axes[1][1] > 0.9 or view == "top"


def test_the_camera_holds_everything():
    places = np.random.default_rng(3).normal(size=(200, 3)) * (50, 3, 7)
    for view in draw_scene.TURN_AND_TILT:
        camera = draw_scene.camera(places, view, 300, (0.4, 1.2))
        seen = camera(places)
        assert (seen >= 0).all()
        assert (seen <= camera.size).all()


def test_a_sheet_shows_both_figures_in_their_colours(tmp_path):
    moved = np.array(pole().values)
    moved[:, 2] += 6
    draw.render(pole(), tmp_path / "sheet.png", replace(pole(), values=moved), width=800)
    picture = pixels(tmp_path / "sheet.png")
    assert near(picture, draw.FIRST[0]) > 200
    assert near(picture, draw.SECOND[0]) > 200
    assert near(picture, draw.ALONE[0]) == 0


def test_poses_along_the_way_stand_where_they_are(tmp_path):
    places = np.zeros((50, 12))
    places[:, 0] = np.linspace(0, 200, 50)  # the pole goes to the right
    for poses in (1, 5, 9):
        draw.render(replace(pole(), values=places), tmp_path / "a.png", poses=poses, view="front", width=600)
        picture = pixels(tmp_path / "a.png")
        columns = (picture[:, :, 2] - picture[:, :, 0] > 50).any(axis=0)  # near and far bones are blue
        assert np.count_nonzero(np.diff(columns.astype(int), prepend=0) == 1) == poses
    with pytest.raises(OptionError, match=r"drawn as \.png"):
        draw.render(pole(), tmp_path / "a.gif", poses=3)


def test_a_sheet_of_one_frame_is_one_panel(tmp_path):
    draw.render(pole(1), tmp_path / "one.png", width=200)
    assert near(pixels(tmp_path / "one.png"), draw.ALONE[0]) > 50


@pytest.mark.parametrize(("fps", "rate"), [(25, 100), (30, 100), (12.5, 60), (50, 50)])
def test_a_gif_plays_as_long_as_the_clip(tmp_path, fps, rate):
    clip = pole(2 * rate + 1, 1 / rate)
    draw.render(clip, tmp_path / "a.gif", fps=fps, width=120)
    with Image.open(tmp_path / "a.gif") as image:
        delays = []
        for frame in range(image.n_frames):
            image.seek(frame)
            delays.append(image.info["duration"])
    assert len(delays) == 2 * fps + 1
    assert sum(delays) == pytest.approx(2000 + 1000 / fps, abs=10)
    assert min(delays) >= 20


def test_a_gif_has_no_more_pictures_a_second_than_the_clip(tmp_path):
    draw.render(pole(21, 0.1), tmp_path / "slow.gif", width=100)
    with Image.open(tmp_path / "slow.gif") as image:
        assert image.n_frames == 21


def test_a_very_long_gif_is_thinned_with_a_warning():
    with pytest.warns(UserWarning, match=r"a long clip: 9\.99 pictures a second, so that there are no more than 1000"):
        times, delays = draw_gif.timing(100.0, 0.01, 25)
    assert len(times) == len(delays) == 1000
    assert sum(delays) == pytest.approx(100_000, abs=150)


def test_drawing_says_how_far_it_is(tmp_path):
    heard = []
    with progress.listening(lambda *step: heard.append(step)):
        draw.render(pole(), tmp_path / "a.gif", width=100)
    assert heard[-1] == ("drawing", len(heard), len(heard))


def test_wrong_options_are_refused(tmp_path):
    for options, message in [
        ({"view": "back"}, "view is one of front, side, top, three-quarter, behind, not 'back'"),
        ({"width": 3}, "width is from 64 to 8192 pixels, not 3"),
        ({"frame": 50}, "there is no frame 50: the clip has frames 0 to 49"),
        ({"frame": -1}, "there is no frame -1"),
        ({"poses": 0}, "poses is from 1 to 200, not 0"),
        ({"poses": 3, "frame": 1}, "not together with a single frame"),
        ({"fps": 0}, "fps is over 0 and at most 50"),
        ({"fps": float("nan")}, "fps is over 0 and at most 50"),
    ]:
        with pytest.raises(OptionError, match=message):
            draw.render(pole(), tmp_path / "a.png", **options)
    with pytest.raises(OptionError, match=r"a\.mp4: the extension of a picture is \.png or \.gif, not '\.mp4'"):
        draw.render(pole(), tmp_path / "a.mp4")
    with pytest.raises(OptionError, match=r"one frame is drawn as \.png"):
        draw.render(pole(), tmp_path / "a.gif", frame=1)
    with pytest.raises(OptionError, match="the clip has no frames to draw"):
        draw.render(pole()[:0], tmp_path / "a.png")
    with pytest.raises(OptionError, match="values that are not finite numbers"):
        draw.render(replace(pole(), values=np.full((50, 12), np.nan)), tmp_path / "a.png")
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_is_not_there_is_named(tmp_path):
    with pytest.raises(FileError, match=r"nowhere/a\.png: cannot write: no such file or directory"):
        draw.render(pole(), tmp_path / "nowhere" / "a.png", frame=0)


def test_a_failure_leaves_the_old_picture(tmp_path, monkeypatch):
    (tmp_path / "a.gif").write_text("old")
    monkeypatch.setattr(draw_scene, "draw_figure", lambda *_: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        draw.render(pole(), tmp_path / "a.gif", width=100)
    assert [path.name for path in tmp_path.iterdir()] == ["a.gif"]
    assert (tmp_path / "a.gif").read_text() == "old"


def test_curves_show_samples_keys_and_tangents(tmp_path):
    draw.curves(pole(), keyed(pole()), "B.Zrotation", tmp_path / "c.png", width=800)
    picture = pixels(tmp_path / "c.png")
    assert picture.shape[1] == 800
    for colour in [(27, 73, 125), (209, 73, 91), (232, 163, 61)]:
        assert near(picture, colour) > 100


def test_curves_of_a_still_channel_and_of_one_frame_are_drawn(tmp_path):
    draw.curves(pole(), keyed(pole()), "C.Xrotation", tmp_path / "still.png")
    alone = replace(keyed(pole()), curves=tuple(HermiteCurve([0.0], [1.0], [0.0]) for _ in range(12)), frames=1)
    draw.curves(pole(1), alone, "A.Xposition", tmp_path / "one.png")


def test_a_curve_that_is_not_there_is_refused_with_the_nearest_name(tmp_path):
    with pytest.raises(UnknownName, match=r"Did you mean 'B\.Zrotation'\?"):
        draw.curves(pole(), keyed(pole()), "B.Zrotatin", tmp_path / "c.png")
    with pytest.raises(OptionError, match=r"the extension of this picture is \.png, not '\.gif'"):
        draw.curves(pole(), keyed(pole()), "B.Zrotation", tmp_path / "c.gif")
