"""The main job: a capture becomes a few keys a channel, and the report says what that cost.

python examples/01_reduce.py [CLIP]
"""

import sys
from pathlib import Path

import mocurve as mc
from mocurve.data import example

clip = Path(sys.argv[1]) if len(sys.argv) > 1 else example()

motion = mc.read(clip)
print(motion)

keys = mc.reduce(motion)  # no joint moves more than 0.1 % of the body's height
print(keys)

mc.write("reduced.curves.json", keys)  # the keys themselves
mc.write("reduced.bvh", keys.sample())  # samples again, for any other program

back = mc.read("reduced.curves.json")
print(f"{back.keys} keys read back: {back.keys / back.frames:.1f} a frame, where {len(back.curves)} numbers were")
