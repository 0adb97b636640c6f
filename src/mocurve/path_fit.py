"""Paths fitted to clips: the track that a body leaves, and the curve of least squares through it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from . import bspline, kinematics
from .bspline_fit import least_squares
from .errors import Mismatch, OptionError
from .feet.planted import FOOT
from .info import first_frame_is_t_pose
from .motion import Clip, Motion
from .path import LARGEST, Fit, Path, chebyshev_places, too_few
from .whittaker import smoothed

SMOOTH = 0.25  # seconds: of the track `smooth`; waves of 1.6 s are halved, those of a stride nearly gone
STANDS = 1e-9  # of the largest coordinate: a shorter way is none
STEADY = 0.1  # seconds: of the way that says where along its path a body is
WILD = 10.0  # times as far as the track goes: control points further away are no path of it
LEAD = 240  # frames that are looked at to see whether the first one is a T-pose


def fitted(clip: Clip, fit: Fit) -> Path:
    """The path of a clip, as `Path.of` tells."""
    motion = clip.sample()
    body = motion[lead(motion) :]
    return of_track(tracked(body, fit), gone(body), fit, body.frame_time)


def residuals(path: Path, clip: Clip) -> np.ndarray:
    """How far (F,) a clip's root is from the path."""
    motion = clip.sample()
    ahead = lead(motion)
    body = motion[ahead:]
    columns = slice(None) if path.points.shape[1] == 3 else [0, 2]
    away = np.linalg.norm(tracked(body, Fit())[:, columns] - path.place(gone(body)), axis=1)
    return np.concatenate([away[:ahead], away])


def lead(motion: Motion) -> int:
    """How many frames (0 or 1) in front are a T-pose and no motion."""
    return int(first_frame_is_t_pose(motion[:LEAD]))


def gone(motion: Motion) -> np.ndarray:
    """(F,) parameters of frames, from 0 to 1, which grow with the square root of the root's speed over the ground.

    So a body that stands stays in one place of its path, where a curve over time would ring, and bends that are taken
    slowly get more of the curve (Lee 1989, Choosing nodes in parametric curve interpolation: centripetal). Whoever does
    not move at all has parameters even in time.
    """
    root = tracked(motion, Fit())[:, [0, 2]]
    if len(root) < 2:
        return np.zeros(len(root))
    way = smoothed(root - root[0], np.ones(len(root)), STEADY / motion.frame_time)
    steps = np.linalg.norm(np.diff(way, axis=0), axis=1)
    if not steps.sum() > STANDS * (1.0 + np.abs(root).max()):
        return np.linspace(0.0, 1.0, len(root))
    grown = np.concatenate([[0.0], np.cumsum(np.sqrt(steps))])
    return grown / grown[-1]


def tracked(motion: Motion, fit: Fit) -> np.ndarray:
    """Places (F, 3) x, y, z of what a path is fitted to."""
    if not motion.frames:
        raise Mismatch("a clip without frames has no path")
    root = roots(motion)
    far = np.abs(root).max(axis=1) > LARGEST
    if far.any():
        frame = int(np.argmax(far))
        raise Mismatch(
            f"the root is {np.abs(root[frame]).max():.3g} units away at frame {frame}, more than {LARGEST:g}"
        )
    bad = ~np.isfinite(root).all(axis=1)
    if bad.any():
        raise Mismatch(f"the root has no place at frame {int(np.argmax(bad))}: fill the gaps first, with denoise")
    if fit.track == "support":
        middle = _between_feet(motion)
        return np.stack([middle[:, 0], root[:, 1], middle[:, 2]], axis=1)
    if fit.track == "smooth":
        return root[:1] + smoothed(root - root[:1], np.ones(len(root)), SMOOTH / motion.frame_time)
    return root


def roots(motion: Motion) -> np.ndarray:
    """Places (F, 3) of the root; where there are several, the mean of those that carry something, or of all."""
    skeleton = motion.skeleton
    tops = np.flatnonzero(skeleton.parents < 0)
    carrying = [joint for joint in tops.tolist() if joint in skeleton.parents]
    chosen = carrying or tops.tolist()
    if not chosen:
        raise Mismatch("a clip without joints has no path")
    places = np.repeat(skeleton.offsets[None, chosen], motion.frames, axis=0)
    joints, axes = skeleton.channel_joints, skeleton.channel_axes
    for place, joint in enumerate(chosen):
        columns = np.flatnonzero((joints == joint) & ~skeleton.rotation_channels)
        places[:, place, axes[columns]] = motion.values[:, columns]
    return places.mean(axis=1)


