"""What ufbx finds in an FBX file, as JSON: python ufbx_says.py clip.fbx time ...

A process of its own, without garbage collection: ufbx 0.0.5 crashes when its objects are collected.
"""

import gc
import json
import os
import sys

gc.disable()
import ufbx  # noqa: E402  # not before collection is off

scene = ufbx.load_file(sys.argv[1])
times = [float(word) for word in sys.argv[2:]]
curves = []
for curve in scene.anim_curves:
    keys = list(curve.keyframes)
    told = {"times": [key.time for key in keys], "slopes": [key.right.dy / key.right.dx for key in keys[:-1]]}
    curves.append({**told, "values": [curve.evaluate(time, 0.0) for time in times]})
found = {
    "warnings": len(scene.metadata.warnings),
    "bones": [bone.name for bone in scene.bones],
    "fps": scene.settings.frames_per_second,
    "metres": scene.settings.unit_meters,
    "curves": curves,
}
print(json.dumps(found), flush=True)
os._exit(0)
