"""Recipes: verbs one after the other, as a person writes them down or as the history of a clip has them.

A step is {"verb": name, option: value, ...}. Where a verb takes a second clip, "with" says which: a file, or the steps
that make it, beginning with {"verb": "read", "file": name}; a verb that takes several gets a list of these.
"""

from __future__ import annotations

import inspect
import json
import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from os import PathLike, fsdecode
from pathlib import Path
from types import NoneType, UnionType
from typing import Any, Union, get_args, get_origin, get_type_hints

from . import edit, progress
from .errors import FileError, MocurveError, OptionError, UnknownName
from .formats import format_of, read
from .motion import Clip

VERBS = {  # name -> module, loaded when a recipe has it
    "denoise": "denoising",
    "reduce": "reduction",
    "refine": "reduction",
    "fit": "fitting",
    **{name: f"edit.{module}" for name, module in edit.VERBS.items()},
}
READ = "read"
TOLD = ("verb", "with", "measured", "table")  # of a step of a history: what is no option
CLIPS = ("Clip", "AnyClip", "Motion", "KeyedMotion", "SplineMotion")  # the nouns in signatures
DEEPEST = 20  # recipes within recipes
LARGEST = 16_000_000  # bytes of a recipe
WORDS = {bool: "true or false", int: "a whole number", float: "a number", str: "a text", Mapping: "a table"}

Steps = Sequence[Mapping[str, Any]]


def run(clip: Clip | None, recipe: str | PathLike[str] | Steps) -> Clip:
    """The clip after all steps of a recipe, each as the verb of that name does it.

    recipe: a file (.toml with [[steps]], .json with a list of steps, or a clip that carries a history), or the steps
    themselves, such as another clip's `history`. A first step `read` counts only where no clip is given. Files that a
    recipe names are looked for beside it, then in the working folder.

    All steps are checked before the first is done. Errors: OptionError that names the step, FileError for a recipe that
    cannot be read.

    >>> calm = mc.run(mc.read("walk.bvh"), [{"verb": "denoise"}, {"verb": "reduce", "tolerance": "2mm"}])
    """
    folder, place = Path(), ""
    if isinstance(recipe, str | PathLike):
        folder, place = Path(recipe).parent, f"{fsdecode(recipe)}: "
        recipe = _steps_of(Path(recipe))
    return _done(clip, _prepared(recipe, folder, place, 0), place)


def hints(verb: Callable[..., Any]) -> dict[str, Any]:
    """What each option of a verb may be; clips count as anything, and their modules need not be loaded."""
    return get_type_hints(verb, {**vars(inspect.getmodule(verb)), **dict.fromkeys(CLIPS, Any)})


# -- in call order ---------------------------------------------------------------------------------


@dataclass(frozen=True)
class Prepared:
    """A step, checked. others: the further clips that it takes, each a file or steps of its own."""

    name: str
    call: Callable[..., Clip]
    options: dict[str, Any]
    others: tuple[Path | list[Prepared], ...] = ()


def _steps_of(path: Path) -> Steps:
    """The steps that a file holds."""
    lower = path.name.lower()
    try:
        format_of(path)
    except OptionError:
        if not lower.endswith((".toml", ".json")):
            raise OptionError(f"{path}: a recipe is a .toml or .json file, or a clip that carries a history") from None
    else:
        return read(path).history
    with path.open("rb") as file:
        raw = file.read(LARGEST + 1)
    if len(raw) > LARGEST:
        raise FileError(f"a recipe has at most {LARGEST // 1_000_000} MB", path)
    try:
        text = raw.decode("utf-8")
        data = tomllib.loads(text) if lower.endswith(".toml") else json.loads(text)
    except RecursionError as error:
        raise FileError("nested too deep", path) from error
    except ValueError as error:  # of TOML, of JSON, of UTF-8: each says where
        raise FileError(str(error), path) from error
    if isinstance(data, dict):
        for name in data:
            if name != "steps":
                raise FileError(str(UnknownName("part of a recipe", name, ["steps"])), path)
        data = data.get("steps", [])
    if not isinstance(data, list):
        raise FileError("a recipe is a list of steps", path)
    return data


