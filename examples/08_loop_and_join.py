"""A cycle that repeats without a seam, and one motion over into another.

python examples/08_loop_and_join.py [CLIP] [SECOND CLIP]
"""

import sys
from pathlib import Path

import mocurve as mc
from mocurve.data import example

clip = Path(sys.argv[1]) if len(sys.argv) > 1 else example()
motion = mc.read(clip)
other = mc.read(sys.argv[2]) if len(sys.argv) > 2 else motion

# The clearest cycle is found by itself; every one goes on from where the one before has arrived.
tour = mc.loop(motion, cycles=3)
found = tour.history[-1]["measured"]
print(f"a cycle from {found['start']:.2f} to {found['end']:.2f} s, {found['travel']:.0f} {found['unit']} far")
print(f"at the seam {found['jump']:.2f} {found['unit']} off, {found['acceleration']:.2f} of the usual acceleration")

# Over into the other, where both look most alike; it is turned and moved to where the first has arrived.
both = mc.join(tour, other)
found = both.history[-1]["measured"]
print(f"left at {found['leave']:.2f} s, entered at {found['enter']:.2f} s, turned by {found['turn']:.0f} degrees")
print(f"largest step {found['step']:.2f}, acceleration {found['acceleration']:.2f} of the clips' own")

mc.write("tour.bvh", both)
mc.render(both, "tour.png")
