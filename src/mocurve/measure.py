"""How far one clip is from another: per channel in its own unit, per joint in space, and what it costs in keys."""

from __future__ import annotations

import warnings
from dataclasses import asdict, dataclass, field, fields, replace
from os import PathLike
from typing import Any

import numpy as np

from . import kinematics
from .errors import Mismatch, OptionError
from .info import unit_of
from .keyed import KeyedMotion
from .measure_feet import FootSkate, foot_skate
from .measure_noise import Noise
from .measure_text import table
from .motion import Clip, Motion
from .skeleton import AXES, Skeleton
from .spline import SplineMotion

NUMBER_BYTES = 8  # float64
KEY_NUMBERS = 3  # time, value, slope


@dataclass(frozen=True)
class ChannelError:
    """One channel: its keys and how far it is off, in `unit` ("degrees", or "units" for the file's length unit).

    lower_bound: fewest keys that could hold the tolerance; tolerance: the tightest that was asked for. None: not known.
    """

    name: str
    unit: str
    keys: int
    max: float
    rms: float
    lower_bound: int | None = None
    tolerance: float | None = None


@dataclass(frozen=True)
class JointError:
    """One joint or end site: how far it is off in space, in the file's length unit."""

    name: str
    max: float
    rms: float
    tolerance: float | None = None


@dataclass(frozen=True)
class Report:
    """What a clip costs and how far it is from its original.

    keys, samples:    of all channels; a clip without keys counts each of its coefficients or samples as one.
    knots:            that the channels of a spline share, those at the ends as often as they count; else None.
    *_error_degrees:  over all rotation channels; None where the two clips have different channels.
    *_error_length:   over all position channels, file units; None likewise.
    *_error_world:    over all joints and end sites at every frame, by forward kinematics, file units.
    unit:             metres that a file unit stands for, None where nobody said.
    unit_guess:       where nobody said: metres that the body's height suggests, None for a body without height.
    bytes:            of the second clip's numbers: 24 a key (time, value, slope), 8 a sample, coefficient or knot.
    lower_bound:      proven fewest keys at the tolerance; seconds: what the reduction took; None where not known.
    clips:            the two that were compared, for the pictures of `save`; not part of the JSON.
    tolerance, method, align, quality: how the second clip was made; None where not known.
    key_frames:       frames of the keys that all channels share; None where they do not, or have none.
    noise:            what denoising found in the clip; None where nobody looked.
    feet:             how feet slide in both, where they stand in the first; None where no two legs stand anywhere.
    """

    keys: int
    samples: int
    frames: int
    max_error_degrees: float | None
    rms_error_degrees: float | None
    max_error_length: float | None
    rms_error_length: float | None
    max_error_world: float
    rms_error_world: float
    bytes: int
    unit: float | None = None
    unit_guess: float | None = None
    lower_bound: int | None = None
    seconds: float | None = None
    tolerance: str | None = None
    method: str | None = None
    align: str | None = None
    quality: str | None = None
    channels: tuple[ChannelError, ...] = ()
    joints: tuple[JointError, ...] = ()
    noise: Noise | None = None
    feet: FootSkate | None = None
    knots: int | None = None
    key_frames: tuple[int, ...] | None = None
    clips: tuple[Clip, Clip] | None = field(default=None, repr=False, compare=False)

    @property
    def ratio(self) -> float:
        """Samples a key: how many times fewer numbers to edit. 0 where there are no keys."""
        return self.samples / self.keys if self.keys else 0.0

    @property
    def over_bound(self) -> float | None:
        """Keys over the proven fewest; None where the bound is not known."""
        return self.keys / self.lower_bound if self.lower_bound else None

    @property
    def unknowns(self) -> str:
        """What `keys` counts, in a word."""
        return "keys" if self.knots is None else "coefficients"

    def sentence(self) -> str:
        """The report in one line."""
        bound = "" if self.over_bound is None else f", {self.over_bound:.2f}x the proven least"
        degrees = "" if self.max_error_degrees is None else f"{self.max_error_degrees:.3g} degrees and "
        where = f"at most {degrees}{_length(self, self.max_error_world)} off"
        return f"{self.keys:,} {self.unknowns} for {self.samples:,} samples (1 for {self.ratio:.1f}){bound}; {where}"

    def __str__(self) -> str:
        found = ([], []) if self.noise is None else (self.noise.lines(), self.noise.rows())
        return "\n".join([*found[0], *_summary_lines(self), *found[1], *_worst_lines(self)])

    def to_json(self) -> dict[str, Any]:
        """Plain dict for json.dumps; `Report.from_json` reads it back."""
        rows = {name: [asdict(row) for row in getattr(self, name)] for name in ("channels", "joints")}
        nested = ("noise", "feet")
        plain = {f.name: getattr(self, f.name) for f in fields(self) if f.name not in (*rows, *nested, "clips")}
        plain |= {name: found and found.to_json() for name in nested for found in (getattr(self, name),)}
        return {**plain, "ratio": self.ratio, "over_bound": self.over_bound, **rows}

    @classmethod
    def from_json(cls, data: dict[str, Any]) -> Report:
        """The report that `to_json` told; keys that a report does not have are left aside."""
        known = {f.name: data[f.name] for f in fields(cls) if f.name in data}
        known["channels"] = tuple(ChannelError(**row) for row in known.get("channels", ()))
        known["joints"] = tuple(JointError(**row) for row in known.get("joints", ()))
        if known.get("key_frames") is not None:
            known["key_frames"] = tuple(known["key_frames"])
        if known.get("noise") is not None:
            known["noise"] = Noise.from_json(known["noise"])
        if known.get("feet") is not None:
            known["feet"] = FootSkate.from_json(known["feet"])
        return cls(**known)

    def save(self, path: str | PathLike[str], *, sweep: bool = True) -> None:
        """Write the report: a page with pictures (.html), .json or .txt, as `report.save` does."""
        from . import report  # plotly is loaded only where a page is written

        report.save(self, path, sweep=sweep)