def _prepared(steps: object, folder: Path, place: str, depth: int) -> list[Prepared]:
    """All steps, checked; files are looked for, but not read."""
    if depth > DEEPEST:
        raise OptionError(f"{place}recipes within recipes go {DEEPEST} deep at most")
    if not isinstance(steps, Sequence) or isinstance(steps, str):
        raise OptionError(f"{place}a recipe is a list of steps, not {_short(steps)}")
    return [_step(step, folder, f"{place}step {i}", i, depth) for i, step in enumerate(steps, 1)]


def _step(step: object, folder: Path, place: str, number: int, depth: int) -> Prepared:
    name = step.get("verb") if isinstance(step, Mapping) else None
    if not isinstance(step, Mapping) or not isinstance(name, str):
        raise OptionError(f"{place}: a step is a table with a verb, not {_short(step)}")
    place = f"{place}, {name}"
    options = {option: value for option, value in step.items() if option not in TOLD}
    if name == READ:
        if number > 1:
            raise OptionError(f"{place}: only the first step can read a clip; others name theirs as with = 'file'")
        source = _file(options.pop("file", None), folder, place)
        return Prepared(name, lambda **given: read(source, **given), _checked(options, read, place, ["path"]))
    if name not in VERBS:
        raise OptionError(f"{place}: {UnknownName('verb', name, [READ, *VERBS])}")
    call = getattr(import_module(f"mocurve.{VERBS[name]}"), name)
    takes = inspect.signature(call).parameters
    clips = [n for n, p in takes.items() if any(word in CLIPS for word in _words(p.annotation))]
    others = _others(step.get("with"), folder, place, depth)
    several = any("Sequence" in _words(takes[n].annotation) for n in clips)
    needed = [n for n in clips if takes[n].default is inspect.Parameter.empty]
    if (not several and not len(needed) - 1 <= len(others) <= len(clips) - 1) or (several and not others):
        most = "other clips" if several else f"{('no', 'one')[len(clips) > 1]} other clip"
        raise OptionError(f"{place}: takes {most} (with = ...), not {len(others)}")
    return Prepared(name, call, _checked(_paths(options, call, folder, place), call, place, clips), others)


def _others(given: object, folder: Path, place: str, depth: int) -> tuple[Path | list[Prepared], ...]:
    """The clips that a step names: a file, several, steps that make one, or a list of such steps."""
    if given is None:
        return ()
    if isinstance(given, str):
        return (_file(given, folder, place),)
    if not isinstance(given, Sequence):
        raise OptionError(f"{place}: with names a file, or has the steps that make a clip, not {_short(given)}")
    if all(isinstance(step, Mapping) for step in given):
        if not given or given[0].get("verb") != READ:
            raise OptionError(
                f"{place}: from which file its other clip comes is not known (nothing in its history read one); say "
                "with = 'file'"
            )
        return (_prepared(given, folder, f"{place}, with: ", depth + 1),)
    return tuple(other for one in given for other in _others(one, folder, place, depth))


def _file(name: object, folder: Path, place: str) -> Path:
    """Where a file lies that a recipe names."""
    if not isinstance(name, str) or not name or "\0" in name:
        raise OptionError(f"{place}: the name of a file is a text, not {_short(name)}")
    for path in (folder / name, Path(name)):
        if _there(path):
            return path
    raise OptionError(f"{place}: there is no file {name!r}, beside the recipe or in the working folder")


def _there(path: Path) -> bool:
    """Whether there is such a file, or such a pair of files (walk.asf+walk.amc)."""
    parts = path.name.split("+") if path.name.lower().endswith(".amc") else [path.name]
    return all((path.parent / Path(part)).is_file() for part in parts)


def _paths(options: dict[str, Any], call: Callable[..., Any], folder: Path, place: str) -> dict[str, Any]:
    """The same with paths over the ground read where they are named as files."""
    from .path import Path as Way

    kinds = hints(call)
    try:
        return {
            name: Way.read(_file(value, folder, place))
            if isinstance(value, str) and Way in _kinds(kinds.get(name))
            else value
            for name, value in options.items()
        }
    except FileError as error:
        raise OptionError(f"{place}: {error}") from error


