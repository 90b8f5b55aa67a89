"""Processes, and a real scheduler with real workers: the same bytes, whatever dies."""

import contextlib
import json
import multiprocessing
import os
import signal
import sys
import tempfile
from concurrent.futures import ProcessPoolExecutor

import pytest
import sweeps

from lagrange_casadi import optimise, sweep
from lagrange_casadi.cli import main
from lagrange_casadi.errors import ClusterError, StoppedError

pytestmark = pytest.mark.usefixtures("released")

distributed = pytest.importorskip(
    "distributed", reason="Dask is not installed: pip install 'lagrange_casadi[cluster]'"
)

ASKED = {"t": (0, 0.08, 41), "wanted": ["effort"]}

GRID = {"l": (0.055, 0.4, 240), "r": [0.05, 0.1]}


@pytest.fixture(scope="module", autouse=True)
def small_blocks():
    """What is a block is this process's to say; workers are told."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("lagrange_casadi.studies.sweep.columns._MOST", 24)
        yield


RUN = "import runpy, sys; {}; runpy.run_module('dask', run_name='__main__')"
PLAIN, WITHOUT = RUN.format("sys"), RUN.format("sys.modules['lagrange_casadi'] = None")
OTHER = RUN.format("import h5py; h5py.__version__ = '0.0'")
"""Dask where this package is not, and where another version of what it needs is."""

QUIET = {
    "cwd": tempfile.gettempdir(),
    "env": {**os.environ, "DASK_LOGGING__DISTRIBUTED": "critical"},
}
ONE = ("--nworkers", "1", "--nthreads", "1", "--no-dashboard", "--no-nanny")


@contextlib.contextmanager
def scheduling(folder):
    """The address of a scheduler, which needs nothing but Dask, and its process."""
    told = folder / "scheduler.json"
    begun = (sys.executable, "-c", WITHOUT, "scheduler", "--host", "127.0.0.1", "--port", "0")
    words = ("--no-dashboard", "--scheduler-file", str(told))
    with sweeps.process(*begun, *words, **QUIET) as scheduler:
        sweeps.wait_for(lambda: told.exists() and told.read_text().endswith("}"))
        yield json.loads(told.read_text())["address"], scheduler


@contextlib.contextmanager
def working(address, *programs, timeout=30):
    """A client of the scheduler at an address, and workers of it, each by the program that it
    runs.
    """
    with contextlib.ExitStack() as stack:
        found = [
            stack.enter_context(
                sweeps.process(sys.executable, "-c", program, "worker", address, *ONE, **QUIET)
            )
            for program in programs
        ]
        client = distributed.Client(address, set_as_default=False, timeout=timeout)
        stack.enter_context(client).wait_for_workers(len(programs))
        yield client, found


@pytest.fixture(scope="module")
def whole(slider_crank, tmp_path_factory):
    """The bytes of the sweep on this process's threads."""
    out = tmp_path_factory.mktemp("whole") / "x.h5"
    return sweep(slider_crank, GRID, **ASKED, out=out).path.read_bytes()


@pytest.fixture(scope="module")
def cluster(tmp_path_factory):
    """The address of a scheduler."""
    with scheduling(tmp_path_factory.mktemp("cluster")) as (address, _):
        yield address


@pytest.fixture(scope="module")
def processes():
    """An executor of Python's own."""
    with ProcessPoolExecutor(2, multiprocessing.get_context("spawn")) as found:
        yield found


def parts(path):
    return len(list(path.parent.glob(f"{path.name}.parts/*.part")))


def test_processes_give_the_same_bytes(slider_crank, processes, whole, tmp_path):
    found = sweep(slider_crank, GRID, **ASKED, out=tmp_path / "x.h5", executor=processes, workers=3)
    assert found.path.read_bytes() == whole


def test_searches_for_a_design_give_the_same_bytes(slider_crank, processes, tmp_path):
    words = {
        "minimise": "peak:effort:O",
        "over": {"l": (0.12, 0.8), "r": (0.05, 0.1)},
        "subject_to": ["r >= 0.07"],
        "starts": 3,
    }
    words |= {"t": (0, 0.08, 41), "screen": 16}
    here, there = tmp_path / "here.h5", tmp_path / "there.h5"
    assert optimise(slider_crank, **words, out=here).converged
    found = optimise(slider_crank, **words, out=there, executor=processes)
    assert found.starts[2].ending == "converged"
    assert there.read_bytes() == here.read_bytes()


