"""Long work says how far it is to whoever listens; without a listener it costs nothing, and the library prints
nothing."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

Listener = Callable[[str, int, int], None]  # label, done, total
_listener: ContextVar[Listener | None] = ContextVar("listener", default=None)


def advance(label: str, done: int, total: int) -> None:
    """Tell the listener, if there is one, that `done` of `total` steps of `label` are done."""
    listener = _listener.get()
    if listener is not None:
        listener(label, done, total)


@contextmanager
def listening(listener: Listener) -> Iterator[None]:
    """Send every `advance` inside the block to the listener."""
    token = _listener.set(listener)
    try:
        yield
    finally:
        _listener.reset(token)
