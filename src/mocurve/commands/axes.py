"""`mocurve axes`: a clip turned so that y is up."""

from __future__ import annotations

from typing import Any

from ..edit import axes as verb
from ..formats import read
from ._edits import Edited, Lossless, Output, check_files, finish
from ._options import Json, Profile, Source, with_options_of
from ._terminal import told_when_compiling


@with_options_of(verb.axes)
@told_when_compiling()
def axes(
    file: Source,
    /,
    *,
    output: Output,
    profile: Profile = None,
    lossless: Lossless = False,
    json: Json = False,
    **options: Any,
) -> None:
    """A clip whose file has z up, or x, turned so that y is up; and back.

    Keys and splines stay what they are, to the last digit.

    For example:
      mocurve axes z_up.bvh -o walk.bvh
      mocurve axes tour.bvh -o z_up_tour.bvh --up y --to z
    """
    check_files(output, file)
    made = verb.axes(read(file), **options)
    finish(Edited(made), output, profile, lossless, json)
