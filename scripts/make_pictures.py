"""Make the pictures of README and docs from the shipped capture: docs/pictures/curve.png, loop.png,
follow.png.

python scripts/make_pictures.py
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

import mocurve as mc
from mocurve.data import example
from mocurve.draw_curves import curves
from mocurve.draw_path import save

PICTURES = Path(__file__).resolve().parent.parent / "docs" / "pictures"

if __name__ == "__main__":
    PICTURES.mkdir(exist_ok=True)
    jump = mc.read(example())
    curves(jump, mc.reduce(jump, tolerance="0.5%height"), "LeftLeg.Xrotation", PICTURES / "curve.png")
    mc.render(mc.loop(jump, cycles=3), PICTURES / "loop.png")
    slalom = mc.Path([(40 * np.sin(2 * np.pi * u), 10 + 120 * u) for u in np.linspace(0, 1, 9)])
    save(PICTURES / "follow.png", jump, mc.Path.of(jump), mc.follow(jump, slalom, at_end="cycle"), slalom)
