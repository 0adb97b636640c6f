"""Paths seen from above: what is drawn where, as picture and as page."""

from __future__ import annotations

from pathlib import Path as File

import numpy as np
import pytest
from paths import laid
from PIL import Image
from walks import PERIOD, walk

import mocurve as mc
from mocurve import OptionError, draw_path
from mocurve.path import Path

RED, GREEN, BLUE = (192, 57, 43), (30, 132, 73), (27, 73, 125)


def amount(image: Image.Image, colour: tuple[int, int, int]) -> int:
    """Pixels of about this colour."""
    return int((np.abs(np.asarray(image.convert("RGB")).astype(int) - colour).max(axis=2) < 40).sum())


def test_the_own_path_is_red_and_a_new_one_green() -> None:
    clip, new = walk(2 * PERIOD), mc.Path([(0, 0), (200, 0), (200, 200)])
    own = Path.of(clip)
    alone = draw_path.picture(clip, own, None, None, width=500)
    both = draw_path.picture(clip, own, laid(clip, new), new, width=500)
    assert min(amount(alone, RED), amount(both, RED), amount(both, GREEN), 2 * amount(both, BLUE)) > 200
    assert amount(alone, GREEN) == 0


@pytest.mark.parametrize("extension", [".png", ".html"])
def test_it_is_written_as_picture_and_as_page(extension: str, tmp_path: File) -> None:
    clip = walk(PERIOD)
    draw_path.save(tmp_path / f"a{extension}", clip, Path.of(clip), numbers="3 < 4", width=300)
    raw = (tmp_path / f"a{extension}").read_bytes()
    if extension == ".png":
        assert raw.startswith(b"\x89PNG")
    else:
        assert b"data:image/png;base64,iVBOR" in raw
        assert b"3 &lt; 4" in raw
        assert b"http" not in raw  # complete in itself


def test_a_body_that_stands_can_be_drawn(tmp_path: File) -> None:
    clip = walk(3)[:1]
    draw_path.save(tmp_path / "a.png", clip, Path.of(clip))
    assert (tmp_path / "a.png").exists()


def test_other_extensions_and_widths_are_refused(tmp_path: File) -> None:
    clip = walk(PERIOD)
    with pytest.raises(OptionError, match=r"the extension of this picture is \.png, \.html or \.gif, not '\.jpg'"):
        draw_path.save(tmp_path / "a.jpg", clip, Path.of(clip))
    with pytest.raises(OptionError, match="width is from 200 to 4096 pixels, not 5"):
        draw_path.save(tmp_path / "a.png", clip, Path.of(clip), width=5)
