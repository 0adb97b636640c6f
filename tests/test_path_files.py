"""Paths in files: what was written is read, what others draw too, and what is no path is told with its line."""

from __future__ import annotations

from pathlib import Path as File

import numpy as np
import pytest

import mocurve as mc
from mocurve import FileError
from mocurve.path import Fit, Path

DICE = np.random.default_rng(0)
PATHS = {
    "cubic": Path(DICE.normal(0, 100, (9, 2))),
    "line": Path([(0, 0), (3, 4)]),
    "heights": Path(DICE.normal(0, 100, (9, 3)), degree=5, fit=Fit(9, 5, height=True)),
    "polynomial": Path(DICE.normal(0, 100, (12, 2)), kind="polynomial"),
    "knots": Path(DICE.normal(0, 100, (5, 2)), knots=np.array([0, 0, 0, 0, 0.3, 1, 1, 1, 1])),
}


@pytest.mark.parametrize("name", PATHS)
@pytest.mark.parametrize("extension", [".csv", ".json"])
def test_what_was_written_is_read_to_the_last_digit(name: str, extension: str, tmp_path: File) -> None:
    path, file = PATHS[name], tmp_path / f"path{extension}"
    path.write(file)
    again = mc.Path.read(file)
    assert again.points.tobytes() == path.points.tobytes()
    assert (again.degree, again.kind, again.fit) == (path.degree, path.kind, path.fit)
    assert again.knots.tobytes() == path.knots.tobytes()


@pytest.mark.parametrize("name", ["cubic", "line", "knots"])
def test_svg_is_the_same_curve(name: str, tmp_path: File) -> None:
    path, file = PATHS[name], tmp_path / "path.svg"
    path.write(file)
    again = mc.Path.read(file)
    assert again.length == pytest.approx(path.length, rel=1e-9)
    at = np.linspace(0, path.length, 200)
    np.testing.assert_allclose(again.at(at)[0], path.at(at)[0], atol=1e-6)


@pytest.mark.parametrize(
    ("name", "text", "points"),
    [
        ("a.csv", "0,1\n2,3\n", [(0, 1), (2, 3)]),
        ("a.csv", "\ufeffx,z\r\n0,1\r\n2,3\r\n", [(0, 1), (2, 3)]),
        ("a.csv", "z;x\n0;1\n2;3\n", [(1, 0), (3, 2)]),
        ("a.csv", "x,y,z\n0,1,2\n3,4,5\n", [(0, 1, 2), (3, 4, 5)]),
        ("a.csv", "# drawn by hand\n\n0 1\n2 3\n", [(0, 1), (2, 3)]),
        ("a.csv", '"name","x","z"\na,0,1\nb,2,3\n', [(0, 1), (2, 3)]),
        ("a.json", "[[0, 1], [2, 3]]", [(0, 1), (2, 3)]),
        ("a.json", '{"points": [[0, 1], [2, 3]]}', [(0, 1), (2, 3)]),
    ],
)
def test_points_are_read_as_people_write_them(name: str, text: str, points: list, tmp_path: File) -> None:
    (tmp_path / name).write_text(text, encoding="utf-8")
    np.testing.assert_array_equal(mc.Path.read(tmp_path / name).points, np.array(points, float))


@pytest.mark.parametrize(
    ("data", "through"),
    [
        ("M 0 0 L 10 0 10 10", [(0, 0), (10, 0), (10, 10)]),
        ("m5,5h10v10H5V5z", [(5, 5), (15, 5), (15, 15), (5, 15), (5, 5)]),
        ("M0 0C0 10 10 10 10 0S20-10 20 0", [(0, 0), (5, 7.5), (10, 0), (15, -7.5), (20, 0)]),
        ("M0 0Q5 10 10 0T20 0", [(0, 0), (5, 5), (10, 0), (15, -5), (20, 0)]),
        ("m0 0q5 10 10 0t10 0l1e1.5", [(0, 0), (5, 5), (20, 0), (30, 0.5)]),
        ("M0 0c0 10 10 10 10 0s10-10 10 0", [(0, 0), (5, 7.5), (15, -7.5), (20, 0)]),
    ],
)
def test_lines_of_vector_programs_go_where_they_were_drawn(data: str, through: list, tmp_path: File) -> None:
    file = tmp_path / "a.svg"
    file.write_text(f'<svg xmlns="http://www.w3.org/2000/svg"><g><path style="fill:none" d="{data}"/></g></svg>')
    path = mc.Path.read(file)
    drawn = path.place(np.linspace(0, 1, 20001))
    away = [np.linalg.norm(drawn - point, axis=1).min() for point in through]
    assert max(away) < 2e-3
    np.testing.assert_allclose(path.points[[0, -1]], np.array(through, float)[[0, -1]], atol=1e-12)
    file.write_text(data)  # the bare attribute says the same
    assert mc.Path.read(file).points.tobytes() == path.points.tobytes()


