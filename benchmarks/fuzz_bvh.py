"""Mutated BVH files for some minutes: no crash, no hang, and nothing accepted that a slow plain reader reads otherwise.

python benchmarks/fuzz_bvh.py 10        # minutes
"""

from __future__ import annotations

import math
import random
import re
import sys
import tempfile
import time
import warnings
from collections import Counter
from pathlib import Path

import numpy as np

import mocurve as mc
from mocurve.formats import _bvh_rows

CHUNKS = (64, 500, _bvh_rows.CHUNK)  # small ones put the seams between chunks everywhere
SLOWEST = 1.0  # seconds of the processor that a small file may take
HEAD = 100_000  # bytes of a seed that are kept
PIECES = [
    *(
        "nan",
        "inf",
        "-",
        ".",
        "1e400",
        "1e5",
        "-0",
        "1-2",
        "1_0",
        "0x1",
        "1,5",
        "+3",
        "12345678.9",
        "1" * 30,
        "1.25e-320",
    ),
    *(
        "{",
        "}",
        "{ }",
        "JOINT a",
        "ROOT b",
        "End Site",
        "MOTION",
        "HIERARCHY",
        "OFFSET 1 2 3",
        "CHANNELS 0",
        "CHANNELS 1 Xrotation",
    ),
    *(
        "Frames: 7",
        "Frames:",
        "Frame Time: 0.01",
        "Frame",
        ":",
        "\n",
        "\r",
        "\r\n",
        "\n\n",
        " ",
        "\t",
        "\f",
        "\0",
        "\x01",
        "\x1a",
    ),
    *("ü", "膝", "\u2028", "\xa0", "٣"),
]
BYTES = [piece.encode() for piece in PIECES] + [b"\xff", b"\xfe\xff", b"\xef\xbb\xbf", b"\x83\x7b", b"\xe9"]


def mutate(data: bytes, rng: random.Random) -> bytes:
    """The file with one to six things changed: pieces put in, taken out, moved, doubled; bytes, words, line ends."""
    for _ in range(rng.choice((1, 1, 1, 2, 3, 6))):
        at = rng.randrange(len(data) + 1)
        to = min(at + rng.choice((1, 1, 2, 5, 20, 200)), len(data))
        words = list(re.finditer(rb"\S+", data[at : at + 300]))
        kind = rng.randrange(8)
        if kind == 0:
            data = data[:at] + rng.choice(BYTES) + data[at:]
        elif kind == 1:
            data = data[:at] + data[to:]
        elif kind == 2:
            data = data[:to] + data[at:to] + data[to:]
        elif kind == 3 and at < len(data):
            data = data[:at] + bytes([data[at] ^ (1 << rng.randrange(8))]) + data[at + 1 :]
        elif kind == 4 and words:
            word = rng.choice(words)
            data = data[: at + word.start()] + rng.choice(BYTES) + data[at + word.end() :]
        elif kind == 5 and len(words) > 1:
            one, other = sorted(rng.sample(words, 2), key=lambda word: word.start())
            a, b, c, d = (at + place for place in (*one.span(), *other.span()))
            data = data[:a] + data[c:d] + data[b:c] + data[a:b] + data[d:]
        elif kind == 6:
            data = data[:at] if rng.random() < 0.3 else data.replace(b"\n", rng.choice((b" ", b"\r", b"\r\n", b"\n\n")))
        elif kind == 7:
            lines = data.split(b"\n")
            lines.insert(rng.randrange(len(lines)), lines.pop(rng.randrange(len(lines))))
            data = b"\n".join(lines)
    return data


def plain(data: bytes) -> tuple[list[str], list[str], list[float], list[float], int, list[int]]:
    """A BVH file read slowly and simply: names, channels, offsets, numbers, frames announced, numbers a line."""
    text = data.decode("utf-8", "replace").removeprefix("\ufeff")
    newline = "\n" if "\n" in text else "\r"
    title = r"(?i)(?<![^\s{}])(root|joint|site)(?![^\s{}])([^\r\n{}]*)"  # a name may look like anything
    names = [name for kind, name in re.findall(title, text) if kind.lower() != "site"]
    tree, _, rest = re.split(r"(?i)frame\s*time\s*:?\s*([^\s:]+)", re.sub(title, " ", text), maxsplit=1)
    body = re.split(r"\r\n|\r|\n", rest, maxsplit=1)[-1]  # the line of the frame time ends with whatever ends it
    channels = re.findall(r"(?i)[xyz](?:position|rotation)", tree)
    offsets = [float(x) for triple in re.findall(r"(?i)offset\s+(\S+)\s+(\S+)\s+([^\s{}]+)", tree) for x in triple]
    frames = int(re.findall(r"(?i)frames\s*:?\s*([0-9]+)", tree)[-1])
    counts = [len(line.split()) for line in body.split(newline)]
    return (
        [name.strip(" \t\f\v") for name in names],
        channels,
        offsets,
        [float(x) for x in body.split()],
        frames,
        counts,
    )


