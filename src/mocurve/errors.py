"""Everything that data or options can cause. Each error is also the builtin that a caller expects."""

from __future__ import annotations

from collections.abc import Iterable
from os import PathLike, fspath


class MocurveError(Exception):
    """Root of all errors that mocurve raises on purpose; the command line prints its text and exits with 2."""


class FileError(MocurveError, ValueError):
    """A file cannot be read or written. `path` and `line` (from 1) say where: "walk.bvh:312: 96 numbers expected, 95
    found"."""

    def __init__(self, message: str, path: str | PathLike[str] | None = None, line: int | None = None):
        self.message, self.line = message, line
        self.path = None if path is None else fspath(path)
        place = ":".join(str(part) for part in (self.path, line) if part is not None)
        super().__init__(f"{place}: {message}" if place else message)


class OptionError(MocurveError, ValueError):
    """An option has a value that it cannot take; the text names the value and what is allowed."""


class Mismatch(MocurveError, ValueError):
    """Two things that must agree do not; the text names the first difference."""


class UnknownName(MocurveError, KeyError):
    """A name that is not there: "no joint 'LeftFot'. Did you mean 'LeftFoot'?"."""

    def __init__(self, kind: str, name: str, known: Iterable[str]):
        from difflib import get_close_matches  # here, so that a start without errors does not pay for it

        known, name = list(dict.fromkeys(known)), str(name)  # whatever was given instead of a name is told
        near = get_close_matches(name, known, n=1, cutoff=0.5) or [k for k in known if k.lower() == name.lower()]
        if near:
            hint = f"Did you mean {near[0]!r}?"
        else:
            hint = f"There is: {', '.join(known[:12])}{' …' if len(known) > 12 else ''}." if known else "There is none."
        self.text = f"no {kind} {name!r}. {hint}"
        super().__init__(self.text)

    def __str__(self) -> str:  # KeyError would print the repr of the text
        return self.text
