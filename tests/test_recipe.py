"""Recipes: what a history tells can be done again, to the last digit, and nothing else gets through."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import mocurve as mc
from mocurve import FileError, OptionError, cli
from mocurve.recipe import LARGEST, VERBS, fits, hints

pytestmark = pytest.mark.filterwarnings(
    "ignore:keys become samples", "ignore:splines become samples", "ignore:the clip runs"
)


@pytest.fixture
def here(jump: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with the capture, jump.bvh, and two pieces of it, a.npz and b.npz; it is the working folder."""
    monkeypatch.chdir(tmp_path)
    shutil.copy(jump, "jump.bvh")
    motion = mc.read("jump.bvh")
    mc.write("a.npz", motion[:160])
    mc.write("b.npz", motion[100:260])
    return tmp_path


Made = Callable[[mc.Clip, mc.Clip], mc.Clip]
EACH: dict[str, list[Made]] = {
    "denoise": [lambda a, b: mc.denoise(a, only=["*Arm", "Hips"])],
    "reduce": [
        lambda a, b: mc.reduce(a, tolerance=["3deg", "LeftHand=1deg"], quality="fast", align="joint"),
        lambda a, b: mc.reduce(a, tolerance="3deg", quality="fast", denoise=True),
        lambda a, b: mc.reduce(a, method="split", tolerance="0.01ratio"),
        lambda a, b: mc.reduce(a, keys=12, pin=[40, "0.5s"], quality="fast"),
        lambda a, b: mc.reduce(a, method="cluster", tolerance="5%span", pin=["contacts"]),
        lambda a, b: mc.reduce(a, tolerance="9deg", pin=[40, 41]),
    ],
    "refine": [
        lambda a, b: mc.refine(mc.reduce(a, tolerance="3deg", method="split"), a),
        lambda a, b: mc.refine(mc.reduce(a, keys=8, pin=[40], quality="fast"), a),
    ],
    "fit": [lambda a, b: mc.fit(a, spans=20, knots="uniform"), lambda a, b: mc.fit(a, tolerance="9deg", degree=2)],
    "trim": [lambda a, b: mc.trim(a, start=0.5, end=1.0), lambda a, b: a[20:50]],
    "axes": [lambda a, b: mc.axes(a, up="y", to="z"), lambda a, b: mc.axes(mc.reduce(a, tolerance="9deg"), up="x")],
    "blend": [lambda a, b: mc.blend(a, b, {"*Arm": "0:0,1:1"}), lambda a, b: mc.blend(a, mc.blend(b, a, 0.5), 0.3)],
    "mix": [lambda a, b: mc.mix([a, b, a], [1, 1, 2])],
    "interpolate": [
        lambda a, b: mc.interpolate([a, mc.retime(a, {0.5: 0.6})], [0.3, 0.7]),
        lambda a, b: mc.interpolate([a, mc.retime(a, {0.5: 0.6})], places=[0.0, 1.0], at=[0.4]),
    ],
    "difference": [lambda a, b: mc.difference(a, b)],
    "add": [lambda a, b: mc.add(mc.difference(a, b), b)],
    "scale": [lambda a, b: mc.scale(mc.difference(a, b), {"*Arm": 2})],
    "warp": [
        lambda a, b: mc.warp(a, [0.5, 0.7], {"LeftArm.Zrotation": [30, None], "Hips.Yposition": [None, 2]}),
        lambda a, b: mc.warp(a, 0.5, pose=b[20:21], only="*Arm"),
    ],
    "bands": [lambda a, b: mc.bands(a, {"0": 0, "2Hz": 1.5}, only="*Arm")],
    "waveshape": [lambda a, b: mc.waveshape(a, soft={"LeftArm.Zrotation": (-80, 40)})],
    "limit": [
        lambda a, b: mc.limit(a, {"LeftArm.Zrotation": (-80, None), "LeftLeg.flexion": (20, 100)}),
        lambda a, b: mc.limit(a),
    ],
    "retime": [lambda a, b: mc.retime(a, {0.5: 0.6, 0.8: 1.0})],
    "loop": [lambda a, b: mc.loop(a, start=0.2, end=1.0, cycles=2, close="cubic")],
    "join": [
        lambda a, b: mc.join(a, b, seconds=0.2),
        lambda a, b: mc.join(mc.fit(a, tolerance="9deg"), mc.fit(b, tolerance="9deg"), seconds=0.2, mode="spline"),
    ],
    "act_out": [
        lambda a, b: mc.act_out(a, [(0, 4), (0.7, 1), (1.2, 9), (1.6, 1)], channel="Hips.Yposition"),
        lambda a, b: mc.act_out(a, b, joint="Hips"),
    ],
    "follow": [
        lambda a, b: mc.follow(a, [(0, 0), (20, 30), (0, 60), (10, 90)]),
        lambda a, b: mc.follow(a, mc.Path([(0, 0), (20, 60), (0, 90)]), of=mc.Path.of(a), lock_feet=False, mode="time"),
        lambda a, b: mc.follow(a, [(0, 0), (20, 30), (0, 60)], mode="paced", heading="kept", lock_feet=False),
        lambda a, b: mc.follow(
            mc.read("jump.bvh"), [(0, 0), (40, 60), (0, 200)], mode="paced", at_end="cycle", lock_feet=False
        ),
    ],
    "lock_feet": [
        lambda a, b: mc.lock_feet(a, release=True),
        lambda a, b: mc.lock_feet(a, mc.contacts(a)[:2], release=True),
    ],
    "register": [lambda a, b: mc.register(a, b, slope=2)],
}


