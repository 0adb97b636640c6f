"""Make the pictures of README and docs from the shipped capture: docs/pictures/curve.png, loop.png, act_out.png.

python scripts/make_pictures.py
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

import mocurve as mc
from mocurve.data import example
from mocurve.draw_curves import curves

# a mouse drawn up and down by hand: seconds, and how high
PERFORMED = [(0, 4), (0.7, 1), (1.2, 9), (1.6, 1), (2.5, 5), (2.9, 0), (3.6, 10), (4.0, 1), (4.6, 5)]
PICTURES = Path(__file__).resolve().parent.parent / "docs" / "pictures"

if __name__ == "__main__":
    PICTURES.mkdir(exist_ok=True)
    jump = mc.read(example())
    curves(jump, mc.reduce(jump, tolerance="0.5%height"), "LeftLeg.Xrotation", PICTURES / "curve.png")
    mc.render(mc.loop(jump, cycles=3), PICTURES / "loop.png")
    acted = mc.act_out(mc.reduce(jump, tolerance="0.5%height"), PERFORMED, channel="Hips.Yposition")
    height = jump.skeleton.channel("Hips.Yposition")
    values = np.zeros((acted.frames, jump.skeleton.channel_count))
    hand = np.interp(np.arange(acted.frames) * jump.frame_time, *np.array(PERFORMED).T)
    values[:, height] = jump.values[:, height].min() + hand / hand.max() * np.ptp(jump.values[:, height])
    curves(mc.Motion(jump.skeleton, values, jump.frame_time), acted, "Hips.Yposition", PICTURES / "act_out.png")
