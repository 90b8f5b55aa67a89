"""Pipes, devices and standard output as outputs: written straight to or refused, never replaced.

All nodes are the tests' own.
"""

import csv
import os
import stat
import subprocess
import sys
import threading
from pathlib import Path

import pytest
import sweeps
from internals import (
    EvaluationMethod,
    Folder,
    Measurement,
    Trade,
    check_writable,
    draw_trade,
    filling,
    replacing,
    sweep,
    writing,
)

from lagrange_casadi import save
from lagrange_casadi.cli import main
from lagrange_casadi.errors import PathError, StoreError

CASE = str(Path(__file__).parents[2] / "cases" / "slider_crank")
COLUMN = "peak:effort:O"


@pytest.fixture
def file(monkeypatch, here):
    sweeps.use(monkeypatch)
    return sweep(sweeps.scene(), {"l": [0.2, 0.3], "r": [0.05, 0.1]}, out=here / "s.h5").path


@pytest.fixture
def pipe(here):
    os.mkfifo(here / "pipe")
    return here / "pipe"


@pytest.fixture
def null(here):
    """A device that takes everything, made for the test where that is allowed."""
    try:
        os.mknod(here / "null", stat.S_IFCHR | 0o666, os.makedev(1, 3))
        (here / "null").open("wb").close()
    except OSError as error:
        pytest.skip(f"no device can be made here: {error}")
    return here / "null"


@pytest.fixture
def listen():
    """Read a pipe in a thread; what came is told when all of it did."""

    def start(path):
        came = []
        thread = threading.Thread(target=lambda: came.append(path.read_bytes()), daemon=True)
        thread.start()

        def heard():
            thread.join(30)
            return came[0]

        return heard

    return start


TABLES = [["best", "s.h5", "--minimise", COLUMN], ["table", "s.h5", "--column", COLUMN]]


@pytest.mark.parametrize("command", TABLES)
def test_csv_goes_through_a_pipe(file, pipe, listen, capfd, command):
    main([*command, "--csv", "x.csv"])
    heard = listen(pipe)
    assert main([*command, "--csv", "pipe"]) == 0
    assert heard() == Path("x.csv").read_bytes()
    assert stat.S_ISFIFO(os.stat(pipe).st_mode)
    assert "wrote pipe: " in capfd.readouterr().out


@pytest.mark.sampled(3)
@pytest.mark.parametrize("ending", [".png", ".svg", ".pdf"])
def test_a_picture_goes_through_a_pipe(pipe, listen, ending):
    one = Measurement(EvaluationMethod("c"), 1e-9, 1e-3, 1e-3, "effort:O")
    heard = listen(pipe)
    with writing(pipe) as (opened,):
        draw_trade(Trade("x", 1, 1, (one,), {}), opened, ending)
    assert heard()[:5] in (b"\x89PNG\r", b"<?xml", b"%PDF-")


@pytest.mark.parametrize("command", TABLES)
def test_a_pipe_that_nobody_reads_is_one_line(file, pipe, monkeypatch, capfd, command):
    monkeypatch.setattr("lagrange_casadi.base.streams._PATIENCE", 0.2)
    assert main([*command, "--csv", "pipe"]) == 1
    assert capfd.readouterr().err == "error: cannot write pipe: nothing reads from it\n"
    assert stat.S_ISFIFO(os.stat(pipe).st_mode)


def test_a_pipe_may_be_read_later(pipe, listen):
    heard = []
    timer = threading.Timer(0.3, lambda: heard.append(listen(pipe)))
    timer.start()
    with writing(pipe) as (opened,):
        opened.write(b"in the end")
    timer.join()
    assert heard[0]() == b"in the end"


def test_a_pipe_that_is_no_longer_read_is_one_line(pipe):
    def close_early():
        with pipe.open("rb") as reader:
            reader.read(1)

    def write():
        with writing(pipe) as (opened,):
            opened.write(b"x" * 10)
            opened.flush()
            thread.join()
            opened.write(b"x" * 1_000_000)

    thread = threading.Thread(target=close_early)
    thread.start()
    with pytest.raises(StoreError, match=r"cannot write .*pipe: Broken pipe$"):
        write()


