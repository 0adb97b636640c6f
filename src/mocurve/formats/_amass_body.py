"""The tree of the SMPL family, and a mean body for poses that come without one.

Segment lengths as parts of the height: R. Drillis and R. Contini, Body segment parameters, 1966, as drawn in D. A.
Winter, Biomechanics and motor control of human movement, figure 4.1. What they do not have is divided simply: the
spine into four like parts, hip joints at half of the hip breadth, the hand into palm and fingers of like length.
The body stands as the models rest: arms to the sides, Y up, Z ahead, X to its left.
"""

from __future__ import annotations

from typing import NamedTuple

HEIGHT = 1.7  # metres
_ANKLE, _KNEE, _HIP, _SHOULDER, _CHIN, _EYE = 0.039, 0.285, 0.530, 0.818, 0.870, 0.936  # above the ground
_HIP_BREADTH, _SHOULDER_BREADTH, _FOOT = 0.191, 0.259, 0.152
_UPPER_ARM, _FOREARM, _HAND = 0.186, 0.146, 0.108
_VERTEBRA = (_SHOULDER - _HIP) / 4
_PALM = _HAND / 2
_PHALANGES = (0.5, 0.3, 0.2)  # parts of a finger
_KNUCKLES = {"index": (1.0, 0.016), "middle": (1.0, 0.005), "ring": (1.0, -0.005), "pinky": (0.8, -0.016)}  # length, Z
_SLANT = 0.5**0.5  # the thumb points to the side and ahead

Place = tuple[float, float, float]


class Bone(NamedTuple):
    """parent: the joint it hangs on; offset: from there, in heights."""

    parent: str
    offset: Place


def _left() -> dict[str, Bone]:
    arm = {
        "left_collar": Bone("spine3", (_SHOULDER_BREADTH / 4, _VERTEBRA, 0.0)),
        "left_shoulder": Bone("left_collar", (_SHOULDER_BREADTH / 4, 0.0, 0.0)),
        "left_elbow": Bone("left_shoulder", (_UPPER_ARM, 0.0, 0.0)),
        "left_wrist": Bone("left_elbow", (_FOREARM, 0.0, 0.0)),
        "left_hand": Bone("left_wrist", (_PALM, 0.0, 0.0)),
    }
    leg = {
        "left_hip": Bone("pelvis", (_HIP_BREADTH / 4, 0.0, 0.0)),
        "left_knee": Bone("left_hip", (0.0, _KNEE - _HIP, 0.0)),
        "left_ankle": Bone("left_knee", (0.0, _ANKLE - _KNEE, 0.0)),
        "left_foot": Bone("left_ankle", (0.0, -_ANKLE, _FOOT / 2)),
    }
    hand: dict[str, Bone] = {}
    for finger, (length, ahead) in _KNUCKLES.items():
        first, second, _ = (part * length * _PALM for part in _PHALANGES)
        hand[f"left_{finger}1"] = Bone("left_wrist", (_PALM, 0.0, ahead))
        hand[f"left_{finger}2"] = Bone(f"left_{finger}1", (first, 0.0, 0.0))
        hand[f"left_{finger}3"] = Bone(f"left_{finger}2", (second, 0.0, 0.0))
    first, second, _ = (part * _PALM * _SLANT for part in _PHALANGES)
    hand["left_thumb1"] = Bone("left_wrist", (_PALM / 3, 0.0, 0.016))
    hand["left_thumb2"] = Bone("left_thumb1", (first, 0.0, first))
    hand["left_thumb3"] = Bone("left_thumb2", (second, 0.0, second))
    face = {"left_eye_smplhf": Bone("head", (0.018, _EYE - _CHIN, 0.05))}
    return {**leg, **arm, **hand, **face}


def _left_ends() -> dict[str, Place]:
    """What ends a joint that has no child in some model."""
    tip = _PHALANGES[2] * _PALM
    return {
        "left_foot": (0.0, 0.0, _FOOT / 4),
        "left_wrist": (_HAND, 0.0, 0.0),
        "left_hand": (_PALM, 0.0, 0.0),
        "left_eye_smplhf": (0.0, 0.0, 0.01),
        "left_thumb3": (tip * _SLANT, 0.0, tip * _SLANT),
        **{f"left_{finger}3": (length * tip, 0.0, 0.0) for finger, (length, _) in _KNUCKLES.items()},
    }


def _right(name: str) -> str:
    return name.replace("left_", "right_")


def _mirrored(place: Place) -> Place:
    return (-place[0], place[1], place[2])


_MIDDLE = {
    "pelvis": Bone("", (0.0, _HIP, 0.0)),
    "spine1": Bone("pelvis", (0.0, _VERTEBRA, 0.0)),
    "spine2": Bone("spine1", (0.0, _VERTEBRA, 0.0)),
    "spine3": Bone("spine2", (0.0, _VERTEBRA, 0.0)),
    "neck": Bone("spine3", (0.0, _VERTEBRA, 0.0)),
    "head": Bone("neck", (0.0, _CHIN - _SHOULDER, 0.0)),
    "jaw": Bone("head", (0.0, 0.01, 0.01)),
}
BONES = {
    **_MIDDLE,
    **_left(),
    **{_right(name): Bone(_right(bone.parent), _mirrored(bone.offset)) for name, bone in _left().items()},
}
ENDS = {  # from the joint, in heights
    "head": (0.0, 1.0 - _CHIN, 0.0),
    "jaw": (0.0, -0.02, 0.04),
    **_left_ends(),
    **{_right(name): _mirrored(place) for name, place in _left_ends().items()},
}
