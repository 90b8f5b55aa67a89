"""A file damaged at random, many times over, and read in every way: a program of its own, for HDF5
may crash or hang on damage.

``python tests damaging FILE SEED COUNT`` prints a number before each attempt, and a line for
whatever is not refused as it should be.
"""

from __future__ import annotations

import io
import os
import random
import signal
import sys
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path

from internals import SIZE, check_sweep, is_sweep
from internals import runs as store

from lagrange_casadi import Sweep, check, load
from lagrange_casadi.cli import main
from lagrange_casadi.errors import StoreError

SECONDS = 30
"""What one attempt may take before the program ends itself."""

LARGEST = 1 << 13


def damaged(content: bytes, chance: random.Random) -> bytes:
    """The content with one thing wrong."""
    size = len(content)
    # Half of all damage is near the ends, where a file says what it is.
    at = chance.choice(
        [
            chance.randrange(size),
            chance.randrange(min(size, 2048)),
            size - 1 - chance.randrange(2 * SIZE),
        ]
    )
    other = chance.randrange(size)
    long = int(LARGEST ** chance.random())
    zeros = bytes(long)
    noise = chance.randbytes(long)
    kinds = [
        lambda: content[:at] + bytes([content[at] ^ 1 << chance.randrange(8)]) + content[at + 1 :],
        lambda: content[:at] + bytes([chance.randrange(256)]) + content[at + 1 :],
        lambda: content[:at] + noise + content[at + long :],
        lambda: content[:at] + zeros + content[at + long :],
        lambda: content[:at] + content[other : other + long] + content[at + long :],
        lambda: swapped(content, at, other, long),
        lambda: content[:at],
        lambda: content[at:],
        lambda: content[:at] + content[at + long :],
        lambda: content[:at] + noise + content[at:],
        lambda: content + noise,
        lambda: content + zeros,
        lambda: content + content[-long:],
        lambda: content[:-SIZE],
        lambda: content[:-SIZE] + content,
        lambda: b"",
    ]
    return chance.choice(kinds)()


def swapped(content: bytes, one: int, other: int, long: int) -> bytes:
    """Two blocks of a content in each other's place."""
    first, second = sorted((one, other))
    long = min(long, second - first, len(content) - second)
    a, b = content[first : first + long], content[second : second + long]
    return content[:first] + b + content[first + long : second] + a + content[second + long :]


def commanded(*arguments: str):
    """A command, which says one line and ends with status 1, or else is as bad as one that believed
    the file.
    """

    def read(path: Path) -> None:
        out, err = io.StringIO(), io.StringIO()
        with redirect_stdout(out), redirect_stderr(err):
            status = main([str(path) if word == "FILE" else word for word in arguments])
        line = err.getvalue()
        if (
            status == 1
            and not out.getvalue()
            and line.startswith("error: ")
            and line.count("\n") == 1
        ):
            raise StoreError(line)

    return read


READERS = {
    False: [load, check, store.figure_specs],
    True: [
        Sweep.open,
        check_sweep,
        commanded("table", "FILE", "--csv", "x.csv"),
        commanded("best", "FILE", "--minimise", "peak:effort:O"),
    ],
}
COMMANDS = [
    commanded("info", "FILE"),
    commanded("check", "FILE"),
    commanded("plot", "FILE", "--out", "figures"),
]


def attempt(path: Path, content: bytes, sweep: bool) -> list[str]:
    """What is not refused as it should be."""
    path.write_bytes(content)
    is_sweep(path)
    found = []
    for number, read in enumerate([*READERS[sweep], *COMMANDS]):
        try:
            read(path)
        except StoreError as error:
            if "\n" in str(error).rstrip("\n"):
                found.append(f"{number}: {error!r}")
        except BaseException as error:
            found.append(f"{number}: {type(error).__name__}: {error}")
        else:
            found.append(f"{number}: accepted")
    return found


def run(source: Path, seed: int, count: int) -> None:
    """Damage and read so many times. A ``count`` of 0 is one attempt without damage."""
    content, sweep = source.read_bytes(), is_sweep(source)
    path, chance = Path("damaged.h5").absolute(), random.Random(seed)
    for number in range(max(count, 1)):
        wrong = content
        while count and wrong == content:
            wrong = damaged(content, chance)
        print(number, flush=True)
        if hasattr(signal, "alarm"):
            signal.signal(signal.SIGALRM, signal.SIG_DFL)
            signal.alarm(SECONDS)
        for line in attempt(path, wrong, sweep):
            print(f"{number}: {line}", flush=True)
    left = sorted(set(os.listdir()) - {path.name})
    if left:
        print(f"left: {left}")


if __name__ == "__main__":
    run(Path(sys.argv[1]).absolute(), int(sys.argv[2]), int(sys.argv[3]))
