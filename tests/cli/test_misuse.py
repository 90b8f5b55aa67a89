"""Misuses of the command line: each ends with status 2 or 1 and one clear line, and none is taken
for what has a meaning. Drawn ones of every option, and a table of the sentences.
"""

import os
import random
import subprocess
import sys
from pathlib import Path

import pytest
from commands import Hung, command, limited, words
from conftest import CASES
from sweeps import ASKED

from lagrange_casadi.cli import main

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]

CASE = """
from lagrange_casadi import Mechanism, Scene, beams, motion


def scene():
    m = Mechanism("swing")
    l, height, width = (m.parameter(name, value, "m", low=1e-3, high=2.0) for name, value in (("l", 0.5), ("h", 0.03), ("w", 0.01)))
    bar = beams.Beam(beams.rectangle(height=height, width=width), beams.material("C45+QT"))
    m.revolute("O", m.ground, m.link("arm", length=l, beam=bar))
    return Scene(m, {"O": motion.polynomial(0.0, 6.28)}, t=(0.0, 1.0, 5), xi=(0.0, 1.0, 3))
"""  # noqa: E501

MOTORS = "name,stall_torque,rated_torque,peak_torque,rated_speed,max_speed,inertia\nM,9,8,20,1000,2000,1e-5\n"  # noqa: E501
FILES = {
    "case.py": CASE,
    "motors.csv": MOTORS,
    "profiles.csv": "name,h,w\nflat,0.03,0.01\n",
    "designs.csv": "l\n0.2\n0.3\n",
    "data.csv": "t [s],O [rad],effort:O [N m]\n"
    + "".join(f"{k / 50},{0.3 * (k / 50) ** 2},{1.0 + 0.1 * k}\n" for k in range(60)),
}

TYPED = {
    "run": "case.py --backend vm --no-figures --out a.h5",
    "sweep": "case.py --grid l=0.2:0.3:2 --want effort --quiet --out b.h5 --force",
    "best": "sweep.h5 --minimise peak:effort:O",
    "table": "sweep.h5",
    "trade": "case.py --want effort",
    "export": "case.py --out c --want effort --force",
    "plot": "run.h5 --out d",
    "report": "run.h5 --out e.html",
    "animate": "run.h5 --out f.svg",
    "info": "case.py",
    "check": "run.h5",
    "optimise": "case.py --minimise l --over l=0.2:0.3 --starts 1 --screen 2 --force",
    "tolerances": "case.py --tolerance l=0.01 --want effort --samples 4",
    "size": "case.py --profiles profiles.csv",
    "drive": "case.py --motors motors.csv",
    "new": "begun",
    "free": "case.py --want effort --want motion --out g.h5",
    "identify": "case.py data.csv --unknown l --out h.h5",
    "loads": "case.py --link arm --bearing O --out i",
}
RIGHT = {command: words(options) for command, options in TYPED.items()}

