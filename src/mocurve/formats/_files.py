"""Opening files for reading, and replacing them whole or not at all."""

from __future__ import annotations

import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from os import PathLike
from typing import BinaryIO

from ..errors import FileError

Path = str | PathLike[str]


@contextmanager
def opened(path: Path) -> Iterator[BinaryIO]:
    """The file's bytes; FileError where it is missing, not readable, or no regular file (a pipe would never end)."""
    try:
        if not stat.S_ISREG(os.stat(path).st_mode):
            raise FileError("is a directory" if os.path.isdir(path) else "is not a regular file", path)
        file = open(path, "rb")  # noqa: SIM115  # closed below: errors of the body are not errors of opening
    except (OSError, ValueError) as error:
        raise error if isinstance(error, FileError) else FileError(_reason(error), path) from error
    with file:
        yield file


@contextmanager
def replacing(path: Path) -> Iterator[BinaryIO]:
    """A new file that takes the place of `path` when the block ends well; a failure leaves the old file as it was."""
    target = os.path.realpath(path)
    try:
        if os.path.isdir(target):
            raise FileError("is a directory", path)
        name = os.path.join(os.path.dirname(target), f".mocurve-{os.urandom(8).hex()}")
        file = open(name, "xb")  # noqa: SIM115  # closed below: errors of the body are not errors of opening
    except (OSError, ValueError) as error:
        raise error if isinstance(error, FileError) else FileError(f"cannot write: {_reason(error)}", path) from error
    try:
        with file:
            yield file
        os.replace(name, target)
    except BaseException as error:
        with suppress(OSError):
            os.remove(name)
        if isinstance(error, OSError):
            raise FileError(f"cannot write: {_reason(error)}", path) from error
        raise


def encoded(text: str, path: Path) -> bytes:
    """The text as UTF-8; FileError where a name holds half a character."""
    try:
        return text.encode()
    except UnicodeEncodeError as error:
        raise FileError(
            f"cannot write: a name holds {error.object[error.start]!r}, which UTF-8 has not", path
        ) from error


def _reason(error: Exception) -> str:
    return (getattr(error, "strerror", None) or str(error)).lower()
