"""A real scheduler and real worker processes: the same bytes, whatever dies."""

import contextlib
import json
import logging
import os
import re
import signal
import sys

import pytest
import sweeps

from lagrange_casadi import Case, load_case, optimise, sweep
from lagrange_casadi.errors import ClusterError, DeclarationError, StoppedError

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

QUIET = {"env": {**os.environ, "DASK_LOGGING__DISTRIBUTED": "critical"}}
ONE = ("--nworkers", "1", "--nthreads", "1", "--no-dashboard", "--no-nanny")


@contextlib.contextmanager
def started(folder, workers):
    """The address of a scheduler, its process, and those of workers, each by the program that it
    runs.
    """
    told = folder / "scheduler.json"
    begun = ("scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard")
    begun += ("--scheduler-file", str(told))
    with contextlib.ExitStack() as stack:

        def process(program, *words):
            asked = (sys.executable, "-c", program, *words)
            return stack.enter_context(sweeps.process(*asked, cwd=folder, **QUIET))

        scheduler = process(WITHOUT, *begun)
        sweeps.wait_for(lambda: told.exists() and told.read_text().endswith("}"))
        address = json.loads(told.read_text())["address"]
        found = [process(program, "worker", address, *ONE) for program in workers]
        if workers:
            with distributed.Client(address, set_as_default=False) as client:
                client.wait_for_workers(len(workers))
        yield address, scheduler, found


@pytest.fixture(scope="module")
def whole(slider_crank, tmp_path_factory):
    """The bytes of the sweep on this process's threads."""
    out = tmp_path_factory.mktemp("whole") / "x.h5"
    return sweep(slider_crank, GRID, **ASKED, out=out).path.read_bytes()


@pytest.fixture(scope="module")
def two_workers(tmp_path_factory):
    """A scheduler needs nothing but Dask."""
    with started(tmp_path_factory.mktemp("cluster"), [PLAIN] * 2) as (address, *_):
        yield address


def parts(path):
    return len(list(path.parent.glob(f"{path.name}.parts/*.part")))


def test_two_worker_processes_give_the_same_bytes(slider_crank, two_workers, whole, tmp_path):
    level = logging.getLogger("distributed").disabled
    found = sweep(slider_crank, GRID, **ASKED, out=tmp_path / "x.h5", dask=two_workers)
    assert found.path.read_bytes() == whole
    assert logging.getLogger("distributed").disabled == level


def test_searches_for_a_design_give_the_same_bytes(slider_crank, two_workers, tmp_path):
    words = {
        "minimise": "peak:effort:O",
        "over": {"l": (0.12, 0.8), "r": (0.05, 0.1)},
        "subject_to": ["r >= 0.07"],
        "starts": 3,
    }
    words |= {"t": (0, 0.08, 41), "screen": 16}
    here, there = tmp_path / "here.h5", tmp_path / "there.h5"
    found = optimise(slider_crank, **words, out=here)
    assert found.converged
    assert (
        optimise(slider_crank, **words, out=there, dask=two_workers).starts[2].ending == "converged"
    )
    assert there.read_bytes() == here.read_bytes()


@pytest.mark.long
def test_a_worker_that_is_killed_is_done_without(slider_crank, whole, tmp_path):
    path, killed = tmp_path / "x.h5", []
    with started(tmp_path, [PLAIN] * 2) as (address, _, workers):

        def progress(_what, done, _total):
            if done and not killed:
                workers[0].send_signal(signal.SIGKILL)
                killed.append(workers[0].wait())

        assert (
            sweep(
                slider_crank, GRID, **ASKED, out=path, dask=address, progress=progress
            ).path.read_bytes()
            == whole
        )
    assert killed == [-signal.SIGKILL]


LACKING = r"^no lagrange_casadi on worker tcp://\S+: install it there too; (nothing|\d+ of 480)"
NUMBERS = "a Dask worker would give other numbers than this machine: versions h5py was .* is 0.0 "


@pytest.mark.parametrize(("program", "says"), [(WITHOUT, LACKING), (OTHER, NUMBERS)])
def test_workers_that_cannot_give_the_same_numbers_are_named(slider_crank, tmp_path, program, says):
    with started(tmp_path, [program]) as (address, *_), pytest.raises(ClusterError, match=says):
        sweep(slider_crank, GRID, **ASKED, out=tmp_path / "x.h5", dask=address)
    assert not (tmp_path / "x.h5").exists()


@pytest.mark.parametrize("lost", ["stopped", pytest.param("scheduler", marks=pytest.mark.long)])
def test_what_is_stopped_or_lost_is_one_line_and_loses_nothing(
    slider_crank, whole, tmp_path, capfd, lost
):
    path, asked = tmp_path / "x.h5", []
    with started(tmp_path, [PLAIN]) as (address, scheduler, _):

        def progress(_what, done, _total):
            if done and not asked:
                asked.append(done)
                os.kill(*((scheduler.pid, 9) if lost == "scheduler" else (os.getpid(), 2)))

        told = rf"{lost}.*; \d+ of 480 designs are kept in .*: continue with resume=True"
        with pytest.raises((ClusterError, StoppedError), match=told):
            sweep(slider_crank, GRID, **ASKED, out=path, dask=address, progress=progress)
    assert capfd.readouterr().err == ""
    assert parts(path) > 0
    assert sweep(slider_crank, GRID, **ASKED, out=path, resume=True).path.read_bytes() == whole


@pytest.mark.parametrize(
    "address", ["", "nonsense", "foo://127.0.0.1:8786", "tcp://127.0.0.1", "tcp://127.0.0.1:22x"]
)
def test_what_is_no_address_is_one_line(slider_crank, tmp_path, address):
    with pytest.raises(
        DeclarationError,
        match=f"dask: expected an address like tcp://HOST:8786, got '{re.escape(address)}'",
    ):
        sweep(slider_crank, GRID, **ASKED, out=tmp_path / "x.h5", dask=address)


def test_without_dask_one_line_says_how_to_get_it(slider_crank, monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(
        ClusterError,
        match=r"a cluster needs Dask; install it with: pip install 'lagrange_casadi\[cluster\]'",
    ):
        sweep(slider_crank, GRID, **ASKED, out=tmp_path / "x.h5", dask="tcp://127.0.0.1:1")
    assert isinstance(load_case(slider_crank.path), Case)