def compare(a: Clip, b: Clip) -> Report:
    """How far clip `b` is from clip `a`, at the frames of `a`, and what it costs.

    Channels are compared by name, rotations up to whole turns and up to the equivalent Euler triple; joints and end
    sites in space by forward kinematics. Where the clips differ in length the common part is compared and a warning
    says so; where only their channels differ (another rotation order) they are compared in space alone, with a warning.
    Mismatch names the first difference of the skeletons.

    >>> mc.compare(walk, mc.reduce(walk, tolerance="2mm")).max_error_world
    """
    first, second = side_by_side(a, b)
    skeleton = first.skeleton
    keys = key_counts(b)
    apart = _world_error(first, second)
    same_channels = skeleton.channel_names == second.skeleton.channel_names
    off = np.abs(second.values - first.values) if same_channels else None
    turning = skeleton.rotation_channels
    degrees = (None, None) if off is None else _max_rms(off[:, turning])
    length = (None, None) if off is None else _max_rms(off[:, ~turning])
    unit = skeleton.unit if skeleton.unit is not None else second.skeleton.unit
    knots = len(b.knots) if isinstance(b, SplineMotion) else None
    report = Report(
        keys=int(keys.sum()),
        knots=knots,
        key_frames=_shared_frames(b) if isinstance(b, KeyedMotion) else None,
        samples=a.frames * skeleton.channel_count,
        frames=a.frames,
        max_error_degrees=degrees[0],
        rms_error_degrees=degrees[1],
        max_error_length=length[0],
        rms_error_length=length[1],
        max_error_world=_max_rms(apart)[0],
        rms_error_world=_max_rms(apart)[1],
        bytes=NUMBER_BYTES * (int(keys.sum()) * (KEY_NUMBERS if isinstance(b, KeyedMotion) else 1) + (knots or 0)),
        unit=unit,
        unit_guess=_guessed_unit(first) if unit is None else None,
        channels=() if off is None else _channel_rows(skeleton, keys, off),
        joints=tuple(JointError(name, *_max_rms(apart[:, joint])) for joint, name in enumerate(skeleton.names)),
        clips=(a, b),
        feet=foot_skate(first, second),
    )
    return _with_making(report, b)


def side_by_side(a: Clip, b: Clip) -> tuple[Motion, Motion]:
    """The two clips on the frames of `a` that both have; rotations of `a` written as near to those of `b` as can be."""
    _check_skeletons(a.skeleton, b.skeleton)
    first = a.sample()
    second = b.sample(None if b.frame_time == a.frame_time else a.frame_time)
    common = min(first.frames, second.frames)
    if abs(a.duration - b.duration) > 1.001 * max(a.frame_time, b.frame_time) or (first.frames > 0) != (
        second.frames > 0
    ):
        _warn(f"the clips last {a.duration:.3f} s and {b.duration:.3f} s: the first {common} frames are compared")
    first, second = first[:common], second[:common]
    if first.skeleton.channel_names != second.skeleton.channel_names:
        named = _first_difference(first.skeleton.channel_names, second.skeleton.channel_names)
        _warn(f"the channels differ ({named}): the clips are compared in space only")
        return first, second
    return replace(first, values=_written_like(first.skeleton, first.values, second.values)), second