@pytest.mark.parametrize(
    ("name", "text", "told"),
    [
        ("a.csv", "", "a.csv: a path has two points or more, here is none"),
        ("a.csv", "x,z\n1,2\n", "a.csv: a path has two points or more, here is one"),
        ("a.csv", "1,2\n3,nan\n", "a.csv:2: column 2: a number expected, 'nan' found"),
        ("a.csv", "x,z\n1,2\n3,\n", "a.csv:3: column 2: a number expected, '' found"),
        ("a.csv", "1,2\n3\n", "a.csv:2: 2 cells expected as in the first row, 1 found"),
        ("a.csv", "1,2\n1e300,4\n", "a.csv:2: column 1: a number up to 1e+12 expected, '1e300' found"),
        ("a.csv", "a,b\n1,2\n3,4\n", "a.csv:1: the columns of a path are x,z or x,y,z, not a,b"),
        ("a.csv", "1,2,3,4\n1,2,3,4\n", "a.csv:1: a point has two numbers x,z or three x,y,z; 4 found"),
        ("a.csv", "\n1,2\n1,2\n1,2\n", "a.csv:2: all points are in one place: the path has no length"),
        ("a.csv", '# mocurve path {"degree": 0}\n1,2\n3,4\n', "the degree of a path is a whole number"),
        ("a.csv", '# mocurve path {"fit": {"points": "x"}}\n1,2\n3,4\n', "a path has 2 to 100000 points, not 'x'"),
        ("a.json", "[[1, 2],\n [3, NaN]]", "a.json:1: not JSON: NaN is no number of JSON"),
        ("a.json", "[[1, 2],\n [3, }]", "a.json:2: column 6: not JSON"),
        ("a.json", "[[1, 2], [3]]", "a.json:1: point 2 is not two numbers x, z, or three x, y, z as all are"),
        ("a.json", '{"points": [[0, 0], [1, 1]], "degre": 3}', "a path has no 'degre'"),
        ("a.json", "[" * 100_000, "nested too deep"),
        ("a.json", "[[0, 0], [0, 0]]", "all points are in one place"),
        ("a.json", "[[1, 2], [3, 1" + "0" * 400 + "]]", "a number is too large"),
        ("a.svg", "<svg/>", "a.svg:1: no line is drawn in it"),
        ("a.svg", '<svg>\n<path d="M 0 0"/></svg>', "a.svg:2: a path has two points or more"),
        ("a.svg", "M 0 0\nA 1 1 0 0 0 5 5", "a.svg:2: 'A' is not read: M L H V C S Q T Z are; turn arcs into curves"),
        ("a.svg", "M 0 0\n L 5 5\n M 3 3", "a.svg:3: the line breaks off and starts again"),
        ("a.svg", "L 1 1", "a line begins with M, not with 'L'"),
        ("a.svg", "M 0 0 L 1", "L takes 2 numbers a segment"),
        ("a.svg", "M 0 0 L 1e999 0", "'1e999' is too large a number"),
        ("a.svg", "M 0 0 L 0 0 z", "a.svg:1: all points are in one place"),
        ("a.svg", '<path d="M0,0L1,1"/>\n<path d="M0,0L1,1"/>', "a.svg:2: 2 lines are drawn in it"),
        ("a.txt", "0,0\n1,1", "a path is in a file .csv, .json, .svg, not '.txt'"),
    ],
)
def test_what_is_no_path_is_told_in_a_sentence(name: str, text: str, told: str, tmp_path: File) -> None:
    (tmp_path / name).write_text(text, encoding="utf-8")
    with pytest.raises(FileError) as error:
        mc.Path.read(tmp_path / name)
    assert told in str(error.value)
    assert "\n" not in str(error.value)


def test_bytes_that_are_no_text_are_told_with_their_line(tmp_path: File) -> None:
    (tmp_path / "a.csv").write_bytes(b"1,2\n3,\xff\n")
    with pytest.raises(FileError, match=r"a\.csv:2: is not text in UTF-8"):
        mc.Path.read(tmp_path / "a.csv")


def test_a_file_that_is_not_there_is_told(tmp_path: File) -> None:
    with pytest.raises(FileError, match="no such file"):
        mc.Path.read(tmp_path / "none.csv")


def test_a_doubled_point_is_a_corner_and_is_told(tmp_path: File) -> None:
    (tmp_path / "a.csv").write_text("x,z\n0,0\n5,5\n5,5\n9,0\n9,9\n")
    with pytest.warns(UserWarning, match=r"a\.csv:4: the point is where the one before it is"):
        assert len(mc.Path.read(tmp_path / "a.csv").points) == 5


def test_a_point_straight_above_another_is_told(tmp_path: File) -> None:
    (tmp_path / "a.csv").write_text("0,0,0\n0,0,20\n0,60,20\n0,60,60\n")
    with pytest.warns(UserWarning, match=r"a\.csv:3: the point is straight above or below the one before it"):
        assert len(mc.Path.read(tmp_path / "a.csv").points) == 4


def test_a_path_straight_up_is_refused(tmp_path: File) -> None:
    (tmp_path / "a.csv").write_text("x,y,z\n0,0,5\n0,50,5\n")
    with pytest.raises(FileError, match=r"a\.csv:2: the path goes straight up: it has no way over the ground"):
        mc.Path.read(tmp_path / "a.csv")


def test_a_transform_that_is_not_done_is_told(tmp_path: File) -> None:
    (tmp_path / "a.svg").write_text('<svg><path transform="scale(2)" d="M0 0L1 1"/></svg>')
    with pytest.warns(UserWarning, match="transform is not looked at"):
        mc.Path.read(tmp_path / "a.svg")


def test_high_degrees_have_no_svg_and_leave_no_file(tmp_path: File) -> None:
    with pytest.raises(mc.OptionError, match=r"up to degree 3, not 5: write \.json or \.csv"):
        PATHS["heights"].write(tmp_path / "a.svg")
    assert not list(tmp_path.iterdir())