@pytest.mark.parametrize(("name", "number"), [(name, i) for name, each in EACH.items() for i in range(len(each))])
def test_a_history_makes_the_clip_again(name: str, number: int, here: Path) -> None:
    with np.errstate(all="raise"):
        made = EACH[name][number](mc.read("a.npz"), mc.read("b.npz"))
    steps = json.loads(json.dumps(made.history))
    assert steps[-1]["verb"] == name
    again = mc.run(None, steps)
    assert type(again) is type(made)
    assert np.array_equal(again.sample().values, made.sample().values)
    assert json.loads(json.dumps(again.history)) == steps


def test_every_verb_is_in_the_table_and_is_public() -> None:
    assert set(EACH) == set(VERBS)
    assert not [name for name in VERBS if not hasattr(mc, name)]


def test_the_steps_of_one_clip_are_done_to_another(here: Path) -> None:
    a, b = mc.read("a.npz"), mc.read("b.npz")
    made = mc.run(b, mc.warp(mc.trim(a, end=1.0), 0.5, {"LeftArm.Zrotation": 30}).history[len(a.history) :])
    assert np.array_equal(made.values, mc.warp(mc.trim(b, end=1.0), 0.5, {"LeftArm.Zrotation": 30}).values)
    assert mc.run(b, []) is b


def test_a_first_step_that_reads_is_left_out_where_a_clip_is_given(here: Path) -> None:
    b = mc.read("b.npz")
    steps = [{"verb": "read", "file": "a.npz"}, {"verb": "trim", "end": 0.5}]
    assert np.array_equal(mc.run(b, steps).values, b.values[:61])
    assert np.array_equal(mc.run(None, steps).values, mc.read("a.npz").values[:61])


LOOK = """
# a little of the other, and few keys
[[steps]]
verb = "blend"
with = "b.npz"
weight = {"*Arm" = 0.5}

[[steps]]
verb = "reduce"
tolerance = "3deg"
quality = "fast"
"""


