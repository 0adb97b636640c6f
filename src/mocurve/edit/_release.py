"""Contacts let go where holding them would pull the body out of shape: the same rule for all who hold feet."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from ..feet.contacts import Contact
from ..motion import Motion
from ._reach import Problem, Strain

TRIES = 20  # times that contacts are let go; after that all are


def released(
    listed: Sequence[Contact], hold: Callable[[Sequence[Contact]], tuple[Motion, Strain]]
) -> tuple[Motion, Strain, tuple[Contact, ...], tuple[Problem, ...]]:
    """What `hold` makes of the contacts in which nothing is too much, and what that takes; the contacts that are let
    go, in the order of their first frames; and what was too much with all of them."""
    kept, gone = list(listed), set[Contact]()
    made, strain = hold(kept)
    asked = strain.problems
    for turn in range(TRIES):
        bad = {contact for problem in strain.problems for contact in _at(problem, kept)}
        if not bad:
            break
        gone |= bad if turn < TRIES - 1 else set(kept)
        kept = [contact for contact in listed if contact not in gone]
        made, strain = hold(kept)
    return made, strain, tuple(sorted(gone, key=lambda contact: (contact.first, contact.joint))), asked


# -- in call order ---------------------------------------------------------------------------------


def _at(problem: Problem, listed: Sequence[Contact]) -> list[Contact]:
    """The contacts during a problem, or else the nearest ones."""
    away = [max(contact.first - problem.last, problem.first - contact.last, 0) for contact in listed]
    return [contact for contact, frames in zip(listed, away, strict=True) if frames == min(away)]
