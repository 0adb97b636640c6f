"""The command line: `mocurve NAME ...`. Which commands there are: commands/; how they end: here.

Whatever data or options can cause ends as one line on stderr and exit code 2; only a bug shows a traceback.
"""

from __future__ import annotations

import os
import sys
import warnings
from collections.abc import Callable, Sequence
from io import TextIOWrapper

from cyclopts import App, CycloptsError, Group, Parameter

from . import __version__
from .commands import COMMANDS, GROUPS
from .commands._terminal import Bar
from .errors import MocurveError, UnknownName
from .progress import listening

EXAMPLE = """Try it:
  mocurve example
  mocurve reduce jump.bvh -o jump.curves.json --html jump.html"""
FLAGS = ("--help", "-h", "--version")
REFUSED, INTERRUPTED, PIPE_CLOSED = 2, 130, 141  # exit codes; the last two as a shell reports the signals


def application(asked: str | None = None) -> App:
    """All commands under one roof. Only the one that is asked for is loaded; the others tell their line in COMMANDS."""
    app = App(
        name="mocurve",
        help="Motion capture into few, editable curves with a promise (no joint moves more than the tolerance), and "
        "what can be done with them.",
        help_epilogue=None if asked in COMMANDS else EXAMPLE,
        help_format="plaintext",
        version=f"mocurve {__version__}",
        default_parameter=Parameter(negative=()),
        group_parameters="Options",
        exit_on_error=False,
        print_error=False,
        suppress_keyboard_interrupt=False,
        result_action="return_value",
    )
    app["--help"].group = app["--version"].group = Group("Also", sort_key=len(GROUPS))
    for place, (title, commands) in enumerate(GROUPS.items()):
        group = Group(title, sort_key=place)
        for row, (name, summary) in enumerate(commands.items()):
            told = None if name == asked else summary
            home = name.replace("-", "_")
            app.command(f"mocurve.commands.{home}:{home}", name=name, help=told, group=group, sort_key=row)
    return app


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; what the process is to end with. Arguments default to the command line's."""
    tokens = sys.argv[1:] if arguments is None else list(arguments)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # a joint may be called in letters that the terminal lacks
    asked = tokens[0] if tokens and tokens[0] not in FLAGS else None
    try:
        if asked is not None and asked not in COMMANDS:
            raise UnknownName("command", asked, [*COMMANDS, *FLAGS])
        with warnings.catch_warnings(), Bar() as bar, listening(bar):
            warnings.simplefilter("always", UserWarning)
            warnings.showwarning = _told_once()
            application(asked)(tokens)
            sys.stdout.flush()  # a closed pipe shows here, not at exit
    except CycloptsError as error:
        return _refuse(f"{error} See: mocurve {asked} --help")
    except KeyboardInterrupt:
        return INTERRUPTED
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # Python flushes once more at exit
        return PIPE_CLOSED
    except MocurveError as error:
        return _refuse(str(error))
    except OSError as error:
        place = f"{error.filename}: " if error.filename is not None else ""
        return _refuse(f"{place}{error.strerror or error}")
    except MemoryError:
        return _refuse("not enough memory")
    return 0


def _refuse(text: str) -> int:
    print("mocurve:", " ".join(text.split()), file=sys.stderr)
    return REFUSED


def _told_once() -> Callable[..., None]:
    """Shows each warning as one line on stderr, the same words only once."""
    told: set[str] = set()

    def show(message: Warning | str, *_: object) -> None:
        text = " ".join(str(message).split())
        if text not in told:
            told.add(text)
            print("warning:", text, file=sys.stderr)

    return show


if __name__ == "__main__":
    sys.exit(main())
