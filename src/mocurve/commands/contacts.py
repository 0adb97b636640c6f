"""`mocurve contacts`: when and where feet stand."""

from __future__ import annotations

import json as notation
from collections.abc import Sequence
from typing import Any

from ..feet import contacts as standing
from ..feet.contacts import Contact
from ..formats import read
from ..motion import Motion
from ._options import Json, Source, Unit, with_options_of
from ._terminal import told_when_compiling

WIDE = 60  # letters of the time line


@with_options_of(standing.contacts)
@told_when_compiling()
def contacts(file: Source, /, *, unit: Unit = None, json: Json = False, **options: Any) -> None:
    """When and where feet stand on the floor, as a table, a time line and JSON to change by hand.

    A contact belongs to the ball of a foot or, under the name of the ankle, to its
    heel. The JSON can be changed by hand and given to lock-feet.

    For example:
      mocurve contacts jump.bvh
      mocurve contacts jump.bvh --json > contacts.json
      mocurve lock-feet jump.bvh -o locked.bvh --contacts contacts.json
    """
    motion = read(file, unit=unit).sample()
    found = standing.contacts(motion, **options)
    rows = [contact.to_json() | {"seconds": _seconds(contact, motion)} for contact in found]
    if json:
        told = {"frames": motion.frames, "frame_time": motion.frame_time, "contacts": rows}
        print(notation.dumps(told, allow_nan=False))
        return
    print(*(_table(rows) if rows else ["no foot stands anywhere"]), *_lines(found, motion), sep="\n")


def _seconds(contact: Contact, motion: Motion) -> list[float]:
    return [contact.first * motion.frame_time, contact.last * motion.frame_time]


def _table(rows: Sequence[dict[str, Any]]) -> list[str]:
    wide = max(len("joint"), *(len(row["joint"]) for row in rows))
    head = f"{'joint':{wide}}  first   last      seconds               place"
    return [head] + [
        f"{row['joint']:{wide}} {row['first']:6} {row['last']:6}  {row['seconds'][0]:7.3f} {row['seconds'][1]:7.3f}  "
        + " ".join(f"{number:9.3f}" for number in row["place"])
        for row in rows
    ]


def _lines(found: Sequence[Contact], motion: Motion) -> list[str]:
    """A line a joint, # where it stands."""
    lines = []
    joints = dict.fromkeys(contact.joint for contact in found)
    for joint in joints:
        marks = [" "] * WIDE
        for contact in found:
            if contact.joint == joint:
                first, end = contact.first * WIDE // motion.frames, -(-(contact.last + 1) * WIDE // motion.frames)
                marks[first:end] = "#" * (end - first)
        lines.append(f"{joint:{max(map(len, joints))}} |{''.join(marks)}|")
    return lines
