"""Sweeps from the command line: what they write and say, and the one line and status of every
mistake.
"""

import os
import re
import signal
import sys
from pathlib import Path

import numpy as np
import pytest
import sweeps
from commands import command, words
from internals import Folder, Sweep
from internals import columns as kept
from internals import dask_workers as cluster
from sweeps import ASKED, CASE

from lagrange_casadi.cli import progress
from lagrange_casadi.errors import StoreError


@pytest.mark.quick
def test_sweep_writes_one_file_and_says_what_is_in_it(here, capfd):
    assert command(f"{ASKED} --grid l=0.06:0.36:4 --grid r=0.05,0.1") == 0
    out, err = capfd.readouterr()
    assert out.startswith("slider_crank: 4 x 2 = 8 designs over l, r\n  1 without a result: ")
    assert out.endswith("wrote slider_crank_sweep.h5\n")
    assert err == ""
    assert os.listdir(here) == ["slider_crank_sweep.h5"]


def test_sweep_takes_options(here, capfd):
    options = "--grid m3=0.1:10:3:log --set l=0.3 --xi 0:1:3 --keep histories --backend vm"
    assert command(f"{ASKED} {options} --workers 1 --quiet --out x.h5") == 0
    found = Sweep.open("x.h5")
    np.testing.assert_allclose(found["m3"], [0.1, 1.0, 10.0], rtol=1e-15)
    assert found["history:section:rod:bending"].shape == (3, 21, 3)
    assert found.identity["backend"] == "vm"
    assert found.identity["mechanism"]["parameters"]["l"]["value"] == 0.3
    capfd.readouterr()
    assert command(f"{ASKED} {options} --workers 1 --resume --out x.h5") == 0
    assert capfd.readouterr().out.splitlines()[1:] == [
        "x.h5 was complete already: nothing was done"
    ]


def test_sweep_of_a_list(here):
    Path("d.csv").write_text("r,l\n0.05,0.2\n0.1,0.3\n0.1,0.05\n")
    assert command(f"{ASKED} --designs d.csv --out x.h5") == 0
    found = Sweep.open("x.h5")
    np.testing.assert_array_equal(found["l"], [0.2, 0.3, 0.05])
    assert (found["status"] != 0).tolist() == [False, False, True]


