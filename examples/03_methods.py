"""The same promise kept by every method, with keys placed per channel or shared by a whole pose.

python examples/03_methods.py [CLIP]
"""

import sys
from pathlib import Path

import mocurve as mc
from mocurve.data import example

clip = Path(sys.argv[1]) if len(sys.argv) > 1 else example()
motion = mc.read(clip)

for method in ("optimal", "split", "dynamic", "linear"):
    keys = mc.reduce(motion, tolerance="1deg", method=method)
    print(f"{method:<8} {keys.report.sentence()}")

for align in ("channel", "joint", "pose"):
    keys = mc.reduce(motion, tolerance="1deg", align=align)
    times = {float(time) for curve in keys.curves for time in curve.times}
    print(f"{align:<8} {keys.keys} keys at {len(times)} different times")

# Whole poses, as an animator blocks: so many keys, and the least error in space. Pins are kept.
for method in ("optimal", "salient", "posture"):
    keys = mc.reduce(motion, keys=12, method=method, pin=["0.5s"], quality="fast")
    print(f"{method:<8} poses at {list(keys.report.key_frames)}, {keys.report.max_error_world:.3f} units off at most")

# The simplification of the thesis chooses the keys, its dynamic programming improves them: as many keys, less error.
keys = mc.reduce(motion, method="split", tolerance="0.02ratio")
better = mc.refine(keys, motion)
print(f"split by ratio: {keys.keys} keys, rms {mc.compare(motion, keys).rms_error_degrees:.4f} degrees")
print(f"refined:        {better.keys} keys, rms {mc.compare(motion, better).rms_error_degrees:.4f} degrees")