@pytest.mark.parametrize("command", TABLES)
def test_a_device_stays_one(file, null, capfd, command):
    assert main([*command, "--csv", "null"]) == 0
    assert stat.S_ISCHR(os.stat(null).st_mode)
    assert sorted(path.name for path in null.parent.iterdir()) == ["null", "s.h5"]


def test_a_device_that_is_full_is_one_line(here, capfd):
    try:
        os.mknod(here / "full", stat.S_IFCHR | 0o666, os.makedev(1, 7))
        (here / "full").open("wb").close()
    except OSError as error:
        pytest.skip(f"no device can be made here: {error}")
    with (
        pytest.raises(StoreError, match=r"cannot write .*full: No space left on device$"),
        writing(here / "full") as (opened,),
    ):
        opened.write(b"x")
    assert stat.S_ISCHR(os.stat(here / "full").st_mode)


@pytest.mark.sampled(5)
@pytest.mark.parametrize("command", TABLES)
@pytest.mark.parametrize("onto", ["pipe", "file"])
def test_standard_output_is_the_csv_alone(file, here, command, onto):
    """By a link of the test's own to what the process has as its standard output, as /dev/stdout
    is.
    """
    (here / "out.csv").symlink_to("/proc/self/fd/1")
    main([*command, "--csv", "x.csv"])
    arguments = [sys.executable, "-m", "lagrange_casadi", *command, "--csv", "out.csv"]
    if onto == "pipe":
        done = subprocess.run(arguments, capture_output=True, text=True, check=True)
        came = done.stdout
    else:
        with open("came", "w") as output:
            done = subprocess.run(
                arguments, stdout=output, stderr=subprocess.PIPE, text=True, check=True
            )
        came = Path("came").read_text()
    assert came == Path("x.csv").read_text()
    assert done.stderr.startswith("wrote out.csv: ")
    assert (here / "out.csv").is_symlink()


@pytest.mark.parametrize("node", ["pipe", "null"])
@pytest.mark.parametrize(
    "arguments",
    [
        ["run", CASE, "--no-figures", "--out", "NODE.h5"],
        ["sweep", CASE, "--grid", "l=0.2,0.3", "--out", "NODE.h5"],
        ["sweep", CASE, "--grid", "l=0.2,0.3", "--force", "--out", "NODE.h5"],
        ["run", CASE, "--figures", "NODE.h5"],
        ["plot", "s.h5", "--out", "NODE.h5"],
        ["export", CASE, "--out", "NODE.h5"],
    ],
)
def test_what_needs_a_file_or_a_folder_refuses_a_node(request, file, capfd, node, arguments):
    path = request.getfixturevalue(node)
    path.rename("x.h5")
    kind = stat.S_IFMT(os.lstat("x.h5").st_mode)
    before = sorted(os.listdir())
    assert main([word.replace("NODE", "x") for word in arguments]) == 2
    word = "a pipe" if node == "pipe" else "a device"
    assert capfd.readouterr().err.startswith(f"error: cannot write x.h5: it is {word}, not a ")
    assert stat.S_IFMT(os.lstat("x.h5").st_mode) == kind
    assert sorted(os.listdir()) == before


@pytest.mark.parametrize("command", ["info", "check", "plot", "table", "best"])
def test_what_is_read_is_no_pipe(pipe, capfd, command):
    pipe.rename("x.h5")
    more = {"plot": ["--out", "figures"], "best": ["--minimise", COLUMN]}.get(command, [])
    assert main([command, "x.h5", *more]) == 2
    assert capfd.readouterr() == ("", "error: x.h5: is a device or a pipe, not a file\n")


def test_a_socket_is_refused(here):
    import socket

    with socket.socket(socket.AF_UNIX) as server:
        server.bind("socket")
        with pytest.raises(PathError, match=r"cannot write socket: it is a socket, not a file$"):
            check_writable(Path("socket"))