MISTAKES = [
    ("--grid q=0.1:0.2:3", 2, "unknown parameter 'q'; valid: r, l, m1, m2, m3"),
    ("--grid l=0.4:0.1:3", 2, "l: STOP must be after START, got 0.4:0.1:3: the range is reversed"),
    ("--grid l=0.1:0.4:0", 2, "l: COUNT must be at least 1, got 0.1:0.4:0: the range is empty"),
    ("--grid l=nan:0.4:3", 2, "l: START and STOP must be finite, got nan:0.4:3"),
    ("--grid l=0.1,nan", 2, "l: expected finite values, got nan"),
    ("--grid l=0:0.4:3:log", 2, "l: a log range must begin above 0, got 0.0:0.4:3:log"),
    (
        "--grid l=0.1:0.4:3:lin",
        2,
        "l: expected log or nothing after COUNT, got 'lin' in 0.1:0.4:3:lin",
    ),
    ("--grid l=0.1:0.4:2.5", 2, "l: expected a whole number for COUNT, got '2.5' in 0.1:0.4:2.5"),
    ("--grid l=0.1:x:5", 2, "l: expected a number for STOP, got 'x' in 0.1:x:5"),
    ("--grid l=0.1,abc", 2, "l: expected a number for each value, got 'abc' in 0.1,abc"),
    ("--grid l=0.1,,0.2", 2, "l: expected a number for each value, got nothing in 0.1,,0.2"),
    ("--grid l=1_0", 2, "l: expected a number for each value, got '1_0' in 1_0"),
    ("--grid l=0.1:0.4:1_0", 2, "l: expected a whole number for COUNT, got '1_0'"),
    ("--grid l=0.1 --set r=1_0", 2, "a number in SI units, as in l=0.25 or phi=30deg, got 'r=1_0'"),
    ("--grid l=0.1 --t 0:1_0:5", 2, "expected START:STOP:COUNT, as in 0:0.08:801, got '0:1_0:5'"),
    (
        "--grid l=0.1:0.4",
        2,
        "expected NAME=START:STOP:COUNT, NAME=START:STOP:COUNT:log or NAME=VALUE,VALUE,...",
    ),
    (
        "--grid ll=0.1:0.4:5 --grid R=1:2:3",
        2,
        "unknown parameters 'll' (did you mean 'l'?), 'R'; valid: r, l, m1, m2, m3",
    ),
    ("--set x=3 --grid q=1,2", 2, "unknown parameters 'q', 'x'; valid: r, l, m1, m2, m3"),
    (
        "--grid l=-1:0.4:5 --set r=-2 --set m1=nan",
        2,
        (
            "-1 to 0.4, out of its range [0, inf]; parameter 'r' = -2 m is out of its range [0,"
            " inf]; parameter 'm1' must be a finite"
        ),
    ),
    (
        "--grid l=0.1,0.2 --set r=-2 --set m3=-1",
        2,
        "is out of its range [0, inf]; parameter 'm3' = -1 kg is out",
    ),
    ("--grid 0.1:0.4:3", 2, "as in l=0.1:0.4:31, got '0.1:0.4:3'"),
    ("--grid l=", 2, "got 'l='"),
    ("--grid l=0.1 --grid l=0.2", 2, "--grid: parameter 'l' is swept twice"),
    ("--grid l=0.1 --set l=0.2", 2, "parameter 'l' is swept and set to 0.2 as well"),
    (
        "--grid l=0.1:0.4:40000 --grid r=0.1:0.4:40000",
        2,
        "the grid has 1 600 000 000 designs, more than 10^9; if that is meant, say --yes",
    ),
    (
        "--grid l=-0.1:0.4:6 --grid m1=-1,1,-2",
        2,
        "l = -0.1 to 0.4, out of its range [0, inf]; m1 = -1, -2, out of its",
    ),
    ("", 2, "expected either --grid, as in --grid l=0.1:0.4:31, or --designs FILE.csv"),
    ("--grid l=0.1 --designs bad.csv", 2, "expected either --grid"),
    ("--designs none.csv", 2, "none.csv: no such file"),
    ("--designs bad.csv", 2, "bad.csv, line 3, column 'r': expected a finite number, got 'x'"),
    ("--designs short.csv", 2, "short.csv, line 2: 1 cells, expected 2, as in the first row"),
    (
        "--designs note.csv",
        2,
        "note.csv, line 1, columns 2, 4: unknown parameters 'note', 'q'; valid: r, l, m1, m2, m3",
    ),
    (
        "--designs numbered.csv",
        2,
        "numbered.csv, line 1, column 1: 'design' is a result of a sweep, not a parameter: take",
    ),
    (
        "--designs low.csv",
        2,
        "error: low.csv: l = -0.2 in line 2, -0.3 in line 4, out of its range [0, inf]",
    ),
    ("--grid l=0.2 --xi 0:2:3", 2, "ratios xi/l must lie in [0, 1]"),
    ("--grid l=0.2 --t 1:0:3", 2, "t: STOP must be after START"),
    ("--grid l=0.2 --t 0:0.08:1", 2, "t: COUNT must be 2 or more to reach from 0 to 0.08, got 1"),
    ("--grid l=0.2 --want torque", 2, "unknown output 'torque'"),
    ("--grid l=0.2 --keep all", 2, "'all' is not one of 'peaks', 'laws', 'histories'"),
    ("--grid l=0.2 --table 128", 2, "No such option"),
    ("--grid l=0.2 --workers 0", 2, "0 is not in the range 1<=x<=1024"),
    ("--grid l=0.2 --out x.txt", 2, "expected a name that ends in .h5"),
    ("--grid l=0.2 --out nowhere/x.h5", 2, "folder nowhere does not exist"),
    ("--grid l=0.2 --out mine.h5", 2, "mine.h5 exists: --force replaces it, --resume continues"),
    ("--grid l=0.2 --out mine.h5 --resume", 1, "mine.h5: not a file of this program"),
    ("--grid l=0.2 --resume --force", 2, "resume and force exclude each other"),
    ("--grid l=0.2 --dask tcp://127.0.0.1:1 --workers 2", 2, "workers and dask exclude each other"),
]


