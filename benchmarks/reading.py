"""Reading and writing BVH beside pybvh 0.9 in the same run: a large file, a small one with all imports, and memory.

    pip install pybvh==0.9.*; python benchmarks/reading.py [megabytes, 100]

Large: the rows of a real clip again and again. Small: a new Python that reads, so that start-up counts. Memory: the
most that is allocated at a time, in sizes of the array. Medians of alternating runs, on the clock and of the processor.
"""

from __future__ import annotations

import os
import re
import statistics
import subprocess
import sys
import tempfile
import time
import tracemalloc
from collections.abc import Callable
from pathlib import Path

import clips

RUNS = 5
Times = tuple[list[tuple[float, float]], list[tuple[float, float]]]  # of ours and theirs: clock, processor


def main(megabytes: int) -> None:
    import mocurve

    small = clips.folder() / "cmu" / "cmu_01_01_jump.bvh"
    with tempfile.TemporaryDirectory() as folder:
        for clip in ("cmu_01_01_jump", "cmu_94_01_dance_max", "cmu_walk_daz19"):
            large = Path(folder) / f"{clip}.bvh"
            repeat(clips.folder() / "cmu" / f"{clip}.bvh", large, megabytes)
            times = alternate(mocurve.read, pybvh_read, large)
            report(f"{large.stat().st_size / 1e6:.0f} MB of {clip}", times)
            print(f"    peak memory: {memory(large):.2f} x the array")
            if clip == "cmu_walk_daz19":
                writing(large, Path(folder) / "written.bvh")
            large.unlink()
        starts = [starting(module, folder) for module in ("mocurve", "pybvh")]
        report(f"{small.stat().st_size / 1e6:.1f} MB, all imports", alternate(*starts, small, 3 * RUNS))


def repeat(source: Path, target: Path, megabytes: int) -> None:
    """A file of about that size from the rows of another."""
    data = source.read_bytes().replace(b"\r\n", b"\n")
    begin = re.search(rb"Frame Time:[^\n]*\n", data).end()
    rows = data[begin:]
    times = max(1_000_000 * megabytes // len(rows), 1)
    target.write_bytes(
        re.sub(rb"Frames:\s*\d+", b"Frames: %d" % (rows.count(b"\n") * times), data[:begin]) + rows * times
    )


def pybvh_read(path: Path) -> object:
    import pybvh

    return pybvh.read_bvh_file(path, world_up="+y")


def starting(module: str, cache: str) -> Callable[[Path], object]:
    """Reading in a new Python that finds all modules compiled (after its first run)."""
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    environment["PYTHONPYCACHEPREFIX"] = cache
    call = "mocurve.read" if module == "mocurve" else "pybvh.read_bvh_file"
    program = f"import sys, {module}; {call}(sys.argv[1])"
    return lambda path: subprocess.run([sys.executable, "-c", program, str(path)], check=True, env=environment)


def alternate(ours: Callable[[Path], object], theirs: Callable[[Path], object], path: Path, runs: int = RUNS) -> Times:
    """Seconds of both, in turn, after one run of each that does not count."""
    times: Times = ([], [])
    for run in range(runs + 1):
        for read, kept in zip((ours, theirs), times, strict=True):
            start = time.perf_counter(), processor()
            read(path)
            if run:
                kept.append((time.perf_counter() - start[0], processor() - start[1]))
    return times


def processor() -> float:
    """Seconds that this program and those that it has run took of the processor."""
    return sum(os.times()[:4])


def report(what: str, times: Times) -> None:
    for kind, seconds in enumerate(("s", "s of the processor")):
        ours, theirs = ([run[kind] for run in runs] for runs in times)
        mine, peer = statistics.median(ours), statistics.median(theirs)
        print(
            f"{what}: mocurve {mine:.3f} {seconds}, pybvh {peer:.3f} {seconds}, {peer / mine:.2f} x as fast "
            f"(best runs {min(theirs) / min(ours):.2f} x)"
        )


def memory(path: Path) -> float:
    """The most memory allocated while reading, in sizes of the array that is read."""
    import mocurve

    tracemalloc.start()
    array = mocurve.read(path).values.nbytes
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return peak / array


def writing(source: Path, target: Path) -> None:
    import mocurve

    motion = mocurve.read(source)
    for lossless in (False, True):
        start = time.perf_counter()
        mocurve.write(target, motion, lossless=lossless)
        seconds = time.perf_counter() - start
        print(f"    writing{', lossless' if lossless else ''}: {target.stat().st_size / 1e6 / seconds:.0f} MB/s")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 100)
