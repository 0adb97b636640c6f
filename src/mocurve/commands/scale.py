"""`mocurve scale`: more or less of a displacement."""

from __future__ import annotations

from typing import Annotated, Any

from cyclopts import Parameter

from ..edit import scale as verb
from ..formats import read
from ._edits import Edited, Lossless, Output, changed, check_files, finish, nothing, sentence
from ._options import Json, Profile, Source, with_options_of
from ._terminal import told_when_compiling

Factor = Annotated[
    list[str], Parameter(help="How much: 0.5, --factor=-1 (back), 0:0,2:1 (changes in time), '*Arm=2' (only there).")
]


@with_options_of(verb.scale)
@told_when_compiling()
def scale(
    displacement: Source,
    /,
    *,
    output: Output,
    factor: Factor,
    profile: Profile = None,
    lossless: Lossless = False,
    json: Json = False,
    **options: Any,
) -> None:
    """More or less of a displacement.

    `mocurve difference` makes one.

    For example:
      mocurve scale limp.npz -o half-a-limp.npz --factor 0.5
      mocurve scale limp.npz -o back.npz --factor=-1
    """
    check_files(output, displacement)
    made = verb.scale(read(displacement), factor, **options)
    told = changed(nothing(made), made)
    finish(Edited(made, {"largest": told}, (sentence(told, "largest"),)), output, profile, lossless, json)
