"""Tolerances in the unit that a person can judge, and what they come to at every frame.

A rule is "[name][@start..end]=amount": "2mm", "0.1%height", "LeftHand=0.5mm", "@1.2..2.0=0.2mm",
"LeftKnee.Xrotation=0.1deg". Later rules win over earlier ones of the same kind. Amounts in mm, cm, m, in, ft, u (file
units) and %height bound how far joints and end sites move in the world; amounts in deg, %range and sigma (of the noise
that denoising found in the channel) bound the channels' own values. Both kinds may be asked at once: ["2mm", "5deg"]
moves nothing by more than 2 mm and turns nothing by more than 5 degrees.

Amounts in ratio (method split: height over base) and %span (methods probe and cluster: of a posture, what the keys do
not make) are the papers' own thresholds. Each stands alone, for the whole clip, and bounds nothing in space.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..errors import OptionError
from ..info import unit_of
from ..kinematics import rest_height
from ..motion import Motion
from ..skeleton import matching

DEFAULT = "0.1%height"
OF_NOISE = "0.3sigma"  # where the clip was denoised: closer would follow what is left of the noise
LEAST_SIGMA = 0.05  # degrees: for a channel that has next to no noise, so that it does not get a key every frame
METRES = {"mm": 0.001, "cm": 0.01, "m": 1.0, "in": 0.0254, "inch": 0.0254, "ft": 0.3048}
WORLD_UNITS = (*METRES, "u", "%height")
CHANNEL_UNITS = ("deg", "%range", "sigma")
THRESHOLDS = {"ratio": ("split",), "%span": ("probe", "cluster")}  # units of the papers -> the methods that have them

_RULE = re.compile(r"(?:(?P<name>[^@]*?)(?:@(?P<start>[^@]*?)\.\.(?P<end>[^@]*))?=)?(?P<amount>[^=]+)", re.DOTALL)
_AMOUNT = re.compile(r"\s*(?P<number>[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(?P<unit>%?\s*[A-Za-z]+)\s*")


@dataclass(frozen=True)
class Rule:
    """One rule: how much, in which unit, for which joints or channels (None: all), from when to when (seconds; None:
    always)."""

    amount: float
    unit: str
    name: str | None = None
    start: float | None = None
    end: float | None = None

    @property
    def in_world(self) -> bool:
        return self.unit in WORLD_UNITS


@dataclass(frozen=True, eq=False)
class Limits:
    """What the rules come to; inf where nothing is asked.

    channels: (C, F) degrees or file length, on the channel's own value.
    joints:   (J, F) file length, on the place of joints and end sites in the world; None where no rule speaks of the
    world.
    """

    channels: np.ndarray
    joints: np.ndarray | None


def parse(tolerance: str | Sequence[str]) -> tuple[Rule, ...]:
    """Rules from their text. Without a rule for the whole clip the default, 0.1 % of the rest height, stands first."""
    texts = [tolerance] if isinstance(tolerance, str) else tolerance
    if not isinstance(texts, Sequence) or not texts or not all(isinstance(text, str) for text in texts):
        raise OptionError(
            f"a tolerance is a text with its unit, like '2mm' or '0.5deg' (or a list of such), not {tolerance!r}"
        )
    rules = tuple(_rule(text) for text in texts)
    own = next((rule for rule in rules if rule.unit in THRESHOLDS), None)
    if own is not None and (len(rules) > 1 or own.name is not None or own.start is not None or own.end is not None):
        raise OptionError(f"a tolerance in {own.unit} is for the whole clip, and no other goes with it")
    if not any(rule.name is None and rule.start is None and rule.end is None for rule in rules):
        rules = (_rule(DEFAULT), *rules)
    return rules


def bounds(tolerance: Sequence[str] | None) -> Sequence[str] | None:
    """The tolerance, or None where it is a paper's own threshold, which bounds nothing."""
    return None if not tolerance or parse(tolerance)[0].unit in THRESHOLDS else tolerance


def resolve(rules: Sequence[Rule], motion: Motion) -> Limits:
    """What the rules allow each channel and each joint at each frame of the (unrolled) motion. OptionError for the
    threshold of a method, which bounds neither."""
    for rule in rules:
        if rule.unit in THRESHOLDS:
            raise OptionError(f"a tolerance in {rule.unit} goes with method {' or '.join(THRESHOLDS[rule.unit])}")
    skeleton = motion.skeleton
    channels = np.full((skeleton.channel_count, motion.frames), np.inf)
    joints = np.full((len(skeleton.names), motion.frames), np.inf)
    for rule in rules:
        frames = _frames(rule, motion)
        if rule.in_world:
            chosen = _chosen(rule, skeleton.names, skeleton.names, "joint")
            joints[np.ix_(np.array(chosen), frames)] = length(rule, motion)
        else:
            owners = [skeleton.names[joint] for joint in skeleton.channel_joints]
            for channel in _chosen(rule, skeleton.channel_names, owners, "joint or channel"):
                channels[channel, frames] = _channel_amount(rule, motion, channel)
    return Limits(channels, joints if any(rule.in_world for rule in rules) else None)


