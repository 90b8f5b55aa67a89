"""A real scheduler and real worker processes: the same bytes, whatever dies."""

import contextlib
import json
import logging
import os
import re
import signal
import socket
import sys
import threading
import time

import pytest
import sweeps
from internals import Cluster, columns, sweep
from internals import dask_workers as cluster

from lagrange_casadi import Case, load_case, optimise
from lagrange_casadi.errors import ClusterError, DeclarationError, StoppedError

distributed = pytest.importorskip(
    "distributed", reason="Dask is not installed: pip install 'lagrange_casadi[cluster]'"
)

# Workers build as users do, and give numbers of the same code only.
pytestmark = pytest.mark.usefixtures("released")

ASKED = {"t": (0, 0.08, 41), "wanted": ["effort"]}
GRID = {"l": (0.055, 0.4, 240), "r": [0.05, 0.1]}


@pytest.fixture(scope="module", autouse=True)
def small_blocks():
    """What is a block is this process's to say; workers are told."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(columns, "_MOST", 24)
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


SPACE = {
    "rssr": {"grid": {"r": (0.05, 0.1, 60)}, "wanted": ["effort"]},
    "cardan_shaft": {"grid": {"aside": (0.02, 0.1, 60)}, "wanted": ["effort"]},
    "spatial_slider_crank": {
        "grid": {"l": (0.4, 0.5, 60)},
        "wanted": ["effort", "section:rod"],
        "xi": (0, 1, 5),
    },
}
"""Loops of closed forms, iterated loops, and the peaks of resultants along a link."""


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
@pytest.mark.parametrize("name", SPACE)
def test_mechanisms_in_space_give_the_same_bytes_too(name, two_workers, tmp_path):
    case, asked = load_case(name), SPACE[name] | {"t": (0, 0.1, 17)}
    local = sweep(case, **asked, out=tmp_path / "here.h5").path.read_bytes()
    assert (
        sweep(case, **asked, out=tmp_path / "there.h5", dask=two_workers).path.read_bytes() == local
    )


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


def test_ctrl_c_comes_through_while_there_is_no_worker(slider_crank, tmp_path):
    def asked(what, _done, _total):
        if what == "designs":
            threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT)).start()

    told = pytest.warns(UserWarning, match="has no workers yet")
    stopped = pytest.raises(StoppedError, match="stopped; nothing was done yet")
    with started(tmp_path, 0) as (address, *_), told, stopped:
        sweep(slider_crank, GRID, **ASKED, out=tmp_path / "x.h5", dask=address, progress=asked)
    assert not (tmp_path / "x.h5").exists()


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


@pytest.mark.long
def test_a_worker_that_is_frozen_for_a_while_is_waited_for(slider_crank, whole, tmp_path):
    path, held = tmp_path / "x.h5", []
    with started(tmp_path, 1) as (address, _, (worker,)):

        def progress(_what, done, _total):
            if done and not held:
                worker.send_signal(signal.SIGSTOP)
                held.append(threading.Timer(1.5, worker.send_signal, (signal.SIGCONT,)))
                held[0].start()

        assert (
            sweep(
                slider_crank, GRID, **ASKED, out=path, dask=address, progress=progress
            ).path.read_bytes()
            == whole
        )
    assert held


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
                name for name, there in client.run(eval, cluster._PROBE).items() if not there
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


@pytest.mark.long
def test_a_worker_without_the_package_that_comes_later_is_named(slider_crank, tmp_path):
    asked = {
        "grid": {"l": (0.12, 0.4, 4000), "r": (0.05, 0.1, 250)},
        "t": (0, 0.08, 21),
        "wanted": ["effort"],
    }
    with started(tmp_path, 1) as (address, *_), contextlib.ExitStack() as stack:
        later = [
            sys.executable,
            "-c",
            WITHOUT,
            "worker",
            address,
            "--nthreads",
            "1",
            "--no-dashboard",
            "--no-nanny",
        ]

        def progress(_what, done, _total, begun=[]):  # noqa: B006
            if done and not begun:
                begun.append(stack.enter_context(sweeps.process(*later, cwd=tmp_path)))

        with pytest.raises(
            ClusterError,
            match=(
                r"^no lagrange_casadi on worker tcp://\S+: install it there too; [\d ]+ of 1"
                r" 000 000"
            ),
        ):
            sweep(slider_crank, **asked, out=tmp_path / "x.h5", dask=address, progress=progress)


@pytest.mark.parametrize(
    "address", ["", "nonsense", "foo://127.0.0.1:8786", "tcp://127.0.0.1", "tcp://127.0.0.1:22x"]
)
def test_what_is_no_address_is_one_line(slider_crank, tmp_path, address):
    with pytest.raises(
        DeclarationError,
        match=f"dask: expected an address like tcp://HOST:8786, got '{re.escape(address)}'",
    ):
        sweep(slider_crank, GRID, **ASKED, out=tmp_path / "x.h5", dask=address)


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:1"])
def test_what_cannot_be_reached_is_one_line(slider_crank, tmp_path, monkeypatch, address):
    monkeypatch.setattr(cluster, "_PATIENCE", 1.0)
    with pytest.raises(
        ClusterError, match=f"no Dask scheduler answers at {re.escape(address)}: "
    ) as caught:
        sweep(slider_crank, GRID, **ASKED, out=tmp_path / "x.h5", dask=address)
    assert "\n" not in str(caught.value)


@contextlib.contextmanager
def answering(says):
    """The address of what accepts connections and says this, or goodbye at once, and the
    connections it has accepted.
    """

    def serve():
        with contextlib.suppress(OSError):
            while True:
                line = server.accept()[0]
                lines.append(line)
                if says is None:
                    line.close()
                else:
                    line.sendall(says)

    lines = []
    with socket.create_server(("127.0.0.1", 0)) as server:
        thread = threading.Thread(target=serve)
        thread.start()
        try:
            yield f"tcp://127.0.0.1:{server.getsockname()[1]}", lines
        finally:
            server.shutdown(socket.SHUT_RDWR)
            thread.join()
            for line in lines:
                line.close()


OTHERS = {
    "silent": (b"", "nothing came from there within 1 s"),
    "http": (
        b"HTTP/1.0 400 Bad request\r\n" + 1000 * b"x",
        r"(nothing came from there within 1 s|what answers there is no scheduler)",
    ),
    "ssh": (b"SSH-2.0-OpenSSH_9.2p1\r\n", "what answers there is no scheduler"),
    "zeros": (bytes(1000), ""),
    "closed": (None, ""),
}


@pytest.mark.sampled(5)
@pytest.mark.parametrize(("says", "told"), OTHERS.values(), ids=OTHERS)
def test_what_is_no_scheduler_is_one_line(slider_crank, tmp_path, monkeypatch, capfd, says, told):
    monkeypatch.setattr(cluster, "_PATIENCE", 1.0)
    with (
        answering(says) as (address, _),
        pytest.raises(
            ClusterError, match=f"no Dask scheduler answers at {address}: {told}"
        ) as caught,
    ):
        sweep(slider_crank, GRID, **ASKED, out=tmp_path / "x.h5", dask=address)
    assert "\n" not in str(caught.value)
    assert capfd.readouterr().err == ""
    assert os.listdir(tmp_path) == []


def test_a_worker_is_no_scheduler(slider_crank, two_workers, tmp_path):
    with distributed.Client(two_workers, set_as_default=False) as client:
        address = next(iter(client.nthreads()))
    with pytest.raises(
        ClusterError, match=f"no Dask scheduler answers at {address}: it is a worker"
    ):
        sweep(slider_crank, GRID, **ASKED, out=tmp_path / "x.h5", dask=address)


@pytest.mark.long
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM], ids=lambda number: number.name)
def test_an_interrupt_comes_through_while_nothing_answers(slider_crank, tmp_path, number):
    asked = ["sweep", str(slider_crank.path), "--grid", "l=0.2,0.3", "--out", "x.h5"]
    with (
        answering(b"") as (address, accepted),
        sweeps.process(
            sys.executable, "-m", "lagrange_casadi", *asked, "--dask", address, cwd=tmp_path
        ) as stopped,
    ):
        sweeps.wait_for(lambda: accepted)
        stopped.send_signal(number)
        assert stopped.communicate(timeout=60) == ("", "error: stopped; nothing was done yet\n")
    assert stopped.returncode == 130
    assert os.listdir(tmp_path) == []


def test_a_cluster_and_threads_exclude_each_other(slider_crank, tmp_path):
    with pytest.raises(DeclarationError, match="workers and dask exclude each other"):
        sweep(
            slider_crank, GRID, **ASKED, out=tmp_path / "x.h5", dask="tcp://127.0.0.1:1", workers=2
        )


def test_without_dask_one_line_says_how_to_get_it(slider_crank, monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(
        ClusterError,
        match=r"a cluster needs Dask; install it with: pip install 'lagrange_casadi\[cluster\]'",
    ):
        sweep(slider_crank, GRID, **ASKED, out=tmp_path / "x.h5", dask="tcp://127.0.0.1:1")
    assert isinstance(load_case(slider_crank.path), Case)
    assert Cluster("tcp://x:1").address == "tcp://x:1"
