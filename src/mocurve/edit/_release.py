"""Contacts let go where holding them would pull the body out of shape: the same rule for all who hold feet."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from ..feet.contacts import Contact
from ..motion import Motion
from ._reach import Problem, Strain

TRIES = 20  # times that contacts are let go; after that all are
GENTLE = 10  # times in which only those go that stand where something is worst


def released(
    listed: Sequence[Contact], feet: Sequence[Sequence[str]], hold: Callable[[Sequence[Contact]], tuple[Motion, Strain]]
) -> tuple[Motion, Strain, tuple[Contact, ...], tuple[Problem, ...]]:
    """What `hold` makes of the contacts in which nothing is too much, and what that takes; the contacts that are let
    go, in the order of their first frames; and what was too much with all of them. feet: names of ball and ankle of
    each leg.

    The worst goes first: what is too much near something worse may be mended with it."""
    kept, gone = list(listed), set[Contact]()
    made, strain = hold(kept)
    asked = strain.problems
    for turn in range(TRIES):
        bad = {contact for problem in _apart(strain.problems) for contact in _at(problem, kept, feet, turn < GENTLE)}
        if not bad:
            break
        gone |= bad if turn < TRIES - 1 else set(kept)
        kept = [contact for contact in listed if contact not in gone]
        made, strain = hold(kept)
    return made, strain, tuple(sorted(gone, key=lambda contact: (contact.first, contact.joint))), asked


# -- in call order ---------------------------------------------------------------------------------


def _apart(problems: Sequence[Problem]) -> list[Problem]:
    """Of problems, the worst first, those that overlap none worse."""
    found: list[Problem] = []
    for problem in problems:
        if all(problem.last < worse.first or worse.last < problem.first for worse in found):
            found.append(problem)
    return found


def _at(problem: Problem, listed: Sequence[Contact], feet: Sequence[Sequence[str]], gently: bool) -> list[Contact]:
    """The contacts during a problem, or gently where it is worst, or else the nearest ones; of its own leg, if it has
    one that still stands."""
    first, last = (problem.peak, problem.peak) if gently else (problem.first, problem.last)
    own = [contact for contact in listed if problem.side >= 0 and contact.joint in feet[problem.side]] or listed
    away = [max(contact.first - last, first - contact.last, 0) for contact in own]
    return [contact for contact, frames in zip(own, away, strict=True) if frames == min(away)]
