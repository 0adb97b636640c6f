"""Whose path it is, where a file does not say: control points that were fitted to a clip, edited and written bare."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from . import planar
from .errors import MocurveError
from .motion import Clip
from .path import Fit, Path
from .path_fit import gone, lead, of_track, tracked

DEGREES = (3, 1, 2, 4, 5, 6, 7, 8, 9)  # that are tried, the usual one first
SAME = 1e-4  # of the path's size: points as near are the same, written with few digits


def recognised(path: Path, clip: Clip) -> Path:
    """The path with the fit (and the degree) that it is an edit of, where its control points tell; else as it is.

    It is an edit of a fit to the clip, with as many control points, if half of these stayed where they were, or if all
    were moved and turned as one.
    """
    if path.fit is not None or path.kind != "spline":
        return path
    count, width = path.points.shape
    degrees = DEGREES if path.degree == min(DEGREES[0], count - 1) else (path.degree,)
    motion = clip.sample()
    body = motion[lead(motion) :]
    for degree in degrees:
        if degree < count:
            fit = Fit(count, degree, height=width == 3)
            try:
                own = of_track(tracked(body, fit), gone(body), fit, body.frame_time)
            except MocurveError:  # a path with more points than the clip settles was drawn
                return path
            if own.points.shape == path.points.shape and _is_edit(path.points, own.points):
                return replace(path, degree=degree, knots=np.zeros(0), fit=own.fit)
    return path


# -- in call order ---------------------------------------------------------------------------------


def _is_edit(points: np.ndarray, own: np.ndarray) -> bool:
    near = SAME * float(np.ptp(own, axis=0).max())
    if (np.abs(points - own).max(axis=1) <= near).sum() >= max(2.0, 0.5 * len(own)):
        return True
    flat, wanted = (part if part.shape[1] == 3 else np.insert(part, 1, 0.0, axis=1) for part in (own, points))
    off = planar.move(planar.align(wanted, flat), flat) - wanted
    off[:, 1] -= off[:, 1].mean()
    return bool(np.abs(off).max() <= near)
