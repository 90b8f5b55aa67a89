"""Misuses of the command line: each ends with status 2 or 1 and one clear line, and none is taken
for what has a meaning.
"""

import random
import signal
from pathlib import Path

import pytest
from commands import words

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
    "sweep": "case.py --backend vm --grid l=0.2:0.3:2 --want effort --quiet --out b.h5 --force",
    "best": "sweep.h5 --minimise peak:effort:O",
    "table": "sweep.h5",
    "trade": "case.py --want effort",
    "export": "case.py --out c --want effort --force",
    "plot": "run.h5 --out d",
    "report": "run.h5 --out e.html",
    "animate": "run.h5 --out f.svg",
    "info": "case.py",
    "check": "run.h5",
    "optimise": "case.py --backend vm --minimise l --over l=0.2:0.3 --starts 1 --screen 2 --force",
    "tolerances": "case.py --backend vm --tolerance l=0.01 --want effort --samples 4",
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
    for command, right in RIGHT.items():
        options = {
            one
            for parameter in main_options(command)
            for one in parameter.opts
            if one.startswith("--") and not getattr(parameter, "is_flag", False)
        }
        for value in (
            WRONG["FILE" if command in (*SWEPT, *RUN) else "CASE"]
            if command != "new"
            else ["", "case.py", "a" * 5000]
        ):
            if value != "." or command not in (
                "report",
                "animate",
            ):  # which show the case of a folder
                yield [command, value, *right[1:]]
        for option in sorted(options & set(WRONG)):
            for value in WRONG[option]:
                if option == "--over" and command == "optimise":
                    value = {"O=0:1:5": "q=0:1"}.get(value, value)
                if option == "--out" and command in ("plot", "export", "loads") and value == ".":
                    continue  # a folder
                kept = [*right]
                if option in kept:
                    place = kept.index(option)
                    kept[place : place + 2] = []
                yield [command, *kept, option, value]
            yield [command, *right, option]
        yield [command]
        yield [command, *right, "one", "too", "many"]
        yield [command, *right, "--nonsense"]
        yield [command, *right, "--nonsense=3"]
        yield [command[:-1], *right]
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
    return group.commands[command].params


class Hung(BaseException):
    """A command that does not end."""


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

    def hung(*_):
        raise Hung

    before = signal.signal(signal.SIGALRM, hung)
    signal.alarm(120)
    try:
        status = main(arguments)
    except Hung:
        return "hangs"
    except (Exception, SystemExit) as error:
        return f"{type(error).__name__}: {str(error)[:200]}"
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)
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