GRID = words(
    "'' l l= =1:2:3 l=a:b:c q=0.2:0.3:2 l=0.2:0.3:0 l=0.2:nan:3 l=0.2:0.3:1.5"
    " l=-1:1:3 l=0.2:0.3:2:9"
)
TEXTS = ["", "nothing", "effort:Q", "peak:effort:Q", "a b", "effort:O:O:O", "\x07"]
COUNTS = ["0", "-1", "1.5", "x", "", "nan", "1" + "0" * 40]
POSITIVE = ["0", "-1", "nan", "inf", "x", "", "1e999"]
FILE = [*words("nowhere.h5 '' . /dev/null profiles.csv text.h5 cut.h5 case.py/x"), "a" * 5000]
WRONG = {
    "FILE": FILE,
    "CASE": [
        *words("nowhere '' /dev/null profiles.csv text.h5 raises.py empty.py none.py"),
        "a" * 5000,
    ],
    "--set": words(
        "'' l l= =1 l=x l=nan l=1e999 q=1 l=-1 l=0.3=4 'l=0.3 kg' 'l=3 deg' l=\u0663 l=1_0"
    ),
    "--t": words(
        "'' 0:1 0:1:0 0:1:-3 0:1:2.5 a:b:c 0:1:nan 1:0:5 0:inf:5 0:1:5:6 '0:1 deg:5' 0:1:1e99"
    ),
    "--over": words(
        "'' O O= Q=0:1:5 O=0:1 O=0:0:5 O=0:360:37 =0:1:5 O=0:1:0 O=0:nan:5 'O=0:1 m:5'"
    ),
    "--xi": ["0:2:5", "-1:1:3", "0:1:0", "x", "", "0:nan:3"],
    "--want": TEXTS,
    "--grid": GRID,
    "--backend": ["fast", "", "VM "],
    "--precision": ["half", ""],
    "--keep": ["all", ""],
    "--newton": COUNTS,
    "--table": ["0", "-1", "x", "", "nan", "inf", "1e99"],
    "--threads": COUNTS,
    "--workers": COUNTS,
    "--out": ["nowhere/x/y.h5", ".", "", "case.py/x.h5"],
    "--designs": ["nowhere.csv", "", ".", "profiles.csv", "text.h5"],
    "--minimise": TEXTS,
    "--maximise": TEXTS,
    "--where": ["", "l", "l<", "<3", "l<x", "nothing<3", "l<<3", "l<nan"],
    "--count": COUNTS[:-1],
    "--rows": COUNTS[1:-1],
    "--column": TEXTS,
    "--accuracy": POSITIVE,
    "--largest": COUNTS[1:-1],
    "--section": ["nothing", "\x07"],
    "--width": [*COUNTS, "81"],
    "--rate": POSITIVE,
    "--seconds": POSITIVE,
    "--time-limit": POSITIVE,
    "--subject-to": ["", "l", "l<", "nothing<3", "peak:effort:O<x", "l<nan"],
    "--starts": COUNTS,
    "--screen": COUNTS,
    "--points": [*COUNTS, "1"],
    "--transmission": ["-1", "2", "nan", "x", ""],
    "--tolerance": ["", "l", "l=", "q=1", "l=x", "l=nan", "l=-1", "l=1 kg"],
    "--samples": [*COUNTS, "1"],
    "--profiles": ["nowhere.csv", "", ".", "motors.csv", "text.h5"],
    "--safety": POSITIVE,
    "--deflection": POSITIVE,
    "--link": TEXTS,
    "--criterion": ["best", ""],
    "--yielding": ["best", ""],
    "--motors": ["nowhere.csv", "", ".", "profiles.csv", "text.h5"],
    "--drive": [*TEXTS, "torque", "torque=", "torque=x", "torque=1,2", "dc=1", "power=nan"],
    "--ratio": ["0", "nan", "x", "", "inf", "O="],
    "--efficiency": ["0", "-1", "nan", "x", "1.5", "inf"],
    "--inertia": ["-1", "nan", "x", "inf"],
    "--lead": ["nan", "x", "inf", "0"],
    "--at": ["x", "nan", ""],
    "--like": ["nothing", "", "../x"],
    "--geared": POSITIVE,
    "--load": ["nan", "x", "inf", ""],
    "--start": ["", "0", "x,1", "0,nan", "0,1,2"],
    "--fluctuation": POSITIVE,
    "--cycle": POSITIVE,
    "--unknown": ["", "q", "l,q", "l,", "a b"],
    "--noise": ["", "l", "effort:O", "effort:O=0", "effort:O=x", "effort:Q=1", "effort:O=-1"],
    "--prior": ["", "l", "q=1", "l=0", "l=-1", "l=x"],
    "--counts-per-turn": POSITIVE,
    "--cutoff": POSITIVE,
    "--trim": ["-1", "nan", "x", "", "9"],
    "--validate": ["nowhere.csv", "", ".", "profiles.csv", "text.h5"],
    "--figure": ["nowhere/x.png", ".", "", "x.txt", "case.py/x.png"],
    "--report": ["nowhere/x.html", ".", "", "x.txt", "case.py/x.html"],
    "--plot": ["nowhere/x.png", ".", "", "x.txt", "case.py/x.png"],
    "--format": ["dwg", ""],
    "--node": ["", "O", "=1", "O="],
    "--spectrum": [*TEXTS, "section:arm:axial", "section:arm:axial@2", "stress:arm@x"],
    "--classes": ["-1", "1.5", "x", "", "nan"],
    "--bearing": TEXTS,
    "--exponent": POSITIVE,
}
"""Values that have no meaning, by the option."""

SWEPT, RUN = ("best", "table"), ("plot", "report", "animate", "check")


