"""How a command gets its options: from the verb's own signature and docstring, so that they are written once."""

from __future__ import annotations

import inspect
import json
import os
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Annotated, Any, get_type_hints

from cyclopts import Parameter

from ..errors import OptionError

Source = Annotated[Path, Parameter(help="A clip: .bvh .npz, or keys: .curves.json")]
Json = Annotated[bool, Parameter(show_default=False, help="Print one JSON object and nothing else.")]
Html = Annotated[Path | None, Parameter(help="Write a page to look at here (one file, works without a network).")]
Unit = Annotated[
    str | None,
    Parameter(
        help="Length unit of the file: mm, cm, m, in, ft, or metres as a number. Else guessed from the body's height."
    ),
]


def with_options_of(verb: Callable[..., Any]) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Give a command the keyword-only options of a verb in place of its own **options: names, types, defaults and help.

    The help of an option is what the verb's docstring says after its name.
    """
    hints, told = get_type_hints(verb), _told(verb.__doc__ or "")
    taken = [
        option.replace(
            annotation=Annotated[
                _typed(hints[option.name]),
                Parameter(help=told[option.name], show_default=option.default not in (None, False, ())),
            ]
        )
        for option in inspect.signature(verb).parameters.values()
        if option.kind is option.KEYWORD_ONLY
    ]

    def give(command: Callable[..., None]) -> Callable[..., None]:
        own = get_type_hints(command, include_extras=True)
        kept = [p for p in inspect.signature(command).parameters.values() if p.kind is not p.VAR_KEYWORD]
        parameters = [p.replace(annotation=own[p.name]) for p in kept] + taken
        command.__annotations__ = {p.name: p.annotation for p in parameters}
        command.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]  # what inspect.signature reads
        return command

    return give


def _typed(hint: Any) -> Any:
    """One text or several becomes a list: on the command line the option is repeated."""
    if hint == str | Sequence[str] | None:
        return list[str] | None
    return list[str] if hint in (str | Sequence[str], str | list[str]) else hint


def _told(docstring: str) -> dict[str, str]:
    """{"tolerance": "How far ..."} from lines "tolerance: How far ..." or "tolerance", and the deeper ones after."""
    told: dict[str, str] = {}
    name, indent = "", 0
    for line in inspect.cleandoc(docstring).splitlines():
        depth = len(line) - len(line.lstrip())
        if name and depth > indent:
            told[name] = f"{told[name]} {line.strip()}".lstrip()
        elif start := re.fullmatch(r" *(\w+)(?:: +(.+))?", line):
            name, indent = start[1], depth
            told[name] = start[2] or ""
        else:
            name = ""
    return told


def check_outputs(source: Path, *outputs: Path | None) -> None:
    """OptionError where a command would write over the file that it reads, or into a folder that is not there.

    Asked before the work starts: it may take minutes.
    """
    for output in outputs:
        if output is None:
            continue
        if not output.parent.is_dir():
            raise OptionError(f"{output}: there is no folder {output.parent}")
        if output.exists() and source.exists() and os.path.samefile(source, output):
            raise OptionError(f"{output} is the file that is read; write the result elsewhere")


def tell(found: Any, as_json: bool, *written: Path | None) -> None:
    """What was found, as one JSON object on stdout or as text and the files that were written."""
    if as_json:
        print(json.dumps(found.to_json(), allow_nan=False))  # NaN is no JSON
        return
    print(found)
    for path in written:
        if path is not None:
            print(f"wrote {path}")
