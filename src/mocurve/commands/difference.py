"""`mocurve difference`: the displacement between two clips."""

from __future__ import annotations

from typing import Any

from ..edit import difference as verb
from ..formats import read
from ._edits import Edited, Lossless, Output, changed, check_files, finish, nothing, sentence
from ._options import Json, Profile, Source, with_options_of
from ._terminal import told_when_compiling


@with_options_of(verb.difference)
@told_when_compiling()
def difference(
    goal: Source,
    clip: Source,
    /,
    *,
    output: Output,
    profile: Profile = None,
    lossless: Lossless = False,
    json: Json = False,
    **options: Any,
) -> None:
    """What is to be added to one clip to get another: a displacement, itself a clip.

    Added to the second clip it gives the first. Both must be equally long.
    `mocurve scale` makes more or less of it, `mocurve add` puts it onto a clip.

    For example:
      mocurve difference limping.bvh walking.bvh -o limp.npz
      mocurve add limp.npz run.bvh -o limping-run.bvh
    """
    check_files(output, goal, clip)
    made = verb.difference(read(goal), read(clip), **options)
    told = changed(nothing(made), made)
    finish(Edited(made, {"largest": told}, (sentence(told, "largest"),)), output, profile, lossless, json)
