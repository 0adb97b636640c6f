"""Commands run in this process, and what they say."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from mocurve import cli


def ran(capsys: pytest.CaptureFixture[str], *words: str | Path) -> str:
    """What a command prints that has nothing to warn of."""
    assert cli.main([str(word) for word in words]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    return out


def run(capsys: pytest.CaptureFixture[str], *words: str | Path) -> dict:
    """What a command tells with --json."""
    assert cli.main([*(str(word) for word in words), "--json"]) == 0
    out, _ = capsys.readouterr()
    found: dict = json.loads(out)
    return found


def refused(capsys: pytest.CaptureFixture[str], *words: str | Path) -> str:
    """The one line on stderr of a command that has to be refused with exit code 2."""
    assert cli.main([str(word) for word in words]) == cli.REFUSED
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    return err
