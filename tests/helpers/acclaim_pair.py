"""A small Acclaim pair to make odd, and what reading it says."""

from __future__ import annotations

import warnings
from pathlib import Path

import pytest

import mocurve as mc

ASF = """# a comment
:version 1.10
:name small
:units
  mass 1.0
  length 0.45
  angle deg
:documentation
  anything: goes here (and, here)
:root
  order TX TY TZ RX RY RZ
  axis XYZ
  position 0 0 0
  orientation 0 0 0
:bonedata
  begin
    id 1
    name back
    direction 0 2 0
    length 3
    axis 0 0 0 XYZ
    dof rx ry rz
    limits (-20.0, 45.0)
           (-inf inf)
           (-30.0 30.0)
    bodymass 10
  end
  begin
    id 2
    name arm
    direction 1 0 0
    length 5
    axis 10 20 30 XYZ
    dof rz rx
  end
  begin
    id 3
    name head
    direction 0 1 0
    length 1
    axis 90 0 0 XYZ
    dof ry rx
  end
:hierarchy
  begin
    root back
    back arm head
  end
"""
AMC = """#!OML:ASF small.asf
:FULLY-SPECIFIED
:DEGREES
1
root 1 2 3 0 0 0
back 10 20 30
arm 40 50
head 5 6
2
root 1.5 2.5 3.5 10 20 30
back 1e1 -2.5E-1 30
arm 41 51
head -7 8
"""


def write_pair(folder: Path, *changes: str, amc: tuple[str, ...] = ()) -> Path:
    """The small files in that folder, every `old` of (old, new, ...) changed to `new`; the path of the motion."""
    for text, edits, name in ((ASF, changes, "small.asf"), (AMC, amc, "small.amc")):
        for old, new in zip(edits[::2], edits[1::2], strict=True):
            assert old in text
            text = text.replace(old, new)
        (folder / name).write_text(text, newline="", encoding="utf-8")
    return folder / "small.amc"


def read(path, **options) -> mc.Motion:
    """The clip; the frame rate is always assumed, so that warning is always there."""
    with pytest.warns(UserWarning, match="no frame rate in the file, 120 frames a second assumed"):
        return mc.read(path, **options)


def refused(path) -> str:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        with pytest.raises(mc.FileError) as caught:
            mc.read(path)
    return str(caught.value).removeprefix(str(path.parent) + "/")
