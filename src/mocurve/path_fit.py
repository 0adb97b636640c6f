"""Paths fitted to clips: the track that a body leaves, and the curve of least squares through it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from . import bspline, kinematics
from .bspline_fit import least_squares
from .contacts import FOOT
from .errors import Mismatch, OptionError
from .info import first_frame_is_t_pose
from .motion import Clip, Motion
from .path import Fit, Path, chebyshev_places
from .whittaker import smoothed

SMOOTH = 0.25  # seconds: of the track `smooth`; waves of 1.6 s are halved, those of a stride nearly gone
LEAD = 240  # frames that are looked at to see whether the first one is a T-pose


def fitted(clip: Clip, fit: Fit) -> Path:
    """The path of a clip, as `Path.of` tells."""
    motion = clip.sample()
    return of_track(tracked(motion[lead(motion) :], fit), fit, motion.frame_time)


def residuals(path: Path, clip: Clip) -> np.ndarray:
    """How far (F,) a clip's root is from the path, the parameter going evenly with time."""
    motion = clip.sample()
    ahead = lead(motion)
    track = tracked(motion[ahead:], Fit())
    columns = slice(None) if path.points.shape[1] == 3 else [0, 2]
    away = np.linalg.norm(track[:, columns] - path.place(even(len(track))), axis=1)
    return np.concatenate([away[:ahead], away])


def lead(motion: Motion) -> int:
    """How many frames (0 or 1) in front are a T-pose and no motion."""
    return int(first_frame_is_t_pose(motion[:LEAD]))


def even(count: int) -> np.ndarray:
    """(F,) parameters of frames, even in time."""
    return np.linspace(0.0, 1.0, count) if count > 1 else np.zeros(count)


def tracked(motion: Motion, fit: Fit) -> np.ndarray:
    """Places (F, 3) x, y, z of what a path is fitted to."""
    if not motion.frames:
        raise Mismatch("a clip without frames has no path")
    root = roots(motion)
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


def of_track(track: np.ndarray, fit: Fit, frame_time: float) -> Path:
    """The path fitted to places (F, 3) that are evenly spaced in time."""
    count, fit = len(track), _settled(fit, len(track), (len(track) - 1) * frame_time)
    samples = track if fit.height else track[:, [0, 2]]
    assert fit.points is not None
    if count == 1:
        return Path(np.repeat(samples, 2, axis=0), 1, fit=fit)
    if fit.kind == "polynomial":
        basis = np.polynomial.chebyshev.chebvander(2.0 * even(count) - 1.0, fit.degree)
        coefficients = np.linalg.lstsq(basis, samples - samples[0], rcond=None)[0]
        at = np.polynomial.chebyshev.chebval(2.0 * chebyshev_places(fit.points) - 1.0, coefficients).T
        return Path(samples[0] + at, fit.degree, "polynomial", fit=fit)
    knots = bspline.clamped(np.linspace(0.0, 1.0, fit.points - fit.degree + 1), fit.degree)
    try:
        moved = least_squares(knots, fit.degree, even(count), samples - samples[0])
    except Mismatch as error:
        raise OptionError(f"{count} frames do not settle {fit.points} control points: take fewer") from error
    return Path(samples[0] + moved, fit.degree, fit=fit)


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


def _settled(fit: Fit, frames: int, duration: float) -> Fit:
    """With a number of points and a degree that so many frames allow."""
    if frames == 1:
        return replace(fit, points=2, degree=1, kind="spline")
    if fit.kind == "polynomial":
        if fit.degree > frames - 1:
            raise OptionError(
                f"the degree of a polynomial through {frames} frames is {frames - 1} at most, not {fit.degree}"
            )
        if fit.points not in (None, fit.degree + 1):
            raise OptionError(f"a polynomial of degree {fit.degree} has {fit.degree + 1} points, not {fit.points}")
        return replace(fit, points=fit.degree + 1)
    points = fit.points
    if points is None:  # one a second, and one more for its end
        points = min(max(fit.degree + 1, round(duration) + 1), frames)
    if points > frames:
        raise OptionError(f"a path of {points} control points takes as many frames, and the clip has {frames}")
    return replace(fit, points=points, degree=min(fit.degree, points - 1))
