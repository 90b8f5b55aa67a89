"""What commands write to: pipes, devices, standard output, links, full disks and closed terminals.
Each is written to, or refused in one line, and never replaced; all nodes are the tests' own.
"""

import os
import shlex
import shutil
import stat
import subprocess
import sys
import threading
import time
from pathlib import Path

import h5py
import pytest
from commands import command

from lagrange_casadi import check, load_case, sweep
from lagrange_casadi.errors import PathError

PROGRAM = f"{shlex.quote(sys.executable)} -B -m lagrange_casadi"
ARM = """
from lagrange_casadi import Mechanism, Scene, motion

def scene():
    m = Mechanism("arm")
    m.revolute("J", m.ground, m.link("a", length=m.parameter("l", 0.2, "m"), mass=1))
    return Scene(m, {"J": motion.polynomial(0, 1)}, t=(0, 1, 5))
"""
RUN = "run arm.py --out x.h5"
SWEEP = "sweep arm.py --grid l=0.2:0.3:3000 --want effort --quiet --out s.h5"
TABLES = ["best s.h5 --minimise peak:effort:J --csv", "table s.h5 --csv"]
TYPES = {"pipe": "a pipe", "null": "a device"}


@pytest.fixture(scope="module")
def made(tmp_path_factory, interpreted):
    """A case, a run, its figures and a sweep."""
    folder = tmp_path_factory.mktemp("made")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        Path("arm.py").write_text(ARM)
        assert command(f"{RUN} --no-figures") == 0
        assert command(SWEEP) == 0
        assert command("plot x.h5 --out f") == 0
    return folder


@pytest.fixture
def folder(made, here, capfd):
    """An own copy of the four, which is the working directory."""
    shutil.copytree(made, here, dirs_exist_ok=True, ignore=shutil.ignore_patterns("__pycache__"))
    return here


def put(kind, name):
    """Make a pipe, a device that takes everything, or a device that is full."""
    if kind == "pipe":
        os.mkfifo(name)
        return
    try:
        os.mknod(name, stat.S_IFCHR | 0o666, os.makedev(1, {"null": 3, "full": 7}[kind]))
        open(name, "wb").close()
    except OSError as error:
        pytest.skip(f"no device can be made here: {error}")


def shell(line, **keywords):
    own = {"shell": True, "capture_output": True, "text": True, "timeout": 120, "check": False}
    return subprocess.run(line, **own, **keywords)


def kind(name):
    return stat.S_IFMT(os.lstat(name).st_mode)


@pytest.mark.parametrize(("line", "delay"), zip(TABLES, (0.0, 0.3), strict=True))
def test_csv_goes_through_a_pipe(folder, capfd, line, delay):
    """However late it is read."""
    put("pipe", "pipe")
    came = []
    timer = threading.Timer(delay, lambda: came.append(Path("pipe").read_bytes()))
    timer.start()
    assert command(f"{line} x.csv") == command(f"{line} pipe") == 0
    timer.join(30)
    assert came == [Path("x.csv").read_bytes()]
    assert kind("pipe") == stat.S_IFIFO
    assert "wrote pipe: " in capfd.readouterr().out


def read_a_byte():
    with open("pipe", "rb") as reader:
        reader.read(1)


@pytest.mark.parametrize(
    ("reader", "says"), [(None, "nothing reads from it"), (read_a_byte, "Broken pipe")]
)
def test_a_pipe_that_is_not_read_is_one_line(folder, capfd, monkeypatch, reader, says):
    put("pipe", "pipe")
    if reader:
        threading.Thread(target=reader, daemon=True).start()
    else:
        clock = time.monotonic
        monkeypatch.setattr(time, "monotonic", lambda: 50.0 * clock())
    assert command("table s.h5 --csv pipe") == 1
    assert capfd.readouterr().err == f"error: cannot write pipe: {says}\n"
    assert kind("pipe") == stat.S_IFIFO


def test_a_device_stays_one(folder, capfd):
    for name in ("null", "full"):
        put(name, name)
    before = sorted(os.listdir())
    assert [command(f"table s.h5 --csv {name}") for name in ("null", "full")] == [0, 1]
    assert capfd.readouterr().err == "error: cannot write full: No space left on device\n"
    assert kind("null") == kind("full") == stat.S_IFCHR
    assert sorted(os.listdir()) == before


@pytest.mark.parametrize("onto", ["| cat >came", ">came"])
def test_standard_output_is_the_csv_alone(folder, onto):
    """By a link of the test's own to the standard output, as /dev/stdout is."""
    (folder / "out.csv").symlink_to("/proc/self/fd/1")
    command("table s.h5 --csv x.csv")
    done = shell(f"{PROGRAM} table s.h5 --csv out.csv {onto}")
    assert Path("came").read_text() == Path("x.csv").read_text()
    assert done.stderr.startswith("wrote out.csv: ")
    assert (folder / "out.csv").is_symlink()


