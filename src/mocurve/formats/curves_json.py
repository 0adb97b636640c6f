"""Keys as JSON, version 1: skeleton, curves, how they were made. The schema is in docs/formats.md."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from ..errors import FileError, MocurveError, OptionError
from ..keyed import HermiteCurve, KeyedMotion
from ..motion import Clip
from ..skeleton import Skeleton
from ._clip_json import Reader, document, loaded, rows
from ._files import Path, opened, replacing

FORMAT, VERSION = "mocurve curves", 1


def read(path: Path) -> KeyedMotion:
    """The keys in a .curves.json file, numbers exactly as written. FileError names the place in it that is wrong."""
    with opened(path) as file:
        return parsed(file.read(), path)


def parsed(raw: bytes, path: Path) -> KeyedMotion:
    """The keys in the bytes of such a file; `path` is only named in errors."""
    return _Reader(path).keyed(loaded(raw, path, ".curves.json"))


def write(path: Path, clip: Clip, lossless: bool = True) -> None:
    """Write the keys of a KeyedMotion, always with all digits; OptionError for a clip that has no keys."""
    if not isinstance(clip, KeyedMotion):
        raise OptionError(f"a .curves.json file holds keys, a {type(clip).__name__} has none: reduce it first")
    encoded = text(clip).encode()
    with replacing(path) as file:
        file.write(encoded)


def text(keys: KeyedMotion) -> str:
    """What such a file holds, in ASCII: a line a joint and a line a curve, so that versions can be compared."""
    curves = [_curve(name, curve) for name, curve in zip(keys.skeleton.channel_names, keys.curves, strict=True)]
    return document(FORMAT, VERSION, keys, {"curves": rows(curves)})


def _curve(name: str, curve: HermiteCurve) -> dict[str, Any]:
    row = {
        "channel": name,
        "times": curve.times.tolist(),
        "values": curve.values.tolist(),
        "slopes": curve.slopes.tolist(),
    }
    return {**row, "in_slopes": curve.in_slopes.tolist()} if curve.broken else row


class _Reader(Reader):
    def keyed(self, data: Any) -> KeyedMotion:
        frame_time, frames = self.head(data, FORMAT, VERSION)
        body = self.skeleton(data)
        curves = self.curves(data, body, frames)
        history = self.rows(data.get("history", []), "history")
        return KeyedMotion(body, curves, frame_time, frames, tuple(history), self.report(data.get("report")))

    def curves(self, data: dict[str, Any], body: Skeleton, frames: int) -> tuple[HermiteCurve, ...]:
        rows = self.rows(data.get("curves"), "curves")
        if len(rows) != body.channel_count:
            self.fail("curves", f"one for each of the {body.channel_count} channels")
        return tuple(self.curve(row, f"curves[{i}]", body.channel_names[i], frames) for i, row in enumerate(rows))

    def curve(self, row: dict[str, Any], place: str, name: str, frames: int) -> HermiteCurve:
        if row.get("channel") != name:
            self.fail(f"{place}.channel", repr(name))
        parts = [self.numbers(row.get(key), f"{place}.{key}") for key in ("times", "values", "slopes")]
        arriving = row.get("in_slopes")
        if frames and not len(parts[0]):
            self.fail(f"{place}.times", "at least one key")
        try:
            curve = HermiteCurve(*parts)
            return curve if arriving is None else replace(curve, in_slopes=self.numbers(arriving, f"{place}.in_slopes"))
        except MocurveError as error:
            raise FileError(f"{place}: {error}", self.path) from error
