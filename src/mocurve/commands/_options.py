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
from ..recipe import hints

Source = Annotated[
    Path, Parameter(help="A clip: .bvh .glb .npz .c3d .asf+.amc, or keys: .curves.json (all: mocurve convert --help)")
]
Profile = Annotated[
    str | None, Parameter(help="How, where a format knows several ways; mocurve convert --help tells them.")
]
Json = Annotated[bool, Parameter(show_default=False, help="Print one JSON object and nothing else.")]
Html = Annotated[Path | None, Parameter(help="Write a page to look at here (one file, works without a network).")]
Unit = Annotated[
    str | None,
    Parameter(
        help="Length unit of the file: mm, cm, m, in, ft, or metres as a number. Else guessed from the body's height."
    ),
]


def with_options_of(*verbs: Callable[..., Any]) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Give a command the keyword-only options of verbs in place of its own **options: names, types, defaults and help.

    What the command has itself under that name stays its own. The help of an option is what the verb's docstring says
    after its name.
    """
    taken = [option for verb in verbs for option in _options(verb)]

    def give(command: Callable[..., None]) -> Callable[..., None]:
        own = get_type_hints(command, include_extras=True)
        kept = [p for p in inspect.signature(command).parameters.values() if p.kind is not p.VAR_KEYWORD]
        parameters = [p.replace(annotation=own[p.name]) for p in kept] + [p for p in taken if p.name not in own]
        command.__annotations__ = {p.name: p.annotation for p in parameters}
        command.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]  # what inspect.signature reads
        return command

    return give


def _options(verb: Callable[..., Any]) -> list[inspect.Parameter]:
    kinds, told = hints(verb), _told(verb.__doc__ or "")
    options = []
    for option in inspect.signature(verb).parameters.values():
        if option.kind is option.KEYWORD_ONLY:
            off = f"--no-{option.name.replace('_', '-')}" if option.default is True else ()
            several = kinds[option.name] == Sequence[int | str] | None  # --pin 30 70, as well as --pin 30 --pin 70
            given = Parameter(help=told[option.name], negative=off, consume_multiple=several)
            options.append(option.replace(annotation=Annotated[_typed(kinds[option.name]), given]))
    return options


def split_options(options: dict[str, Any], *verbs: Callable[..., Any]) -> list[dict[str, Any]]:
    """The options of each verb, out of those that a command got."""
    return [{name: options[name] for name in inspect.signature(verb).parameters if name in options} for verb in verbs]


def _typed(hint: Any) -> Any:
    """One text or several becomes a list: on the command line the option is repeated."""
    if hint == str | Sequence[str] | None:
        return list[str] | None
    if hint == str | os.PathLike[str] | None:
        return Path | None
    if hint == str | float | None:
        return str | None
    if hint == Sequence[int | str] | None:
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
