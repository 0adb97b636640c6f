"""`mocurve contacts`: when and where feet stand."""

from __future__ import annotations

import json as notation
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from ..feet import contacts as standing
from ..feet.contacts import Contact
from ..formats import read
from ..formats._files import replacing
from ..motion import Motion
from ._options import Json, Source, Unit, check_outputs, tell, with_options_of
from ._terminal import told_when_compiling

WIDE = 60  # letters of the time line

Output = Annotated[
    Path | None, Parameter(name=("--output", "-o"), help="Where the contacts go as JSON, to be changed by hand.")
]


@dataclass(frozen=True, eq=False)
class Found:
    """The contacts of a clip, as a table with a time line and as JSON."""

    contacts: Sequence[Contact]
    motion: Motion

    def __str__(self) -> str:
        rows = self.to_json()["contacts"]
        return "\n".join([*_table(rows), *_lines(self.contacts, self.motion.frames)]) if rows else "no foot stands"

    def to_json(self) -> dict[str, Any]:
        """The same as plain numbers, texts and lists."""
        step = self.motion.frame_time
        rows = [one.to_json() | {"seconds": [one.first * step, one.last * step]} for one in self.contacts]
        return {"frames": self.motion.frames, "frame_time": step, "contacts": rows}


@with_options_of(standing.contacts)
@told_when_compiling()
def contacts(file: Source, /, *, output: Output = None, unit: Unit = None, json: Json = False, **options: Any) -> None:
    """When and where feet stand on the floor: a table, a time line, and JSON to change by hand.

    A contact belongs to the ball of a foot or, under the name of the ankle, to its
    heel. The JSON can be changed by hand and given to lock-feet.

    For example:
      mocurve contacts jump.bvh
      mocurve contacts jump.bvh -o contacts.json
      mocurve lock-feet jump.bvh -o locked.bvh --contacts contacts.json
    """
    check_outputs(file, output)
    motion = read(file, unit=unit).sample()
    found = Found(standing.contacts(motion, **options), motion)
    if output is not None:
        with replacing(output) as stream:
            stream.write(notation.dumps(found.to_json(), indent=1, allow_nan=False).encode())
    tell(found, json, output)


# -- in call order ---------------------------------------------------------------------------------


def _table(rows: Sequence[dict[str, Any]]) -> list[str]:
    wide = max(len("joint"), *(len(row["joint"]) for row in rows))
    head = f"{'joint':{wide}}  first   last      seconds               place"
    return [head] + [
        f"{row['joint']:{wide}} {row['first']:6} {row['last']:6}  {row['seconds'][0]:7.3f} {row['seconds'][1]:7.3f}  "
        + " ".join(f"{number:9.3f}" for number in row["place"])
        for row in rows
    ]


def _lines(found: Sequence[Contact], frames: int) -> list[str]:
    """A line a joint, # where it stands."""
    lines = []
    joints = dict.fromkeys(contact.joint for contact in found)
    for joint in joints:
        marks = [" "] * WIDE
        for contact in found:
            if contact.joint == joint:
                first, end = contact.first * WIDE // frames, -(-(contact.last + 1) * WIDE // frames)
                marks[first:end] = "#" * (end - first)
        lines.append(f"{joint:{max(map(len, joints))}} |{''.join(marks)}|")
    return lines