def length(rule: Rule, motion: Motion) -> float:
    """A world rule's amount in the file's length unit."""
    if rule.unit == "u":
        return rule.amount
    if rule.unit == "%height":
        height = rest_height(motion)
        if height == 0.0:
            raise OptionError("the rest pose has no height to take a part of; give the tolerance in u, mm or deg")
        return rule.amount / 100.0 * height
    unit = unit_of(motion)
    if not unit.said:
        warnings.warn(
            f"the file does not say its length unit; its rest height suggests {unit.name} (the option unit says it)",
            stacklevel=5,
        )
    return rule.amount * METRES[rule.unit] / unit.metres


def _channel_amount(rule: Rule, motion: Motion, channel: int) -> float:
    if rule.unit == "%range":
        return rule.amount / 100.0 * float(np.ptp(motion.values[:, channel])) if motion.frames else 0.0
    if rule.unit == "sigma":
        return rule.amount * _sigma(motion, channel)
    if motion.skeleton.rotation_channels[channel]:
        return rule.amount
    # what the angle spans at one rest height; a body without height has no lever to speak of
    return float(np.radians(rule.amount)) * (rest_height(motion) or 1.0)


def _sigma(motion: Motion, channel: int) -> float:
    """Noise of a channel: what denoising found, that of its like where it did not look, at least LEAST_SIGMA."""
    noise = None if motion.report is None else motion.report.noise
    if noise is None:
        raise OptionError("a tolerance in sigma is a part of the noise, which nobody measured: reduce with denoise")
    name, turns = motion.skeleton.channel_names[channel], motion.skeleton.rotation_channels[channel]
    alike = [row for row in noise.channels if (row.unit == "degrees") == turns]
    usual = float(np.median([row.sigma for row in alike])) if alike else 0.0
    sigma = next((row.sigma for row in alike if row.name == name), usual)
    least = LEAST_SIGMA if turns else float(np.radians(LEAST_SIGMA)) * (rest_height(motion) or 1.0)
    return max(sigma, least)


def _chosen(rule: Rule, names: Sequence[str], owners: Sequence[str], kind: str) -> list[int]:
    if rule.name is None:
        return list(range(len(names)))
    return matching(rule.name, names, owners, kind)


def _frames(rule: Rule, motion: Motion) -> np.ndarray:
    times = np.arange(motion.frames) * motion.frame_time
    inside = np.ones(motion.frames, bool)
    if rule.start is not None:
        inside &= times >= rule.start - 1e-9
    if rule.end is not None:
        inside &= times <= rule.end + 1e-9
    if not inside.any() and motion.frames:
        until = "on" if rule.end is None else f"to {rule.end:g} s"
        raise OptionError(f"no frame lies from {rule.start or 0:g} s {until}; the clip ends at {motion.duration:g} s")
    return inside


def _rule(text: str) -> Rule:
    known = ", ".join((*WORLD_UNITS, *CHANNEL_UNITS, *THRESHOLDS))
    parts = _RULE.fullmatch(text.strip())
    amount = _AMOUNT.fullmatch(parts["amount"]) if parts else None
    if parts is None or amount is None:
        raise OptionError(
            f"tolerance {text!r}: a number and a unit are expected, like 2mm or LeftHand@1.2..2.0=0.5mm; units: {known}"
        )
    unit = amount["unit"].replace(" ", "")
    if unit not in (*WORLD_UNITS, *CHANNEL_UNITS, *THRESHOLDS):
        raise OptionError(f"tolerance {text!r}: no unit {unit!r}; units: {known}")
    value = float(amount["number"])
    if not 0.0 <= value < np.inf:
        raise OptionError(f"tolerance {text!r}: the amount must be a number from 0 up")
    start, end = _seconds(parts["start"], text), _seconds(parts["end"], text)
    if start is not None and end is not None and start > end:
        raise OptionError(f"tolerance {text!r}: the interval ends before it starts")
    return Rule(value, unit, (parts["name"] or "").strip() or None, start, end)


def _seconds(text: str | None, rule: str) -> float | None:
    text = (text or "").strip().removesuffix("s").strip()
    if not text:
        return None
    try:
        value = float(text)
    except ValueError:
        raise OptionError(f"tolerance {rule!r}: {text!r} is not a time in seconds") from None
    if not 0.0 <= value < np.inf:
        raise OptionError(f"tolerance {rule!r}: a time is a number of seconds from 0 up")
    return value
