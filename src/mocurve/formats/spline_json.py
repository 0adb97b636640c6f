"""B-splines as JSON, version 1: skeleton, knots, coefficients, how they were made. The schema is in docs/formats.md."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..errors import FileError, MocurveError, OptionError
from ..keyed import KeyedMotion
from ..motion import Clip
from ..skeleton import Skeleton
from ..spline import SplineMotion, of_keys
from ._clip_json import Reader, document, dumped, loaded, rows
from ._files import Path, opened, replacing

FORMAT, VERSION = "mocurve splines", 1


def read(path: Path) -> SplineMotion:
    """The splines in a .spline.json file, numbers exactly as written. FileError names the place in it that is wrong."""
    with opened(path) as file:
        return _Reader(path).splines(loaded(file.read(), path, ".spline.json"))


def write(path: Path, clip: Clip, lossless: bool = True) -> None:
    """Write splines, or keys as the same curves, always with all digits; OptionError for samples."""
    if isinstance(clip, KeyedMotion):
        clip = of_keys(clip)
    if not isinstance(clip, SplineMotion):
        raise OptionError(f"a .spline.json file holds splines, a {type(clip).__name__} has none: fit it first")
    names = clip.skeleton.channel_names
    curves = [{"channel": name, "values": clip.values[:, c].tolist()} for c, name in enumerate(names)]
    parts = {"degree": dumped(clip.degree), "knots": dumped(clip.knots.tolist()), "curves": rows(curves)}
    encoded = document(FORMAT, VERSION, clip, parts).encode()
    with replacing(path) as file:
        file.write(encoded)


class _Reader(Reader):
    def splines(self, data: Any) -> SplineMotion:
        frame_time, frames = self.head(data, FORMAT, VERSION)
        body = self.skeleton(data)
        degree = self.whole(data.get("degree"), "degree", 1, 5)
        knots = self.numbers(data.get("knots"), "knots")
        values = self.values(data, body, len(knots) - degree - 1)
        history = self.rows(data.get("history", []), "history")
        report = self.report(data.get("report"))
        try:
            return SplineMotion(body, knots, values, degree, frame_time, frames, tuple(history), report)
        except MocurveError as error:
            raise FileError(f"knots: {error}", self.path) from error

    def values(self, data: dict[str, Any], body: Skeleton, count: int) -> np.ndarray:
        found = self.rows(data.get("curves"), "curves")
        if len(found) != body.channel_count:
            self.fail("curves", f"one for each of the {body.channel_count} channels")
        names, values = body.channel_names, np.empty((max(count, 0), len(found)), order="F")
        for i, row in enumerate(found):
            if row.get("channel") != names[i]:
                self.fail(f"curves[{i}].channel", repr(names[i]))
            column = self.numbers(row.get("values"), f"curves[{i}].values")
            if len(column) != count:
                self.fail(f"curves[{i}].values", f"{max(count, 0)} numbers, for the knots and the degree,")
            values[:, i] = column
        return values
