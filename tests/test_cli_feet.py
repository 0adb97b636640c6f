"""`mocurve contacts` and `mocurve lock-feet`, as a person meets them."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from commands import ran, refused

import mocurve as mc


def test_contacts_are_a_table_with_a_time_line(jump: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = ran(capsys, "contacts", jump).splitlines()
    assert out[0].split() == ["joint", "first", "last", "seconds", "place"]
    rows = [line.split() for line in out[1:13]]
    assert {row[0] for row in rows} == {"LeftToeBase", "RightToeBase", "LeftFoot", "RightFoot"}
    assert all(int(row[1]) <= int(row[2]) and float(row[3]) <= float(row[4]) for row in rows)
    lines = out[13:]
    assert len(lines) == 4
    assert all(len(line.split("|")[1]) == 60 for line in lines)
    assert "##########        ###" in lines[0]


def test_contacts_are_one_json_object_or_a_file(jump: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    told = json.loads(ran(capsys, "contacts", jump, "--json", "-o", tmp_path / "c.json"))
    assert told == json.loads((tmp_path / "c.json").read_text())
    assert (told["frames"], len(told["contacts"])) == (420, 12)
    first = told["contacts"][0]
    assert first.keys() == {"joint", "first", "last", "place", "seconds"}
    assert first["seconds"] == [first["first"] / 120, first["last"] / 120]
    slow = json.loads(ran(capsys, "contacts", jump, "--json", "--speed", "5"))
    assert slow["contacts"] != told["contacts"]


def test_feet_are_locked_with_contacts_from_a_file(
    jump: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    listed, locked = tmp_path / "c.json", tmp_path / "locked.bvh"
    ran(capsys, "contacts", jump, "-o", listed)
    told = json.loads(ran(capsys, "lock-feet", jump, "-o", locked, "--contacts", listed, "--json"))
    assert told["verb"] == "lock_feet"
    assert told["measured"]["speed"] < 1e-6
    assert told["changed"]["turned"]["by"] > 0.5
    out = ran(capsys, "lock-feet", locked, "-o", tmp_path / "again.bvh")
    assert "6 stances, 0 of them held anew" in out
    some = json.loads(listed.read_text())["contacts"][:1]
    listed.write_text(json.dumps(some))
    few = json.loads(ran(capsys, "lock-feet", jump, "-o", locked, "--contacts", listed, "--json"))
    assert few["measured"]["stances"] == 1
    assert mc.read(locked).frames == 420


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("{", "c.json: no JSON"),
        ("{}", "c.json: no list of contacts"),
        ('{"contacts": 3}', "no list of contacts"),
        ("[3]", "a contact is an object with joint, first, last and place, not 3"),
        ('[{"joint": "LeftToe", "first": 0, "last": 9, "place": [0, 0, 0]}]', "Did you mean 'LeftToeBase'"),
        ("[" * 100_000, "no JSON"),
    ],
)
def test_a_file_that_holds_no_contacts_is_refused(
    text: str, told: str, jump: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "c.json").write_text(text)
    arguments = ["lock-feet", jump, "-o", tmp_path / "l.bvh", "--contacts", tmp_path / "c.json"]
    assert told in refused(capsys, *arguments)
    assert not (tmp_path / "l.bvh").exists()


def test_other_refusals_are_one_line(jump: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    target = tmp_path / "l.bvh"
    assert "no such file" in refused(capsys, "lock-feet", jump, "-o", target, "--contacts", tmp_path / "no.json")
    assert "speed is a positive number" in refused(capsys, "lock-feet", jump, "-o", target, "--speed", "0")
    assert "Did you mean" in refused(capsys, "contacts", jump, "--feet", "LeftToe", "--feet", "RightToeBase")
    assert "is the file that is read" in refused(capsys, "contacts", jump, "-o", jump)
    assert not target.exists()