def key_counts(clip: Clip) -> np.ndarray:
    """(C,) keys of each channel, or coefficients; of a clip without either its samples."""
    if isinstance(clip, KeyedMotion):
        return np.array([len(curve) for curve in clip.curves], np.int64)
    if isinstance(clip, SplineMotion):
        return np.full(clip.values.shape[1], len(clip.values), np.int64)
    return np.full(clip.skeleton.channel_count, clip.frames, np.int64)


# -- in call order -----------------------------------------------------------------------------------------------------


def _shared_frames(keyed: KeyedMotion) -> tuple[int, ...] | None:
    """Frames of the keys, where every channel has the same key times and they lie on frames."""
    if not keyed.curves or any(not np.array_equal(keyed.curves[0].times, curve.times) for curve in keyed.curves):
        return None
    frames = keyed.curves[0].times / keyed.frame_time
    if (np.abs(frames - np.rint(frames)) > 1e-6 * np.maximum(frames, 1.0)).any():
        return None
    return tuple(int(frame) for frame in np.rint(frames))


def _check_skeletons(a: Skeleton, b: Skeleton) -> None:
    if a.names != b.names:
        raise Mismatch(f"the skeletons differ: {_first_difference(a.names, b.names)}")
    if (a.parents != b.parents).any():
        joint = int(np.flatnonzero(a.parents != b.parents)[0])
        over = ["no joint" if s.parents[joint] < 0 else repr(s.names[s.parents[joint]]) for s in (a, b)]
        raise Mismatch(
            f"the skeletons differ: {a.names[joint]!r} hangs on {over[0]} in the first, on {over[1]} in the second"
        )
    if a.unit is not None and b.unit is not None and not np.isclose(a.unit, b.unit, rtol=1e-3):
        raise Mismatch(f"the length units differ: {a.unit:g} m in the first, {b.unit:g} m in the second")


def _first_difference(a: tuple[str, ...], b: tuple[str, ...]) -> str:
    for place, (mine, other) in enumerate(zip(a, b, strict=False), start=1):
        if mine != other:
            return f"number {place} is {mine!r} in the first, {other!r} in the second"
    longer, which = (a, "first") if len(a) > len(b) else (b, "second")
    return f"only the {which} has {longer[min(len(a), len(b))]!r}"


def _warn(text: str) -> None:
    warnings.warn(text, stacklevel=4)


