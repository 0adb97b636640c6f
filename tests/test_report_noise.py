"""The page of a clip that was cleaned: what was captured, what was no motion, and where; spectra and noise."""

import base64
from dataclasses import replace

import numpy as np
import pytest
from visits import Visit

import mocurve as mc
from mocurve import report, report_data
from mocurve.keyed import HermiteCurve, KeyedMotion
from mocurve.measure import compare
from mocurve.measure_noise import Artefact, ChannelNoise, Noise
from mocurve.motion import Motion
from mocurve.skeleton import Skeleton

TURNS = ("Zrotation", "Yrotation", "Xrotation")
FPS, FRAMES, SIGMA = 60, 480, 0.5
HOSTILE = "</script><b>Arm"
ARM = 4  # the channel with all the artefacts
SPIKE, RUN, GAP, OFFSET = (60, 60), (120, 127), (200, 211), (300, 399)


def body(name="Arm"):
    channels = (("Yposition", *TURNS), TURNS, ())
    return Skeleton(("Hips", name, "Tip"), [-1, 0, 1], [[0, 0, 0], [0, 8, 0], [0, 8, 0]], channels, [0, 0, 1])


def clean_clip(name="Arm"):
    times = np.arange(FRAMES)[:, None] / FPS
    values = 20 * np.sin(2 * np.pi * np.linspace(0.3, 0.6, 7) * times + np.arange(7))
    values[:, 0] /= 20
    return Motion(body(name), values, 1 / FPS)


def told(name="Arm", **changes):
    """The report of a clip that was cleaned perfectly, with artefacts of every sort in one channel."""
    clean = clean_clip(name)
    values = clean.values + np.random.default_rng(1).normal(0, SIGMA, clean.values.shape)
    for (first, last), by in ((SPIKE, 30), (RUN, -25), (OFFSET, 10)):
        values[first : last + 1, ARM] += by
    values[GAP[0] : GAP[1] + 1, ARM] = clean.values[GAP[0] : GAP[1] + 1, ARM]  # denoise fills what was lost
    captured = replace(clean, values=values)
    names = clean.skeleton.channel_names
    rows = tuple(
        ChannelNoise(n, "units" if i == 0 else "degrees", SIGMA * (1 + i / 10), i != 2, 9.0)
        for i, n in enumerate(names)
    )
    kinds = {"spike": SPIKE, "run": RUN, "lost": GAP, "offset": OFFSET}
    artefacts = tuple(
        Artefact(name, (names[ARM],), kind, *place, by=10.0 if kind == "offset" else None)
        for kind, place in kinds.items()
    )
    noise = Noise(rows, artefacts, samples=21, captured=captured)
    return replace(compare(captured, clean), noise=replace(noise, **changes))


def keyed(motion, every=12):
    frames = np.unique(np.append(np.arange(0, motion.frames, every), motion.frames - 1))
    slopes = np.gradient(motion.values, motion.frame_time, axis=0)
    columns = range(motion.values.shape[1])
    curves = [HermiteCurve(frames / FPS, motion.values[frames, c], slopes[frames, c]) for c in columns]
    return KeyedMotion(motion.skeleton, tuple(curves), motion.frame_time, motion.frames)


def floats(text, channels=7):
    return np.frombuffer(base64.b64decode(text), "<f4").reshape(channels, -1)


# -- without a browser -------------------------------------------------------------------------------------------------


def test_a_comparison_without_noise_has_no_such_part():
    assert report_data.page_data(compare(clean_clip(), clean_clip()))["noise"] is None


def test_captured_curves_have_gaps_where_samples_were_lost():
    made = told()
    curves = floats(report_data.page_data(made)["noise"]["captured"])
    missing = np.isnan(curves)
    assert np.flatnonzero(missing[ARM]).tolist() == list(range(GAP[0], GAP[1] + 1))
    assert missing.sum() == GAP[1] - GAP[0] + 1
    assert np.allclose(curves[~missing], made.noise.captured.values.T[~missing], atol=1e-4)


def test_whole_turns_between_captured_and_clean_are_not_drawn():
    made = told()
    turned = np.array(made.noise.captured.values)
    turned[:, 5] += 360
    away = told(captured=replace(made.noise.captured, values=turned))
    assert report_data.page_data(away)["noise"]["captured"] == report_data.page_data(made)["noise"]["captured"]


def test_a_captured_clip_of_another_length_is_left_out():
    made = told()
    data = report_data.page_data(told(captured=made.noise.captured[:100]))["noise"]
    assert data["captured"] is None
    assert data["spectra"] is None
    assert len(data["artefacts"]) == 4


