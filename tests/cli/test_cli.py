"""The command line: what it writes, and the one line and status of every mistake."""

import errno
import math
import os
import re
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path
from xml.etree import ElementTree

import h5py
import numpy as np
import pytest
from commands import command, words
from forging import forging
from internals import ordered, peak_line, shown
from internals import report_readable as readable

from lagrange_casadi import Peak, evaluate, load, load_case
from lagrange_casadi.cli import main

CASE = Path(__file__).parents[2] / "cases" / "slider_crank"


def test_run_writes_the_file_and_the_figures(here, capsys):
    assert command("run CASE") == 0
    assert sorted(path.name for path in here.iterdir()) == [
        "slider_crank.h5",
        "slider_crank_figures",
    ]
    figures = sorted(path.stem for path in (here / "slider_crank_figures").glob("*.png"))
    assert [name[:5] for name in figures[:9]] == [f"fig{n:02}" for n in range(6, 15)]
    assert figures[9:] == ["mechanism", "rod_maps"]
    index = (here / "slider_crank_figures" / "index.html").read_text()
    assert sorted(re.findall(r'<img src="(\w+)\.png"', index)) == figures
    out = capsys.readouterr().out
    assert "wrote slider_crank.h5 and the figures in slider_crank_figures/" in out
    assert (
        "  bending moment  section:crank:bending            -8.31361 N m  at t = 0.0076 s, xi/l ="
        " 0\n" in out
    )
    (row,) = (line for line in out.splitlines() if line.startswith("  section:rod:bending"))
    assert row.split()[1:] == ["0.941724", "N", "m", "0.0692", "0.4527", "-0.896639", "0.941724"]
    assert " +- " not in out


def test_figures_may_be_svg(here):
    """The same ones as PNG, with a page that shows them; the bytes are the same each time."""
    assert command("run CASE --t 0:0.08:41 --want effort --want reaction:A --no-figures") == 0
    for out in ("png", "svg --svg", "again --svg"):
        assert command(f"plot slider_crank.h5 --out {out}") == 0
    drawn = sorted((here / "svg").glob("*.svg"))
    assert drawn
    assert [path.stem for path in drawn] == sorted(
        path.stem for path in (here / "png").glob("*.png")
    )
    assert not [*(here / "svg").glob("*.png")]
    index = (here / "svg" / "index.html").read_text()
    assert sorted(re.findall(r'<img src="([\w.]+)"', index)) == [path.name for path in drawn]
    for path in drawn:
        assert ElementTree.parse(path).getroot().tag == "{http://www.w3.org/2000/svg}svg"
        assert path.read_bytes() == (here / "again" / path.name).read_bytes()


def test_run_refines_peaks(here, capsys):
    """The report changes, the file does not."""
    line = "run CASE --t 0:0.08:41 --no-figures --want effort --want section:rod"
    assert command(f"{line} --out one.h5") == 0
    assert "ratios xi/l, backend" in (plain := capsys.readouterr().out)
    assert command(f"{line} --out two.h5 --refine-peaks") == 0
    refined = capsys.readouterr().out
    assert "; largest at the instants:" in plain
    assert "; largest, refined between the instants:" in refined
    assert Path("one.h5").read_bytes() == Path("two.h5").read_bytes()
    solution = evaluate(load_case(CASE).scene, t=(0, 0.08, 100_001), wanted=["effort"])
    value = f"  effort:O                     {solution.peak('effort:O').value:>12.6g} N m  at "
    assert value in refined
    assert value not in plain


def test_a_peak_that_is_not_told_is_no_number(slider_crank):
    solution = evaluate(slider_crank.scene, wanted=["effort"], t=(0, 0.08, 9))
    line = peak_line(solution, Peak("effort:O", math.nan, "N m", 0.02, None, 7.5))
    assert ">= 7.5 N m  at t = 0.02 s; the peak between the instants was not found" in line
    assert "nan" not in line


@pytest.mark.quick
def test_run_takes_options(here):
    options = "--set l=0.25 --set m3=0.2 --t 0:0.04:5 --xi 0:1:3 --want section:rod"
    assert command(f"run CASE {options} --backend vm --out x.h5 --no-figures") == 0
    assert [path.name for path in here.iterdir()] == ["x.h5"]
    with h5py.File("x.h5") as h:
        assert set(h) == {"t", "xi", "section", "certificate"}
        assert h["section/rod/bending"].shape == (5, 3)
        assert h.attrs["backend"] == "vm"
        assert '"l": 0.25' in h.attrs["parameters"]


