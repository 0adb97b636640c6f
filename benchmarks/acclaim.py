"""Acclaim clips of CMU against their BVH conversions, joint by joint, and how long they take to read.

    python benchmarks/acclaim.py

The conversions put the children of a bone that has several at its start, and may begin with a T-pose: both is taken
out here. Distances are in the files' length unit (5.6444 cm); times are the median of seven, of the processor.
"""

from __future__ import annotations

import time
import warnings
from dataclasses import replace

import numpy as np

import mocurve as mc
from mocurve import kinematics

PAIRS = {  # motion: its conversion, T-poses before the first frame
    "cmu_01_01.amc": ("cmu_01_01_jump.bvh", 1),
    "cmu_02_03.amc": ("cmu_02_03_run.bvh", 0),
    "cmu_05_20.amc": ("cmu_05_20_dance_motionbuilder.bvh", 1),
}
# names of the joints in the conversions by B. Hahn, which other programs pass on
NAMES = {
    "root": "Hips", "lhipjoint": "LHipJoint", "lfemur": "LeftUpLeg", "ltibia": "LeftLeg", "lfoot": "LeftFoot",
    "ltoes": "LeftToeBase", "rhipjoint": "RHipJoint", "rfemur": "RightUpLeg", "rtibia": "RightLeg",
    "rfoot": "RightFoot", "rtoes": "RightToeBase", "lowerback": "LowerBack", "upperback": "Spine", "thorax": "Spine1",
    "lowerneck": "Neck", "upperneck": "Neck1", "head": "Head", "lclavicle": "LeftShoulder", "lhumerus": "LeftArm",
    "lradius": "LeftForeArm", "lwrist": "LeftHand", "lhand": "LeftFingerBase", "lfingers": "LeftHandIndex1",
    "lthumb": "LThumb", "rclavicle": "RightShoulder", "rhumerus": "RightArm", "rradius": "RightForeArm",
    "rwrist": "RightHand", "rhand": "RightFingerBase", "rfingers": "RightHandIndex1", "rthumb": "RThumb",
}  # fmt: skip
OTHER_NAMES = {"root": "hip", "lfingers": "LFingers", "rfingers": "RFingers"}


def named_in(joint: str, names: tuple[str, ...]) -> int:
    """Index of an Acclaim joint among the names of a conversion."""
    base, end = joint.removesuffix("_End"), "_End" * joint.endswith("_End")
    fits = [n + end for n in (base, NAMES[base], OTHER_NAMES.get(base, base)) if n + end in names]
    return names.index(fits[0])


def without_branching_offsets(motion: mc.Motion) -> mc.Motion:
    """Where a bone has several children the conversions put these at its start: that length is missing in them."""
    body = motion.skeleton
    children = np.bincount(body.parents[1:], minlength=len(body.names))
    branching = (body.parents >= 0) & (children[body.parents] > 1)
    return replace(motion, skeleton=replace(body, offsets=np.where(branching[:, None], 0.0, body.offsets)))


def apart(motion: mc.Motion, other: mc.Motion) -> np.ndarray:
    """(J,) how far each joint of a motion is from its place in the conversion, at the worst frame."""
    ours, theirs = kinematics.world(without_branching_offsets(motion)), kinematics.world(other)
    places = [named_in(joint, other.skeleton.names) for joint in motion.skeleton.names]
    return np.linalg.norm(ours - theirs[:, places], axis=2).max(axis=0)


def seconds(path) -> float:
    """Median of seven times to read a file, seconds of the processor."""
    taken = []
    for _ in range(7):
        start = time.process_time()
        mc.read(path)
        taken.append(time.process_time() - start)
    return sorted(taken)[3]


def main() -> None:
    from clips import folder

    cmu = folder() / "cmu"
    warnings.simplefilter("ignore")
    print(f"{'clip':16}{'frames':>8}{'root':>10}{'joints':>10}{'seconds':>9}")
    for name, (conversion, t_poses) in PAIRS.items():
        motion = mc.read(cmu / name)
        away = apart(motion, mc.read(cmu / conversion)[t_poses:])
        print(f"{name:16}{motion.frames:8}{away[0]:10.1e}{away.max():10.1e}{seconds(cmu / name):9.3f}")


if __name__ == "__main__":
    main()