def misuses():
    """Commands that are wrong in one place."""
    for name, right in RIGHT.items():
        options = {
            one
            for parameter in main_options(name)
            for one in parameter.opts
            if one.startswith("--") and not getattr(parameter, "is_flag", False)
        }
        for value in (
            WRONG["FILE" if name in (*SWEPT, *RUN) else "CASE"]
            if name != "new"
            else ["", "case.py", "a" * 5000]
        ):
            if value != "." or name not in (
                "report",
                "animate",
            ):  # which show the case of a folder
                yield [name, value, *right[1:]]
        for option in sorted(options & set(WRONG)):
            for value in WRONG[option]:
                if option == "--over" and name == "optimise":
                    value = {"O=0:1:5": "q=0:1"}.get(value, value)
                if option == "--out" and name in ("plot", "export", "loads") and value == ".":
                    continue  # a folder
                kept = [*right]
                if option in kept:
                    place = kept.index(option)
                    kept[place : place + 2] = []
                yield [name, *kept, option, value]
            yield [name, *right, option]
        yield [name]
        yield [name, *right, "one", "too", "many"]
        yield [name, *right, "--nonsense"]
        yield [name, *right, "--nonsense=3"]
        yield [name[:-1], *right]
    yield ["run", *RIGHT["run"], "--t", "0:1:5", "--over", "O=0:1:5"]
    yield ["run", *RIGHT["run"], "--newton", "3", "--table", "64"]
    yield ["sweep", *RIGHT["sweep"], "--resume"]
    yield ["sweep", *RIGHT["sweep"], "--designs", "designs.csv"]
    yield ["sweep", *RIGHT["sweep"], "--set", "l=0.3"]
    yield ["optimise", *RIGHT["optimise"], "--resume"]
    yield ["best", *RIGHT["best"], *words("--maximise l --maximise peak:effort:O --minimise l")]
    yield []
    yield ["--nonsense"]


def main_options(command):
    """The parameters of a command."""
    import click

    from lagrange_casadi import cli

    group = next(value for value in vars(cli).values() if isinstance(value, click.Group))
    return group.get_command(click.Context(group), command).params


@pytest.fixture(scope="module")
def folder(tmp_path_factory, interpreted):
    place = tmp_path_factory.mktemp("misuses")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(place)
        for name, text in FILES.items():
            Path(name).write_text(text)
        Path("raises.py").write_text("raise RuntimeError('no')")
        Path("empty.py").write_text("")
        Path("none.py").write_text("def scene():\n    return None\n")
        assert main(["run", *RIGHT["run"][:-1], "run.h5"]) == 0
        assert (
            main(["sweep", *("sweep.h5" if one == "b.h5" else one for one in RIGHT["sweep"])]) == 0
        )
        Path("text.h5").write_text("no file of HDF5")
        Path("cut.h5").write_bytes(Path("run.h5").read_bytes()[:3000])
        yield place


def fault(arguments, capsys):
    """What is wrong with how a misuse is answered."""
    try:
        with limited(120):
            status = main(arguments)
    except Hung:
        return "hangs"
    except (Exception, SystemExit) as error:
        return f"{type(error).__name__}: {str(error)[:200]}"
    told = capsys.readouterr()
    lines = [
        line for line in told.err.splitlines() if not line.startswith(("note:", "Usage:", "Try "))
    ]
    if status not in (1, 2):
        return f"status {status}"
    if (
        "Traceback" in told.err
        or not lines
        or (len(lines) > 1 and arguments and len(arguments) > 1)
        or len(told.err) > 4000
    ):
        return f"says {told.err[:300]!r}"
    return ""


def answered(chosen, capsys):
    found = {}
    for arguments in chosen:
        if said := fault(arguments, capsys):
            found[" ".join(one[:40] for one in arguments)] = said
    return found


def test_misuses_are_refused(folder, capsys):
    assert answered(random.Random(6).sample(list(misuses()), 40), capsys) == {}


@pytest.mark.long
@pytest.mark.parametrize("part", range(8))
def test_every_misuse_is_refused(folder, capsys, part):
    assert answered(list(misuses())[part::8], capsys) == {}


