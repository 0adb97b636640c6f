"""Noise out, motion kept: `denoise` for clips, `clean` for plain arrays."""

from .cleaning import clean as clean
from .verb import denoise as denoise