def _written_like(skeleton: Skeleton, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """`a` (F, C) with each rotation written, by whole turns and the equivalent triple, as near to `b` as it can be."""
    written = np.array(a, order="F")
    for turning, order in skeleton.eulers:
        if not turning:
            continue
        plain = _nearest_turn(a[:, turning], b[:, turning])
        written[:, turning] = plain
        if sorted(order) == sorted(AXES):
            other = _nearest_turn(a[:, turning] * (1, -1, 1) + 180.0, b[:, turning])
            nearer = _worst(other, b[:, turning]) < _worst(plain, b[:, turning]) - 1e-9
            written[:, turning] = np.where(nearer[:, None], other, plain)
    return written


def _nearest_turn(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    turns = np.round((b - a) / 360.0)
    return a + 360.0 * turns if turns.any() else a


def _worst(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.abs(a - b).max(axis=1)


def _world_error(a: Motion, b: Motion) -> np.ndarray:
    """(F, J) distances in file units."""
    if not a.frames:
        return np.zeros((0, len(a.skeleton.names)))
    return np.linalg.norm(kinematics.world(b) - kinematics.world(a), axis=2)


def _max_rms(errors: np.ndarray) -> tuple[float, float]:
    """Largest and root mean square; nothing compared is nothing wrong."""
    return (float(errors.max()), float(np.sqrt(np.mean(errors**2)))) if errors.size else (0.0, 0.0)


def _guessed_unit(motion: Motion) -> float | None:
    try:
        return unit_of(motion).metres
    except OptionError:  # a body without height
        return None


def _channel_rows(skeleton: Skeleton, keys: np.ndarray, off: np.ndarray) -> tuple[ChannelError, ...]:
    units = np.where(skeleton.rotation_channels, "degrees", "units")
    return tuple(
        ChannelError(name, str(units[c]), int(keys[c]), *_max_rms(off[:, c]))
        for c, name in enumerate(skeleton.channel_names)
    )


def _with_making(report: Report, b: Clip) -> Report:
    """How `b` was made is taken over from the report that it carries, or else from its history."""
    told = getattr(b, "report", None)
    if told is not None and told.noise is not None:
        report = replace(report, noise=told.noise)
    if not isinstance(b, KeyedMotion | SplineMotion) or told is None:
        step = b.history[-1] if b.history and b.history[-1].get("verb") in ("reduce", "fit") else {}
        texts = step.get("tolerance")
        made = {name: step[name] for name in ("method", "align", "quality") if isinstance(step.get(name), str)}
        if isinstance(texts, list | tuple) and all(isinstance(text, str) for text in texts):
            made["tolerance"] = ", ".join(texts)
        return replace(report, **made)
    known = ("lower_bound", "seconds", "tolerance", "method", "align", "quality")
    channels, joints = report.channels, report.joints
    if [row.name for row in told.channels] == [row.name for row in channels]:
        pairs = zip(channels, told.channels, strict=True)
        channels = tuple(replace(row, lower_bound=old.lower_bound, tolerance=old.tolerance) for row, old in pairs)
    if [row.name for row in told.joints] == [row.name for row in joints]:
        joints = tuple(replace(row, tolerance=old.tolerance) for row, old in zip(joints, told.joints, strict=True))
    return replace(report, channels=channels, joints=joints, **{name: getattr(told, name) for name in known})


def _summary_lines(report: Report) -> list[str]:
    bound = (
        f"; at least {report.lower_bound:,} are needed, this is {report.over_bound:.2f}x" if report.over_bound else ""
    )
    if report.noise is not None and report.keys == report.samples:
        lines = ["changed    from the captured clip to the clean one:"]
    else:
        count = f"{report.keys:,} for {report.samples:,} samples, 1 for {report.ratio:.1f}{bound}"
        lines = [f"keys       {count}"]
        if report.knots is not None:
            lines = [f"splines    coefficients {count}", f"knots      {report.knots:,}, shared by all channels"]
    settings = [(name, getattr(report, name)) for name in ("tolerance", "method", "align", "quality")]
    made = [f"{name} {value}" for name, value in settings if value]
    made += [f"{report.seconds:.2f} s"] if report.seconds is not None else []
    lines += [f"made       {', '.join(made)}"] if made else []
    if report.max_error_degrees is not None:
        lines += [f"rotations  max {report.max_error_degrees:.4g} degrees, RMS {report.rms_error_degrees:.3g} degrees"]
    if report.max_error_length is not None and report.rms_error_length is not None:
        lines += [f"positions  {_lengths(report, report.max_error_length, report.rms_error_length)}"]
    lines += [f"in space   {_lengths(report, report.max_error_world, report.rms_error_world)}"]
    return lines if report.feet is None else [*lines, f"feet       {report.feet}"]


def _lengths(report: Report, most: float, rms: float) -> str:
    return f"max {_length(report, most)}, RMS {_length(report, rms)}"


def _length(report: Report, length: float) -> str:
    """ "0.0354 units (2 mm)": a length in file units, and in millimetres where the unit is known or can be guessed."""
    if report.unit is not None:
        return f"{length:.3g} units ({length * report.unit * 1000:.3g} mm)"
    about = "" if report.unit_guess is None else f" (about {length * report.unit_guess * 1000:.3g} mm)"
    return f"{length:.3g} units{about}"


def _worst_lines(report: Report, count: int = 5) -> list[str]:
    """The few channels and joints that are furthest off."""
    channels = sorted((row for row in report.channels if row.max > 0), key=lambda row: (row.unit, -row.max))
    joints = sorted((row for row in report.joints if row.max > 0), key=lambda row: -row.max)
    keyed = report.keys != report.samples
    angles = [
        [r.name, *([f"{r.keys:,}"] if keyed else []), f"{r.max:.4g} {r.unit}", f"{r.rms:.3g} {r.unit}"]
        for r in channels[:count]
    ]
    places = [[r.name, _length(report, r.max), _length(report, r.rms)] for r in joints[:count]]
    lines = table(["furthest channels", *([report.unknowns] if keyed else []), "max", "RMS"], angles)
    return lines + table(["furthest joints", "max", "RMS"], places)
