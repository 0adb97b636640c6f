"""The report's page in a real browser: it shows what it should, asks for nothing, and no name can break it."""

import base64
import json
from dataclasses import replace

import numpy as np
import pytest
from legged import stepping, walk_left
from visits import Visit

import mocurve as mc
from mocurve import report, report_data
from mocurve.errors import FileError, OptionError
from mocurve.keyed import HermiteCurve, KeyedMotion
from mocurve.measure import Report, compare
from mocurve.motion import Motion
from mocurve.skeleton import Skeleton

TURNS = ("Zrotation", "Yrotation", "Xrotation")
PLACES = ("Xposition", "Yposition", "Zposition")
HOSTILE = "</script><script>alert(1)</script>"


def clip(frames=90, name="Head", seed=2):
    """A small body, 16 units tall, that sways; the last joint has the given name."""
    rng = np.random.default_rng(seed)
    skeleton = Skeleton(
        ("Hips", "Spine", name, "Top"),
        [-1, 0, 1, 2],
        [[0, 4, 0], [0, 4, 0], [0, 4, 0], [0, 4, 0]],
        (PLACES + TURNS, TURNS, TURNS, ()),
        [0, 0, 0, 1],
    )
    times = np.arange(frames)[:, None] / 30
    values = 12 * np.sin(rng.uniform(1, 5, 12) * times + rng.uniform(0, 6, 12))
    values[:, 1] += 4
    return Motion(skeleton, values, 1 / 30)


def keyed(motion, every=9):
    frames = np.unique(np.append(np.arange(0, motion.frames, every), motion.frames - 1))
    slopes = np.gradient(motion.values, motion.frame_time, axis=0)
    times = frames * motion.frame_time
    columns = range(motion.values.shape[1])
    curves = [HermiteCurve(times, motion.values[frames, c], slopes[frames, c]) for c in columns]
    return KeyedMotion(motion.skeleton, tuple(curves), motion.frame_time, motion.frames)


# -- without a browser -------------------------------------------------------------------------------------------------


def test_json_and_text_are_the_report_s_own(tmp_path):
    told = compare(clip(), keyed(clip()))
    told.save(tmp_path / "a.json")
    told.save(tmp_path / "a.txt")
    assert Report.from_json(json.loads((tmp_path / "a.json").read_text())) == told
    assert (tmp_path / "a.txt").read_text() == f"{told}\n"


def test_two_clips_are_compared_and_saved(tmp_path):
    report.save((clip(), keyed(clip())), tmp_path / "a.json")
    assert json.loads((tmp_path / "a.json").read_text())["keys"] == keyed(clip()).keys


def test_another_extension_and_a_report_without_clips_are_refused(tmp_path):
    told = compare(clip(), keyed(clip()))
    with pytest.raises(
        OptionError, match=r"a\.pdf: the extension of a report is one of \.html, \.json, \.txt, not '\.pdf'"
    ):
        told.save(tmp_path / "a.pdf")
    with pytest.raises(OptionError, match="this report has no clips to show"):
        Report.from_json(told.to_json()).save(tmp_path / "a.html")
    with pytest.raises(FileError, match=r"gone/a\.txt: cannot write"):
        told.save(tmp_path / "gone" / "a.txt")
    assert list(tmp_path.iterdir()) == []


def test_values_that_are_no_numbers_are_refused_and_leave_the_old_page(tmp_path):
    values = np.array(clip().values)
    values[3, 3] = np.nan
    (tmp_path / "a.html").write_text("old")
    with pytest.raises(OptionError, match="a clip has values that are not finite numbers"):
        compare(clip(), replace(clip(), values=values)).save(tmp_path / "a.html", sweep=False)
    assert (tmp_path / "a.html").read_text() == "old"


def test_a_long_clip_is_thinned_but_keeps_its_largest_error(monkeypatch):
    monkeypatch.setattr(report_data, "MOST_VALUES", 300)
    values = np.array(clip().values)
    values[41, 5] -= 7.0
    data = report_data.page_data(compare(clip(), replace(clip(), values=values)))
    errors = np.frombuffer(base64.b64decode(data["errors"]), "<f4").reshape(12, -1)
    assert data["stride"] == 4
    assert errors.shape == (12, data["shown_frames"]) == (12, 23)
    assert errors[5].min() == pytest.approx(-7.0)


def test_the_page_of_a_long_clip_stays_small():
    motion = clip(4000)
    wide = Skeleton(
        tuple(f"J{i}" for i in range(32)),
        np.arange(-1, 31),
        np.tile([0.0, 1.0, 0.0], (32, 1)),
        tuple(TURNS for _ in range(32)),
    )
    long = Motion(wide, np.tile(motion.values[:, :8], 12), 1 / 120)
    page = report.page(compare(long, keyed(long, 5)), "long", sweep=False)
    assert len(page) < 25e6


