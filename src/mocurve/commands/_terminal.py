"""What a person at a terminal sees while something takes long. Nothing is shown where stderr is a file or a pipe."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import copy_context
from time import monotonic
from types import TracebackType
from typing import TYPE_CHECKING

from ..progress import advance

if TYPE_CHECKING:
    from rich.progress import Progress, TaskID

PATIENCE = 1.0  # seconds before a bar appears
COMPILING = "compiling kernels (first run only)"


class Bar:
    """Listens to progress; after a second it shows it on stderr, and takes it away at the end."""

    def __init__(self) -> None:
        self.born = monotonic()
        self.progress: Progress | None = None
        self.tasks: dict[str, TaskID] = {}

    def __enter__(self) -> Bar:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self.progress is not None:
            self.progress.stop()

    def __call__(self, label: str, done: int, total: int) -> None:
        """`done` of `total` steps of some work. Work of unknown length (total 0) shows now, other after a second."""
        if self.progress is None:
            if not sys.stderr.isatty() or (total and monotonic() - self.born < PATIENCE):
                return
            self.progress = _progress()
        if label not in self.tasks:
            self.tasks[label] = self.progress.add_task(label)
        going_on = done < (total or 1)
        self.progress.update(self.tasks[label], completed=min(done, total), total=total or None, visible=going_on)


def _progress() -> Progress:
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
    shown = Progress(*columns, console=Console(stderr=True), transient=True)
    shown.start()
    return shown


@contextmanager
def told_when_compiling() -> Iterator[None]:
    """Say so while Numba compiles a kernel: the first run on a machine waits for that, the next ones do not."""
    from numba.core import event

    here = copy_context()  # a kernel may be compiled in a thread, which does not know the listener

    class Compiling(event.Listener):
        depth = 0  # compiling a kernel compiles those that it calls

        def on_start(self, event: object) -> None:
            self.depth += 1
            here.run(advance, COMPILING, 0, 0)

        def on_end(self, event: object) -> None:
            self.depth -= 1
            if not self.depth:
                here.run(advance, COMPILING, 1, 0)

    with event.install_listener("numba:compile", Compiling()):
        yield
