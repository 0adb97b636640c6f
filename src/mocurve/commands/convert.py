"""`mocurve convert`: another format."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from ..errors import OptionError
from ..formats import format_of, read, write
from ._options import check_outputs, split_options, with_options_of

Source = Annotated[
    Path, Parameter(help="A clip in any format that is read, or body and motion of Acclaim: walk.asf+walk.amc")
]
Rest = Annotated[
    Path, Parameter(name="TARGET", help="Where it goes. More clips may stand before it: several animations in one .glb")
]


@with_options_of(read, write)
def convert(source: Source, /, *target: Rest, **options: Any) -> None:
    """The same clip in another format.

    The extensions say which:
      .bvh              read, written: samples
      .curves.json      read, written: keys, everything exact
      .glb .gltf        read, written (see --profile)
      .blend.py         read, written: a script that builds the action in Blender
      .npz .csv         read, written: samples as arrays or table; AMASS poses
      .asf .amc .c3d    read: Acclaim, markers
      .fbx .ma .usda    written

    Where a format can be written in several ways, --profile chooses; the first
    is the default:
      .glb  linear      few keys, straight lines between, within --tolerance
            cubic       the curves of a reduced clip; Blender drops tangents
            baked       a key at every frame
      .fbx  baked       a key at every frame: the same in every program
            keys        the curves of a reduced clip, for Maya, MotionBuilder
      .usda splines     the curves of a reduced clip, exact
            skel        a UsdSkel skeleton, a key at every frame
      .blend.py
            euler       the keys on the clip's own channels, exact
            quaternion  bones along the body, quaternion keys
      .npz  mocurve     everything of a motion
            amass       poses of SMPL joints as axis-angle

    What is lost on the way is told. Samples do not become keys: that is
    `mocurve reduce`.

    For example:
      mocurve convert jump.curves.json jump.glb
      mocurve convert walk.asf+walk.amc walk.bvh
      mocurve convert walk.bvh run.bvh both.glb --tolerance 2mm --no-mesh
    """
    if not target:
        raise OptionError("a second file name is needed: where the clip goes")
    sources, goal = [source, *target[:-1]], target[-1]
    reading, writing = split_options(options, read, write)
    for each in sources:
        check_outputs(each, goal)
    format_of(goal)  # refused before work is done
    clips = [read(each, **reading) for each in sources]
    write(goal, clips[0] if len(clips) == 1 else dict(zip(_names(sources), clips, strict=True)), **writing)
    print(f"wrote {goal}")


def _names(paths: list[Path]) -> list[str]:
    """A name for each animation: the file's without its extension, numbered where it would stand twice."""
    names: list[str] = []
    for path in paths:
        stem = path.name.split(".")[0] or path.name
        same = sum(name == stem or name.startswith(f"{stem} ") for name in names)
        names.append(f"{stem} {same + 1}" if same else stem)
    return names
