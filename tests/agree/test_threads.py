"""Many threads of a program at once give, to the byte, what one gives."""

import json
import os
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
import spying
import threaded
from internals import (
    in_threads,
)
from places import FOLDERS, TESTS
from stepped import pinned

from lagrange_casadi import (
    Mechanism,
    Scene,
    evaluate,
    export,
    optimise,
    prepare,
    refine,
    sensitivities,
    sweep,
    symbolic,
    tolerances,
)
from lagrange_casadi.motion import samples


def jobs(threads, folder, cache):
    folder.mkdir()
    command = [sys.executable, "-W", "error", str(TESTS), "threaded", str(threads), str(folder)]
    done = subprocess.run(
        command,
        env={**os.environ, "XDG_CACHE_HOME": str(cache)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.mark.early
def test_many_threads_give_the_bytes_of_one(tmp_path):
    """Scenes that they share and their own; single precision, Newton steps, sweeps, exports, files;
    a cold cache and a warm one.
    """
    alone = jobs(1, tmp_path / "alone", tmp_path / "cache")
    assert len(set(alone)) > threaded.JOBS / 2
    assert jobs(threaded.JOBS, tmp_path / "cold", tmp_path / "another") == alone
    assert jobs(threaded.JOBS, tmp_path / "warm", tmp_path / "another") == alone


@pytest.mark.parametrize("times", [100, pytest.param(5000, marks=pytest.mark.long)])
def test_no_constant_is_dropped_while_another_thread_asks_for_it(times):
    """CasADi crashes then, for its constants are those of the whole process."""
    command = [sys.executable, str(TESTS), "constants", str(times)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_properties_of_expressions_wait_for_one_lock():
    """A thread that makes expressions reads a property of one scene, while another waits within
    that property of another one.
    """
    done = subprocess.run(
        [sys.executable, "-c", IN_TURN],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(FOLDERS)},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert done.returncode == 0, done.stderr


IN_TURN = """
import threading
import casadi as ca
from lagrange_casadi import symbolic
from lagrange_casadi.model.kinks import Smooth
from threaded import press

scenes, moving = [press(0), press(1)], ca.SX.sym("t")
demands = [scene.parameter_constraints() for scene in scenes]
smooth = [Smooth.of("law", ca.fabs(k * moving), moving, ca.SX(0, 1)) for k in (1, 2)]
pairs = dict.fromkeys(("laws", "guided", "prescribed", "span"), scenes) | {"function": demands, "_turns": smooth}
for name, (first, second) in pairs.items():
    for whole in (first, second):
        vars(whole).pop(name, None)
    other = threading.Thread(target=getattr, args=(first, name), daemon=True)
    with symbolic:
        other.start()
        other.join(0.2)
        getattr(second, name)
    other.join()
"""  # noqa: E501


WAYS = {
    "evaluate": lambda scene, folder: evaluate(scene, wanted=["effort", "sensitivity"]),
    "interpreted": lambda scene, folder: evaluate(scene, backend="vm"),
    "single": lambda scene, folder: evaluate(scene, precision="single"),
    "newton": lambda scene, folder: evaluate(scene, newton=3),
    "table": lambda scene, folder: evaluate(scene, table=32),
    "refine": lambda scene, folder: refine(scene, evaluate(scene)),
    "sensitivities": lambda scene, folder: sensitivities(scene, evaluate(scene)),
    "slopes": lambda scene, folder: prepare(scene, wanted=["effort"]).gradient().mean,
    "curvature": lambda scene, folder: prepare(scene, wanted=["effort"]).curvature(),
    "tolerances": lambda scene, folder: tolerances(scene, {"l": 0.001}, wanted=["effort"]),
    "sweep": lambda scene, folder: sweep(
        scene, {"l": (0.5, 0.6, 3)}, wanted=["effort", "sensitivity"], out=folder / "x.h5"
    ),
    "export": lambda scene, folder: export(
        scene, folder / "c", precision="single", wanted=["effort"]
    ),
    "optimise": lambda scene, folder: optimise(
        scene, minimise="peak:effort:O", over={"r": (0.08, 0.1)}, screen=4, starts=1
    ),
}


@pytest.mark.parametrize("way", WAYS)
def test_expressions_are_made_by_one_thread_at_a_time(way, fresh_cache, monkeypatch, tmp_path):
    unlocked = spying.spied(monkeypatch)
    with symbolic:
        pin = pinned if way == "newton" else Mechanism.revolute
        scene = threaded.press(1 + len(way) / 32, pin)  # as no other test has it
    assert not unlocked
    WAYS[way](
        Scene(scene.mechanism, {"O": scene.laws["O"]}, t=(0.0, 1.0, 9), posture=scene.posture),
        tmp_path,
    )
    assert not unlocked


RODS = [0.5 + 0.01 * k for k in range(6)]
THREADS = 4
TIMES = np.linspace(0.0, 1.0, 9)


ASKED = {
    "series": lambda f, l: dict(f(l=l)),
    "peaks": lambda f, l: vars(f.peaks(l=l)),
    "designs": lambda f, l: vars(
        f.designs([[{"l": l, "r": 0.1}[name] for name in f.parameters]], histories=True)
    ),
    "gradient": lambda f, l: {"slopes": (found := f.gradient(l=l)).slopes, "mean": found.mean},
    "curvature": lambda f, l: {"bends": f.curvature(l=l).bends},
    "instants": lambda f, l: {"effort": f(l=l)["effort:O"], "t": f.t},
}


def told(found):
    """Every number of what was found, whatever becomes of its arrays."""
    return {
        name: np.array(rows).tobytes() if isinstance(rows, np.ndarray) else repr(rows)
        for name, rows in found.items()
    }


def hammered(asked, values, times=4):
    """What each of many threads that ask for all values at once, in orders of their own, got
    otherwise than one thread alone.
    """
    alone = [asked(value) for value in values]
    before = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)

    def ask(first):
        order = [(first + k) % len(values) for k in range(times * len(values))]
        return [k for k in order if asked(values[k]) != alone[k]]

    try:
        with ThreadPoolExecutor(THREADS) as pool:
            return [wrong for some in pool.map(ask, range(THREADS)) for wrong in some]
    finally:
        sys.setswitchinterval(before)


ITERATED, SCALAR, WAVED = {"newton": 3}, {"backend": "c"}, {"waved": True}
QUICK = [
    *(({}, way) for way in ASKED),
    (ITERATED, "series"),
    (ITERATED, "gradient"),
    (SCALAR, "peaks"),
    (WAVED, "designs"),
]
REST = [
    (asked, way)
    for asked in (ITERATED, SCALAR, WAVED)
    for way in ASKED
    if (asked, way) not in QUICK
]


@pytest.mark.parametrize(
    ("asked", "way"),
    [*QUICK, *(pytest.param(*pair, marks=pytest.mark.long) for pair in REST)],
    ids=str,
)
def test_a_prepared_scene_answers_each_thread(asked, way):
    """By packs, with loops iterated, by scalar code; and with samples, and instants of each
    design's own.
    """
    scene = threaded.press(0, pinned if "newton" in asked else Mechanism.revolute)
    if "waved" in asked:
        law = samples(TIMES, 0.3 + np.sin(2.0 * TIMES))
        scene = Scene(scene.mechanism, {"O": law}, t=(0.0, 1.0, 9), posture={"rod": 1.5})
        asked = {"t": (0.0, scene.mechanism.parameters["l"].symbol, 9)}
    f = prepare(scene, **{"t": (0.0, 1.0, 9), "wanted": ["effort", "section:rod"], **asked})
    assert not hammered(lambda l: told(ASKED[way](f, l)), RODS, 4)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs os.fork")
@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")
def test_a_child_process_does_not_wait_for_threads_of_its_parent():
    barrier = threading.Barrier(2, timeout=60)
    in_threads(lambda _: barrier.wait(), range(2), 2)  # a thread now waits for more
    child = os.fork()
    if not child:
        try:
            in_threads(lambda _: barrier.wait(), range(2), 2)
        except BaseException:
            os._exit(1)
        os._exit(0)
    assert os.waitpid(child, 0)[1] == 0