def test_tolerances_in_degrees_give_bands_and_those_in_space_marks():
    motion = clip()
    made = compare(motion, keyed(motion))
    data = report_data.page_data(replace(made, tolerance="2deg, Spine@1..2=0.5deg"))
    assert data["bands"][3] == pytest.approx(2.0)
    varying = np.frombuffer(base64.b64decode(data["bands"][7]), "<f4")
    assert set(varying.tolist()) == {2.0, 0.5}
    data = report_data.page_data(replace(made, tolerance="0.3u, Top=0.1u"))
    assert data["bands"] == [None] * 12
    assert [joint["tolerance"] for joint in data["joints"]] == pytest.approx([0.3, 0.3, 0.3, 0.1])
    assert report_data.page_data(replace(made, tolerance="ratio 0.01, no promise"))["bands"] is None


def test_the_sweep_falls_with_the_tolerance_and_tells_its_progress():
    heard = []
    with mc.progress.listening(lambda label, done, total: heard.append((label, done, total))):
        sweep = report.sweep_data(compare(clip(), keyed(clip())))
    lines = {line["name"]: line for line in sweep["lines"]}
    assert set(lines) == {"optimal", "optimal, held in space", "split", "split by ratio"}
    for line in sweep["lines"]:
        assert line["keys"] == sorted(line["keys"], reverse=True)
    least = sweep["bound"]["keys"]
    assert all(a >= b for a, b in zip(lines["optimal"]["keys"], least, strict=True))
    steps = [step for step in heard if step[0] == "trying tolerances"]
    assert steps[-1][1] == steps[-1][2] == sum(len(line["keys"]) for line in sweep["lines"])


def test_a_clip_of_a_few_frames_has_no_sweep():
    assert report.sweep_data(compare(clip(3), clip(3))) is None


# -- in Chromium -------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def visit(browser, tmp_path_factory):
    """The page of a reduced clip, with its sweep."""
    path = tmp_path_factory.mktemp("page") / "sway.html"
    motion = clip()
    replace(compare(motion, keyed(motion)), tolerance="2deg").save(path)
    opened = Visit(browser, path)
    yield opened
    opened.page.close()


def test_the_page_asks_for_nothing_but_itself_and_says_no_error(visit):
    assert visit.errors == []
    assert [url.split("/")[-1] for url in visit.requests] == ["sway.html"]


def test_the_numbers_are_in_plain_words(visit):
    words = visit.page.inner_text("#numbers")
    assert "132" in words
    assert "keys instead of 1,080 samples" in words
    assert "units" in words
    assert "tolerance 2deg" in visit.page.inner_text("#made")


def test_choosing_a_channel_changes_the_curve(visit):
    page = visit.page
    page.click("#channel-7")
    before = visit.trace("90 samples")[1]
    assert np.allclose(before, clip().values[:, 7], atol=1e-4)
    page.click("#channel-8")
    assert np.allclose(visit.trace("90 samples")[1], clip().values[:, 8], atol=1e-4)
    assert page.inner_text("#curve-name") == "Spine.Xrotation"


def test_curve_keys_and_error_are_those_of_the_clip(visit):
    visit.page.click("#channel-7")
    made = keyed(clip())
    off = made.sample().values[:, 7] - clip().values[:, 7]
    assert np.allclose(visit.trace("error")[1], off, atol=1e-4)
    assert np.allclose(visit.trace("11 keys")[1], made.curves[7].values, atol=1e-4)
    times, values = visit.trace("curve")
    assert np.allclose(made.curves[7].at(times), values, atol=1e-3)
    assert visit.trace("tolerance")[1].tolist() == [2.0, 2.0]


def test_keys_grow_when_there_is_room_for_them(visit):
    script = """async () => {
        const plot = document.getElementById('curve-plot'), keys = plot.data.findIndex(t => t.name === '11 keys');
        await Plotly.restyle(plot, { 'marker.size': 1 }, [keys]);
        await Plotly.relayout(plot, { 'xaxis.range': [0, 1] });
        return plot.data[keys].marker.size;
    }"""
    visit.page.click("#channel-7")
    assert visit.page.evaluate(script) == 9