BROKEN = {
    "x.csv": "l,r\n0.2,0.1\n0.3,x\n",
    "short.csv": "l,r\n0.2\n",
    "note.csv": "l,note,r,q\n0.2,hello,0.1,1\n",
    "numbered.csv": "design,l\n0,0.2\n",
    "low.csv": "l\n-0.2\n0.1\n-0.3\n",
    "mine.h5": "mine",
    "text.h5": "mine",
    "raises.py": "1 / 0\n",
    "empty.py": "x = 1\n",
    "numbers.csv": "0,1\n1,2\n",
    "leaves.py": "raise SystemExit(3)\n",
    "draws.py": (
        f"""
from lagrange_casadi import load_case
def scene(): return load_case({str(CASES / "slider_crank")!r}).scene
def figures(): return 3
"""
    ),
    "heavy.py": (
        """
from lagrange_casadi import Mechanism, Scene, motion
def scene():
    m = Mechanism("heavy")
    m.revolute("J", m.ground, m.link("a", length=1, mass=m.parameter("m", 1.0, "kg", low=-10)))
    return Scene(m, {"J": motion.polynomial(0, 1)})
"""
    ),
    "gantry.py": (
        """
from lagrange_casadi import Mechanism, Scene
from lagrange_casadi.motion import dwell, move, moves


def scene():
    m = Mechanism("gantry")
    m.set_gravity(0, 0)
    load = m.parameter("load", 8.0, "kg")
    beam = m.link("beam", length=1.0, mass=12.0)
    m.prismatic("X", m.ground, beam, axis=(1, 0))
    m.prismatic("Y", beam, m.point_mass("table", load), axis=(0, 1))
    law = moves([move(0.4, time=0.4), dwell(0.2), move(0.0, time=0.4), dwell(0.1)], cyclic=True)
    other = moves([move(0.2, time=0.3), dwell(0.3), move(0.0, time=0.3), dwell(0.2)], cyclic=True)
    return Scene(m, {"X": law, "Y": other}, t=(0, 1.1, 441))
"""
    ),
    "rotary.csv": MOTORS,
    "linear.csv": "name;stall_force;rated_force;rated_speed;peak_force;max_speed;mass\n"
    "L;100;80;2;300;4;1,5\n",
    "late.py": """
from lagrange_casadi import Mechanism, Scene, motion

def law(t):
    raise SystemExit("gone")

def scene():
    m = Mechanism("arm")
    m.revolute("J", m.ground, m.link("a", length=1, mass=1))
    return Scene(m, {"J": motion.expression(law)})
""",
}
"""Files that are none of those that commands read."""

