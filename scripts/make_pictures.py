"""Make the pictures of README and docs from the shipped capture: curve, loop, act_out, shape, follow.

python scripts/make_pictures.py
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

import mocurve as mc
from mocurve import draw_curves, draw_path
from mocurve.data import example
from mocurve.draw_curves import CURVE, KEY, LARGER, PAPER, SAMPLES, TEXT, Axes
from mocurve.edit import _bank

# a mouse drawn up and down by hand: seconds, and how high
PERFORMED = [(0, 4), (0.7, 1), (1.2, 9), (1.6, 1), (2.5, 5), (2.9, 0), (3.6, 10), (4.0, 1), (4.6, 5)]
PICTURES = Path(__file__).resolve().parent.parent / "docs" / "pictures"
WIDTH, HEIGHT, LETTER = 1200 * LARGER, 440 * LARGER, 20 * LARGER
KNEE, HIGH = "LeftLeg.flexion", 60.0
HIPS = "Hips.Yposition"
SHOWN = (2, 3, 4, 5, 6)  # bands
LANES = 10 * LETTER


def shape(jump: mc.Motion) -> None:
    """Above: a knee that may bend by 60 degrees, before and after. Below: the height of the hips in bands."""
    whole = Image.new("RGB", (WIDTH, 2 * HEIGHT), PAPER)
    times = np.arange(jump.frames) * jump.frame_time
    made = mc.limit(jump, {KNEE: (None, HIGH)})
    before, after = (flexion(clip) for clip in (jump, made))
    lines = [(SAMPLES, "captured", before), (KEY, f"the limit, {HIGH:g}", np.full(jump.frames, HIGH))]
    whole.paste(panel(times, f"{KNEE} (degrees)", [*lines, (CURVE, "after limit", after)])[0], (0, 0))
    whole.paste(bands(times, jump), (0, HEIGHT))
    whole.reduce(LARGER).quantize(64).save(PICTURES / "shape.png", "PNG", optimize=True)


def acted_out(jump: mc.Motion, keys: mc.KeyedMotion) -> None:
    """A hand's curve, and the height of the hips that follows it in time."""
    acted = mc.act_out(keys, PERFORMED, channel=HIPS)
    height = jump.skeleton.channel(HIPS)
    values = np.zeros((acted.frames, jump.skeleton.channel_count))
    hand = np.interp(np.arange(acted.frames) * jump.frame_time, *np.array(PERFORMED).T)
    values[:, height] = jump.values[:, height].min() + hand / hand.max() * np.ptp(jump.values[:, height])
    draw_curves.curves(mc.Motion(jump.skeleton, values, jump.frame_time), acted, HIPS, PICTURES / "act_out.png")


def flexion(clip: mc.Motion) -> np.ndarray:
    """(F,) degrees."""
    from mocurve.edit._anatomy import of_people

    return next(kind.angles(clip.values)[:, 0] for kind in of_people(clip)[0] if kind.names == (KNEE,))


def bands(times: np.ndarray, jump: mc.Motion) -> Image.Image:
    """The slower bands of the hips' height, one above the other, all in one scale."""
    height = jump.values[:, [jump.skeleton.channel(HIPS)]]
    edges = _bank.edges(_bank.count(jump.frames), jump.frame_time)
    _, found = _bank.shaped(height, np.ones(len(edges) - 1))
    apart = 1.1 * max(float(np.ptp(found[k])) for k in SHOWN)
    lines = [(CURVE, "", found[k][:, 0] - row * apart) for row, k in enumerate(SHOWN)]
    image, axes = panel(times, f"{HIPS}: the slower bands, in one scale", lines, LANES)
    draw, font = ImageDraw.Draw(image), ImageFont.load_default(LETTER)
    draw.rectangle((0, axes.box[1], axes.box[0] - 1, axes.box[3]), PAPER)  # heights of lanes are no values
    for (_, _, values), k in zip(lines, SHOWN, strict=True):
        ((_, down),) = axes(times[-1:], values[-1:])
        told = f"{k}: {edges[k + 1]:.2g} to {edges[k]:.2g} Hz"
        draw.text((axes.box[2] + LETTER, down), told, TEXT, font, anchor="lm")
    return image


def panel(
    times: np.ndarray, title: str, lines: list[tuple[str, str, np.ndarray]], beside: float = 1.2 * LETTER
) -> tuple[Image.Image, Axes]:
    """Curves over time: colour, name and values (F,) of each; `beside`: pixels left free on the right."""
    image = Image.new("RGB", (WIDTH, HEIGHT), PAPER)
    box = (5 * LETTER, 2.6 * LETTER, WIDTH - beside, HEIGHT - 3.4 * LETTER)
    least, most = min(v.min() for _, _, v in lines), max(v.max() for _, _, v in lines)
    margin = 0.06 * (most - least)
    axes = Axes(box, (float(times[0]), float(times[-1])), (float(least - margin), float(most + margin)))
    draw = ImageDraw.Draw(image)
    draw_curves.frame(draw, axes, LETTER, title)
    for colour, _, values in lines:
        draw.line(axes(times, values), colour, 3 * LARGER if colour != KEY else LARGER, joint="curve")
    draw_curves.legend(draw, [(colour, name) for colour, name, _ in lines if name], box, LETTER)
    return image, axes


if __name__ == "__main__":
    PICTURES.mkdir(exist_ok=True)
    capture = mc.read(example())
    keys = mc.reduce(capture, tolerance="0.5%height")
    draw_curves.curves(capture, keys, "LeftLeg.Xrotation", PICTURES / "curve.png")
    mc.render(mc.loop(capture, cycles=3), PICTURES / "loop.png")
    acted_out(capture, keys)
    shape(capture)
    slalom = mc.Path([(40 * np.sin(2 * np.pi * u), 10 + 120 * u) for u in np.linspace(0, 1, 9)])
    followed = mc.follow(capture, slalom, at_end="cycle")
    draw_path.save(PICTURES / "follow.png", capture, mc.Path.of(capture), followed, slalom)
