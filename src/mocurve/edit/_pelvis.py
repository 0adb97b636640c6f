"""Where the pelvis goes so that both feet reach what they should and the knees bend as they did: one banded least
squares over all frames; compiled, which is nearly three times as fast as NumPy and LAPACK, three times an edit.

Unknown is a shift (F, 3), cm, of the whole body. Every term is divided by its tolerance in its own unit; the bend of a
knee as it depends on the shift is made linear a few times (Gauss and Newton).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.ndimage import maximum_filter1d

from .._jit import kernel
from ._hinge import Hinge
from ._reach import LIMITS

BENDS = np.radians(6.0)  # flexion off what is wanted
QUICKENS = np.radians(1500.0)  # a second a second, of that
JERKS = 3.5  # times that: a knee that shakes more pulls hips that are at their end no harder (Huber's loss)
SIDEWAYS, UP = 2.5, 2.5  # cm of shift
HURRIES = 300.0  # cm a second a second, of the shift
GENTLY = 0.15  # seconds around a foot out of reach in which the body is lower
WALLS = (LIMITS["shift"], LIMITS["drop"])  # cm that hips should go aside, and down, at most
FROM, TO, TIGHT = 0.85, 0.92, 0.1  # of that: where it begins to tell, and where it is to end; cm
AROUND = 0.5  # seconds around that in which what shakes is let shake
ROUNDS = 3  # solutions with that, and with walls
FAST = 1e12  # weight of a shift that is to be none
BAND = 9


class Legs:
    """What pulls at the pelvis: hips as carried (F, 3), ankle targets, hinges, wanted flexion and weights (F,)."""

    def __init__(self, hinge: Hinge, hip: np.ndarray, wanted: np.ndarray, weight: np.ndarray) -> None:
        self.hinge, self.hip, self.wanted, self.weight = hinge, hip, wanted, weight


def shifted(
    legs: list[tuple[Legs, np.ndarray]],
    at: np.ndarray,
    fixed: np.ndarray,
    frame_time: float,
    jerks: np.ndarray | None = None,
    walls: Sequence[tuple[np.ndarray, np.ndarray, np.ndarray]] = (),
) -> np.ndarray:
    """The best shift (F, 3), the knees linear about the shift `at`. legs: each with its ankle targets (F, 3). Where
    `fixed` (F,) the shift is none. jerks: (F,) in tolerances, what of a knee pulls no harder. walls: as `_walls` has
    them."""
    frames = len(at)
    band, right = np.zeros((3 * frames + BAND - 1, BAND)), np.zeros(3 * frames + BAND - 1)
    tolerances = np.array([SIDEWAYS, UP, SIDEWAYS]) ** -2.0
    none = np.full(frames, np.inf)
    hardest = none if jerks is None else jerks
    _quiet(band, fixed, tolerances, (HURRIES * frame_time**2) ** -2.0)
    for leg, target in legs:
        to = leg.hip + at - target
        length = np.sqrt((to * to).sum(axis=1))
        flexion, slope = leg.hinge.bend(length)
        pull = to * (slope / length)[:, None]
        now = flexion - leg.wanted
        off = now - (pull * at).sum(axis=1)
        _add(band, right, pull, off, now, leg.weight, BENDS**-2.0, QUICKENS * frame_time**2, hardest)
    for way, length, weight in walls:
        _add(band, right, way, -length, 0.0 * length, weight, TIGHT**-2.0, np.inf, none)
    _solve(band, right)
    result = right[: 3 * frames].reshape(frames, 3)
    result[fixed] = 0.0
    return result


def spared(legs: list[tuple[Legs, np.ndarray]], shift: np.ndarray, fixed: np.ndarray, frame_time: float) -> np.ndarray:
    """The shift (F, 3) as it is, unless it comes near what hips may do: there knees that shake pull no harder than
    quick ones, and the hips are kept a little within what they may do, as far as knees can take it."""
    near = _near(shift, frame_time)
    if near is None:
        return shift
    jerks = JERKS / np.maximum(near, 1e-9)
    for _ in range(ROUNDS):
        shift = shifted(legs, shift, fixed, frame_time, jerks)
    walls = _walls(shift)
    for _ in range(ROUNDS if walls else 0):
        shift = shifted(legs, shift, fixed, frame_time, jerks, walls)
    return shift


def beyond_reach(
    legs: list[tuple[Legs, np.ndarray]], at: np.ndarray, stands: np.ndarray, frame_time: float
) -> np.ndarray:
    """How much lower (F,) the body with the shift `at` has to be so that no leg is too short where it stands, (2, F):
    what least squares leave, millimetres."""
    straight = np.zeros(len(at))
    over = [lacking(leg.hip + at - target, leg.hinge.length(straight)) for leg, target in legs]
    need = np.where(stands, over, 0.0).max(axis=0)
    return around(need, round(GENTLY / frame_time)) if (need > 0.0).any() else straight


def lacking(to: np.ndarray, length: np.ndarray) -> np.ndarray:
    """By how much (F,) a hip, at `to` (F, 3) from its ankle, is too high for a leg of this length (F,); below zero
    where it is not."""
    lack: np.ndarray = to[:, 1] - np.sqrt(np.maximum(length**2 - to[:, 0] ** 2 - to[:, 2] ** 2, 0.0))
    return lack


def around(need: np.ndarray, half: int) -> np.ndarray:
    """The least smooth values (F,) that are not below any need nor zero, zero twice so many frames away."""
    third = max(half // 3, 1)
    highest = maximum_filter1d(np.maximum(need, 0.0), 6 * third + 1, mode="nearest")
    box = np.full(2 * third + 1, 1.0 / (2 * third + 1))
    bell = np.convolve(np.convolve(box, box), box)
    return np.convolve(np.pad(highest, 3 * third, mode="edge"), bell, mode="valid")


# -- in call order ---------------------------------------------------------------------------------


def _asked(shift: np.ndarray) -> list[tuple[np.ndarray, np.ndarray, float]]:
    """The part (F, 3) of a shift that goes aside, and that which goes down, how far (F,) each does, and may."""
    aside, down = shift * [1.0, 0.0, 1.0], np.minimum(shift, 0.0) * [0.0, 1.0, 0.0]
    return [(part, np.linalg.norm(part, axis=1), most) for part, most in zip((aside, down), WALLS, strict=True)]


def _near(shift: np.ndarray, frame_time: float) -> np.ndarray | None:
    """(F,) 1 where a shift comes near what hips may do, smoothly 0 from a second away on; None where it never does."""
    far = np.logical_or.reduce([size > FROM * most for _, size, most in _asked(shift)])
    return around(far.astype(np.float64), round(AROUND / frame_time)) if far.any() else None


def _walls(shift: np.ndarray) -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """What keeps a shift (F, 3) that comes near what hips may do, or goes beyond, a little within it, aside and down:
    the direction (F, 3) of it, how far (F,) it is to go instead, cm, and a weight (F,)."""
    found = []
    for part, size, most in _asked(shift):
        start, room = FROM * most, (TO - FROM) * most
        over = np.maximum(size - start, 0.0) / room
        if over.any():
            way = part / np.maximum(size, start)[:, None]
            found.append((way, start + room * np.tanh(over), np.minimum(over, 1.0) ** 2))
    return found


# band (3F, 9): row u has what unknown u (x, y, z of the first frame, then of the second) has to do with u ... u + 8


@kernel
def _quiet(band: np.ndarray, fixed: np.ndarray, tolerances: np.ndarray, hurries: float) -> None:
    """A small shift, without haste."""
    frames = len(fixed)
    bend = np.array([1.0, -2.0, 1.0])
    for f in range(frames):
        for j in range(3):
            band[3 * f + j, 0] += tolerances[j] + (FAST if fixed[f] else 0.0)
            if f < frames - 2:
                for a in range(3):
                    for b in range(a, 3):
                        band[3 * (f + a) + j, 3 * (b - a)] += hurries * bend[a] * bend[b]


@kernel
def _add(
    band: np.ndarray,
    right: np.ndarray,
    pull: np.ndarray,
    off: np.ndarray,
    now: np.ndarray,
    weight: np.ndarray,
    bends: float,
    quickens: float,
    jerks: np.ndarray,
) -> None:
    """A leg's pull: the flexion off what is wanted, pull (F, 3) . shift + off, and its second difference, squared; both
    in their tolerances, the latter no harder than `jerks` (F,) times that. now: (F,) what it is off where it was made
    linear."""
    row = np.empty(9)
    for f in range(len(off)):
        heavy = weight[f] * bends
        for j in range(3):
            right[3 * f + j] -= heavy * pull[f, j] * off[f]
            for i in range(3 - j):
                band[3 * f + j, i] += heavy * pull[f, j] * pull[f, j + i]
    for f in range(len(off) - 2):
        jerk = abs(now[f] - 2.0 * now[f + 1] + now[f + 2]) / quickens
        heavy = weight[f + 1] / (quickens * quickens) * min(jerks[f + 1] / max(jerk, 1e-9), 1.0)
        if heavy == 0.0:
            continue
        for j in range(3):
            row[j], row[3 + j], row[6 + j] = pull[f, j], -2.0 * pull[f + 1, j], pull[f + 2, j]
        change = off[f] - 2.0 * off[f + 1] + off[f + 2]
        for j in range(9):
            right[3 * f + j] -= heavy * row[j] * change
            for i in range(9 - j):
                band[3 * f + j, i] += heavy * row[j] * row[j + i]


@kernel
def _solve(band: np.ndarray, right: np.ndarray) -> None:
    """Solve in place, by Cholesky: band becomes the factor's, right the unknowns; both with 8 empty rows at their end,
    so that no loop has an end of its own."""
    count = len(right) - BAND + 1
    for u in range(count):
        over = 1.0 / np.sqrt(band[u, 0])
        for i in range(BAND):
            band[u, i] *= over
        right[u] *= over
        for i in range(1, BAND):
            share = band[u, i]
            right[u + i] -= share * right[u]
            for k in range(BAND - i):
                band[u + i, k] -= share * band[u, i + k]
    for u in range(count - 1, -1, -1):
        for i in range(1, BAND):
            right[u] -= band[u, i] * right[u + i]
        right[u] /= band[u, 0]
