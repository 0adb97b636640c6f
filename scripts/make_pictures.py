"""Make the pictures of README and docs from the shipped capture: docs/pictures/curve.png, loop.png.

python scripts/make_pictures.py
"""

from __future__ import annotations

from pathlib import Path

import mocurve as mc
from mocurve.data import example
from mocurve.draw_curves import curves

PICTURES = Path(__file__).resolve().parent.parent / "docs" / "pictures"

if __name__ == "__main__":
    PICTURES.mkdir(exist_ok=True)
    jump = mc.read(example())
    curves(jump, mc.reduce(jump, tolerance="0.5%height"), "LeftLeg.Xrotation", PICTURES / "curve.png")
    mc.render(mc.loop(jump, cycles=3), PICTURES / "loop.png")
