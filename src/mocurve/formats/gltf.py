"""glTF 2.0: .glb, and .gltf with its buffer inside, so that it too is one file.

A clip becomes an armature (nodes, and a skin that lists all joints, end sites too, in the skeleton's order), a figure
of octahedra around the bones, and an animation. Lengths are metres; joints rest unturned at their offsets; quaternions
are xyzw and turn the joint against its parent. Source: the Khronos glTF 2.0 specification, sections 3.7 and 3.11.

What glTF has no place for stands in two objects `extras.mocurve`, which `read` takes and other programs leave aside.
Of the skin, `skins[0].extras.mocurve`:
    version:    1.
    names:      J joint names as in the clip; a node's name has a number after it where it would stand twice.
    channels:   J lists, "Xposition" ... "Zrotation" in file order.
    offsets:    J x 3, file units; a joint that is moved by constant position channels rests elsewhere.
    end_sites:  indices of the joints that are end sites.
    unit:       metres that somebody said a file unit is, or null.
    scale:      metres that a file unit was written as (the unit, or a guess).
Of each animation, `animations[i].extras.mocurve`:
    frame_time: seconds; key times are times of frames, rounded to float32.
    frames:     how many there are, from time 0.
    start:      C channel values at the first frame, degrees and file units: which whole turns, and which of the two
                Euler triples, the rotations are meant to start with.
    history:    the steps that made the clip, a list of objects.
A path without a channel in the animation stays at the node's rest.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from ..errors import OptionError, UnknownName
from ._files import Path, encoded, replacing

if TYPE_CHECKING:
    from ..keyed import KeyedMotion
    from ..motion import Clip, Motion

PROFILES = {
    "linear": "few keys, straight between them, chosen for each joint so that the clip stays within the tolerance",
    "cubic": "the curves of a reduced clip, exact; Blender drops their tangents",
    "baked": "a key at every frame",
}
SEVERAL = True


def read(path: Path, *, animation: str | None = None) -> Motion | KeyedMotion:
    """An animation of a skeleton, the first or the one of that name; FileError where there is none to read."""
    from . import _gltf_read  # the writer has no use for it

    return _gltf_read.read(path, animation=animation)
