"""`mocurve add`: a displacement put onto a clip."""

from __future__ import annotations

from typing import Any

from ..edit import add as verb
from ..formats import read
from ._edits import Edited, Lossless, Output, changed, check_files, finish, sentence
from ._options import Json, Profile, Source, with_options_of
from ._terminal import told_when_compiling


@with_options_of(verb.add)
@told_when_compiling()
def add(
    displacement: Source,
    clip: Source,
    /,
    *,
    output: Output,
    profile: Profile = None,
    lossless: Lossless = False,
    json: Json = False,
    **options: Any,
) -> None:
    """A displacement put onto a clip.

    `mocurve difference` makes one. Each joint is turned by it in its own frame.
    Both must be equally long.

    For example:
      mocurve add limp.npz run.bvh -o limping-run.bvh
    """
    check_files(output, displacement, clip)
    base = read(clip)
    made = verb.add(read(displacement), base, **options)
    told = changed(base, made)
    finish(Edited(made, {"changed": told}, (sentence(told, "changed"),)), output, profile, lossless, json)
