"""Threads that declare and drop mechanisms, while others make and drop the constants in them:
`python tests constants TIMES`.

It ends well, or in a crash of the process.
"""

import faulthandler
import sys
from concurrent.futures import ThreadPoolExecutor
from threading import Event

import casadi as ca
from mechanisms import pins_of

from lagrange_casadi import Mechanism, Scene, derive, symbolic
from lagrange_casadi.motion import polynomial

LENGTH, MASS, THREADS = 0.37, 1.2, 2


def declared():
    m = Mechanism("arm")
    with symbolic:
        length = m.parameter("ratio", 1.0) * LENGTH
    links = [m.link(name, length=length, mass=MASS) for name in "ab"]
    pins_of(m, O=(m.ground.at(LENGTH, MASS), links[0]), A=(links[0].tip, links[1]))
    return Scene(m, {"O": polynomial(LENGTH), "A": polynomial(MASS)}, t=(0, LENGTH, 2))


def main(times):
    over = Event()

    def hammer():
        while not over.is_set():
            with symbolic:
                for _ in range(100):
                    ca.SX(LENGTH) + ca.SX(MASS)

    def work():
        for k in range(times):
            scene = declared()
            if k % 100 == 0:
                derive(scene, ["effort"])

    faulthandler.enable()
    with ThreadPoolExecutor(2 * THREADS) as pool:
        hammers = [pool.submit(hammer) for _ in range(THREADS)]
        try:
            for worker in [pool.submit(work) for _ in range(THREADS)]:
                worker.result()
        finally:
            over.set()
        for one in hammers:
            one.result()


if __name__ == "__main__":
    main(int(sys.argv[1]))