SENTENCES = [
    ("run CASE --set R=1", 2, "unknown parameter 'R'; valid: r, l, m1, m2, m3"),
    ("run CASE --set r=big", 2, "a number in SI units, as in l=0.25 or phi=30deg, got 'r=big'"),
    ("run CASE --set r", 2, "expected NAME=VALUE"),
    ("run CASE --set r=nan", 2, "parameter 'r' must be a finite number, got nan"),
    ("run CASE --set r=0.1 --set r=0.2", 2, "parameter 'r' is set twice"),
    ("identify CASE empty.py --noise O=1 --noise O=2", 2, "--noise: column 'O' has two"),
    ("identify CASE empty.py --column O=a --column O=b", 2, "'O' is read from two columns"),
    ("identify CASE empty.py --column O", 2, "'--column': expected NAME=NAME, got 'O'"),
    ("identify CASE numbers.csv", 2, "expected names of columns in the first line, as 't [s]'"),
    ("identify CASE empty.py --out raises.py", 2, "expected a name that ends in .h5"),
    ("identify CASE empty.py --out text.h5", 2, "cannot write text.h5: it is no file of HDF5"),
    ("loads CASE --link rod --out l --node A=1 --node A=2", 2, "--node: 'A' is named twice"),
    ("report CASE --beside r=1 --beside r=2", 2, "--beside: parameter 'r' is set twice"),
    ("sweep CASE --grid r=1,2 --grid r=3", 2, "--grid: parameter 'r' is swept twice"),
    ("tolerances CASE --tolerance r=1 --tolerance r=2", 2, "parameter 'r' is listed twice"),
    ("free CASE --geared 3", 2, "--geared goes with --drive"),
    ("free CASE --load inf", 2, "load: expected a law of forward, or a number"),
    ("free CASE --cycle -1", 2, "--cycle: expected a positive number of turns, got -1"),
    ("free CASE --drive torque=inf", 2, "--drive torque: expected a finite number, got 'inf'"),
    ("free CASE --fluctuation 95kN", 2, "'95kN' is a force; expected a number without a unit"),
    ("size CASE --profiles x.csv --deflection 0/1", 2, "expected a share of the length, as 1/500"),
    ("size CASE --profiles x.csv --deflection x", 2, "expected a share of the length, as 1/500"),
    ("identify CASE x.csv --counts-per-turn x", 2, "as in 4096 or O=4096, got 'x'"),
    (
        "identify CASE x.csv --counts-per-turn O=1 --counts-per-turn O=2",
        2,
        "all columns in counts, or one NAME=NUMBER for each",
    ),
    ("plot CASE --out x --at l=inf", 2, "l: expected a finite number, got inf"),
    ("draw raises.py", 2, "ZeroDivisionError"),
    ("drive CASE --ratio 0", 2, "expected numbers other than 0, as in 5 or 5,10,20, got"),
    ("drive CASE --ratio O=0", 2, "expected numbers other than 0, as in 5 or 5,10,20, got"),
    ("plot CASE --out ''", 2, "expected a path, got ''"),
    ("drive CASE --efficiency x", 2, "'--efficiency': expected a number, as in 0.05 or 5%, got"),
    ("drive CASE --lead 5kN", 2, "'--lead': '5kN' is a force; expected a length [m]"),
    ("free CASE --fluctuation 0.1 --t 0:1:5", 2, "expected it without --t"),
    ("free CASE --out raises.py", 2, "expected a name that ends in .h5"),
    ("run CASE --set m2=-1", 2, "parameter 'm2' = -1 kg is out of its range [0, inf]"),
    (
        "run CASE --set l=-1 --set r=-2",
        2,
        (
            "'l' = -1 m is out of its range [0, inf]; parameter 'r' = -2 m is out of its range"
            " [0, inf]"
        ),
    ),
    ("run CASE --set l=0", 2, "link 'rod': length must be positive, got 0 m"),
    (
        "run CASE --set r=0.3",
        1,
        "closed by joint 'guide' cannot be closed at t = 0.0093 s, where O = 0.73",
    ),
    ("run CASE --set m1=0 --set m2=0 --set m3=0", 2, "'slider_crank' has neither mass"),
    ("run heavy.py --set m=-1", 2, "link 'a': mass must not be negative, got -1 kg"),
    (
        "run CASE --want torque",
        2,
        "unknown output 'torque'; valid: all, effort, motion, reaction:O",
    ),
    ("run CASE --want reaction:X", 2, "unknown output 'reaction:X'"),
    ("run CASE --want section:slider", 2, "'slider' is not a link and has no sections"),
    ("run CASE --t 0:1:0", 2, "t: COUNT must be a whole number from 1 to 2^63 - 1, got 0"),
    ("run CASE --t 0:1", 2, "expected START:STOP:COUNT, as in 0:0.08:801, got '0:1'"),
    ("run CASE --t 1:0:5", 2, "t: STOP must be after START"),
    (
        "run CASE --over O=0:1",
        2,
        "expected JOINT=START:STOP:COUNT, as in O=0:720deg:721, got 'O=0:1'",
    ),
    ("run CASE --over A=0:1:5", 2, "unknown driven joint in over 'A'; valid: O"),
    (
        "run CASE --over O=0:1lap:5",
        2,
        "expected JOINT=START:STOP:COUNT, as in O=0:720deg:721, got 'O=0:1lap:5'",
    ),
    ("run CASE --over O=0:1:5 --t 0:1:5", 2, "t and over exclude each other"),
    (
        "run CASE --over O=1:0:5",
        2,
        "the motion of joint 'O' runs opposite to the range from 1 rad",
    ),
    ("run CASE --xi 0:2:5", 2, "ratios xi/l must lie in [0, 1]"),
    ("run CASE --backend gpu", 2, "'gpu' is not one of 'auto', 'lanes', 'c', 'vm'"),
    ("sweep CASE --grid l=1:2:3 --backend vm", 2, "'vm' is not one of 'auto', 'lanes', 'c'"),
    (
        "run CASE --out nowhere/x.h5",
        2,
        "cannot write nowhere/x.h5: folder nowhere does not exist",
    ),
    ("run CASE --out .", 2, "expected a name that ends in .h5"),
    ("run CASE --figures raises.py", 2, "it is a file, not a folder"),
    ("run nothing", 2, "case nothing: no such file"),
    ("run low.csv", 2, "expected a folder with a case.py, or a Python file ending in .py"),
    ("run raises.py", 2, "case raises.py, line 1: ZeroDivisionError: division by zero"),
    ("run empty.py", 2, "case empty.py: has no function scene()"),
    ("run", 2, "Missing argument 'CASE'"),
    (
        "walk",
        2,
        (
            "unknown command 'walk'; valid: run, info, check, cases, new, sweep, best, table,"
            " optimise, size"
        ),
    ),
    ("run CASE --fast", 2, "No such option"),
    ("run CASE --figures a --no-figures", 2, "exclude each other"),
    ("run CASE --out m.txt", 2, "expected a name that ends in .h5"),
    ("run late.py", 1, ": gone"),
    ("run leaves.py", 2, "case leaves.py, line 1: SystemExit: 3"),
    ("run draws.py", 2, "figures() must return a list of specs"),
    ("info .", 2, "case .: has no case.py"),
    ("check nothing.h5", 2, "nothing.h5: no such file"),
    ("check raises.py", 1, "raises.py: not a file of this program"),
    ("plot raises.py --out figures", 1, "not a file of this program"),
    ("info nothing.h5", 2, "nothing.h5: no such file"),
    ("info x.h5 --want effort", 2, "--want goes with a case"),
    ("export CASE", 2, "Missing option '--out'"),
    ("export CASE --out raises.py", 2, "it is a file, not a folder"),
    (
        "export CASE --out .",
        2,
        "cannot export into .: it holds other files, 'draws.py' among them",
    ),
    ("export CASE --out c --precision half", 2, "'half' is not one of 'double', 'single'"),
    ("export CASE --out c --want torque", 2, "unknown output 'torque'"),
    ("export CASE --out c --set r=0.3", 1, "closed by joint 'guide' cannot be closed"),
    ("export CASE --out c --table 64 --newton 2", 2, "newton and table exclude each other"),
    ("export CASE --out c --table 4096 --precision single", 1, "and the limit is 64000"),
    ("export CASE --out nowhere/c", 2, "folder nowhere does not exist"),
    ("export CASE --out raises.py/c", 2, "folder raises.py is a file"),
    ("export CASE --out " + "a" * 300, 2, "File name too long"),
    ("run " + "a" * 300, 2, "File name too long"),
    *(
        (f"drive gantry.py {more}", 2, says)
        for more, says in {
            "--motors rotary.csv": "drive 'X' slides: expected --lead, the travel per turn of the",
            "--motors linear.csv --lead 0.1": "--lead: linear motors have no lead",
            "--lead -1": "--lead: expected a positive length",
            "--inertia nan": "--inertia: expected a number that is not negative",
            "--ratio 5,x": "expected numbers other than 0, as in 5 or 5,10,20, got 'x'",
            "--drive Z": "unknown drive 'Z'; valid: X, Y",
            "--plot x.png": "--plot: expected one drive, by --drive; there are X, Y",
            "--drive X --plot x.txt": "x.txt: expected a name that ends in .png, .pdf, .svg",
            "--motors none.csv": "none.csv: no such file",
            "--motors rotary.csv --lead 0.02 --efficiency 2": "must be above 0 and at most 1",
        }.items()
    ),
]


