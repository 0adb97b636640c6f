"""The body: joints, their tree, rest offsets and channels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from functools import cached_property

import numpy as np

from .errors import Mismatch, OptionError, UnknownName

AXES = "XYZ"
CHANNEL_KINDS = tuple(f"{axis}{kind}" for kind in ("position", "rotation") for axis in AXES)


def frozen(array: np.ndarray) -> np.ndarray:
    """The array, no longer writable: frozen data keeps its contents too."""
    array.setflags(write=False)
    return array


@dataclass(frozen=True, eq=False)
class JointLimits:
    """How far a joint may turn, as files say it: least and largest Euler angles about axes of its own.

    joint:     index of the joint.
    axes:      (4,) wxyz, what turns the axes of the frame above the joint to those that the angles are about.
    order:     axes of the angles, as a rotation order: "ZYX".
    low, high: (n,) degrees, one for each axis of the order; infinite where there is no limit.
    """

    joint: int
    axes: np.ndarray
    order: str
    low: np.ndarray
    high: np.ndarray

    def __post_init__(self) -> None:
        if type(self.joint) is not int:
            raise Mismatch(f"joint limits are of a joint, by its index, not of {self.joint!r}")
        for name, count in (("axes", 4), ("low", len(self.order)), ("high", len(self.order))):
            array = np.array(getattr(self, name), np.float64).reshape(-1)
            if len(array) != count or np.isnan(array).any():
                raise Mismatch(f"joint limits about {self.order!r} have {count} {name}, not {array.tolist()}")
            object.__setattr__(self, name, frozen(array))
        if not 1 <= len(self.order) <= 3 or any(axis not in AXES for axis in self.order):
            raise OptionError(f"joint limits are about one to three axes of XYZ, not {self.order!r}")
        if not abs(float(self.axes @ self.axes) - 1.0) < 1e-6:
            raise Mismatch(f"the axes of joint limits are a quaternion of length 1, not {self.axes.tolist()}")
        if not (self.low <= self.high).all():
            raise Mismatch(
                f"joint limits from {self.low.tolist()} to {self.high.tolist()}: the lower is above the higher"
            )


@dataclass(frozen=True, eq=False)
class Skeleton:
    """Joints in depth-first order; a parent comes before its children, a root's parent is -1 (a file may have several
    roots).

    names:     J names as in the file; an end site is called after its parent, "LeftToeBase_End".
    parents:   (J,) index of the parent, -1 for a root.
    offsets:   (J, 3) rest position in the parent's frame, in the file's length unit.
    channels:  per joint, in file order, of "Xposition" ... "Zrotation"; an end site has none.
    end_sites: (J,) True for an end site, a place without channels that ends a bone. Empty: there are none.
    unit:      metres that one length unit of the file stands for, None where nobody said.
    limits:    how far joints may turn, of those whose file says so; the others have no limits.
    """

    names: tuple[str, ...]
    parents: np.ndarray
    offsets: np.ndarray
    channels: tuple[tuple[str, ...], ...]
    end_sites: np.ndarray = field(default_factory=lambda: np.zeros(0, bool))
    unit: float | None = None
    limits: tuple[JointLimits, ...] = ()

    def __post_init__(self) -> None:
        count = len(self.names)
        ends = self.end_sites if len(self.end_sites) else np.zeros(count, bool)
        put = object.__setattr__  # the dataclass is frozen; this is its constructor
        put(self, "names", tuple(self.names))
        put(self, "channels", tuple(tuple(names) for names in self.channels))
        put(self, "parents", frozen(np.array(self.parents, np.int64).reshape(-1)))
        put(self, "offsets", frozen(np.array(self.offsets, np.float64).reshape(-1, 3)))
        put(self, "end_sites", frozen(np.array(ends, bool).reshape(-1)))
        put(self, "limits", tuple(self.limits))
        for label in ("parents", "offsets", "channels", "end_sites"):
            if len(getattr(self, label)) != count:
                raise Mismatch(f"{count} joint names but {len(getattr(self, label))} {label}")
        open_joints: list[int] = []  # the joint before and its ancestors
        for joint, parent in enumerate(self.parents.tolist()):
            while open_joints and open_joints[-1] != parent:
                open_joints.pop()
            if parent != -1 and not open_joints:
                raise Mismatch(
                    f"joint {self.names[joint]!r} is out of order: joints stand depth first, after their parent"
                )
            open_joints.append(joint)
        for name, kinds in zip(self.names, self.channels, strict=True):
            for kind in kinds:
                if kind not in CHANNEL_KINDS:
                    raise UnknownName(f"channel kind (joint {name!r})", kind, CHANNEL_KINDS)
        if self.unit is not None and not (np.isfinite(self.unit) and self.unit > 0):
            raise OptionError(f"unit must be a positive number of metres, not {self.unit!r}")
        bounded = [limits.joint for limits in self.limits]
        if any(not 0 <= joint < count for joint in bounded) or len(set(bounded)) < len(bounded):
            raise Mismatch(f"joint limits are of the joints 0 to {count - 1}, each once, not of {bounded}")

    def __repr__(self) -> str:
        joints = len(self.names) - int(self.end_sites.sum())
        return f"<Skeleton {joints} joints, {int(self.end_sites.sum())} end sites, {self.channel_count} channels>"

    # -- channels, in file order ---------------------------------------------------------------
    @cached_property
    def channel_count(self) -> int:
        return sum(len(kinds) for kinds in self.channels)

    @cached_property
    def channel_names(self) -> tuple[str, ...]:
        """C names such as "LeftKnee.Xrotation": how a channel is addressed everywhere."""
        return tuple(f"{name}.{kind}" for name, kinds in zip(self.names, self.channels, strict=True) for kind in kinds)

    @cached_property
    def channel_joints(self) -> np.ndarray:
        """(C,) the joint that each channel moves."""
        return frozen(np.repeat(np.arange(len(self.names)), [len(kinds) for kinds in self.channels]))

    @cached_property
    def channel_axes(self) -> np.ndarray:
        """(C,) 0, 1, 2 for X, Y, Z."""
        return frozen(np.array([AXES.index(kind[0]) for kinds in self.channels for kind in kinds], np.int64))

    @cached_property
    def rotation_channels(self) -> np.ndarray:
        """(C,) True where the channel is a rotation (degrees), False where a position (file length)."""
        return frozen(np.array([kind.endswith("rotation") for kinds in self.channels for kind in kinds], bool))

    @cached_property
    def eulers(self) -> list[tuple[list[int], str]]:
        """For each joint the columns of its rotation channels and the order of their axes, "ZYX"."""
        found, first = [], 0
        for kinds in self.channels:
            columns = [first + i for i, kind in enumerate(kinds) if kind.endswith("rotation")]
            found.append((columns, "".join(kinds[column - first][0] for column in columns)))
            first += len(kinds)
        return found

    # -- names ---------------------------------------------------------------------------------
    def joint(self, name: str) -> int:
        """Index of a joint by name; UnknownName with the nearest name where there is none, Mismatch where there are
        several."""
        return _only(name, self.names, "joint")

    def channel(self, name: str) -> int:
        """Index of a channel by name, "LeftKnee.Xrotation"."""
        return _only(name, self.channel_names, "channel")

    def below(self, joint: int) -> np.ndarray:
        """(J,) True for the joint itself and all that hang on it."""
        inside = np.zeros(len(self.names), bool)
        for j in range(joint, len(self.names)):
            inside[j] = j == joint or (self.parents[j] >= 0 and inside[self.parents[j]])
        return inside


def matching(name: str, names: Sequence[str], owners: Sequence[str], kind: str) -> list[int]:
    """Places of the names that are, or belong to, what `name` says, * for anything; UnknownName where none is."""
    places = [
        i
        for i, (own, owner) in enumerate(zip(names, owners, strict=True))
        if name in (own, owner) or fnmatchcase(own, name) or fnmatchcase(owner, name)
    ]
    if not places:
        raise UnknownName(kind, name, (*owners, *names))
    return places


def _only(name: str, known: Sequence[str], kind: str) -> int:
    places = [i for i, other in enumerate(known) if other == name]
    if not places:
        raise UnknownName(kind, name, known)
    if len(places) > 1:
        raise Mismatch(f"{len(places)} {kind}s are called {name!r}")
    return places[0]