@pytest.mark.quick
def test_run_goes_over_a_drive(here, capsys):
    """Angles in degrees where they are typed and where they are shown."""
    assert command("run CASE --over 'O = 0:360deg:37' --want effort --out x.h5 --no-figures") == 0
    assert re.search(r"effort:O .* N m  at O = 30 deg, t = 0\.00666", capsys.readouterr().out)
    with h5py.File("x.h5") as h:
        np.testing.assert_allclose(h["over"], math.tau * np.arange(37) / 36, rtol=1e-15)
    assert command("info x.h5") == 0
    assert "in equal steps of O [deg]: 0 to 360" in capsys.readouterr().out


def test_run_replaces_an_older_file(here):
    Path("x.h5").touch()
    for count in (5, 9):
        assert command(f"run CASE --t 0:0.04:{count} --out x.h5 --no-figures") == 0
        assert load("x.h5").t.size == count
    assert command("check x.h5") == 0


PLAIN = f"""
from lagrange_casadi import load_case
def scene(): return load_case({str(CASE)!r}).scene
"""


def test_cases_of_two_versions_write_files_of_their_own(here):
    for version in ("1.2", "1.3"):
        folder = Path("cases") / f"press_{version}"
        folder.mkdir(parents=True)
        (folder / "case.py").write_text(PLAIN)
        assert command(f"run {folder} --t 0:0.04:5 --want effort") == 0
        line = f"sweep {folder} --grid l=0.2,0.3 --want effort --t 0:0.04:5 --quiet"
        assert command(line) == 0
    own = [
        f"press_{version}{end}"
        for version in ("1.2", "1.3")
        for end in (".h5", "_figures", "_sweep.h5")
    ]
    assert sorted(os.listdir(here)) == ["cases", *own]


@pytest.mark.parametrize("figures", ["x.h5", "./x.h5", "y/../x.h5"])
def test_figures_have_a_place_of_their_own(here, capfd, figures):
    (here / "y").mkdir()
    assert command(f"run CASE --t 0:0.04:5 --out x.h5 --figures {figures}") == 2
    assert capfd.readouterr() == (
        "",
        f"error: --figures {Path(figures)}: expected another place than the file's\n",
    )
    assert os.listdir(here) == ["y"]


def test_what_is_in_the_way_of_a_figure_is_told_before_the_file_is_there(here, capfd):
    (here / "figures" / "effort_O.png").mkdir(parents=True)
    (here / "case.py").write_text(PLAIN)
    assert command("run case.py --t 0:0.04:5 --want effort --out x.h5 --figures figures") == 2
    assert capfd.readouterr().err.startswith(
        "error: cannot draw into figures: it holds other files, 'effort_O.png' among"
    )
    assert sorted(path.name for path in here.iterdir() if path.name != "__pycache__") == [
        "case.py",
        "figures",
    ]
    assert os.listdir(here / "figures") == ["effort_O.png"]


FEW_FIGURES = """
from lagrange_casadi import load_case
CASE = load_case({case!r})
def scene(): return CASE.scene
def figures(): return list({{type(spec): spec for spec in CASE.figures}}.values())
"""


@pytest.mark.long
def test_plot_draws_what_run_drew(here):
    """Of the case's own figures some: one of each kind."""
    (here / "case.py").write_text(FEW_FIGURES.format(case=str(CASE)))
    assert command("run case.py --t 0:0.08:41 --out slider_crank.h5 --figures one") == 0
    assert len(list(Path("one").glob("*.png"))) == 4
    assert command("plot slider_crank.h5 --out two") == 0
    for path in Path("one").iterdir():
        assert path.read_bytes() == (Path("two") / path.name).read_bytes(), path.name


def test_info_of_a_case_counts_instructions(capsys):
    assert command("info CASE") == 0
    everything = capsys.readouterr().out
    assert command("info CASE --want effort") == 0
    effort = capsys.readouterr().out
    counts = [
        int(text.split("instructions an instant: ")[1].split()[0]) for text in (effort, everything)
    ]
    assert counts[0] < counts[1]
    assert "outputs: all, effort, motion, reaction:O" in everything
    assert "loops closed by: guide (closed form)" in everything
    assert "parameter r = 0.1 m (range 0 to inf)" in everything