SEARCH = "optimise CASE --minimise peak:effort:O --over l=0.12:0.8 --starts 2"
PLAIN = "run CASE --no-figures"
SEARCHED_AND_SWEPT = [
    (f"{SEARCH} --over r=0.3", 2, "expected NAME=LEAST:LARGEST, as in l=0.15:0.4, got 'r=0.3'"),
    (f"{SEARCH} --over l=0.1:0.2", 2, "--over: parameter 'l' is listed twice"),
    (f"{SEARCH} --over k=0.1:0.2", 2, "unknown parameter 'k'; valid: r, l"),
    (f"{SEARCH} --subject-to peak:effort:O", 2, "expected a constraint such as"),
    (f"{SEARCH} --figure x.txt", 2, "expected a name that ends in .png or .pdf or .svg"),
    (f"{SEARCH} --set l=0.2", 2, "parameter 'l' is in over= and set to a value as well"),
    (f"{SEARCH} --out notes.txt", 2, "--out notes.txt: expected a name that ends in .h5 or .hdf5"),
    (f"{SEARCH} --out nowhere/x.h5", 2, "folder nowhere does not exist"),
    (
        f"{PLAIN} --newton 0",
        2,
        "newton: expected a number of steps, from 1 to 1000 (after some ten",
    ),
    (f"{PLAIN} --newton two", 2, "Invalid value for '--newton': 'two' is not a valid integer"),
    (
        f"{PLAIN} --table 3",
        2,
        "table: expected a number of nodes, at least 8, or an accuracy betwee",
    ),
    (
        f"{PLAIN} --table few",
        2,
        "expected a number of nodes or an accuracy, as in 128 or 1e-6, got",
    ),
    (f"{PLAIN} --precision half", 2, "'half' is not one of 'double', 'single'"),
    (
        f"{PLAIN} --backend vm --flags -O1",
        2,
        "backend 'vm' compiles nothing; flags '-O1' need lanes",
    ),
    (
        f"{PLAIN} --newton 1",
        2,
        "newton: no loop of 'slider_crank' is iterated; leave newton out",
    ),
    (
        f"{PLAIN} --csv ./slider_crank.h5",
        2,
        "slider_crank.h5: expected another place",
    ),
    (f"{PLAIN} --csv nowhere/rows.csv", 2, "folder nowhere does not exist"),
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
    ("--grid l=0.1 --designs x.csv", 2, "expected either --grid"),
    ("--designs none.csv", 2, "none.csv: no such file"),
    ("--designs x.csv", 2, "x.csv, line 3, column 'r': expected a finite number, got 'x'"),
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
]
SENTENCES += [
    (line if "CASE" in line else f"{ASKED} {line}", *row) for line, *row in SEARCHED_AND_SWEPT
]