def disagreement(data: bytes, motion: mc.Motion, told: list[str]) -> str | None:
    """How an accepted file differs from what the plain reader makes of it; None if not at all."""
    names, channels, offsets, numbers, frames, counts = plain(data)
    body = motion.skeleton
    columns = body.channel_count
    if any("not UTF-8" in text for text in told):
        names = [name for name, end in zip(body.names, body.end_sites, strict=True) if not end]
    if names != [name for name, end in zip(body.names, body.end_sites, strict=True) if not end]:
        return "names"
    if [kind.lower() for kind in channels] != [kind.lower() for kinds in body.channels for kind in kinds]:
        return "channels"
    if body.offsets.tobytes() != np.array(offsets).tobytes():
        return "offsets"
    if motion.values.tobytes() != np.array(numbers).tobytes() or not all(map(math.isfinite, numbers)):
        return "values"
    if motion.frames != frames and not any(f"{frames} frames announced" in text for text in told):
        return "a wrong frame count without a warning"
    if columns and any(count % columns for count in counts) and len(numbers) != frames * columns:
        return "rows that do not end where lines do, and are not as many as announced"
    return None


def outcome(path: Path, chunk: int, compiled: bool) -> tuple[mc.Motion | str, list[str]]:
    """The motion or the refusal, and the warnings, in chunks of that size, by the one or the other way."""
    _bvh_rows.CHUNK, _bvh_rows.COMPILED_FROM = chunk, 0 if compiled else 1 << 62
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            return mc.read(path), [str(warning.message) for warning in caught]
        except mc.FileError as error:
            return str(error), []


def problem(data: bytes, path: Path, rng: random.Random) -> tuple[str, str | None]:
    """Whether a file is "read", "warned" of or "refused", and what is wrong with that."""
    path.write_bytes(data)
    start = time.process_time()  # not what other programs take
    compiled = rng.random() < 0.5
    whole, told = outcome(path, CHUNKS[-1], compiled)
    seconds = time.process_time() - start
    if seconds > SLOWEST:
        return "slow", f"took {seconds:.2f} s"
    small, _ = outcome(path, rng.choice(CHUNKS), not compiled)
    if isinstance(whole, str):
        same = isinstance(small, str) and (small == whole or "a number expected, '" in small)
        return "refused", None if same else f"chunks, or how they are read, decide: {whole} | {small}"
    long_word = isinstance(small, str) and max(map(len, data.split()), default=0) >= CHUNKS[0]
    if not long_word and (isinstance(small, str) or small.values.tobytes() != whole.values.tobytes()):
        return "read", f"chunks, or how they are read, decide: {small}"
    return "warned" if told else "read", disagreement(data, whole, told)


def seeds(folder: Path) -> list[bytes]:
    """Small files whole, and the beginnings of large ones with the frame count that fits."""
    found = []
    for path in sorted(folder.glob("*/*.bvh")):
        data = path.read_bytes()
        if len(data) > HEAD:
            data = data[: data.rindex(b"\n", 0, HEAD) + 1]
        rows = len(data[re.search(rb"(?i)frame\s*time[^\n]*\n", data).end() :].splitlines()) if b"ime" in data else 0
        found.append(re.sub(rb"Frames:\s*\d+", b"Frames: %d" % rows, data) if len(data) > 20_000 else data)
    return found


def main(minutes: float) -> None:
    import clips

    rng = random.Random(time.time_ns())
    files, counts = seeds(clips.folder()), Counter[str]()
    end = time.monotonic() + 60 * minutes
    with tempfile.TemporaryDirectory() as folder:
        first = Path(folder) / "first.bvh"
        first.write_bytes(files[0])
        outcome(first, CHUNKS[-1], True)  # compiles: no file's fault
        while time.monotonic() < end:
            data = mutate(rng.choice(files), rng)
            try:
                kind, wrong = problem(data, Path(folder) / "fuzz.bvh", rng)
            except Exception as error:  # a crash is what is looked for
                kind, wrong = "crash", repr(error)
            counts[kind] += 1
            if wrong:
                kept = Path(tempfile.gettempdir()) / f"fuzz_bvh_{counts.total()}.bvh"
                kept.write_bytes(data)
                print(f"{wrong}: {kept}", flush=True)
                counts["problems"] += 1
    print(f"{minutes:g} minutes: {dict(counts)}")


if __name__ == "__main__":
    main(float(sys.argv[1]) if len(sys.argv) > 1 else 1.0)
