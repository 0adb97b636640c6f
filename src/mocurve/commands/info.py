"""`mocurve info`: what a file holds."""

from __future__ import annotations

import json as notation

from .. import info as questions
from ..formats import read
from ..keyed import KeyedMotion
from ._options import Json, Source, Unit


def info(file: Source, /, *, unit: Unit = None, json: Json = False) -> None:
    """What a file holds: skeleton, channels, frames, length unit, and what is odd about it.

    Files do not say their length unit: it is guessed from the height of the body at
    rest, and the guess is told. Where the file carries the steps that made it, these
    are told, too: `mocurve run` does them to another clip.

    For example:
      mocurve info jump.bvh
    """
    clip = read(file, unit=unit)
    found = questions.inspect(clip.sample(), file)
    keys = clip if isinstance(clip, KeyedMotion) else None
    if json:
        print(notation.dumps(found.to_json() | ({} if keys is None else {"keys": keys.keys})))
    else:
        print(found, *([] if keys is None else [repr(keys)]), sep="\n")
