"""What `mocurve NAME` runs: one file a command, loaded only when its name is typed."""

COMMANDS = {
    "reduce": "Few Hermite keys instead of a sample at every frame; nothing moves more than the tolerance.",
    "fit": "B-splines on few knots, which all channels share; nothing moves more than the tolerance.",
    "clean": "Jitter, spikes and dropouts of a capture go; kicks and heel strikes stay. Nothing has to be tuned.",
    "blend": "Between two clips, or the mean of several: joints turn the shorter way, without flips.",
    "difference": "What is to be added to one clip to get another: a displacement, itself a clip.",
    "add": "A displacement put onto a clip.",
    "scale": "More or less of a displacement.",
    "warp": "A clip bent smoothly so that channels have given values at given times.",
    "retime": "Moments of a clip moved to other times; smooth in between, never backwards.",
    "refine": "The same number of keys, moved until they follow the clip better.",
    "join": "One motion over into another, where the two look most alike.",
    "register": "One clip retimed so that it runs in step with another.",
    "loop": "One cycle of a motion, closed and repeated without a seam.",
    "contacts": "When and where feet stand on the floor: a table, a time line, and JSON to change by hand.",
    "lock-feet": "Feet that slide while they should stand, held still.",
    "compare": "What changed between two clips: per channel, per joint, and as a page to look at.",
    "info": "What a file holds: skeleton, channels, frames, length unit, and what is odd about it.",
    "convert": "The same clip in another format.",
    "render": "A picture (.png) or an animation (.gif) of the moving figure.",
    "example": "Put a real capture, jump.bvh, into a folder to try things on.",
}