def test_the_command_line_connects_to_a_scheduler(cluster, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    words = ["sweep", "slider_crank", "--grid", "l=0.2:0.4:9", "--want", "effort", "--quiet"]
    assert main([*words, "--out", "here.h5"]) == 0
    with working(cluster, PLAIN):
        assert main([*words, "--out", "there.h5", "--dask", cluster]) == 0
    assert (tmp_path / "there.h5").read_bytes() == (tmp_path / "here.h5").read_bytes()
    assert capsys.readouterr().err == ""


@pytest.mark.long
def test_a_worker_that_is_killed_is_done_without(slider_crank, cluster, whole, tmp_path):
    path, killed = tmp_path / "x.h5", []
    with working(cluster, PLAIN, PLAIN) as (executor, workers):

        def progress(_what, done, _total):
            if done and not killed:
                workers[0].send_signal(signal.SIGKILL)
                killed.append(workers[0].wait())

        found = sweep(slider_crank, GRID, **ASKED, out=path, executor=executor, progress=progress)
        assert found.path.read_bytes() == whole
    assert killed == [-signal.SIGKILL]


LACKING = "^a worker has no lagrange_casadi: install it there too; nothing was done yet"
NUMBERS = "a worker would give other numbers than this machine: versions h5py was .* is 0.0 "


@pytest.mark.parametrize(("program", "says"), [(WITHOUT, LACKING), (OTHER, NUMBERS)])
def test_workers_that_cannot_give_the_same_numbers_are_refused(
    slider_crank, cluster, tmp_path, program, says
):
    with working(cluster, program) as (executor, _), pytest.raises(ClusterError, match=says):
        sweep(slider_crank, GRID, **ASKED, out=tmp_path / "x.h5", executor=executor)
    assert not (tmp_path / "x.h5").exists()


@pytest.mark.parametrize("lost", ["stopped", pytest.param("scheduler", marks=pytest.mark.long)])
def test_what_is_stopped_or_lost_is_one_line_and_loses_nothing(slider_crank, whole, tmp_path, lost):
    path, asked = tmp_path / "x.h5", []
    with (
        scheduling(tmp_path) as (address, scheduler),
        working(address, PLAIN, timeout=2) as (executor, _),
    ):

        def progress(_what, done, _total):
            if done and not asked:
                asked.append(done)
                os.kill(*((scheduler.pid, 9) if lost == "scheduler" else (os.getpid(), 2)))

        told = rf"{lost}.*; \d+ of 480 designs are kept in .*: continue with resume=True"
        with pytest.raises((ClusterError, StoppedError), match=told):
            sweep(slider_crank, GRID, **ASKED, out=path, executor=executor, progress=progress)
    assert parts(path) > 0
    assert sweep(slider_crank, GRID, **ASKED, out=path, resume=True).path.read_bytes() == whole


def test_what_is_no_scheduler_is_one_line(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("lagrange_casadi.cli.executor._PATIENCE", 1.0)
    monkeypatch.chdir(tmp_path)
    words = ["sweep", "slider_crank", "--grid", "l=0.2:0.4:9", "--dask"]
    for address, says in {
        "tcp://127.0.0.1": "dask: expected an address like tcp://HOST:8786, got 'tcp://127.0.0.1'\n",
        "tcp://127.0.0.1:1": "no Dask scheduler answers at tcp://127.0.0.1:1: ",
    }.items():
        assert main([*words, address]) > 0
        assert capsys.readouterr().err.startswith(f"error: {says}")
    monkeypatch.setitem(sys.modules, "distributed", None)
    assert main([*words, "tcp://127.0.0.1:1"]) == 2
    says = "a cluster needs distributed; install it with: pip install 'lagrange_casadi[cluster]'"
    assert capsys.readouterr().err == f"error: {says}\n"