def test_a_thinned_page_keeps_the_spike_and_the_clean_curve(monkeypatch):
    monkeypatch.setattr(report_data, "MOST_VALUES", 7 * FRAMES // 8)
    made = told()
    data = report_data.page_data(made)
    at, off = SPIKE[0] // data["stride"], floats(data["errors"])
    assert data["stride"] == 8
    assert floats(data["noise"]["captured"])[ARM, at] == pytest.approx(
        made.noise.captured.values[SPIKE[0], ARM], abs=1e-4
    )
    assert (floats(data["samples"]) + off)[ARM, at] == pytest.approx(clean_clip().values[SPIKE[0], ARM], abs=1e-4)


def test_white_noise_is_level_in_the_spectrum_and_gone_after():
    data = report_data.page_data(told())["noise"]["spectra"]
    hertz, before, after = floats(data["hertz"], 1)[0], floats(data["before"]), floats(data["after"])
    high = hertz > 5
    assert hertz[-1] == FPS / 2
    others = [c for c in range(7) if c != ARM]
    assert np.sqrt((before[others][:, high] ** 2).mean()) == pytest.approx(SIGMA * np.sqrt(2 / FPS), rel=0.1)
    assert after[:, high].max() < 0.1 * SIGMA * np.sqrt(2 / FPS)


def test_a_sine_stands_at_its_frequency():
    data = report_data.page_data(told())["noise"]["spectra"]
    assert floats(data["hertz"], 1)[0][floats(data["after"]).argmax(axis=1)] == pytest.approx(0.5, abs=0.26)


def test_gaps_that_are_left_are_drawn_as_gaps_and_bridged_in_space_and_spectrum():
    made = told()
    holes = np.array(made.clips[1].values)
    holes[30:40, 5] = holes[:, 6] = np.nan
    clips = tuple(replace(clip, values=np.where(np.isnan(holes), np.nan, clip.values)) for clip in made.clips)
    data = report_data.page_data(replace(made, clips=clips, noise=replace(made.noise, captured=clips[0])))
    assert np.isnan(floats(data["samples"])[5, 30:40]).all()
    assert np.isfinite(floats(data["poses"]["b"], 1)).all()
    assert np.isfinite(floats(data["noise"]["spectra"]["after"])).all()
    assert data["first_channel"] == ARM


def test_a_tolerance_in_sigma_is_a_band_of_each_channel():
    made = replace(compare(clean_clip(), keyed(clean_clip())), noise=told().noise, tolerance="0.3sigma")
    bands = report_data.page_data(made)["bands"]
    assert bands[1:] == pytest.approx([0.3 * row.sigma for row in made.noise.channels[1:]])


def test_a_clip_of_a_few_frames_has_no_spectrum():
    short = clean_clip()[:9]
    made = replace(compare(short, short), noise=Noise((), captured=short))
    assert report_data.page_data(made)["noise"]["spectra"] is None


def test_a_clean_clip_is_not_reduced_for_its_page(monkeypatch):
    monkeypatch.setattr(report, "sweep_data", lambda _: pytest.fail("the sweep was made"))
    assert len(report.page(told(), "clean")) > 1e6


# -- in Chromium -------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def visit(browser, tmp_path_factory):
    """The page of the cleaned clip."""
    path = tmp_path_factory.mktemp("page") / "clean.html"
    told(HOSTILE).save(path)
    opened = Visit(browser, path)
    yield opened
    opened.page.close()


def plot(visit, name, part):
    return visit.page.evaluate(f"() => document.getElementById('{name}').{part}")


def test_the_page_says_no_error_and_no_name_is_code(visit):
    assert visit.errors == []
    assert len(visit.requests) == 1
    assert HOSTILE in visit.page.inner_text("#artefacts")
    assert HOSTILE in visit.page.inner_text("#level-plot")
    assert visit.page.locator("main b b").count() == 0


def test_the_numbers_tell_noise_and_artefacts_and_no_samples(visit):
    words = visit.page.inner_text("#numbers")
    assert "0.7°\nis the noise of 6 moving rotation channels" in words
    assert "0.5 units\nis the noise of one position channel" in words
    assert "4\nartefacts; 21 samples filled in; 1 displaced part moved back" in words
    assert "any joint was moved" in words
    assert "samples, against" not in words


def test_captured_and_clean_curve_change_and_noise_are_drawn(visit):
    visit.page.click("#channel-1")
    values = clean_clip().values[:, 1]
    before = told().noise.captured.values[:, 1]
    assert np.allclose(visit.trace("captured")[1], before, atol=1e-4)
    assert np.allclose(visit.trace("clean")[1], values, atol=1e-4)
    assert np.allclose(visit.trace("change")[1], values - before, atol=1e-4)
    assert visit.trace("noise, ±2 sigma")[1].tolist() == pytest.approx([2 * SIGMA * 1.1] * 2)
    assert plot(visit, "curve-plot", "layout.shapes") == []


def test_masked_frames_are_shaded_and_hovering_tells_kind_and_frames(visit):
    visit.page.click(f"#channel-{ARM}")
    shapes = plot(visit, "curve-plot", "layout.shapes")
    places = [((s["x0"] * FPS + 0.5), (s["x1"] * FPS - 0.5)) for s in shapes]
    assert np.allclose(places, [SPIKE, RUN, GAP, OFFSET])
    assert len({s["fillcolor"] for s in shapes}) == 4
    marks = plot(visit, "curve-plot", "data.find(t => t.name === 'run')")
    assert marks["text"][0] == "run, frames 120–127"
    assert [x * FPS for x in marks["x"][:-1]] == pytest.approx(range(RUN[0], RUN[1] + 1))
    assert np.allclose(marks["y"][:-1], told().noise.captured.values[RUN[0] : RUN[1] + 1, ARM], atol=1e-4)
    gap = plot(visit, "curve-plot", "data.find(t => t.name === 'lost')")["y"]
    assert np.allclose(gap[:-1], clean_clip().values[GAP[0] : GAP[1] + 1, ARM], atol=1e-4)
    assert plot(visit, "curve-plot", "data.find(t => t.name === 'offset')")["text"][0].endswith("off by 10°")


def test_the_change_is_drawn_as_large_as_the_noise_not_as_the_artefacts(visit):
    visit.page.click(f"#channel-{ARM}")
    low, high = plot(visit, "curve-plot", "layout.yaxis2.range")
    assert 2 * SIGMA < high < 5
    assert -5 < low < -2 * SIGMA


def test_clicking_an_artefact_leads_to_its_channel_and_time(visit):
    page = visit.page
    page.click("#channel-1")
    page.fill("#search", "hips")
    page.locator("#artefacts button").nth(2).click()
    assert page.inner_text("#curve-name") == f"{HOSTILE}.Zrotation"
    assert page.get_attribute(f"#channel-{ARM}", "aria-selected") == "true"
    low, high = plot(visit, "curve-plot", "layout.xaxis.range")
    assert low < GAP[0] / FPS < GAP[1] / FPS < high < low + 2
    assert float(page.inner_text("#time").split()[0]) == pytest.approx(GAP[0] / FPS + 0.1, abs=0.04)
    assert page.evaluate("Math.abs(document.getElementById('curves').getBoundingClientRect().top)") < 40


def test_the_list_can_show_one_kind_and_the_longest_first(visit):
    page = visit.page
    kinds = "() => [...document.querySelectorAll('#artefacts .kind')].map(e => e.textContent)"
    assert page.evaluate(kinds) == ["spike", "run", "lost", "offset"]
    page.select_option("#artefact-order", "longest")
    assert page.evaluate(kinds) == ["offset", "lost", "run", "spike"]
    page.select_option("#kind", "run")
    assert page.evaluate(kinds) == ["run"]
    assert "120–127" in page.inner_text("#artefacts")
    assert "133 ms" in page.inner_text("#artefacts")
    page.select_option("#kind", "")
    page.select_option("#artefact-order", "time")


def test_the_spectrum_is_that_of_the_chosen_channel(visit):
    data = report_data.page_data(told())["noise"]["spectra"]
    for channel in (1, 6):
        visit.page.click(f"#channel-{channel}")
        before, after, floor, cutoff = plot(visit, "spectrum-plot", "data.map(t => [[...t.x], [...t.y], t.name])")
        assert np.allclose(before[1], floats(data["before"])[channel])
        assert np.allclose(after[1], floats(data["after"])[channel], atol=1e-6)
        assert floor[1] == pytest.approx([SIGMA * (1 + channel / 10) * np.sqrt(2 / FPS)] * 2)
        assert cutoff[0] == [9, 9]
    assert visit.page.inner_text("#spectrum-name") == f"{HOSTILE}.Xrotation"
    assert plot(visit, "spectrum-plot", "layout.yaxis.title.text") == "degrees / √Hz"
    assert plot(visit, "spectrum-plot", "layout.xaxis.title.text") == "Hz"


def test_every_channel_has_a_dot_hollow_where_there_is_no_floor_and_a_click_shows_its_curve(visit):
    traces = plot(visit, "level-plot", "data.map(t => [t.customdata, [...t.x], t.marker.symbol])")
    dots = {
        c: (x, symbol) for channels, xs, symbols in traces for c, x, symbol in zip(channels, xs, symbols, strict=True)
    }
    assert sorted(dots) == list(range(7))
    assert [dots[c][0] for c in range(7)] == pytest.approx([SIGMA * (1 + c / 10) for c in range(7)])
    assert [c for c in dots if dots[c][1] == "circle-open"] == [2]
    texts = plot(visit, "level-plot", "data.flatMap(t => t.text)")
    assert "Hips.Yposition<br>halved at 9 Hz" in texts
    assert "Hips.Yrotation<br>halved at 9 Hz<br>no white noise floor" in texts
    visit.page.evaluate(
        "() => document.getElementById('level-plot').emit('plotly_click', { points: [{ customdata: 5 }] })"
    )
    assert visit.page.inner_text("#curve-name") == f"{HOSTILE}.Yrotation"


def test_a_channel_without_a_floor_says_so(visit):
    assert "no white noise floor found in Hips.Yrotation" in visit.page.inner_text("#noise-lines")
    visit.page.click("#channel-2")
    assert "no white noise floor found" in visit.page.inner_text("#curves-hint")
    visit.page.click("#channel-1")
    assert "no white noise floor found" not in visit.page.inner_text("#curves-hint")


def test_channels_can_be_ordered_by_their_noise(visit):
    visit.page.select_option("#order", "noise")
    first = visit.page.locator("#channels [role=option]").first.inner_text()
    assert first.startswith("Hips.Yposition")  # half a file unit is more than a degree spans on a body so small
    visit.page.select_option("#order", "tree")


def test_nothing_is_wider_than_a_narrow_window(visit):
    visit.page.set_viewport_size({"width": 420, "height": 800})
    visit.page.wait_for_timeout(400)
    assert visit.page.evaluate("document.documentElement.scrollWidth") <= 420
    visit.page.set_viewport_size({"width": 1280, "height": 800})


def test_the_page_of_keys_shows_the_captured_curve_behind_them(browser, tmp_path):
    clean, made = clean_clip(), told()
    path = tmp_path / "keys.html"
    replace(compare(clean, keyed(clean)), noise=made.noise).save(path, sweep=False)
    opened = Visit(browser, path)
    opened.page.click(f"#channel-{ARM}")
    names = plot(opened, "curve-plot", "data.map(t => t.name)")
    assert names[:3] == ["captured", f"{FRAMES} clean samples", "curve"]
    assert {"spike", "run", "lost", "offset", "error"} <= set(names)
    seen = opened.trace("captured")[1].astype(float)
    assert np.nanmax(np.abs(seen - made.noise.captured.values[:, ARM])) < 1e-4
    assert len(plot(opened, "curve-plot", "layout.shapes")) == 4
    assert "keys instead of" in opened.page.inner_text("#numbers")
    assert opened.errors == []
    opened.page.close()


def odd_noise():
    yield "nothing looked at", Noise((), captured=clean_clip())
    yield "no captured clip", replace(told().noise, captured=None)
    yield (
        "channels of another body",
        Noise((ChannelNoise("Leg.Xrotation", "degrees", 0.1, True),), told("Leg").noise.artefacts),
    )


@pytest.mark.parametrize(("case", "noise"), list(odd_noise()))
def test_odd_findings_make_a_page_too(browser, tmp_path, case, noise):
    path = tmp_path / "odd.html"
    replace(compare(clean_clip(), clean_clip()), noise=noise).save(path)
    opened = Visit(browser, path, (400, 300))
    assert opened.errors == []
    assert opened.page.is_visible("#noise")
    assert opened.page.is_visible("#spectrum") == (case == "nothing looked at")
    assert opened.page.is_visible("#levels") == (case == "no captured clip")
    opened.page.close()


def test_what_denoise_makes_has_such_a_page(jump, tmp_path):
    motion = mc.read(jump)[:60]
    mc.denoise(motion).report.save(tmp_path / "clean.html")
    assert '"noise": {' in (tmp_path / "clean.html").read_text("utf-8")
