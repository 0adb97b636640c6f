"""Cyclic motions as Fourier series, and what lies between them or beyond.

Source: Unuma, Anjyo and Takeuchi 1995, Fourier principles for emotion-based human figure animation, sections 3 and 4.
Where they expand joint angles, here a joint's rotation vectors from its mean rotation are expanded, and the root as it
stands in a frame that goes along evenly, one planar screw a cycle.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass, replace

import numpy as np

from .. import planar, rotation
from ..errors import OptionError
from ..kinematics import world
from ..motion import Motion
from ..progress import advance
from . import _cycles
from ._bodies import fitted, main_root
from ._in_step import LONGEST
from ._means import heaviest_of
from ._poses import Poses, motion_of, moved, poses_of
from ._turns import mean
from .loop import loop

ROUGH = 0.3  # of the largest distance within the cycle: ends that are further apart are worth a warning
PHASES = 256  # of a cycle, of which the one is found where two cycles go together best
SILENT = 0.01  # of the largest amplitude: less has no phase
TURNS = np.radians(175.0)  # from the mean rotation: further there are no rotation vectors


@dataclass(frozen=True, eq=False)
class Cycle:
    """One cycle of a motion on the body of the first, as a Fourier series in a frame that goes along.

    start, period: seconds in its clip. frames: of the cycle. residual: how far its ends were apart, as a part of the
    largest distance within. error: root mean square distance of the joints from the series. closed: its motion.
    step: (3,) what a cycle travels, in the common frame. phase: of the cycle, where it goes together with the others'
    start. home: (3,) from the common frame to where it is at that phase.
    middle: (J, 4) mean rotations. shifts, turns: (H + 1, J, 3) complex coefficients of exp(2 pi i n u), u in cycles.
    """

    start: float
    period: float
    residual: float
    error: float
    closed: Motion
    step: np.ndarray
    phase: float
    home: np.ndarray
    middle: np.ndarray
    shifts: np.ndarray
    turns: np.ndarray


def cycles_of(motions: list[Motion], harmonics: int) -> list[Cycle]:
    """The clearest cycle of every motion, on the body of the first, all in phase and in one frame."""
    first = motions[0]
    found, had = [], []
    for place, motion in enumerate(motions):
        advance("finding cycles", place, len(motions))
        if motion.frames < 2:
            raise OptionError(f"clip {place + 1} is not cyclic: it has fewer than two frames")
        body, has = fitted(first, motion)
        found.append(_closed(body, place))
        had.append(np.bincount(first.skeleton.channel_joints[has], minlength=len(first.skeleton.names)) > 0)
    advance("finding cycles", len(motions), len(motions))
    middle = sorted(range(len(found)), key=lambda i: (found[i][1], motions[i].values.tobytes()))[len(found) // 2]
    series = _series(found, middle, harmonics)
    carries = np.isin(np.arange(len(first.skeleton.names)), first.skeleton.channel_joints)
    return [
        series[0],
        *(_without(one, series[0], carries & ~has) for one, has in zip(series[1:], had[1:], strict=True)),
    ]


def between_cycles(
    cycles: list[Cycle], shares: np.ndarray, count: int, frame_time: float
) -> tuple[Motion, float, np.ndarray]:
    """So many cycles between these, shares (N, J): the motion, its period (seconds), and seconds (N, F) of every clip.

    Coefficients and travel are weighted means, of the first harmonic amplitude and phase, the short way from that of
    the largest amplitude; the period is the weighted geometric mean, rounded to frames. It begins where the heaviest is
    at its phase.
    """
    first = cycles[0].closed
    root = main_root(first)
    period = float(np.exp(shares[:, root] @ np.log([cycle.period for cycle in cycles])))
    frames = period / frame_time
    if not frames * count < LONGEST:
        raise OptionError(f"the result would have {frames * count:.3g} frames, more than {LONGEST}")
    each = max(2, round(frames))
    u = np.arange(count * each + 1) / each
    heaviest = heaviest_of(shares[:, root])
    away = rotation.log(np.stack([rotation.mul(one.middle, rotation.inv(cycles[heaviest].middle)) for one in cycles]))
    middle = rotation.mul(mean(rotation.exp(away), shares), cycles[heaviest].middle)
    shift, turn = (
        _at(_between([getattr(cycle, part) for cycle in cycles], shares), u).real for part in ("shifts", "turns")
    )
    travel = planar.exp(shares[:, root] @ np.stack([planar.log(cycle.step) for cycle in cycles]))
    poses = Poses(shift, rotation.mul(middle, rotation.exp(turn)))
    along = planar.compose(cycles[heaviest].home, planar.power(travel, u))
    values = first.values[np.rint((u % 1.0) * (first.frames - 1)).astype(np.int64)]
    base = replace(first, values=values, frame_time=frame_time)
    made = motion_of(moved(poses, first.skeleton, along), base)
    times = np.stack([cycle.start + ((u + cycle.phase) % 1.0) * cycle.period for cycle in cycles])
    return made, each * frame_time, times


# -- in call order ---------------------------------------------------------------------------------


def _closed(motion: Motion, place: int) -> tuple[float, float, float, Motion]:
    """Start, period and residual of the clearest cycle, and that cycle closed; the whole clip, where that is one."""
    places = world(motion)
    refused = ""
    whole = {"start": 0.0, "end": motion.duration, "close": "linear"}
    for options in ({}, {"close": "linear"}, whole):
        try:
            with warnings.catch_warnings(action="ignore"):  # of seams that show: a series has none
                made = loop(motion, **options)
        except OptionError as error:
            refused = refused or str(error).split(";")[0]  # what follows are options of loop
            continue
        assert isinstance(made, Motion)  # of samples
        told = made.history[-1]["measured"]
        start, end = (round(told[name] / motion.frame_time) for name in ("start", "end"))
        apart = _cycles.apart(places, start, end, motion.frame_time)
        largest = float(planar.frame_distances(places[start : start + 1], places[start:end]).max())
        residual = apart / largest if largest > 0 else 0.0
        if residual <= _cycles.ALIKE:
            if residual > ROUGH:
                found = f"the ends of its cycle are {residual:.2g} of the largest distance within it apart"
                warnings.warn(f"clip {place + 1} is hardly cyclic: {found}", stacklevel=6)
            return told["start"], told["end"] - told["start"], residual, made
        refused = refused or f"its ends are {residual:.2g} of the largest distance within it apart"
    raise OptionError(f"clip {place + 1} is not cyclic: {refused}")


def _series(found: list[tuple[float, float, float, Motion]], middle: int, harmonics: int) -> list[Cycle]:
    """The series of all, in phase with one of them and in its frame."""
    evenly = [_along(made) for _, _, _, made in found]
    clouds = [_cloud(poses, made) for (poses, _), (_, _, _, made) in zip(evenly, found, strict=True)]
    made_of = []
    for (start, period, residual, made), (poses, step), cloud in zip(found, evenly, clouds, strict=True):
        phase, common = _met(clouds[middle], cloud)
        home = planar.compose(planar.power(step, phase), planar.inverse(common))
        step = planar.compose(common, planar.compose(step, planar.inverse(common)))
        poses = moved(poses, made.skeleton, common)
        rest, vectors = _vectors(poses.turns, made)
        shifts, turns = (_coefficients(part, harmonics, phase) for part in (poses.shifts, vectors))
        u = np.arange(len(poses)) / len(poses) - phase
        series = Poses(_at(shifts, u).real, rotation.mul(rest, rotation.exp(_at(turns, u).real)))
        apart = world(motion_of(series, made[:-1])) - world(motion_of(poses, made[:-1]))
        error = float(np.sqrt((apart**2).sum(axis=-1).mean()))
        made_of.append(Cycle(start, period, residual, error, made, step, phase, home, rest, shifts, turns))
    return made_of


def _along(made: Motion) -> tuple[Poses, np.ndarray]:
    """The poses of a closed cycle in a frame that goes along with it evenly, and what a cycle travels (3,)."""
    places = world(made)
    step = planar.align(places[-1], places[0])
    u = np.arange(made.frames - 1) / (made.frames - 1)
    return moved(poses_of(made[:-1]), made.skeleton, planar.inverse(planar.power(step, u))), step


def _cloud(poses: Poses, made: Motion) -> np.ndarray:
    """(PHASES, J, 3) the joints in that frame, at even phases."""
    base = made[:-1]
    places = world(motion_of(poses, base))
    return _at(_coefficients(places, PHASES // 8, 0.0), np.arange(PHASES) / PHASES).real


def _met(to: np.ndarray, of: np.ndarray) -> tuple[float, np.ndarray]:
    """The phase at which the one cycle (M, J, 3) goes together with the start of the other, and the planar transform
    (3,) that brings it there.

    All phases at once: the closed form of planar.align, its sums being circular correlations.
    """
    places = [cloud[..., 2] + 1j * cloud[..., 0] for cloud in (to, of)]  # turned by a: times exp(i a)
    middles = [place.mean() for place in places]
    spectra = [np.fft.fft(place - at, axis=0) for place, at in zip(places, middles, strict=True)]
    ground = np.fft.ifft((spectra[0].conj() * spectra[1]).sum(axis=1))
    heights = [np.fft.fft(cloud[..., 1] - to[..., 1].mean(), axis=0) for cloud in (to, of)]
    alike = np.abs(ground) + np.fft.ifft((heights[0].conj() * heights[1]).sum(axis=1)).real
    best = int(np.argmax(alike))
    before, here, after = alike[best - 1], alike[best], alike[(best + 1) % len(alike)]
    bend = before - 2.0 * here + after
    phase = best + (0.5 * (before - after) / bend if bend < -1e-9 * abs(here) else 0.0)
    angle = -float(np.angle(ground[best]))
    there = np.exp(1j * angle) * middles[1]
    return phase / len(alike) % 1.0, np.array([angle, -there.imag, -there.real])


def _vectors(turns: np.ndarray, made: Motion) -> tuple[np.ndarray, np.ndarray]:
    """Mean rotations (J, 4), and rotation vectors (F, J, 3) from there."""
    spread = np.einsum("fja,fjb->jab", turns, turns)  # Markley and others 2007: the mean is the first eigenvector
    middle = np.linalg.eigh(spread)[1][..., -1]
    vectors = rotation.log(rotation.mul(rotation.inv(middle), turns))
    far = np.linalg.norm(vectors, axis=-1).max(axis=0) > TURNS
    if far.any():
        name = made.skeleton.names[int(np.argmax(far))]
        raise OptionError(f"joint {name!r} turns round within a cycle: a Fourier series cannot say that")
    return middle, vectors


def _coefficients(values: np.ndarray, harmonics: int, phase: float) -> np.ndarray:
    """(H + 1, ...) complex, of values (F, ...) of a cycle, which then begins at this phase."""
    spectrum = np.fft.rfft(values, axis=0)[: harmonics + 1] / len(values)
    if 2 * (len(spectrum) - 1) == len(values):
        spectrum = spectrum[:-1]  # the fastest that even samples can tell has no phase
    spectrum[1:] *= 2.0
    n = np.arange(len(spectrum)).reshape(-1, *[1] * (values.ndim - 1))
    spectrum = spectrum * np.exp(2j * np.pi * n * phase)
    return np.concatenate([spectrum, np.zeros((harmonics + 1 - len(spectrum), *values.shape[1:]))])


def _at(coefficients: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Values (F, ...) at phases (F,), complex: their real part is meant."""
    waves = np.exp(2j * np.pi * u[:, None] * np.arange(len(coefficients)))
    return np.tensordot(waves, coefficients, axes=1)


