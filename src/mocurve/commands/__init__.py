"""What `mocurve NAME` runs: one file a command, loaded only when its name is typed.

GROUPS is what `mocurve --help` shows.
"""

GROUPS = {
    "From captures to curves": {
        "reduce": "Few Hermite keys instead of a sample at every frame; nothing moves more than the tolerance.",
        "poses": "The frames that say most of a clip, as an animator would block it.",
        "refine": "The same number of keys, moved until they follow the clip better.",
        "fit": "B-splines on few knots, which all channels share; nothing moves more than the tolerance.",
        "clean": "Jitter, spikes and dropouts of a capture go; kicks and heel strikes stay. Nothing has to be tuned.",
    },
    "One motion changed": {
        "trim": "A piece of a clip, exactly as it was.",
        "axes": "A clip whose file has z up, or x, turned so that y is up; and back.",
        "warp": "A clip bent smoothly so that channels have given values at given times.",
        "retime": "Moments of a clip moved to other times; smooth in between, never backwards.",
        "act-out": "A clip gets the timing with which somebody performs it.",
        "loop": "One cycle of a motion, closed and repeated without a seam.",
        "bands": "The fine and the slow of a motion, each made more or less: smoothed, or exaggerated.",
        "waveshape": "Values of channels put through a curve: bent softly towards limits, or through given pairs.",
        "limit": "Joints kept within what they can do, bent smoothly wherever they are not.",
    },
    "Several motions": {
        "blend": "Between two clips, or the mean of several: joints turn the shorter way, without flips.",
        "interpolate": "Between motions of one kind, brought in step: a walk, a run, and what lies between or beyond.",
        "join": "One motion over into another, where the two look most alike.",
        "register": "One clip retimed so that it runs in step with another.",
        "difference": "What is to be added to one clip to get another: a displacement, itself a clip.",
        "add": "A displacement put onto a clip.",
        "scale": "More or less of a displacement.",
    },
    "Over the ground": {
        "path": "The path of a clip over the ground, as control points to edit.",
        "follow": "A clip laid along a path: what it does relative to its own path, it does relative to the new one.",
        "contacts": "When and where feet stand on the floor: a table, a time line, and JSON to change by hand.",
        "lock-feet": "Feet that slide while they should stand, held still.",
    },
    "Files and pictures": {
        "info": "What a file holds: skeleton, channels, frames, length unit, and what is odd about it.",
        "compare": "What changed between two clips: per channel, per joint, and as a page to look at.",
        "convert": "The same clip in another format.",
        "render": "A picture (.png) or an animation (.gif) of the moving figure.",
        "run": "Several steps in one, from a recipe or from the history of a clip.",
        "example": "Put a real capture, jump.bvh, into a folder to try things on.",
    },
}
COMMANDS = {name: told for commands in GROUPS.values() for name, told in commands.items()}
