"""What many threads do at once: `python tests threaded THREADS FOLDER` prints a digest of what
each of 10 jobs gave.

With one thread the jobs come one after another. The scenes are built where they are evaluated, as
users' threads do it.
"""

import hashlib
import json
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Barrier

import numpy as np
from mechanisms import links_of, pins_of
from stepped import pinned

from lagrange_casadi import Mechanism, Scene, evaluate, export, load, save, sweep, symbolic
from lagrange_casadi.motion import polynomial

JOBS = 10
QUICK = "-O0"  # to compile


def press(own, pin=Mechanism.revolute):
    """A press whose crank turns a hundred times; with ``own`` one that no other job has."""
    with symbolic:
        return _press(Mechanism("press"), own, pin)


def _press(m, own, pin):
    l, r = m.parameter("l", 0.5, "m", low=0.0), m.parameter("r", 0.1, "m", low=0.0)
    crank, rod = links_of(m, crank=(r, 1.2 + own / 8), rod=(2 * l - l, l * 4))
    ram = m.point_mass("ram", 15.0)
    pins_of(m, O=(m.ground, crank), A=(crank.tip, rod))
    pin(m, "B", rod.tip, ram)
    m.prismatic("guide", m.ground, ram, axis=(0, 1))
    return Scene(
        m,
        {"O": polynomial(0.3, 10)},
        t=(0, 62.8, 301),
        xi=(0, 1, 3),
        posture={"rod": 1.5, "guide": 0.6},
    )


SHARED, ITERATED = press(0), press(0, pinned)


def numbers(solution):
    return b"".join(np.ascontiguousarray(row).tobytes() for row in solution.series.values())


def files(folder):
    return b"".join(
        path.name.encode() + path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    )


def swept(own, folder):
    scene, grid = press(own), {"l": (0.4, 0.6, 5), "r": (0.08, 0.1, 3)}
    sweep(
        scene,
        grid,
        t=(0, 0.6, 21),
        wanted=["effort", "section:rod"],
        flags=QUICK,
        out=folder / "sweep.h5",
    )
    return files(folder)


def exported(own, folder):
    export(press(own), folder / "c", precision="single", wanted=["effort"])
    return files(folder)


def kept(own, folder):
    save(evaluate(press(own), backend="c", flags=QUICK), folder / "run.h5")
    return files(folder) + numbers(load(folder / "run.h5"))


KINDS = (
    lambda own, folder: numbers(evaluate(SHARED, backend="c", flags=QUICK)),
    lambda own, folder: numbers(evaluate(SHARED, backend="c", precision="single", flags=QUICK)),
    lambda own, folder: numbers(evaluate(press(own), backend="c", precision="single", flags=QUICK)),
    lambda own, folder: numbers(evaluate(press(own, pinned), backend="c", newton=3, flags=QUICK)),
    lambda own, folder: numbers(evaluate(press(own), backend="vm")),
    swept,
    exported,
    kept,
)


def main(threads, folder):
    together = Barrier(threads)

    def job(k):
        if k < threads:
            together.wait()
        place = folder / str(k)
        place.mkdir()
        return hashlib.sha256(KINDS[k % len(KINDS)](k // len(KINDS), place)).hexdigest()

    with ThreadPoolExecutor(threads) as pool:
        print(json.dumps(list(pool.map(job, range(JOBS)))))


if __name__ == "__main__":
    main(int(sys.argv[1]), Path(sys.argv[2]))
