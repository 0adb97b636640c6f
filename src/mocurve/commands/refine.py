"""`mocurve refine`: keys polished."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from .. import measure, reduction
from ..errors import OptionError
from ..formats import read, write
from ..keyed import KeyedMotion
from ._options import Html, Json, Source, Unit, check_outputs, tell
from ._terminal import told_when_compiling

Keys = Annotated[Path, Parameter(help="Keys: .curves.json")]
Output = Annotated[Path, Parameter(name=("--output", "-o"), help="Where the polished keys go: .curves.json")]


@told_when_compiling()
def refine(
    keys: Keys, clip: Source, /, *, output: Output, html: Html = None, unit: Unit = None, json: Json = False
) -> None:
    """The same number of keys, moved until they follow the clip better.

    Dynamic programming over the keys' times, values and slopes. Works on keys from
    any method, and on keys that an animator moved.

    For example:
      mocurve refine jump.curves.json jump.bvh -o polished.curves.json
    """
    check_outputs(keys, output, html)
    check_outputs(clip, output, html)
    given = read(keys, unit=unit)
    if not isinstance(given, KeyedMotion):
        raise OptionError(f"{keys} holds samples and no keys; `mocurve reduce` makes keys of them")
    original = read(clip, unit=unit)
    polished = reduction.refine(given, original)
    write(output, polished)
    report = measure.compare(original, polished)
    if html is not None:
        report.save(html)
    tell(report, json, output, html)