def _checked(options: dict[str, Any], call: Callable[..., Any], place: str, clips: Sequence[str]) -> dict[str, Any]:
    """The options of a verb; OptionError for one that it has not, for a missing one, for a value that none can be."""
    takes, kinds = inspect.signature(call).parameters, hints(call)
    known = [name for name in takes if name not in clips]
    for name, value in options.items():
        if name not in known:
            raise OptionError(f"{place}: {UnknownName('option', name, known)}")
        if not fits(value, kinds[name]):
            raise OptionError(f"{place}: {name} is {_told(kinds[name])}, not {_short(value)}")
    for name in known:
        if takes[name].default is inspect.Parameter.empty and name not in options:
            raise OptionError(f"{place}: {name} is missing ({_told(kinds[name])})")
    return options


def fits(value: object, kind: Any) -> bool:
    """Whether a value, as JSON and TOML have them, is of a kind that an annotation names."""
    origin, inner = get_origin(kind), get_args(kind)
    if origin in (Union, UnionType):
        return any(fits(value, each) for each in inner)
    if kind in (None, NoneType):
        return value is None
    if kind in (bool, str):
        return isinstance(value, kind)
    if kind in (int, float):
        return isinstance(value, int | (float if kind is float else int)) and not isinstance(value, bool)
    if origin is tuple:
        return isinstance(value, list | tuple) and len(value) == len(inner) and all(map(fits, value, inner))
    if origin is not None and issubclass(origin, Mapping):
        return isinstance(value, Mapping) and all(fits(each, inner[1]) for each in value.values())
    if origin is not None and issubclass(origin, Sequence):
        return isinstance(value, list | tuple) and all(fits(each, inner[0]) for each in value)
    return kind is Any or origin is None


def _told(kind: Any) -> str:
    """A kind of value in words."""
    words = [WORDS.get(get_origin(each) or each, "a list") for each in _kinds(kind) if each not in (None, NoneType)]
    return ", or ".join(dict.fromkeys(words))


def _kinds(kind: Any) -> tuple[Any, ...]:
    """The kinds that an annotation allows."""
    return get_args(kind) if get_origin(kind) in (Union, UnionType) else (kind,)


def _words(annotation: object) -> list[str]:
    """The names in an annotation, which `from __future__ import annotations` keeps as text."""
    return "".join(letter if letter.isalnum() else " " for letter in str(annotation)).split()


def _short(value: object) -> str:
    told = repr(value)
    return told if len(told) <= 60 else f"{told[:57]}..."


def _done(clip: Clip | None, steps: Sequence[Prepared], place: str) -> Clip:
    for i, step in enumerate(steps, 1):
        progress.advance("recipe", i - 1, len(steps))
        try:
            if step.name == READ:
                clip = step.call(**step.options) if clip is None else clip
                continue
            if clip is None:
                raise OptionError("no clip is given, and no step reads one")
            others = [read(o) if isinstance(o, Path) else _done(None, o, "") for o in step.others]
            clip = step.call(**_clips(step.call, clip, others), **step.options)
        except MocurveError as error:
            raise OptionError(f"{place}step {i}, {step.name}: {error}") from error
    progress.advance("recipe", len(steps), len(steps))
    if clip is None:
        raise OptionError(f"{place}no clip is given, and no step reads one")
    return clip


def _clips(call: Callable[..., Clip], clip: Clip, others: Sequence[Clip]) -> dict[str, Any]:
    """The arguments of a verb that are clips: the one called so, or else the first, is what has come so far."""
    takes = inspect.signature(call).parameters
    names = [name for name, one in takes.items() if any(word in CLIPS for word in _words(one.annotation))]
    if "Sequence" in _words(takes[names[0]].annotation):
        return {names[0]: [clip, *others]}
    main = "clip" if "clip" in names else names[0]
    rest = [name for name in names if name != main]
    return {main: clip, **dict(zip(rest, others, strict=False))}