@pytest.mark.parametrize("kind", ["pipe", "folder", "link"])
def test_what_is_in_a_folder_and_not_a_file_is_not_replaced(tmp_path, kind):
    folder = tmp_path / "figures"
    folder.mkdir()
    (folder / "a.png").write_text("old")
    there = folder / "b.png"
    {"pipe": os.mkfifo, "folder": os.mkdir, "link": lambda path: path.symlink_to("a.png")}[kind](
        there
    )

    def fill():
        with filling(folder) as draft:
            for name in ("a.png", "b.png"):
                (draft / name).write_text("new")

    with pytest.raises(PathError, match=r"cannot write .*b\.png: what is there is not a file$"):
        fill()
    assert (folder / "a.png").read_text() == "old"
    assert sorted(os.listdir(folder)) == ["a.png", "b.png"]
    assert not stat.S_ISREG(os.lstat(there).st_mode)
    assert os.listdir(tmp_path) == ["figures"]


def test_a_node_that_came_meanwhile_is_not_replaced(tmp_path):
    def replace():
        with replacing(tmp_path / "x") as draft:
            draft.write_text("new")
            os.mkfifo(tmp_path / "x")

    def write():
        with writing(tmp_path / "y", tmp_path / "z") as (one, other):
            one.write(b"new")
            other.write(b"new")
            os.mkfifo(tmp_path / "y")

    for put in (replace, write):
        with pytest.raises(PathError, match="what is there is not a file"):
            put()
    assert sorted(os.listdir(tmp_path)) == ["x", "y"]


def test_a_node_in_the_place_of_a_sweep_is_not_replaced(monkeypatch, here):
    sweeps.use(monkeypatch)

    def progress(what, done, total):
        if not (here / "s.h5").exists():
            os.mkfifo(here / "s.h5")

    with pytest.raises(PathError, match="what is there is not a file"):
        sweep(sweeps.scene(), {"l": [0.2, 0.3]}, out=here / "s.h5", progress=progress)
    assert stat.S_ISFIFO(os.lstat("s.h5").st_mode)
    assert Folder(here / "s.h5").done() == 2


def test_a_link_stays_and_what_it_leads_to_is_written(monkeypatch, solution, here):
    sweeps.use(monkeypatch)
    (here / "real").mkdir()
    for name in ("run.h5", "sweep.h5", "x.csv", "figures"):
        (here / name).symlink_to(here / "real" / name)
    save(solution.during(slice(0, 3)), "run.h5")
    sweep(sweeps.scene(), {"l": [0.2, 0.3]}, out="sweep.h5")
    assert main(["table", "sweep.h5", "--column", COLUMN, "--csv", "x.csv"]) == 0
    (here / "real" / "figures").mkdir()
    with filling(here / "figures") as draft:
        (draft / "a.png").touch()
    with open("x.csv", newline="") as text:
        assert len(list(csv.DictReader(text))) == 2
    assert sorted(os.listdir("real")) == ["figures", "run.h5", "sweep.h5", "x.csv"]
    assert os.listdir("figures") == ["a.png"]
    assert all((here / name).is_symlink() for name in ("run.h5", "sweep.h5", "x.csv", "figures"))


@pytest.mark.parametrize("before", [False, True])
def test_a_table_that_cannot_be_written_leaves_the_files_of_before(here, capfd, before):
    """A run's file, its figures and its table are put into their places together."""
    if before:
        assert main(["run", str(CASE), "--t", "0:0.08:5", "--no-figures"]) == 0
    there = {path.name: path.read_bytes() for path in here.iterdir()}
    assert main(["run", str(CASE), "--t", "0:0.08:9", "--csv", "/dev/full"]) == 1
    assert capfd.readouterr().err.endswith(
        "error: cannot write /dev/full: No space left on device\n"
    )
    assert {path.name: path.read_bytes() for path in here.iterdir()} == there
