"""`mocurve run`: a recipe."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from .. import recipe as recipes
from ..formats import read
from ._edits import Edited, Lossless, Output, check_files, finish
from ._options import Json, Profile, Source
from ._terminal import told_when_compiling

Recipe = Annotated[
    Path, Parameter(help="Steps: .toml, .json, or a clip that carries its history (.curves.json .npz .glb)")
]


@told_when_compiling()
def run(
    recipe: Recipe,
    file: Source | None = None,
    /,
    *,
    output: Output,
    profile: Profile = None,
    lossless: Lossless = False,
    json: Json = False,
) -> None:
    """Several steps in one, from a recipe or from the history of a clip.

    A recipe is a text file, a table for each step: the verb, and its options as
    they are called on the command line. Where a verb takes a second clip, `with`
    names its file. Say, look.toml:

      [[steps]]
      verb = "denoise"

      [[steps]]
      verb = "blend"
      with = "run.bvh"
      weight = 0.3

      [[steps]]
      verb = "reduce"
      tolerance = ["2mm", "LeftHand=1mm"]

    Every clip carries the steps that made it: what was done to one can be done to
    the next. All steps are checked before the first is done.

    For example:
      mocurve run look.toml walk.bvh -o walk.glb
      mocurve run walk.curves.json other_walk.bvh -o other_walk.curves.json
    """
    check_files(output, recipe, *([] if file is None else [file]))
    before = None if file is None else read(file)
    made = recipes.run(before, recipe)
    new = made.history[0 if before is None else len(before.history) :]
    steps = [{name: value for name, value in step.items() if name != "with"} for step in new]
    words = tuple(f"{i}. {step['verb']}" for i, step in enumerate(steps, 1))
    finish(Edited(made, {"steps": steps}, words), output, profile, lossless, json)
