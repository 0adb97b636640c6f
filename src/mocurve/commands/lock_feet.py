"""`mocurve lock-feet`: feet held still where they stand."""

from __future__ import annotations

import json as notation
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from ..edit import lock_feet as locking
from ..errors import FileError
from ..formats import read
from ..formats._files import opened
from ._edits import Edited, Lossless, Output, changed, check_files, finish, sentence
from ._options import Json, Profile, Source, Unit, with_options_of
from ._terminal import told_when_compiling

Contacts = Annotated[
    Path | None,
    Parameter(help="When and where feet stand: what mocurve contacts wrote, changed by hand or not."),
]


@with_options_of(locking.lock_feet)
@told_when_compiling()
def lock_feet(
    file: Source,
    /,
    *,
    output: Output,
    contacts: Contacts = None,
    unit: Unit = None,
    profile: Profile = None,
    lossless: Lossless = False,
    json: Json = False,
    **options: Any,
) -> None:
    """Feet that slide while they should stand, held still.

    Hips, knees, ankles and the place of the body change, near contacts that slide;
    nothing else does. What a body cannot do is refused, and the frames are named.

    For example:
      mocurve lock-feet jump.bvh -o locked.bvh
      mocurve lock-feet run.bvh -o locked.bvh --speed 30 --release
      mocurve lock-feet jump.bvh -o locked.bvh --contacts contacts.json --json
    """
    check_files(output, file, *([] if contacts is None else [contacts]))
    clip = read(file, unit=unit)
    made = locking.lock_feet(clip, None if contacts is None else _listed(contacts), **options)
    told = changed(clip, made)
    lines = (str(locking.Locked(**made.history[-1]["measured"])), sentence(told, "changed"))
    finish(Edited(made, {"changed": told}, lines), output, profile, lossless, json)


def _listed(path: Path) -> list[Mapping[str, Any]]:
    """Contacts of a JSON file: a list of them, or an object with such a list."""
    try:
        with opened(path) as stream:
            given = notation.loads(stream.read())
    except (ValueError, RecursionError) as error:
        raise FileError(f"no JSON: {error}", path) from None
    listed = given.get("contacts") if isinstance(given, dict) else given
    if not isinstance(listed, list):
        raise FileError("no list of contacts, as mocurve contacts writes it", path)
    return listed
