"""Motion as B-splines: few coefficients on knots that all channels share, bent, retimed, and all of it undone exactly.

python examples/06_splines.py [CLIP]
"""

import sys
from pathlib import Path

import numpy as np

import mocurve as mc
from mocurve import spline
from mocurve.data import example

clip = Path(sys.argv[1]) if len(sys.argv) > 1 else example()
motion = mc.read(clip)
curves = mc.fit(motion, tolerance="1%height")  # no joint moves more than this
print(curves)

# Bent through a value, within half a second on both sides: knots are put in where the change begins and ends, exactly.
middle, arm = motion.duration / 2, "LeftArm.Zrotation"
channel = motion.skeleton.channel(arm)
raised = mc.warp(curves, middle, {arm: 60.0})
print(f"{arm} at {middle:.2f} s: {raised.at(middle)[0, channel]:.3f} degrees, on {len(raised.knots)} knots")

# What was done is a spline, too: on common knots it is the difference of coefficients.
before, after = spline.align(curves, raised)
back = mc.warp(raised, middle, {arm: float(curves.at(middle)[0, channel])})
undone = np.abs(back.sample().values - curves.sample().values).max()
print(f"{np.count_nonzero(np.any(before.values != after.values, axis=1))} rows of coefficients differ")
print(f"warped back, the curves are as they were to {undone:.1e} degrees")

# Time: moments moved to other times. An even speed only stretches the knots.
slow = mc.retime(curves, {motion.duration: 2 * motion.duration})
print(f"half the speed: {slow.duration:.2f} s, {len(slow.values)} coefficients as before: {len(curves.values)}")

# The same curves as Hermite keys, for other programs.
keys = spline.to_keys(raised)
print(f"{keys.keys} keys, {np.abs(keys.sample().values - raised.sample().values).max():.1e} degrees off")
mc.write("raised.spline.json", raised)
mc.write("raised.curves.json", keys)
