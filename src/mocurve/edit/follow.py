"""The verb `follow`: a motion laid along another path (Gleicher 2001, Motion path editing).

A motion is taken relative to its own path, to axes that stand upright, look along the path and move as the body does;
these are put onto the other path, at the same distance from its beginning. Axes that keep their heading leave residuals
absolute.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from ..motion import Clip, Motion, complete
from ..path import Path, walkable
from ..path_edits import recognised
from ..path_fit import lead
from ._following import Following as Following
from .path_edit import check, course_of, path_of, ready, taken_back


def follow(
    clip: Clip,
    path: Path | Sequence[Any] | Mapping[str, Any],
    *,
    mode: str = "arclength",
    at_end: str = "extend",
    heading: str = "tangent",
    posture: str = "upright",
    of: Path | None = None,
    lock_feet: bool = True,
) -> Motion:
    """The motion laid along a path: what it does relative to its own path, it does relative to the new one.

    Parameters
    ----------
    mode
        How far along the new path a frame is. arclength: as far as it was along the clip's own path, so that the speed
        stays. paced: so too, but slower in bends narrower than 2.5 m, as people go. time: where the curve's parameter
        is the same. scaled: so that the clip fills the path, with strides 0.6 to 1.15 times as long, and more or less
        time where that is not enough. span: only where control points of the clip's own path were moved is anything
        changed, in the same bounds.
    at_end
        Where one of the two is longer, for modes arclength and paced. extend: straight on behind the path's end.
        truncate: the clip ends with the path. stop: it comes to rest there. reset: it begins again there, as does the
        path. scale: as mode scaled. cycle: the clearest cycle is repeated to the path's end.
    heading
        tangent: the body turns as the path does. facing: so too, but where it backs up it goes back along the path.
        kept: it is only shifted and does not turn.
    posture
        On a path with heights. upright: every foot that is held stands on the path beside it, the hips are as high as
        it is in between; without feet as lift. lift: the whole body is lifted. tangent: it also leans with the slope.
    of
        The path that the clip is on; by default the one that the path is an edit of, or one that is fitted. Where the
        clip was taken from the new path before, as its own, it comes back exactly.
    lock_feet
        Hold feet still where they stand in the clip, as the verb lock_feet does, where the path moves them unevenly.
        Contacts that would pull the body out of shape are let go.

    The path is in the clip's length unit, on the ground x, z with y up: a `Path`, or its points. The own path laid back
    changes nothing; one moved as a whole moves the motion so. The last step of `history` has the numbers of `Following`
    under "measured", and under "table" of every frame which frame it was, in which cycle, and its distance along the
    path. Errors: OptionError and Mismatch for paths and options that do not fit the clip. Warnings: of a clip that goes
    nowhere, of strides beyond 0.6 to 1.15, of a path that asks too much of the legs, of a body that has none. Who lays
    one clip on path after path takes `PathEdit`.

    >>> tour = mc.follow(walk, mc.Path([(0, 0), (200, 80), (400, -80), (600, 0)]), at_end="cycle")
    """
    given = walkable(path_of(path))
    own = None if of is None else path_of(of)
    check(mode, at_end, heading, posture, own is not None)
    if own is None and clip.frames:
        given = recognised(given, complete(clip.sample()))
    edit = ready(clip, given, own, lock_feet)
    if own is not None and (mode, at_end) == ("arclength", "extend"):
        edit = taken_back(edit, given, heading, posture)
    return edit.laid(given, mode=mode, at_end=at_end, heading=heading, posture=posture)


def own_path(clip: Clip, path: Path, of: Path | None = None) -> Path:
    """The path that `follow` takes the clip to be on."""
    motion = complete(clip.sample())
    ahead = lead(motion)
    body = replace(motion[ahead:], history=motion.history)
    return course_of(body, ahead, path if of else recognised(path, motion), of).path
