"""The keys are plain arrays: look at them, change one, sample at any rate, draw.

python examples/04_curves.py [CLIP]
"""

import sys
from dataclasses import replace
from pathlib import Path

import mocurve as mc
from mocurve.data import example

clip = Path(sys.argv[1]) if len(sys.argv) > 1 else example()
motion = mc.read(clip)
keys = mc.reduce(motion, tolerance="0.2%height", quality="fast")

# The channel that turns most: its keys are times (s), values (degrees) and slopes (degrees per second).
spans = motion.values.max(axis=0) - motion.values.min(axis=0)
channel = int((spans * motion.skeleton.rotation_channels).argmax())
curve = keys.curves[channel]
print(f"{motion.skeleton.channel_names[channel]}: {motion.frames} samples became {curve}")
for time, value, slope in list(zip(curve.times, curve.values, curve.slopes, strict=True))[:5]:
    print(f"  {time:6.3f} s {value:9.2f} deg {slope:9.2f} deg/s")

# Half the swing: what an animator does with a drag, here in one line.
middle = curve.values.mean()
calm = mc.HermiteCurve(curve.times, middle + (curve.values - middle) / 2, curve.slopes / 2)
calmer = replace(keys, curves=(*keys.curves[:channel], calm, *keys.curves[channel + 1 :]), report=None)

mc.write("calmer_24fps.bvh", calmer.sample(1 / 24))
mc.render(calmer, "calmer.png")
mc.compare(motion, calmer).save("calmer.html")
