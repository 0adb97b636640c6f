"""Key postures by growing clusters (Park and Shin 2004, Example-based motion cloning; Önder 2007, section 2.2).

Postures fall into clusters, each with the posture nearest to its centre as the key. As long as some posture is no
linear combination of the keys within epsilon (the paper: 2 to 5 %), the worst one becomes a cluster of its own.
"""

from __future__ import annotations

import numpy as np

from ..motion import Motion
from .choices import Choices, astray, stances

SPANNED = 1e-9  # part of a posture: missed by less is spanned


def choose(motion: Motion, pinned: np.ndarray, most: int) -> Choices:
    """The choices up to `most` keys; pinned (F,) True where a key has to be."""
    clip = stances(motion)
    size = np.linalg.norm(clip, axis=1)
    clusters = _Clusters(clip, np.flatnonzero(pinned))
    frames, errors, spanned = [], [], False
    while True:
        keys = np.array(sorted(clusters.keys), np.int64)
        missed = np.zeros(len(clip))
        if not spanned:
            missed = np.divide(astray(clip, keys), size, out=np.zeros_like(size), where=size > 0.0)
            spanned = missed.max(initial=0.0) <= SPANNED
        frames.append(keys)
        errors.append(0.0 if spanned else float(missed.max()))
        if len(keys) >= most or len(keys) == len(clip):
            return Choices(frames, np.array(errors), "largest part of a posture that no combination of the keys makes")
        # when the keys span everything: the posture farthest from its cluster's centre
        away = clusters.distances() if spanned else missed
        away[keys] = -1.0
        clusters.grow(int(np.argmax(away)))


class _Clusters:
    """Clusters of the postures (F, D), each with its key frame; those of the first keys keep theirs."""

    def __init__(self, clip: np.ndarray, seeds: np.ndarray) -> None:
        self.clip, self.fixed = clip, len(seeds)
        self.keys = [int(seed) for seed in seeds]
        away = np.array([((clip - clip[seed]) ** 2).sum(axis=1) for seed in seeds])
        self.owner = away.argmin(axis=0)
        self.owner[seeds] = np.arange(len(seeds))
        self.centres = clip[seeds].copy()
        for cluster in range(len(seeds)):
            self._settle(cluster)

    def distances(self) -> np.ndarray:
        """(F,) of every posture from the centre of its cluster, squared."""
        return ((self.clip - self.centres[self.owner]) ** 2).sum(axis=1)

    def grow(self, seed: int) -> None:
        """A cluster more: the posture `seed` and those that are nearer to it than to their cluster's centre."""
        new = len(self.keys)
        nearer = ((self.clip - self.clip[seed]) ** 2).sum(axis=1) < self.distances()
        nearer[self.keys] = False  # a key stays in the cluster that it speaks for
        nearer[seed] = True
        lost = np.unique(self.owner[nearer])
        self.owner[nearer] = new
        self.keys.append(seed)
        self.centres = np.vstack([self.centres, self.clip[seed]])
        for cluster in (*lost.tolist(), new):
            self._settle(cluster)

    def _settle(self, cluster: int) -> None:
        """Centre and key of a cluster, from its postures."""
        members = np.flatnonzero(self.owner == cluster)
        self.centres[cluster] = self.clip[members].mean(axis=0)
        if cluster >= self.fixed:
            away = ((self.clip[members] - self.centres[cluster]) ** 2).sum(axis=1)
            self.keys[cluster] = int(members[np.argmin(away)])