@pytest.mark.parametrize(("line", "status", "says"), SENTENCES)
def test_a_mistake_is_one_line_and_leaves_nothing(here, capfd, line, status, says):
    for name, text in BROKEN.items():
        (here / name).write_text(text)
    before = sorted(os.listdir(here))
    assert command(line) == status
    out, err = capfd.readouterr()
    assert err.startswith("error: ")
    assert err.count("\n") == 1
    assert says in err
    assert out == ""
    left = [name for name in os.listdir(here) if name != "__pycache__"]
    # But for the picture of a loop that does not close, which is said.
    assert sorted(name for name in left if f"{name} draws it" not in err) == before


def test_a_compiler_that_fails_or_lacks_is_one_line(here, capfd, monkeypatch, tmp_path_factory):
    folder = tmp_path_factory.mktemp("cc")
    program = folder / "cc"
    program.write_text(
        '#!/bin/sh\ntest "$1" = --version && exit 0\necho "x.c:1: error: no" >&2\nexit 1\n'
    )
    program.chmod(0o755)
    monkeypatch.setenv("CC", str(program))
    monkeypatch.setenv("XDG_CACHE_HOME", str(folder / "cache"))
    assert command("run CASE --backend c") == 1
    assert "failed with status 1: x.c:1: error: no (whole message in" in capfd.readouterr().err
    program = (
        "import importlib.util, sys; importlib.util.find_spec = lambda _: None;"
        " from lagrange_casadi.cli import main; ways = [], ['--backend', 'c'], ['--refine-peaks'];"
        " print([main([*sys.argv[1:], *more]) for more in ways])"
    )
    asked = [sys.executable, "-c", program, *words("run CASE --t 0:0.08:11 --no-figures")]
    bare = {"env": {"PATH": "", "XDG_CACHE_HOME": str(folder)}}
    done = subprocess.run(asked, check=True, capture_output=True, text=True, **bare)
    assert done.stdout.endswith("\n[0, 1, 1]\n")
    assert done.stderr.startswith("note: no C or C++ compiler found")
    assert "backend vm; largest at the instants:" in done.stdout
    assert "backend 'c' needs a C compiler" in done.stderr
    assert "peaks between instants need a compiler" in done.stderr
    assert os.listdir(here) == ["slider_crank.h5"]
