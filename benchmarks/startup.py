"""How long `mocurve --help` and `mocurve info` take, as multiples of `python -c "import numpy"` in the same run.

    python benchmarks/startup.py [--rounds 15] [CLIP of about 2 MB]

Without a clip one of 2 MB is made of the shipped capture's rows. The three commands take turns, after one round that
leaves bytecode behind; medians are told.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from argparse import ArgumentParser
from pathlib import Path
from statistics import median
from time import perf_counter

from mocurve.data import example

LEAST = {"help": 3.0, "info": 6.0}
AIM = {"help": 2.0, "info": 3.0}


def seconds(command: list[str]) -> float:
    start = perf_counter()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return perf_counter() - start


def two_megabytes(folder: Path) -> Path:
    """The shipped capture, its rows repeated until the file has 2 MB."""
    head, rows = example().read_text(encoding="ascii").split("Frame Time:")
    time, *frames = rows.splitlines()
    times = 2_000_000 // len("\n".join(frames))
    head = head.replace(f"Frames: {len(frames)}", f"Frames: {len(frames) * times}")
    path = folder / "two_megabytes.bvh"
    path.write_text(head + "Frame Time:" + "\n".join([time, *(frames * times)]) + "\n", encoding="ascii")
    return path


def main() -> None:
    asked = ArgumentParser()
    asked.add_argument("clip", nargs="?", type=Path)
    asked.add_argument("--rounds", type=int, default=15)
    options = asked.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        clip = options.clip or two_megabytes(Path(folder))
        mocurve = [sys.executable, "-m", "mocurve.cli"]
        commands = {
            "numpy": [sys.executable, "-c", "import numpy"],
            "help": [*mocurve, "--help"],
            "info": [*mocurve, "info", str(clip)],
        }
        rounds = [{name: seconds(command) for name, command in commands.items()} for _ in range(options.rounds + 1)][1:]
    base = median(r["numpy"] for r in rounds)
    print(f'python -c "import numpy"   {base * 1000:6.0f} ms   median of {options.rounds}')
    for name in LEAST:
        took, ratio = median(r[name] for r in rounds), median(r[name] / r["numpy"] for r in rounds)
        goal = f"least {LEAST[name]:g}x, aim {AIM[name]:g}x"
        print(f"mocurve {name:<18} {took * 1000:6.0f} ms   {ratio:.2f}x   {goal}")


if __name__ == "__main__":
    main()