def test_info_of_a_file(here, capsys):
    command("run CASE --t 0:0.08:41 --no-figures")
    capsys.readouterr()
    assert command("info slider_crank.h5") == 0
    out = capsys.readouterr().out
    assert re.search(r"backend: (lanes|c), double", out)
    assert "section:rod:bending" in out


def test_check_fails_a_damaged_file(here, capsys):
    command("run CASE --t 0:0.08:41 --no-figures")
    with forging(Path("slider_crank.h5")) as h:
        h["section/rod/bending"][3, 4] = 7.0
    capsys.readouterr()
    assert command("check slider_crank.h5") == 1
    assert "section/rod/bending: differs from its law" in capsys.readouterr().err


BROKEN = {
    "text.h5": "mine",
    "raises.py": "1 / 0\n",
    "empty.py": "x = 1\n",
    "leaves.py": "raise SystemExit(3)\n",
    "draws.py": (
        f"""
from lagrange_casadi import load_case
def scene(): return load_case({str(CASE)!r}).scene
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
}


@pytest.mark.quick
@pytest.mark.parametrize(
    ("line", "status", "says"),
    [
        ("run CASE --set R=1", 2, "unknown parameter 'R'; valid: r, l, m1, m2, m3"),
        ("run CASE --set r=big", 2, "a number in SI units, as in l=0.25 or phi=30deg, got 'r=big'"),
        ("run CASE --set r", 2, "expected NAME=VALUE"),
        ("run CASE --set r=nan", 2, "parameter 'r' must be a finite number, got nan"),
        ("run CASE --set r=0.1 --set r=0.2", 2, "parameter 'r' is set twice"),
        ("identify CASE empty.py --noise O=1 --noise O=2", 2, "--noise: column 'O' has two"),
        ("identify CASE empty.py --column O=a --column O=b", 2, "'O' is read from two columns"),
        ("identify CASE empty.py --column O", 2, "'--column': expected NAME=NAME, got 'O'"),
        ("identify CASE empty.py --out raises.py", 2, "expected a name that ends in .h5"),
        ("identify CASE empty.py --out text.h5", 2, "cannot write text.h5: it is no file of HDF5"),
        ("loads CASE --link rod --out l --node A=1 --node A=2", 2, "--node: 'A' is named twice"),
        ("report CASE --beside r=1 --beside r=2", 2, "--beside: parameter 'r' is set twice"),
        ("sweep CASE --grid r=1,2 --grid r=3", 2, "--grid: parameter 'r' is swept twice"),
        ("tolerances CASE --tolerance r=1 --tolerance r=2", 2, "parameter 'r' is listed twice"),
        ("free CASE --geared 3", 2, "--geared goes with --drive"),
        ("free CASE --load inf", 2, "--load: expected a finite number, got inf"),
        ("free CASE --cycle -1", 2, "--cycle: expected a positive number of turns, got -1"),
        ("free CASE --drive torque=inf", 2, "--drive torque: expected a finite number, got 'inf'"),
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
        (
            "run CASE --out nowhere/x.h5",
            2,
            "cannot write nowhere/x.h5: folder nowhere does not exist",
        ),
        ("run CASE --out .", 2, "expected a name that ends in .h5"),
        ("run CASE --figures raises.py", 2, "it is a file, not a folder"),
        ("run nothing", 2, "case nothing: no such file"),
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
    ],
)
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
    assert sorted(name for name in os.listdir(here) if name != "__pycache__") == before


def test_export_says_what_it_wrote_and_how_to_try_it(here, capfd):
    case = here / "float"
    case.mkdir()
    (case / "case.py").write_text(BROKEN["heavy.py"].replace('"m"', '"int"'))
    assert command("export float --out c --precision single --want effort") == 0
    out, err = capfd.readouterr()
    assert err == ""
    assert out.splitlines() == [
        "name float is called float_mechanism in C",
        "parameter int is called int_ in C",
        (
            "wrote c: float_mechanism.h, float_mechanism.c and what goes with them; 4 inputs, 1"
            " outputs"
        ),
        "try it: cd c && cmake -B build && cmake --build build && ctest --test-dir build",
    ]


def test_export_to_a_full_disk_is_one_line(here, capfd, monkeypatch):
    def full(*_arguments, **_options):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", full)
    assert command("export CASE --out c") == 1
    assert capfd.readouterr().err == "error: cannot write c: No space left on device\n"
    assert os.listdir(here) == []


def test_a_failing_compiler_is_one_line(here, capfd, monkeypatch, tmp_path_factory):
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
    assert os.listdir(here) == []


def test_without_a_compiler_one_line_says_so(here, capfd, monkeypatch):
    for variable in ("CC", "CXX"):
        monkeypatch.delenv(variable, raising=False)
    monkeypatch.setenv("PATH", "")
    monkeypatch.setattr("lagrange_casadi.codegen.compiler.importlib.util.find_spec", lambda _: None)
    assert command("run CASE --t 0:0.08:11 --no-figures") == 0
    assert capfd.readouterr().err.startswith("note: no C or C++ compiler found")
    assert command("run CASE --backend c --out y.h5 --no-figures") == 1
    assert "backend 'c' needs a C compiler" in capfd.readouterr().err
    assert os.listdir(here) == ["slider_crank.h5"]


WITHIN_TEXT = """
import os, signal
def scene():
    exec("os.kill(os.getpid(), signal.SIGINT)")
"""


def test_ctrl_c_while_python_executes_text_ends_with_its_status(here):
    """Python would end the program by the signal itself, as it does while a dataclass is made."""
    Path("text.py").write_text(WITHIN_TEXT)
    command = [sys.executable, *words("-m lagrange_casadi run text.py")]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (130, "")
    assert done.stderr == "error: interrupted; no file was left incomplete\n"


SLOW = """
import time
from lagrange_casadi import load_case
def scene():
    print("ready", flush=True)
    return load_case({case!r}).scene
"""


@pytest.mark.sampled(5)
@pytest.mark.parametrize("delay", [0.0, 0.01, 0.02, 0.5])
def test_ctrl_c_is_one_line_and_leaves_nothing(here, tmp_path_factory, delay):
    """A real interrupt of a real process, which would compute for a long while."""
    case = tmp_path_factory.mktemp("slow") / "slow.py"
    case.write_text(SLOW.format(case=str(CASE)))
    command = [
        sys.executable,
        *words("-m lagrange_casadi run"),
        str(case),
        *words("--t 0:0.08:10000000 --backend vm"),
    ]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert process.stdout.readline() == "ready\n"
    time.sleep(delay)
    process.send_signal(signal.SIGINT)
    try:
        out, err = process.communicate(timeout=60)
    finally:
        process.kill()
    assert process.returncode == 130, err
    assert re.fullmatch(
        r"(note: 10 000 000 instants take about .*\n)?error: interrupted; no file was left"
        r" incomplete\n",
        err,
    )
    assert out == ""
    assert os.listdir(here) == []


@pytest.mark.sampled(3)
@pytest.mark.parametrize("size", [20_000, 400_000, 2_000_000])
def test_a_file_that_cannot_grow_is_one_line(released, here, size):
    """A real write that fails, at several places of the file; the system's limit stands for a full
    disk.
    """

    def limit():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))

    asked = ["run", str(CASE), "--no-figures"]
    # All that it compiles is there: a compiler could not write, either.
    assert main([*asked, "--t", "0:0.08:601"]) == 0
    before = Path("slider_crank.h5").read_bytes()
    # Without bytecode, which Python would leave cut off for others.
    command = [sys.executable, "-B", "-m", "lagrange_casadi", *asked]
    done = subprocess.run(command, capture_output=True, text=True, check=False, preexec_fn=limit)
    assert done.returncode == 1
    assert done.stderr == "error: cannot write slider_crank.h5: File too large\n"
    assert os.listdir(here) == ["slider_crank.h5"]
    assert Path("slider_crank.h5").read_bytes() == before


def test_no_command_shows_the_help(capsys):
    assert command("") == 2
    assert "Many designs:\n" in capsys.readouterr().err


@pytest.mark.quick
def test_version(capsys):
    assert command("--version") == 0
    assert "lagrange-casadi, version" in capsys.readouterr().out


@pytest.mark.quick
@pytest.mark.parametrize(
    ("shell", "words", "number", "offered"),
    [
        ("bash", "lagrange-casadi r", "1", ["plain,report", "plain,run"]),
        ("bash", "lagrange-casadi run --prec", "2", ["plain,--precision"]),
        ("bash", "lagrange-casadi run x --precision ", "4", ["plain,double", "plain,single"]),
        ("bash", "lagrange-casadi run slider", "2", ["file,slider", "plain,slider_crank"]),
        ("bash", "lagrange-casadi no_command --", "2", ["plain,--version", "plain,--help"]),
        ("zsh", "lagrange-casadi cac", "1", ["plain", "cache", "Show the cache of graphs and"]),
        ("fish", "lagrange-casadi cac", "cac", ["plain,cache\tShow the cache of graphs and"]),
    ],
)
def test_a_shell_completes(monkeypatch, capsys, shell, words, number, offered):
    monkeypatch.setenv("_LAGRANGE_CASADI_COMPLETE", f"{shell}_complete")
    monkeypatch.setenv("COMP_WORDS", words)
    monkeypatch.setenv("COMP_CWORD", number)
    assert main([]) == 0
    # Releases of click part a kind, a word and its help by commas, tabs or lines.
    found, starts = (
        re.split("[,\t\n]", text.strip()) for text in (capsys.readouterr().out, "\n".join(offered))
    )
    assert [word[: len(start)] for word, start in zip(found, starts, strict=True)] == starts


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_a_shell_gets_its_completion(monkeypatch, capsys, shell):
    monkeypatch.setenv("_LAGRANGE_CASADI_COMPLETE", f"{shell}_source")
    assert main([]) == 0
    assert f"_LAGRANGE_CASADI_COMPLETE={shell}_complete" in capsys.readouterr().out


@pytest.mark.parametrize("case", ["slider_crank", "excavator", "stewart_gough"])
def test_a_run_fits_a_screen(here, capsys, case):
    """The rest is in the whole list, in which no name stands twice."""
    line = f"run {case} --no-figures --backend vm --no-certificate"
    assert command(line) == 0
    short = capsys.readouterr().out.splitlines()
    assert len(short) < 40
    assert command(f"{line} --verbose") == 0
    whole = capsys.readouterr().out
    solution = load(f"{case}.h5")
    rows = [row.split() for row in whole.splitlines()[2:] if row.startswith("  ")]
    names = [row[0] for row in rows if ":" in row[0]]
    assert len(names) == len(set(names))
    assert set(map(str, ordered(solution))) <= set(names)
    cut = case != "slider_crank"
    assert any("--verbose lists all" in row for row in short) == cut


def test_rounding_is_zero_and_an_error_is_shown_where_it_reaches_the_digits():
    assert readable(1e-13, 2e-13, 100.0) == "0"
    assert readable(3e-5, 2e-13, 100.0) == "3e-05"
    assert readable(-0.0, None, 1.0) == "0"
    peak = Peak("effort:O", 8.31361, "N m", 0.1)
    assert shown(peak, 4e-6, 8.3) == "8.31361"
    assert shown(peak, 6e-6, 8.3) == "8.31361 +- 6e-06"
    assert shown(Peak("effort:O", 0.003, "N m", 0.1), 0.01, 0.1) == "0.003 +- 1e-02"


def test_welds_inside_bent_bars_are_left_out_unless_asked_for(here, capsys):
    Path("bell.py").write_text(
        "from lagrange_casadi import Mechanism, Scene\nfrom lagrange_casadi.elements import"
        " bent_bar\n"
        "from lagrange_casadi.motion import polynomial\n\n\n"
        "def scene():\n    m = Mechanism('bell')\n"
        "    bar = bent_bar(m, 'crank', [(0, 0), (0.2, 0), (0.2, 0.3)], mass=1.0)\n"
        "    m.revolute('O', m.ground, bar.base)\n"
        "    m.weld('hook', bar.tip, m.link('tip', length=0.1, mass=0.2), angle=0.0)\n"
        "    return Scene(m, {'O': polynomial(0.0, 3.0)}, t=(0.0, 1.0, 11))\n"
    )
    line = "run bell.py --no-figures --backend vm"
    assert command(line) == 0
    out = capsys.readouterr().out
    assert "reaction:hook" in out
    assert "reaction:crank_bend_1" not in out
    for more in ("--verbose", "--want reaction:crank_bend_1"):
        assert command(f"{line} {more}") == 0
        assert "reaction:crank_bend_1:resultant" in capsys.readouterr().out
