"""Blender: one Python script that holds the keys and makes an armature and an action of them, and takes them back.

The script's own code is in the modules _blender_*.py, under the MIT licence: code that runs in Blender has to be under
a licence that goes with the GPL. docs/blender.md says how it is used.
"""

from __future__ import annotations

import warnings
from importlib import resources
from os import fsdecode
from pathlib import PurePath

import numpy as np

from ..errors import FileError, OptionError
from ..info import unit_of
from ..keyed import HermiteCurve, KeyedMotion
from ..motion import Clip, Motion, unroll
from ..skeleton import Skeleton
from . import curves_json
from ._files import Path, opened, replacing

PROFILES = {
    "euler": "the clip's own keys on its own channels; bones lie along the axes",
    "quaternion": "bones lie along the body; rotations become quaternion keys, within 1e-4 degrees",
}
PARTS = ("_blender_maths", "_blender_keys", "_blender_scene", "_blender_export")
MARKER = "# --- part of the script ---\n"
START, END = b'\nPAYLOAD = r"""\n', b'\n"""\n'
LINES = b"\nLINEAR = True\n"
LARGEST = 1e30  # Blender's numbers have 32 bits, and its rotations are in other units

HEAD = '''\
# SPDX-License-Identifier: MIT
#
# Copyright the authors of mocurve
#
{licence}
"""The motion {name} for Blender 4.4 and later, written by mocurve {version}.

Make an armature with an action, or give the action to an armature that has bones of the same names:
    blender --python {file}
    blender rig.blend --python {file} -- --armature NAME
Take edited keys back (or: File > Export, where this script has run):
    blender edited.blend --python {file} -- --export edited.curves.json
It can also be run in Blender's text editor, and `{file} --help` by a Python that has bpy tells more.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import sys
from collections.abc import Callable
from itertools import permutations, product
from typing import Any, NamedTuple, NoReturn

import bpy
import numpy as np
from bpy_extras.io_utils import ExportHelper

NAME = {literal}
PROFILE = {profile!r}
METRES = {metres!r}
LINEAR = {linear}
'''
TAIL = """
if __name__ == "__main__":
    main()
"""
LICENCE = """\
Permission is hereby granted, free of charge, to any person obtaining a copy of this software and associated
documentation files (the "Software"), to deal in the Software without restriction, including without limitation the
rights to use, copy, modify, merge, publish, distribute, sublicense, and/or sell copies of the Software, and to permit
persons to whom the Software is furnished to do so, subject to the following conditions:

The above copyright notice and this permission notice shall be included in all copies or substantial portions of the
Software.

THE SOFTWARE IS PROVIDED "AS IS", WITHOUT WARRANTY OF ANY KIND, EXPRESS OR IMPLIED, INCLUDING BUT NOT LIMITED TO THE
WARRANTIES OF MERCHANTABILITY, FITNESS FOR A PARTICULAR PURPOSE AND NONINFRINGEMENT. IN NO EVENT SHALL THE AUTHORS OR
COPYRIGHT HOLDERS BE LIABLE FOR ANY CLAIM, DAMAGES OR OTHER LIABILITY, WHETHER IN AN ACTION OF CONTRACT, TORT OR
OTHERWISE, ARISING FROM, OUT OF OR IN CONNECTION WITH THE SOFTWARE OR THE USE OR OTHER DEALINGS IN THE SOFTWARE.
"""


def read(path: Path) -> Motion | KeyedMotion:
    """The clip in the script, exactly; samples where it was made of samples. Nothing of the script is run."""
    with opened(path) as file:
        script = file.read()
    head, start, rest = script.replace(b"\r\n", b"\n").partition(START)
    payload, end, _ = rest.rpartition(END)
    if not start or not end:
        raise FileError("not a script that mocurve wrote: it holds no keys", path)
    try:
        keys = curves_json.parsed(payload, path)
    except FileError as error:
        raise FileError(f"the keys in the script: {error.message}", path) from error
    return keys.sample() if LINES in head else keys


def write(path: Path, clip: Clip, profile: str = "euler") -> None:
    """Write a script that makes the clip's keys in Blender.

    A Motion gets a key at every frame with straight lines between, unrolled, and a warning that it is so. OptionError
    where a joint has a channel twice, and for numbers too large for Blender.
    """
    keys = clip if isinstance(clip, KeyedMotion) else _key_a_frame(unroll(clip.sample()))
    linear = keys is not clip
    if linear and keys.frames > 1:
        warnings.warn("samples have no keys: Blender gets one at every frame; reduce the clip first", stacklevel=3)
    _refuse(keys)
    file = PurePath(fsdecode(path)).name
    name = file[: -len(".blend.py")] if file.lower().endswith(".blend.py") else file
    script = _script(keys, name or "motion", profile, linear)
    with replacing(path) as out:
        out.write(script.encode())


def _script(keys: KeyedMotion, name: str, profile: str, linear: bool) -> str:
    from .. import __version__

    plain = "".join(c if c.isascii() and (c.isalnum() or c in "-_.") else "_" for c in name)
    licence = "\n".join(f"# {line}".rstrip() for line in LICENCE.splitlines())
    head = HEAD.format(
        licence=licence,
        name=plain,
        file=f"{plain}.blend.py",
        version=__version__,
        literal=ascii(name),
        profile=profile,
        metres=_metres(keys),
        linear=linear,
    )
    parts = [resources.files(__package__).joinpath(f"{part}.py").read_text("utf-8") for part in PARTS]
    code = "\n\n".join(part.partition(MARKER)[2] for part in parts)
    # JSON has no three quotes in a row and no line end within a string: nothing in it can end the literal
    return f'{head}{code}\n\nPAYLOAD = r"""\n{curves_json.text(keys)}"""\n{TAIL}'


def _metres(keys: KeyedMotion) -> float:
    """Metres in a length unit, by a guess where nobody said it, 1 where there is nothing to guess from."""
    try:
        return unit_of(keys.sample()).metres
    except OptionError:
        return 1.0


def _key_a_frame(motion: Motion) -> KeyedMotion:
    """A key at every frame, straight lines between; a channel that never changes has one key."""
    times = np.arange(motion.frames) * motion.frame_time
    curves = []
    for values in motion.values.T:
        if motion.frames < 2 or (values == values[0]).all():
            curves.append(HermiteCurve(times[:1], values[:1], np.zeros(len(values[:1]))))
            continue
        chords = np.diff(values) / np.diff(times)
        curves.append(HermiteCurve(times, values, np.append(chords, chords[-1]), np.append(chords[0], chords)))
    return KeyedMotion(motion.skeleton, tuple(curves), motion.frame_time, motion.frames, motion.history)


def _refuse(keys: KeyedMotion) -> None:
    body: Skeleton = keys.skeleton
    for joint, kinds in zip(body.names, body.channels, strict=True):
        if len(set(kinds)) < len(kinds):
            raise OptionError(f"joint {joint!r} has a channel twice ({' '.join(kinds)}), as no bone of Blender can")
    for name, curve in zip(body.channel_names, keys.curves, strict=True):
        parts = (curve.values, curve.slopes * keys.frame_time, curve.in_slopes * keys.frame_time)
        if any((np.abs(part) > LARGEST).any() for part in parts):
            raise OptionError(
                f"channel {name} has numbers above {LARGEST:g}, more than Blender's numbers of 32 bits hold"
            )
