"""A drawn path with heights, filled with cycles of a clip, and pictures of it.

python examples/12_tour.py [CLIP]
"""

import sys
from pathlib import Path

import numpy as np

import mocurve as mc
from mocurve.data import example
from mocurve.draw_path import save

clip = Path(sys.argv[1]) if len(sys.argv) > 1 else example()
motion = mc.read(clip)
own = mc.Path.of(motion)

# x, height, z: a bend over a low hill, three times as long as the clip's own path.
around = np.linspace(0.0, np.pi, 9)
ring = own.length * np.stack([1.0 - np.cos(around), 0.0 * around, np.sin(around)], axis=1)
ring[:, 1] = 0.05 * own.length * np.sin(around) ** 2
tour = mc.Path(ring)
tour.write("tour.csv")
print(tour)

walked = mc.follow(motion, tour, at_end="cycle")
found, table = walked.history[-1]["measured"], walked.history[-1]["table"]
print(
    f"{found['cycles']} cycles in {found['frames']} frames, {found['travelled']:.0f} of {found['length']:.0f} cm gone"
)
print(f"frame 100 was frame {table['frame'][100]:.0f} of the clip, {table['distance'][100]:.1f} along the path")

mc.write("tour.bvh", walked)
mc.render(walked, "tour.png", poses=16)
save("views.png", motion, own, walked, tour)  # from above and four views, own path and new one