def test_the_chooser_finds_by_words_and_moves_by_keys(visit):
    page = visit.page
    page.click("#channel-10")
    page.fill("#search", "spine rot")
    assert page.locator("#channels [role=option]").count() == 3
    assert page.inner_text("#curve-name") == "Spine.Zrotation"
    page.focus("#search")
    page.keyboard.press("ArrowDown")
    assert page.inner_text("#curve-name") == "Spine.Yrotation"
    assert page.get_attribute("#channel-7", "aria-selected") == "true"
    assert page.get_attribute("#search", "aria-activedescendant") == "channel-7"
    page.fill("#search", "no such name")
    assert "no channel has this name" in page.inner_text("#channels")
    page.fill("#search", "")
    page.select_option("#order", "error")
    first = page.locator("#channels [role=option]").first.inner_text()
    rows = compare(clip(), keyed(clip())).channels
    worst = max(rows, key=lambda row: row.max / (1 if row.unit == "degrees" else np.radians(12)))  # 12: the height
    assert first.startswith(worst.name)
    page.select_option("#order", "tree")


def test_play_moves_the_figures_and_the_slider_sets_them(visit):
    page = visit.page
    bones = "() => document.getElementById('figures').data[4].z.slice(0, 5)"
    still = page.evaluate(bones)
    page.click("#play")
    page.wait_for_function("document.getElementById('frame').valueAsNumber > 3")
    page.click("#play")
    assert page.inner_text("#play") == "Play"
    assert page.evaluate(bones) != still
    page.evaluate(
        "() => { const s = document.getElementById('frame'); s.value = 45; s.dispatchEvent(new Event('input')) }"
    )
    assert page.inner_text("#time") == "1.50 / 2.97 s"
    places = mc.kinematics.world(clip())[45]
    drawn = page.evaluate("() => document.getElementById('figures').data[5].z")
    assert np.allclose(drawn, places[:, 1], atol=1e-3)  # Y of the clip points up on the page


def test_turning_one_view_turns_the_other(visit):
    turned = visit.page.evaluate(
        """async () => {
            const plot = document.getElementById('figures'), eye = { x: 0.1, y: -2, z: 0.6 };
            await Plotly.relayout(plot, { 'scene.camera': { eye } });
            await new Promise((done) => setTimeout(done, 300));
            return plot.layout.scene2.camera.eye;
        }"""
    )
    assert turned == {"x": 0.1, "y": -2, "z": 0.6}


def test_the_sweep_is_drawn(visit):
    assert visit.page.locator("#keys-plot .scatterlayer .trace").count() == 3
    assert visit.page.locator("#ratio-plot .scatterlayer .trace").count() == 5


def test_nothing_is_wider_than_a_narrow_window(visit):
    visit.page.set_viewport_size({"width": 420, "height": 800})
    visit.page.wait_for_timeout(400)
    assert visit.page.evaluate("document.documentElement.scrollWidth") <= 420
    visit.page.set_viewport_size({"width": 1280, "height": 800})


def test_a_hostile_joint_name_is_only_text(browser, tmp_path):
    motion = clip(name=HOSTILE)
    path = tmp_path / "<img src=x onerror=alert(2)>.html"
    compare(motion, keyed(motion)).save(path, sweep=False)
    opened = Visit(browser, path)
    opened.page.click("#channel-10")
    assert opened.page.inner_text("#curve-name") == f"{HOSTILE}.Yrotation"
    assert opened.page.inner_text("h1") == "<img src=x onerror=alert(2)>"
    assert HOSTILE in opened.page.inner_text("#joint-plot")
    assert opened.dialogs == []
    assert opened.errors == []
    assert len(opened.requests) == 1
    opened.page.close()


def odd_pairs():
    channels = (PLACES + TURNS, TURNS[::-1], TURNS, ())
    reordered = replace(clip(), skeleton=replace(clip().skeleton, channels=channels))
    yield "one frame", clip(1), clip(1)
    yield "no frames", clip()[:0], clip()[:0]
    yield "two motions", clip(), clip(seed=3)
    yield "other rotation order", clip(), reordered


@pytest.mark.filterwarnings("ignore:the channels differ")
@pytest.mark.parametrize(("case", "first", "second"), list(odd_pairs()))
def test_odd_pairs_make_a_page_too(browser, tmp_path, case, first, second):
    compare(first, second).save(tmp_path / "odd.html", sweep=False)
    opened = Visit(browser, tmp_path / "odd.html", (400, 300))
    assert opened.errors == []
    assert opened.page.is_visible("#curves") == (case != "other rotation order")
    assert opened.page.is_visible("#space") == (case != "no frames")
    opened.page.close()


def test_the_page_tells_how_feet_slide(browser, tmp_path):
    step = walk_left()
    slid = stepping(0.25 * np.arange(step.frames), np.zeros(step.frames))
    path = tmp_path / "feet.html"
    made = compare(step, slid)
    made.save(path, sweep=False)
    opened = Visit(browser, path)
    words = opened.page.inner_text("#numbers")
    assert f"{made.feet.after.speed:.2f} cm/s" in words
    assert "feet slide where they stand in the first clip; there they do at 0.00" in words
    assert opened.errors == []
    opened.page.close()
