"""Which candidates are artefacts: what a run adds to the motion comes and goes by an isolated jump, or is too sharp for
any body."""

from __future__ import annotations

import numpy as np

from .._jit import kernel

BELIEVED, BESIDE = 1.0, 0.5  # strength of the jumps: alone; next to a channel of the joint that is believed
TRIM = 0.35  # of the largest deviation: frames below it are not part of the artefact
CORE = 0.6  # of the largest deviation
EDGE = 0.15  # of the largest deviation: a shoulder that counts as a step of the run
VISIBLE, UNSURE, CERTAIN = 4.0, 2.0, 6.0  # deviations in their standard deviations
ISOLATED, MOVING, SIDED = 2.0, 1.5, 2.0  # jump over steps inside, over curvature around, of one side alone
VISIBLY = 3.0  # a deviation jumps at most that many times as far as the samples
REAL = 0.3  # part of a channel's second difference that the rotation of its joint has at least
STAYS = 0.5  # part of a leap that is left a frame later
AROUND = 6  # frames
SHORT, LONG = 2, 6  # frames


@kernel
def judge(y, x, variance, sigma, candidate, turn, sharpest, floor, out):
    """Marks in out (C, n) what of the candidate runs (n,) of a joint is an artefact, channel by channel.

    y (C, n) samples; x, variance (C, n) the fit without all candidates and the variance of its values; sigma (C,)
    noise; turn (n,) second difference of the joint's rotation itself, below 0: unknown; sharpest (C,) largest second
    difference of any motion; floor (C,) jumps below it are no artefact."""
    channels, n = y.shape
    strength = np.zeros((channels, n))  # of the run that a frame is part of
    for c in range(channels):
        a = 0
        while a < n:
            if not candidate[a]:
                a += 1
                continue
            b = a
            while b < n and candidate[b]:
                b += 1
            of_channel(y[c], x[c], variance[c], sigma[c], a, b, turn, sharpest[c], floor[c], strength[c])
            a = b
    for i in range(n):
        if candidate[i]:
            most = 0.0
            for c in range(channels):
                most = max(most, strength[c, i])
            for c in range(channels):
                out[c, i] = strength[c, i] > (BESIDE if most > BELIEVED else BELIEVED)


@kernel
def of_channel(y, x, variance, sigma, a, b, turn, sharpest, floor, strength):
    """Takes the candidate run a ... b - 1 apart into the runs that are off, and says how much each looks like an
    artefact."""
    least = VISIBLE * sigma
    for i in range(a, b):
        least = max(least, EDGE * abs(y[i] - x[i]))
    i = a
    while i < b:
        if abs(y[i] - x[i]) <= least:
            i += 1
            continue
        j, most = i, 0.0
        while j < b and abs(y[j] - x[j]) > least:
            most = max(most, abs(y[j] - x[j]))
            j += 1
        p, q = trimmed(y, x, i, j, TRIM * most)
        value = lost(y, sigma, i, j, sharpest) if q - p > LONG else impossible(y, sigma, p, q, sharpest)
        if value <= BELIEVED:
            value = max(value, of_run(y, x, variance, sigma, a, b, i, j, floor))
        elif q - p > LONG:
            p, q = i, j  # such a run leaves and comes back over several frames
        if only_notation(y, turn, p, q) or no_simpler(y, x, p, q):
            value = 0.0
        for k in range(p, q):
            strength[k] = value
        i = j


@kernel
def trimmed(y, x, p, q, least):
    while abs(y[p] - x[p]) < least:
        p += 1
    while abs(y[q - 1] - x[q - 1]) < least:
        q -= 1
    return p, q