@pytest.mark.parametrize("node", TYPES)
def test_what_is_a_file_or_a_folder_is_no_node(folder, capfd, node):
    """To read one would wait, and to write one would lose what it is."""
    put(node, "n.h5")
    before = sorted(os.listdir())
    for line in (
        "run arm.py --no-figures --out n.h5",
        "sweep arm.py --grid l=0.2,0.3 --force --out n.h5",
        "run arm.py --figures n.h5",
        "plot x.h5 --out n.h5",
        "export arm.py --out n.h5",
    ):
        assert command(line) == 2
        told = capfd.readouterr().err
        assert told.startswith(f"error: cannot write n.h5: it is {TYPES[node]}, not a "), line
    for line in ("info", "check", "plot --out p", "table", "best --minimise peak:effort:J"):
        assert command(f"{line} n.h5") == 2
        assert capfd.readouterr() == ("", "error: n.h5: is a device or a pipe, not a file\n")
    assert kind("n.h5") == (stat.S_IFIFO if node == "pipe" else stat.S_IFCHR)
    assert sorted(os.listdir()) == before


@pytest.mark.parametrize("kind", ["pipe", "folder", "link"])
def test_what_is_among_figures_and_not_a_file_is_not_replaced(folder, capfd, kind):
    first, *others = sorted((folder / "f").glob("*.png"))
    first.unlink()
    makers = {"pipe": os.mkfifo, "folder": os.mkdir, "link": lambda path: path.symlink_to("x")}
    makers[kind](first)
    for path in others:
        path.write_text("old")
    assert command("plot x.h5 --out f") == 2
    assert capfd.readouterr().err.count("\n") == 1
    assert not stat.S_ISREG(os.lstat(first).st_mode)
    assert {path.read_text() for path in others} == {"old"}


def test_a_node_that_came_meanwhile_is_not_replaced(folder, interpreted):
    def progress(*_):
        if not os.path.exists("y.h5"):
            os.mkfifo("y.h5")

    with pytest.raises(PathError, match="what is there is not a file"):
        sweep(load_case("arm.py").scene, {"l": [0.2, 0.3]}, out="y.h5", progress=progress)
    assert kind("y.h5") == stat.S_IFIFO


def test_a_link_stays_and_what_it_leads_to_is_written(folder, interpreted):
    names = ("run.h5", "sweep.h5", "x.csv", "figures")
    (folder / "real" / "figures").mkdir(parents=True)
    for name in names:
        (folder / name).symlink_to(folder / "real" / name)
    assert command("run arm.py --out run.h5 --figures figures") == 0
    assert command("sweep arm.py --grid l=0.2,0.3 --quiet --out sweep.h5") == 0
    assert command("table sweep.h5 --csv x.csv") == 0
    assert sorted(os.listdir("real")) == sorted(names)
    assert "index.html" in os.listdir("real/figures")
    assert all((folder / name).is_symlink() for name in names)


@pytest.mark.parametrize("before", [False, True])
def test_a_table_that_cannot_be_written_leaves_the_files_of_before(folder, capfd, before):
    """A run's file, its figures and its table are put into their places together."""
    if not before:
        os.remove("x.h5")
    there = sorted((path.name, path.stat().st_mtime_ns) for path in folder.glob("*.*"))
    assert command(f"{RUN} --t 0:1:9 --csv /dev/full") == 1
    assert capfd.readouterr().err.endswith(
        "error: cannot write /dev/full: No space left on device\n"
    )
    assert sorted((path.name, path.stat().st_mtime_ns) for path in folder.glob("*.*")) == there


def test_output_that_cannot_be_written_is_one_line(folder):
    done = shell(f"{PROGRAM} info arm.py >/dev/full")
    says = "error: cannot write to standard output: No space left on device\n"
    assert (done.returncode, done.stderr) == (1, says)


@pytest.mark.long
@pytest.mark.parametrize(
    "closed", ["2>&-", "<&-", "<&- 2>&-", ">&- 2>&-", "<&- >&- 2>&-", "2>/dev/full"]
)
def test_streams_that_are_closed_stop_nothing(folder, closed):
    """Nor a cache that cannot be written, of which nobody hears."""
    lines = (f"{RUN} {closed}", f"{SWEEP} --force {closed}")
    elsewhere = {**os.environ, "XDG_CACHE_HOME": str(folder / "arm.py")} if "2>" in closed else None
    done = shell(" && ".join(f"{PROGRAM} {line}" for line in lines), env=elsewhere)
    assert done.returncode == 0
    assert ("wrote x.h5" in done.stdout) == (">&- 2" not in closed)
    assert check("x.h5") == []
    with h5py.File("s.h5") as file:
        assert file.attrs["complete"]
    assert list(folder.glob("*_figures/*.png"))
    assert shell(f"{PROGRAM} run nothing {closed}").returncode == 2


@pytest.mark.sampled(3)
@pytest.mark.parametrize("line", [f"{RUN} --no-figures", "cases", "--help"])
def test_a_reader_that_goes_early_is_no_error(folder, line):
    """As head, or a pager that is left: no line says so, and what was computed is kept."""
    os.remove("x.h5")
    done = shell(f"{{ {PROGRAM} {line}; echo $? >status; }} | true")
    assert done.stderr == ""
    assert Path("status").read_text() == "1\n"
    assert os.path.exists("x.h5") == line.startswith("run")