@pytest.mark.parametrize(("options", "status", "says"), MISTAKES)
def test_a_mistake_is_one_line_and_leaves_nothing(here, capfd, monkeypatch, options, status, says):
    monkeypatch.setattr(cluster, "_PATIENCE", 0.5)
    files = {
        "bad.csv": "l,r\n0.2,0.1\n0.3,x\n",
        "short.csv": "l,r\n0.2\n",
        "note.csv": "l,note,r,q\n0.2,hello,0.1,1\n",
        "numbered.csv": "design,l\n0,0.2\n",
        "low.csv": "l\n-0.2\n0.1\n-0.3\n",
        "mine.h5": "mine",
    }
    for name, text in files.items():
        (here / name).write_text(text)
    assert command(f"{ASKED} {options}") == status
    out, err = capfd.readouterr()
    assert err.startswith("error: ")
    assert err.count("\n") == 1
    assert says in err
    assert out == ""
    assert {path.name: path.read_text() for path in here.iterdir()} == files


def test_info_and_check_tell_how_far_an_unfinished_sweep_is(here, capfd, monkeypatch):
    def fail(*_):
        raise StoreError("no more")

    with monkeypatch.context() as patch:
        patch.setattr(Folder, "publish", fail)
        patch.setattr(kept, "_MOST", 20)
        assert command(f"{ASKED} --grid l=0.2:0.4:70 --workers 1 --quiet --out x.h5") == 1
    folder = here / "x.h5.parts"
    first, *_ = sorted(folder.glob("*.part"))
    for path in sorted(folder.glob("*.part"))[1:]:
        path.unlink()
    done = int(first.stem.partition("-")[2])
    (folder / "x.part.draft").write_text("being written")
    (folder / "000000000900-000000000901.part").write_text("damaged")
    (folder / "000000000000-000000000001.part").write_bytes(first.read_bytes())
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    capfd.readouterr()
    told = f"unfinished: {done} of 70 designs done; run it again with resume=True to continue"
    with Folder(here / "x.h5").locked():
        for target in ("x.h5.parts", "x.h5"):
            assert command(f"info {target}") == 0
            out = capfd.readouterr().out
            assert "swept l: 0.2:0.4:70" in out
            assert out.splitlines()[-1] == told
            assert command(f"check {target}") == 1
            out, err = capfd.readouterr()
            flaw = (
                "damaged in its header or length, or an earlier one has the same designs: it will"
                " be done again"
            )
            flawed = [
                f"{target}: {name}: {flaw}"
                for name in ("000000000000-000000000001.part", "000000000900-000000000901.part")
            ]
            assert (out, err.splitlines()) == ("", [f"{target}: {told}", *flawed])
        assert command("table x.h5") == 2
        told = "x.h5: its sweep is not finished: `lagrange-casadi info` shows its progress"
        assert capfd.readouterr() == ("", f"error: {told}\n")
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before
    (folder / "plan.json").write_text('{"grid": 3}')
    assert command("check x.h5.parts") == 1
    assert (
        "plan.json: damaged: plan.schema_version is not of the expected kind; start anew with"
        " --force" in capfd.readouterr().err
    )


def program(line):
    return sweeps.process(sys.executable, "-m", "lagrange_casadi", *words(line))


LONG = f"{ASKED} --grid l=0.11:0.4:4000 --grid r=0.05:0.1:25 --out x.h5"
SHORT = f"{ASKED} --grid l=0.11:0.4:25 --grid r=0.05:0.1:6"


@pytest.mark.long
def test_killed_and_resumed_from_the_command_line(here):
    """The real engine, in processes of its own."""
    with program(f"{SHORT} --out whole.h5") as whole:
        assert whole.communicate(timeout=120)[1] == ""
    with program(f"{SHORT} --out x.h5") as killed:
        sweeps.wait_for(lambda: killed.poll() is not None or list(here.glob("x.h5.parts/*.part")))
        killed.send_signal(signal.SIGKILL)
        killed.wait()
    with program(f"{SHORT} --out x.h5 --resume") as resumed:
        out, err = resumed.communicate(timeout=120)
        assert resumed.returncode == 0
    assert out.endswith("wrote x.h5\n")
    assert err == "" or err.startswith("going on after ")
    assert Path("x.h5").read_bytes() == Path("whole.h5").read_bytes()
    assert sorted(os.listdir(here)) == ["whole.h5", "x.h5"]


