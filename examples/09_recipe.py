"""What was done to one clip is done to the next: a clip carries its steps, and a recipe is a text file with steps.

python examples/09_recipe.py [CLIP]
"""

import json
import sys
from pathlib import Path

import mocurve as mc
from mocurve.data import example

clip = Path(sys.argv[1]) if len(sys.argv) > 1 else example()
motion = mc.read(clip)
keys = mc.reduce(mc.trim(motion, end=motion.duration / 2), tolerance="0.5%height", quality="fast")
mc.write("first.curves.json", keys)

# The steps are in the file, and do the same to another clip; on the command line:
#   mocurve run first.curves.json other.bvh -o other.curves.json
other = mc.run(motion[10:], "first.curves.json")
print(f"{keys.keys} keys of one clip, {other.keys} of another")
print(json.dumps(keys.history[1:], indent=1))  # the first step, read, says which file it was

recipe = """
# calm, closed, and played four times
[[steps]]
verb = "denoise"

[[steps]]
verb = "loop"
cycles = 4
"""
Path("calm.toml").write_text(recipe, encoding="utf-8")
print(mc.run(motion, "calm.toml"))
