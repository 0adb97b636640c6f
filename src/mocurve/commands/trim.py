"""`mocurve trim`: a piece of a clip."""

from __future__ import annotations

from typing import Any

from ..edit import trim as verb
from ..formats import read
from ._edits import Edited, Lossless, Output, check_files, finish
from ._options import Json, Profile, Source, with_options_of
from ._terminal import told_when_compiling


@with_options_of(verb.trim)
@told_when_compiling()
def trim(
    file: Source,
    /,
    *,
    output: Output,
    profile: Profile = None,
    lossless: Lossless = False,
    json: Json = False,
    **options: Any,
) -> None:
    """A piece of a clip, exactly as it was.

    Keys stay keys: their curves get a key at both ends.

    For example:
      mocurve trim jump.bvh -o landing.bvh --start 2 --end 2.8
      mocurve trim jump.curves.json -o start.curves.json --end 1
    """
    check_files(output, file)
    made = verb.trim(read(file), **options)
    finish(Edited(made), output, profile, lossless, json)
