"""Many threads of a program at once give, to the byte, what one gives."""

import json
import os
import subprocess
import sys
import threading

import casadi as ca
import threaded

from lagrange_casadi import evaluate


def jobs(threads, folder, cache):
    folder.mkdir()
    command = [sys.executable, "-W", "error", threaded.__file__, str(threads), str(folder)]
    done = subprocess.run(command, env={**os.environ, "XDG_CACHE_HOME": str(cache)}, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_many_threads_give_the_bytes_of_one(tmp_path):
    """Scenes that they share and their own; single precision, Newton steps, sweeps, exports, files; a cold cache and a warm one."""
    alone = jobs(1, tmp_path / "alone", tmp_path / "cache")
    assert len(set(alone)) > threaded.JOBS / 2
    assert jobs(threaded.JOBS, tmp_path / "cold", tmp_path / "another") == alone
    assert jobs(threaded.JOBS, tmp_path / "warm", tmp_path / "another") == alone


def test_no_switch_of_casadis_is_turned(fresh_cache):
    """Whoever builds expressions meanwhile, of whatever else, has them simplified as ever."""
    x, lost, over = ca.SX.sym("x"), [], threading.Event()

    def build():
        while not over.is_set():
            if not ca.GlobalOptions.getSimplificationOnTheFly() or not ca.is_equal((x + 1) - 1, x) or not (0 * x).is_zero():
                lost.append(1)

    building = threading.Thread(target=build)
    building.start()
    try:
        for precision in ("single", "double"):
            evaluate(threaded.press(0), precision=precision, certificate=False)
    finally:
        over.set()
        building.join()
    assert not lost