def test_a_recipe_in_a_file_names_files_beside_it(
    here: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (here / "look.toml").write_text(LOOK)
    (here / "away").mkdir()
    monkeypatch.chdir(here / "away")
    assert cli.main(["run", "../look.toml", "../a.npz", "-o", "made.curves.json", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert [step["verb"] for step in told["steps"]] == ["blend", "reduce"]
    assert (told["kind"], told["frames"]) == ("KeyedMotion", 160)
    a, b = mc.read("../a.npz"), mc.read("../b.npz")
    wanted = mc.reduce(mc.blend(a, b, {"*Arm": 0.5}), tolerance="3deg", quality="fast")
    made = mc.read("made.curves.json")
    assert np.array_equal(made.sample().values, wanted.sample().values)
    # a clip is a recipe, too; its files are found from the working folder
    monkeypatch.chdir(here)
    assert cli.main(["run", "away/made.curves.json", "b.npz", "-o", "second.npz"]) == 0
    assert "2. reduce" in capsys.readouterr().out
    assert np.abs(mc.read("second.npz").values - mc.read("b.npz").values).max() < 10


def test_a_path_may_be_named_as_a_file(here: Path) -> None:
    a, way = mc.read("a.npz"), mc.Path([(0, 0), (20, 30), (0, 60)])
    way.write("way.csv")
    made = mc.run(a, [{"verb": "follow", "path": "way.csv", "lock_feet": False}])
    assert np.array_equal(made.sample().values, mc.follow(a, mc.Path.read("way.csv"), lock_feet=False).values)
    (here / "bad.csv").write_text("x,z\n1,nan\n")
    with pytest.raises(OptionError, match=r"step 1, follow: .*bad\.csv"):
        mc.run(a, [{"verb": "follow", "path": "bad.csv"}])


def test_read_begins_a_history_and_takes_over_a_file_s_own(here: Path) -> None:
    assert mc.read("jump.bvh", unit="cm").history == ({"verb": "read", "file": "jump.bvh", "unit": "cm"},)
    assert [step["verb"] for step in mc.read("a.npz").history] == ["read", "trim"]


@pytest.mark.parametrize(
    ("steps", "message"),
    [
        ([{"verb": "blned"}], "step 1, blned: no verb 'blned'. Did you mean 'blend'"),
        ([{"name": "blend"}], "step 1: a step is a table with a verb"),
        ("denoise", "a recipe is a .toml or .json file"),
        ([{"verb": "trim"}, {"verb": "trim", "ende": 1}], "step 2, trim: no option 'ende'. Did you mean 'end'"),
        ([{"verb": "trim", "end": "late"}], "step 1, trim: end is a number, not 'late'"),
        ([{"verb": "trim", "end": True}], "end is a number, not True"),
        ([{"verb": "loop", "cycles": 2.5}], "cycles is a whole number, not 2.5"),
        ([{"verb": "reduce", "tolerance": [1]}], "tolerance is a text, or a list, not"),
        ([{"verb": "scale"}], "step 1, scale: factor is missing"),
        ([{"verb": "blend"}], "takes one other clip"),
        ([{"verb": "mix", "weights": [1]}], "takes other clips"),
        ([{"verb": "trim", "with": "b.npz"}], "takes no other clip"),
        ([{"verb": "blend", "with": ["a.npz", "b.npz"]}], "takes one other clip .*, not 2"),
        ([{"verb": "blend", "with": []}], "from which file its other clip comes is not known"),
        ([{"verb": "blend", "with": 7}], "with names a file"),
        ([{"verb": "blend", "with": "c.npz"}], "there is no file 'c.npz', beside the recipe or in the working folder"),
        ([{"verb": "blend", "with": "a\0b"}], "the name of a file is a text"),
        ([{"verb": "trim"}, {"verb": "read", "file": "a.npz"}], "step 2, read: only the first step can read"),
        ([{"verb": "read"}], "step 1, read: the name of a file is a text, not None"),
        ([{"verb": "read", "file": "a.npz", "path": "b"}], "no option 'path'"),
        ([{"verb": "blender", "action": "x", "curves": 2}], "no verb 'blender'"),
        ([{"verb": "trim", "start": 9.0}], "step 1, trim: the start at 9 s lies outside"),
    ],
)
def test_what_is_no_recipe_is_refused_by_step_before_anything_is_done(steps: object, message: str, here: Path) -> None:
    with pytest.raises((OptionError, FileError), match=message):
        mc.run(mc.read("a.npz"), steps)  # type: ignore[arg-type]


def test_without_a_clip_a_recipe_reads_one(here: Path) -> None:
    for steps in ([], [{"verb": "trim", "end": 0.5}]):
        with pytest.raises(OptionError, match="no clip is given, and no step reads one"):
            mc.run(None, steps)


def test_recipes_within_recipes_have_an_end(here: Path) -> None:
    steps: list = [{"verb": "read", "file": "a.npz"}]
    for _ in range(30):
        steps = [{"verb": "read", "file": "a.npz"}, {"verb": "blend", "with": steps}]
    with pytest.raises(OptionError, match="go 20 deep at most"):
        mc.run(None, steps)


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("bad.toml", "[[steps]\n", "bad.toml: .*line 1"),
        ("bad.toml", "[[step]]\nverb = 'trim'\n", "bad.toml: no part of a recipe 'step'. Did you mean 'steps'"),
        ("bad.toml", "steps = 3\n", "bad.toml: a recipe is a list of steps"),
        ("bad.json", '[{"verb": "trim",}]', "bad.json: .*line 1"),
        ("bad.json", "[" * 100_000, "bad.json: nested too deep"),
        ("bad.json", '[{"verb": "trim", "ende": 1}]', "bad.json: step 1, trim: no option 'ende'"),
        ("bad.txt", "trim", "bad.txt: a recipe is a .toml or .json file, or a clip that carries a history"),
        ("long.json", " " * (LARGEST + 1), "long.json: a recipe has at most 16 MB"),
    ],
)
def test_a_file_that_is_no_recipe_is_refused_in_one_line(
    name: str, text: str, message: str, here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (here / name).write_text(text)
    with pytest.raises((OptionError, FileError), match=message):
        mc.run(mc.read("a.npz"), here / name)
    assert cli.main(["run", name, "a.npz", "-o", "out.npz"]) == cli.REFUSED
    assert capsys.readouterr().err.count("\n") == 1
    assert not Path("out.npz").exists()


def test_a_missing_recipe_is_told(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["run", "look.toml", "a.npz", "-o", "out.npz"]) == cli.REFUSED
    assert "look.toml" in capsys.readouterr().err


def test_kinds_of_values() -> None:
    weight, pairs = hints(mc.blend)["weight"], hints(mc.retime)["map"]
    for value in (0.3, 1, "0:0,2:1", ["*Arm=1"], [[0, 0], [2, 1]], {"*Arm": 0.5}):
        assert fits(value, weight), value
    for value in (None, True, [[1, 2, 3]], {"*Arm": [1]}):
        assert not fits(value, weight), value
    assert fits([[0, 0], [1, 1.5]], pairs)
    assert not fits(7, pairs)
