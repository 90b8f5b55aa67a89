"""Sweeps from the command line: what they write and say, and the one line and status of every
mistake, of searches, trades and runs too.
"""

import re
from pathlib import Path

import numpy as np
import pytest
from commands import command
from sweeps import ASKED, CASE

from lagrange_casadi import Sweep


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


SEARCH = "optimise CASE --minimise peak:effort:O --over l=0.12:0.8 --starts 2"
RUN = "run CASE --no-figures"
MISTAKES = [
    (f"{SEARCH} --over r=0.3", 2, "expected NAME=LEAST:LARGEST, as in l=0.15:0.4, got 'r=0.3'"),
    (f"{SEARCH} --over l=0.1:0.2", 2, "--over: parameter 'l' is listed twice"),
    (f"{SEARCH} --over k=0.1:0.2", 2, "unknown parameter 'k'; valid: r, l"),
    (f"{SEARCH} --subject-to peak:effort:O", 2, "expected a constraint such as"),
    (f"{SEARCH} --figure x.txt", 2, "expected a name that ends in .png or .pdf or .svg"),
    (f"{SEARCH} --set l=0.2", 2, "parameter 'l' is in over= and set to a value as well"),
    (f"{SEARCH} --out notes.txt", 2, "--out notes.txt: expected a name that ends in .h5 or .hdf5"),
    (f"{SEARCH} --out nowhere/x.h5", 2, "folder nowhere does not exist"),
    (f"{RUN} --newton 0", 2, "newton: expected a number of steps, from 1 to 1000 (after some ten"),
    (f"{RUN} --newton two", 2, "Invalid value for '--newton': 'two' is not a valid integer"),
    (f"{RUN} --table 3", 2, "table: expected a number of nodes, at least 8, or an accuracy betwee"),
    (f"{RUN} --table few", 2, "expected a number of nodes or an accuracy, as in 128 or 1e-6, got"),
    (f"{RUN} --precision half", 2, "'half' is not one of 'double', 'single'"),
    (f"{RUN} --backend vm --flags -O1", 2, "backend 'vm' compiles nothing; flags '-O1' need lanes"),
    (
        f"{RUN} --newton 1",
        2,
        "newton: no loop of 'slider_crank' is iterated; leave newton out",
    ),
    (
        f"{RUN} --csv ./slider_crank.h5",
        2,
        "slider_crank.h5: expected another place",
    ),
    (f"{RUN} --csv nowhere/rows.csv", 2, "folder nowhere does not exist"),
    ("trade CASE --figure x.txt", 2, "x.txt: expected a name that ends in .png"),
    ("trade CASE --out x.png", 2, "x.png: expected a name that ends in .json"),
    ("trade CASE --out nowhere/x.json", 2, "cannot write nowhere/x.json: folder nowhere does not"),
    ("trade CASE --accuracy 0", 2, "accuracy: expected a finite number above 0, got 0.0"),
    ("trade CASE --accuracy nan", 2, "accuracy: expected a finite number above 0, got nan"),
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
    monkeypatch.setattr("lagrange_casadi.cluster.dask_workers._PATIENCE", 0.5)
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
    assert command(options if "CASE" in options else f"{ASKED} {options}") == status
    out, err = capfd.readouterr()
    assert err.startswith("error: ")
    assert err.count("\n") == 1
    assert says in err
    assert out == ""
    assert {path.name: path.read_text() for path in here.iterdir()} == files


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
