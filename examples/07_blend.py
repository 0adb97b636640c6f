"""Between two motions, and from the one to the other: what differs is a motion, too.

python examples/07_blend.py [CLIP]
"""

import sys
from pathlib import Path

import mocurve as mc
from mocurve.data import example

clip = Path(sys.argv[1]) if len(sys.argv) > 1 else example()
motion = mc.read(clip)
first, second = motion[: motion.frames // 2], motion[-(motion.frames // 2) :]

# Between: one number, one that changes in time, one for some joints.
for weight in (0.5, [(0, 0), (first.duration, 1)], {"*Arm": 1.0}):
    made = mc.blend(first, second, weight)
    print(f"weight {weight}: {made}")
mc.write("between.bvh", mc.blend(first, second, 0.5))

# Brought in step first: at every moment both do the same then, and what lies between is a motion of its own.
between = mc.interpolate([first, second], [0.5, 0.5])
told = between.history[-1]["measured"]["clips"][1]
print(f"in step: {told['distance']:.1f} cm apart, {told['even_distance']:.1f} where both run evenly")
mc.render(between, "between.png", poses=10)

# What is in the second and not in the first: a displacement. Twice as much of it, only in the arms, put onto the first.
style = mc.difference(second, first)
more = mc.scale(style, {"*": 0.0, "*Arm": 2.0})
mc.write("exaggerated.bvh", mc.add(more, first))
assert abs(mc.add(style, first).values[:, 3:] - second.values[:, 3:]).max() % 360 < 1e-9
