"""Feet that stand: when and where, and held still after a motion was looped and joined.

python examples/11_feet.py [CLIP]
"""

import sys
from pathlib import Path

import mocurve as mc
from mocurve.data import example

clip = Path(sys.argv[1]) if len(sys.argv) > 1 else example()
motion = mc.read(clip)

for contact in mc.contacts(motion):
    x, _, z = contact.place
    print(f"{contact.joint:14} frames {contact.first:4} to {contact.last:4} at {x:7.2f}, {z:7.2f}")


def told(name: str, locked: mc.Motion) -> None:
    found = locked.history[-1]["measured"]
    print(f"{name}: {found['speed_before']:.1f} -> {found['speed']:.2f} cm/s, hips down by {found['drop']:.1f} cm")


# A captured foot slides a little by itself; a blend slides more, because two steps are in it.
told("captured", mc.lock_feet(motion))
hops = mc.loop(motion, cycles=3)
told("looped", mc.lock_feet(hops))
joined = mc.join(hops, motion)
held = mc.lock_feet(joined, release=True)  # what would pull the body out of shape is let go, with a warning
told("joined", held)
mc.write("held.bvh", held)

# Contacts are data: a foot's place can be changed by hand. Frames of one clip, places in its own unit.
left = [contact.to_json() for contact in mc.contacts(motion)]
left[0]["place"][0] += 0.2
told("moved", mc.lock_feet(motion, left))