@kernel
def of_run(y, x, variance, sigma, a, b, p, q, floor):
    """How much frames p ... q - 1 of the candidates a ... b - 1 look like an artefact: over 1, they are one."""
    n, certainty = len(y), 0.0
    for i in range(p, q):
        certainty = max(certainty, abs(y[i] - x[i]) / np.sqrt(sigma * sigma + variance[i] + 1e-300))
    short = q - p <= SHORT
    if certainty < UNSURE:
        return 0.0
    entry = jump(y, x, p, p - 1)
    leave = jump(y, x, q - 1, q)
    largest = second = after = before = 0.0
    for i in range(p + 1, q):
        step = abs((y[i] - x[i]) - (y[i - 1] - x[i - 1]))
        if step > largest:
            largest, second = step, largest
        elif step > second:
            second = step
        if i == p + 1:
            after = step
        before = step
    inside = largest if q - p < 5 else second
    curved = 0.0
    for i in range(max(1, a - AROUND + 1), min(n - 1, b + AROUND - 1)):
        curved = max(curved, abs(x[i - 1] - 2.0 * x[i] + x[i + 1]))
    least = max(MOVING * curved, CERTAIN * sigma, floor, 1e-12)
    entry_strength = entry / max(ISOLATED * max(inside, after), least)
    leave_strength = leave / max(ISOLATED * max(inside, before), least)
    less, more = min(entry_strength, leave_strength), max(entry_strength, leave_strength)
    strength = max(less, 0.0 if short else more / SIDED)
    if certainty < CERTAIN and short:
        strength /= 1.5
    if (p == 0 or q == n) and certainty < CERTAIN:
        return 0.0
    return strength


@kernel
def core(off, variance, sigma, candidate, out):
    """Marks in out (n,) the frames about the largest deviation of each candidate run."""
    channels, n = off.shape
    a = 0
    while a < n:
        if not candidate[a]:
            a += 1
            continue
        b = a
        while b < n and candidate[b]:
            b += 1
        most, where, which = 0.0, a, 0
        for c in range(channels):
            for i in range(a, b):
                z = abs(off[c, i]) / np.sqrt(variance[c, i] + sigma[c] * sigma[c] + 1e-300)
                if z > most:
                    most, where, which = z, i, c
        peak = off[which, where]
        p, q = where, where + 1
        while p > a and off[which, p - 1] / peak > CORE:
            p -= 1
        while q < b and off[which, q] / peak > CORE:
            q += 1
        if q - p <= SHORT:
            out[p:q] = True
        a = b


@kernel
def jump(y, x, inner, outer):
    """How far the deviation jumps from a frame of a run to its neighbour outside, as far as the samples jump too."""
    if not 0 <= outer < len(y):
        return abs(y[inner] - x[inner])
    deviation = (y[inner] - x[inner]) - (y[outer] - x[outer])
    sample = y[inner] - y[outer]
    return min(abs(deviation), max(0.0, VISIBLY * sample * np.sign(deviation)))


@kernel
def impossible(y, sigma, p, q, sharpest):
    """The sharpest turn in and beside a run, over what a body can do."""
    sharp = 0.0
    for i in range(max(p - 1, 1), min(q + 1, len(y) - 1)):
        sharp = max(sharp, abs(y[i - 1] - 2.0 * y[i] + y[i + 1]))
    return (sharp - CERTAIN * sigma) / sharpest


@kernel
def lost(y, sigma, p, q, sharpest):
    """The same for a long run, as where a sensor loses a limb: it has to leave and to come back by such a turn, each
    time for longer than a frame, else there is but a spike at its end."""
    if p == 0 or q == len(y):
        return 0.0
    out, back = abs(y[p + 1] - y[p - 1]), abs(y[q - 2] - y[q])
    if out < STAYS * abs(y[p] - y[p - 1]) or back < STAYS * abs(y[q - 1] - y[q]):
        return 0.0
    turned = min(impossible(y, sigma, p, p + 1, sharpest), impossible(y, sigma, q - 1, q, sharpest))
    return min(turned, min(out, back) / sharpest)


@kernel
def only_notation(y, turn, p, q):
    """Whether the channel turns sharply and the joint does not: near gimbal lock angles leap where nothing moves."""
    sharp = real = 0.0
    for i in range(max(p - 1, 1), min(q + 1, len(y) - 1)):
        sharp = max(sharp, abs(y[i - 1] - 2.0 * y[i] + y[i + 1]))
        real = max(real, turn[i]) if turn[i] >= 0.0 else np.inf
    return real < REAL * sharp


@kernel
def no_simpler(y, x, p, q):
    """Whether the curve that replaces a long run swings wider about the chord than the samples do."""
    n = len(y)
    if q - p <= LONG or p == 0 or q == n:
        return False
    samples = curve = 0.0
    for i in range(p, q):
        chord = y[p - 1] + (y[q] - y[p - 1]) * (i - p + 1) / (q - p + 1)
        samples, curve = max(samples, abs(y[i] - chord)), max(curve, abs(x[i] - chord))
    return curve > samples
