"""The text of a HIERARCHY."""

from __future__ import annotations

import re

import numpy as np

from ..errors import Mismatch
from ..skeleton import Skeleton
from ._bvh_header import MAX_NAME, end_site_name

_INDENT = 40  # tabs at most: a chain of 20,000 joints must not become gigabytes of them


def hierarchy(skeleton: Skeleton, lossless: bool) -> str:
    """HIERARCHY down to the last brace; Mismatch where a skeleton is none that a BVH file can hold."""
    _check(skeleton)
    lines = ["HIERARCHY"]
    open_joints: list[int] = []
    sites: dict[int, int] = {}
    for joint, parent in enumerate(skeleton.parents.tolist()):
        while open_joints and open_joints[-1] != parent:
            open_joints.pop()
            lines.append(_tabs(len(open_joints)) + "}")
        tabs = _tabs(len(open_joints))
        lines += [tabs + _title(skeleton, joint, sites), tabs + "{"]
        tabs = _tabs(len(open_joints) + 1)
        lines.append(tabs + "OFFSET " + " ".join(_number(x, lossless) for x in skeleton.offsets[joint].tolist()))
        if not skeleton.end_sites[joint]:
            kinds = skeleton.channels[joint]
            lines.append(tabs + " ".join(("CHANNELS", str(len(kinds)), *kinds)))
        open_joints.append(joint)
    lines += [_tabs(depth) + "}" for depth in reversed(range(len(open_joints)))]
    return "\n".join(lines) + "\n"


def _title(skeleton: Skeleton, joint: int, sites: dict[int, int]) -> str:
    name, parent = skeleton.names[joint], int(skeleton.parents[joint])
    if not skeleton.end_sites[joint]:
        return f"{'ROOT' if parent < 0 else 'JOINT'} {name}"
    sites[parent] = sites.get(parent, 0) + 1
    return "End Site" if name == end_site_name(skeleton.names[parent], sites[parent]) else f"End Site {name}"


def _check(skeleton: Skeleton) -> None:
    if not skeleton.names:
        raise Mismatch("a BVH file has at least one joint, the skeleton has none")
    for joint, parent in enumerate(skeleton.parents.tolist()):
        name = skeleton.names[joint]
        if re.search(r"[{}\r\n\0]|\A[ \t\f\v]|[ \t\f\v]\Z", name) or len(name) > MAX_NAME:
            raise Mismatch(
                f"a BVH file cannot hold the joint name {name[:60]!r}: braces, line ends, blanks at an end, or too long"
            )
        if len(set(skeleton.channels[joint])) != len(skeleton.channels[joint]):
            raise Mismatch(f"joint {name!r} has a channel twice")
        if skeleton.end_sites[joint] and (parent < 0 or skeleton.channels[joint]):
            raise Mismatch(f"the end site {name!r} has channels or no parent")
        if parent >= 0 and skeleton.end_sites[parent]:
            raise Mismatch(f"joint {name!r} hangs on an end site")
        if not np.isfinite(skeleton.offsets[joint]).all():
            raise Mismatch(f"the offset of {name!r} is not finite")


def _tabs(depth: int) -> str:
    return "\t" * min(depth, _INDENT)


def _number(value: float, lossless: bool) -> str:
    return repr(value) if lossless else f"{value:.6f}"
