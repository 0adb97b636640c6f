"""The path of a motion, edited, and the motion walking it: at its own speed, or only where a point was moved.

python examples/10_path.py [CLIP]
"""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

import mocurve as mc
from mocurve.data import example

clip = Path(sys.argv[1]) if len(sys.argv) > 1 else example()
motion = mc.read(clip)

# The path is a B-spline through the root's way, by least squares; what it leaves out stays in the motion.
path = mc.Path.of(motion, points=8)
away = path.residuals(motion)
print(f"{path}; the root is up to {away.max():.2f} away from it")
assert (mc.follow(motion, path).values == motion.values).all()  # laid on its own path it is itself

# One control point aside, by a tenth of the path's length. Distances are kept, so the speed is.
points = np.array(path.points)
points[4] += 0.1 * path.length * np.array([1.0, 0.0])
edited = replace(path, points=points)
edited.write("edited.csv")  # on the command line: mocurve follow jump.bvh --path edited.csv -o bent.bvh
bent = mc.follow(motion, edited)
feet = bent.history[-1]["measured"]["feet"]
print(f"whole clip: balls of standing feet slide {feet['speed_slid']:.1f} cm/s carried, {feet['speed']:.1f} held")
mc.write("bent.bvh", bent)

# The same edit as a span: frames outside the part that the point reaches keep every digit.
part = mc.follow(motion, edited, mode="span")
found = part.history[-1]["measured"]
print(f"span: frames {found['first']} to {found['last']} of {part.frames}, strides {found['stride']:.2f} times as long")
assert (part.values[: found["first"]] == motion.values[: found["first"]]).all()
