"""A real scheduler and real worker processes: the same bytes, whatever dies."""

import contextlib
import json
import logging
import os
import re
import signal
import sys
import time
from importlib.util import find_spec

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


WITHOUT = (
    "import runpy, sys; sys.modules['lagrange_casadi'] = None; runpy.run_module('dask',"
    " run_name='__main__')"
)
"""Dask where this package is not."""


@contextlib.contextmanager
def started(folder, workers, without=()):
    """The address of a scheduler, its process, and those of its workers; ``without`` this package
    those of which it says so.
    """
    told = folder / "scheduler.json"

    def dask(who):
        return (sys.executable, "-c", WITHOUT) if who in without else (sys.executable, "-m", "dask")

    quiet = {"env": {**os.environ, "DASK_LOGGING__DISTRIBUTED": "critical"}}
    with contextlib.ExitStack() as stack:
        begun = (
            "scheduler",
            "--host",
            "127.0.0.1",
            "--port",
            "0",
            "--no-dashboard",
            "--scheduler-file",
            str(told),
        )
        scheduler = stack.enter_context(sweeps.process(*dask("scheduler"), *begun, **quiet))
        sweeps.wait_for(lambda: told.exists() and told.read_text().endswith("}"))
        address = json.loads(told.read_text())["address"]
        begin = (
            "worker",
            address,
            "--nworkers",
            "1",
            "--nthreads",
            "1",
            "--no-dashboard",
            "--no-nanny",
        )
        found = [
            stack.enter_context(sweeps.process(*dask(k), *begin, cwd=folder, **quiet))
            for k in range(workers)
        ]
        if workers:
            with distributed.Client(address, set_as_default=False) as client:
                client.wait_for_workers(workers)
        yield address, scheduler, found


@pytest.fixture(scope="module")
def whole(slider_crank, tmp_path_factory):
    """The bytes of the sweep on this process's threads."""
    out = tmp_path_factory.mktemp("whole") / "x.h5"
    return sweep(slider_crank, GRID, **ASKED, out=out).path.read_bytes()


@pytest.fixture(scope="module")
def two_workers(tmp_path_factory):
    """A scheduler needs nothing but Dask."""
    with started(tmp_path_factory.mktemp("cluster"), 2, without=["scheduler"]) as (address, *_):
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


def test_ctrl_c_commits_what_is_under_way(slider_crank, two_workers, whole, tmp_path):
    path, asked = tmp_path / "x.h5", []

    def progress(_what, done, _total):
        if done and not asked:
            asked.append(done)
            os.kill(os.getpid(), signal.SIGINT)

    with pytest.raises(StoppedError, match=r"stopped; \d+ of 480 designs are kept"):
        sweep(slider_crank, GRID, **ASKED, out=path, dask=two_workers, progress=progress)
    assert 1 < parts(path) <= 6
    assert (
        sweep(
            slider_crank, GRID, **ASKED, out=path, dask=two_workers, resume=True
        ).path.read_bytes()
        == whole
    )


@pytest.mark.long
def test_a_worker_that_is_killed_is_done_without(slider_crank, whole, tmp_path):
    path, killed = tmp_path / "x.h5", []
    with started(tmp_path, 2) as (address, _, workers):

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


@pytest.mark.long
def test_a_scheduler_that_is_killed_is_one_line_and_loses_nothing(
    slider_crank, whole, tmp_path, capfd
):
    path = tmp_path / "x.h5"
    with started(tmp_path, 1) as (address, scheduler, _):

        def progress(_what, done, _total):
            if done:
                scheduler.send_signal(signal.SIGKILL)
                scheduler.wait()

        told = (
            rf"the Dask scheduler at {re.escape(address)} was lost; \d+ of 480 designs are kept in"
            r" .*: continue with resume=True"
        )
        with pytest.raises(ClusterError, match=told):
            sweep(slider_crank, GRID, **ASKED, out=path, dask=address, progress=progress)
    assert capfd.readouterr().err == ""
    assert parts(path) > 0
    assert sweep(slider_crank, GRID, **ASKED, out=path, resume=True).path.read_bytes() == whole


@pytest.mark.long
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM], ids=lambda number: number.name)
@pytest.mark.parametrize("frozen", ["scheduler", "worker"])
def test_an_interrupt_does_not_wait_for_what_is_frozen(slider_crank, tmp_path, number, frozen):
    asked = [
        "sweep",
        str(slider_crank.path),
        "--grid",
        "l=0.12:0.4:4000",
        "--grid",
        "r=0.05:0.1:250",
        "--t",
        "0:0.08:21",
    ]
    with started(tmp_path, 1) as (address, scheduler, (worker,)):
        command = [
            sys.executable,
            "-m",
            "lagrange_casadi",
            *asked,
            "--want",
            "effort",
            "--out",
            "x.h5",
            "--dask",
            address,
        ]
        with sweeps.process(*command, cwd=tmp_path) as stopped:
            sweeps.wait_for(lambda: parts(tmp_path / "x.h5"))
            stuck = {"scheduler": scheduler, "worker": worker}[frozen]
            stuck.send_signal(signal.SIGSTOP)
            time.sleep(0.5)
            began = time.monotonic()
            stopped.send_signal(number)
            out, err = stopped.communicate(timeout=60)
            assert time.monotonic() - began < 10.0
        stuck.send_signal(signal.SIGCONT)
    assert (stopped.returncode, out) == (130, "")
    assert re.fullmatch(
        r"error: stopped; [\d ]+ of 1 000 000 designs are kept in x\.h5\.parts: continue with"
        r" --resume\n",
        err,
    )


def test_workers_without_the_package_are_named_at_once(slider_crank, two_workers, tmp_path):
    begin = (
        "worker",
        two_workers,
        "--nworkers",
        "1",
        "--nthreads",
        "1",
        "--no-dashboard",
        "--no-nanny",
    )
    with distributed.Client(two_workers, set_as_default=False) as client:
        with sweeps.process(sys.executable, "-c", WITHOUT, *begin, cwd=tmp_path):
            client.wait_for_workers(3)
            lacking = [
                name
                for name, there in client.run(find_spec, "lagrange_casadi").items()
                if not there
            ]
            assert len(lacking) == 1
            with pytest.raises(
                ClusterError,
                match=(  # a worker that does not answer for three seconds is not waited for
                    rf"^no lagrange_casadi on worker {lacking[0]}: install it there too;"
                    r" (nothing was done yet|\d+ of 480 designs are kept in .*resume=True)$"
                ),
            ):
                sweep(slider_crank, GRID, **ASKED, out=tmp_path / "x.h5", dask=two_workers)
        sweeps.wait_for(lambda: len(client.nthreads()) == 2)
    assert not (tmp_path / "x.h5").exists()


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
