"""A tolerance is a length in space: for the whole body, for one joint, for a while.

python examples/02_tolerances.py [CLIP]
"""

import sys
from pathlib import Path

import mocurve as mc
from mocurve.data import example

clip = Path(sys.argv[1]) if len(sys.argv) > 1 else example()
motion = mc.read(clip)
hand = next(name for name in motion.skeleton.names if name.endswith("Hand"))

TOLERANCES = {
    "half a percent of the height": "0.5%height",
    "a tenth, the default": "0.1%height",
    "coarse, one hand fine": ["0.5%height", f"{hand}=0.1%height"],
    "coarse, fine for half a second": ["0.5%height", "@1..1.5=0.1%height"],
    "one degree a channel": "1deg",
}

for label, tolerance in TOLERANCES.items():
    keys = mc.reduce(motion, tolerance=tolerance, quality="fast")
    print(f"{label:<32} {keys.keys:6} keys   worst joint {keys.report.max_error_world:.4f} units off")