def test_ctrl_c_is_one_line_that_says_how_to_go_on(here):
    with program(LONG) as stopped:
        sweeps.wait_for(lambda: list(here.glob("x.h5.parts/*.part")))
        stopped.send_signal(signal.SIGINT)
        out, err = stopped.communicate(timeout=60)
        assert stopped.returncode == 130
    assert out == ""
    told = (
        r"error: stopped; [\d ]+ of 100 000 designs are kept in x\.h5\.parts:"
        r" continue with --resume\n"
    )
    assert re.fullmatch(told, err)
    assert os.listdir(here) == ["x.h5.parts"]


def test_ctrl_c_before_anything_is_done_leaves_nothing(here):
    case = here / "slow.py"
    case.write_text(
        "from lagrange_casadi import load_case\nprint('ready', flush=True)\nscene ="
        f" load_case({str(CASE)!r}).scene\n"
    )
    case.write_text(case.read_text().replace("scene = ", "import time; time.sleep(30)\nscene = "))
    with program("sweep slow.py --grid l=0.2 --out x.h5") as stopped:
        assert stopped.stdout.readline() == "ready\n"
        stopped.send_signal(signal.SIGINT)
        assert (
            stopped.communicate(timeout=60)[1]
            == "error: interrupted; no file was left incomplete\n"
        )
        assert stopped.returncode == 130
    assert [name for name in os.listdir(here) if name != "__pycache__"] == ["slow.py"]


def test_lines_tell_of_progress_now_and_then(capsys, monkeypatch):
    clock = iter([100.0, 101.0, 115.0, 116.0, 130.0])
    monkeypatch.setattr(progress.time, "monotonic", lambda: next(clock))
    lines = progress.Lines()
    for done in (1000, 1100, 2500, 2600, 4000):
        lines("designs", done, 10_000)
    lines.close()
    assert capsys.readouterr().err.splitlines() == [
        "going on after 1 000 of 10 000 designs",
        "2 500 of 10 000 designs, 25 %, 100 a second, 01:15 left",
        "4 000 of 10 000 designs, 40 %, 100 a second, 01:00 left",
    ]


def test_a_bar_is_shown_on_a_terminal_only(capsys, monkeypatch):
    assert type(progress.shown(quiet=True)) is progress.Silent
    assert isinstance(progress.shown(quiet=False), progress.Lines)
    monkeypatch.setattr("sys.stderr.isatty", lambda: True, raising=False)
    bar = progress.shown(quiet=False)
    for what, done, total in (("designs", 100, 1000), ("designs", 1000, 1000), ("file", 0.5, 1.0)):
        bar(what, done, total)
    bar.close()
    err = capsys.readouterr().err
    assert "designs:" in err
    assert "/1.00k" in err


def test_one_design_is_no_more_than_one(here, capfd):
    assert command(f"{ASKED} --grid l=0.2 --out x.h5") == 0
    assert capfd.readouterr().out == "slider_crank: 1 design over l\nwrote x.h5\n"


def test_the_examples_of_the_help_run(here, capfd):
    Path("cases").symlink_to(CASE.parent)
    assert command("sweep --help") == 0
    examples = re.findall(r"^ *lagrange-casadi (.*)$", capfd.readouterr().out, re.MULTILINE)
    assert [example.split()[0] for example in examples] == ["sweep", "best"]
    for example in examples:
        assert command(example) == 0


def test_of_all_the_motion_is_left_out_and_alone_it_is_kept(here, capfd):
    """As the help says."""
    for wanted in ("all", "motion"):
        line = f"sweep CASE --t 0:0.08:9 --grid l=0.2 --want {wanted} --out {wanted}.h5"
        assert command(line) == 0
        moving = {
            name.split(":")[1] for name in Sweep.open(f"{wanted}.h5").columns if name != "status"
        } & {"motion", "pose"}
        assert moving == (set() if wanted == "all" else {"motion", "pose"})
