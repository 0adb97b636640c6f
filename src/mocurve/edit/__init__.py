"""Changes to motion: one file a verb, clip in, clip out.

VERBS is the table: the name of a verb -> the module that has it. Adding a verb is a file and a line. Nothing is loaded
before it is asked for.
"""

VERBS = {
    "trim": "trim",
    "axes": "axes",
    "blend": "blend",
    "mix": "mix",
    "interpolate": "interpolate",
    "difference": "difference",
    "add": "add",
    "scale": "scale",
    "warp": "warp",
    "retime": "retime",
    "loop": "loop",
    "join": "join",
    "register": "register",
    "bands": "bands",
    "waveshape": "waveshape",
    "limit": "limit",
    "act_out": "act_out",
    "follow": "follow",
    "lock_feet": "lock_feet",
}