def _between(coefficients: list[np.ndarray], shares: np.ndarray) -> np.ndarray:
    """(H + 1, J, 3) of coefficients of N cycles and shares (N, J).

    Of the first harmonic amplitude and phase are interpolated, so that limbs out of phase do not cancel. The paper does
    so with all; but then each runs ahead of its own, and planted feet slide. The others are added as they are.
    """
    every = np.stack(coefficients)  # (N, H + 1, J, 3)
    made = np.einsum("nj,nhjk->hjk", shares, every)
    first = every[:, 1]
    sizes = np.abs(first)
    largest = np.take_along_axis(first, sizes.argmax(axis=0)[None], axis=0)[0]
    heard = sizes > SILENT * np.abs(largest)
    ahead = np.where(heard, np.angle(np.where(heard, first * largest.conj(), 1.0)), 0.0)
    size, angle = (np.einsum("nj,njk->jk", shares, part) for part in (sizes, ahead))
    made[1] = size * np.exp(1j * (np.angle(largest) + angle))
    return made


def _without(cycle: Cycle, first: Cycle, lacking: np.ndarray) -> Cycle:
    """Joints (J,) that a body lacks move as in the first."""
    if not lacking.any():
        return cycle
    columns = lacking[:, None]
    return replace(
        cycle,
        middle=np.where(columns, first.middle, cycle.middle),
        shifts=np.where(columns, first.shifts, cycle.shifts),
        turns=np.where(columns, first.turns, cycle.turns),
    )