def moving(at: np.ndarray, frame_time: float) -> float:
    """Seconds in which a body moves whose frames are at parameters (F,): half of the time, if it stands half of it."""
    speed = np.diff(at)
    return frame_time * float(speed.sum() ** 2 / max((speed**2).sum(), 1e-300))


def of_track(track: np.ndarray, at: np.ndarray, fit: Fit, frame_time: float) -> Path:
    """The path fitted to places (F, 3) at parameters (F,) that do not fall, from 0 to 1."""
    count, fit = len(track), _settled(fit, len(track), moving(at, frame_time))
    samples = track if fit.height else track[:, [0, 2]]
    assert fit.points is not None
    if count == 1:
        return Path(np.repeat(samples, 2, axis=0), 1, fit=fit)
    if fit.kind == "polynomial":
        basis = np.polynomial.chebyshev.chebvander(2.0 * at - 1.0, fit.degree)
        coefficients = np.linalg.lstsq(basis, samples - samples[0], rcond=None)[0]
        moved = np.polynomial.chebyshev.chebval(2.0 * chebyshev_places(fit.points) - 1.0, coefficients).T
        return Path(samples[0] + _tame(moved, samples, fit), fit.degree, "polynomial", fit=fit)
    knots = bspline.clamped(np.linspace(0.0, 1.0, fit.points - fit.degree + 1), fit.degree)
    try:
        moved = least_squares(knots, fit.degree, at, samples - samples[0])
    except Mismatch as error:
        raise OptionError(f"{count} frames do not settle {fit.points} control points: take fewer") from error
    return Path(samples[0] + _tame(moved, samples, fit), fit.degree, fit=fit)


# -- in call order ---------------------------------------------------------------------------------


def _between_feet(motion: Motion) -> np.ndarray:
    names = motion.skeleton.names
    feet = [joint for joint, name in enumerate(names) if FOOT.search(name)]
    if not feet:
        raise OptionError("no joint is called foot, toe, ankle, heel or ball: track support has nothing to follow")
    sides = [[j for j in feet if names[j].lower().lstrip("_:").startswith(side)] for side in ("l", "r")]
    places = kinematics.world(motion)
    groups = sides if all(sides) else [feet]
    return np.mean([places[:, group].mean(axis=1) for group in groups], axis=0)


def _tame(moved: np.ndarray, samples: np.ndarray, fit: Fit) -> np.ndarray:
    """Control points (N, D) from the first sample on, as they are; OptionError where they are far from the samples
    (F, D), as where frames hardly tell some of them."""
    if np.abs(moved).max() > WILD * np.abs(samples - samples[0]).max() + STANDS * (1.0 + np.abs(samples).max()):
        raise OptionError(
            f"{len(samples)} frames do not settle {fit.points} control points of degree {fit.degree}: between frames "
            "the path would swing far out; take fewer"
        )
    return moved


def _settled(fit: Fit, frames: int, seconds: float) -> Fit:
    """With a number of points and a degree that so many frames allow; seconds in which the body moves."""
    if frames == 1:
        return replace(fit, points=2, degree=1, kind="spline")
    if fit.kind == "polynomial":
        if fit.degree > frames - 1:
            raise OptionError(
                f"the degree of a polynomial through {frames} frames is {frames - 1} at most, not {fit.degree}"
            )
        if fit.points not in (None, fit.degree + 1):
            raise OptionError(too_few(fit.points, fit.degree, fit.kind))
        return replace(fit, points=fit.degree + 1)
    points = fit.points
    if points is not None and fit.degree > points - 1:
        raise OptionError(too_few(points, fit.degree, fit.kind))
    if points is None:  # one a second, and one more for its end
        points = min(max(fit.degree + 1, round(seconds) + 1), frames)
    if points > frames:
        raise OptionError(f"a path of {points} control points takes as many frames, and the clip has {frames}")
    return replace(fit, points=points, degree=min(fit.degree, points - 1))
