"""What commands print, write and return: transcripts, lines that do the same, and the files of the
paper's case.
"""

import filecmp
import math
import os
import re
import runpy
import shlex
import textwrap
from pathlib import Path

import h5py
import numpy as np
import pytest
from commands import command, missing
from conftest import CASES, NAMES

from lagrange_casadi import evaluate, load_case
from lagrange_casadi.cli import main
from lagrange_casadi.errors import LagrangeCasadiError

TEXT = (Path(__file__).parent / "transcripts.txt").read_text()
TRANSCRIPTS = dict(part.split("\n", 1) for part in TEXT.split("\n== ")[1:])


def play(line, stated, folder, capfd):
    """Have a line of a transcript done, and compare what comes of it."""
    line, _, status = line.partition("=> ")
    stated, _, added = stated.partition("\n+ ")
    before = set(os.listdir(folder))
    capfd.readouterr()
    assert command(line) == int(status or 0), capfd.readouterr()
    printed = "".join(capfd.readouterr())
    assert missing(stated, printed) is None, missing(stated, printed)
    assert re.search(r"\bnan\b", printed) is None
    assert set(os.listdir(folder)) - before - {"__pycache__"} == {*shlex.split(added)}


@pytest.mark.parametrize("title", TRANSCRIPTS)
def test_a_command_prints_what_its_transcript_has(here, capfd, title):
    for step in re.split(r"^(?=\$ |file )", TRANSCRIPTS[title], flags=re.MULTILINE):
        head, _, text = step.partition("\n")
        if head.startswith("file "):
            path = here / head.removeprefix("file ")
            path.parent.mkdir(exist_ok=True)
            path.write_text(re.sub(r"^    ", "", text, flags=re.MULTILINE))
        elif head:
            play(head.removeprefix("$ "), text, here, capfd)


def test_a_case_has_the_numbers_of_its_script(here, capfd):
    script = re.split(r"^file press.py$|^\$ ", TRANSCRIPTS["a script becomes a case"], flags=re.M)[
        1
    ]
    Path("press.py").write_text(textwrap.dedent(script).replace("# [m]", '# µ\nnote = """1\n2"""'))
    assert command("new mine --from press.py") == 0
    stated = runpy.run_path("press.py")["solution"]
    found = evaluate(load_case("mine").scene, backend="vm")
    assert np.array_equal(found.effort("O"), stated.effort("O"))
    assert re.search(
        '    note = """1\\n2"""\n.*    # a turn\n', Path("mine/case.py").read_text(), re.S
    )


CRANK = """
from lagrange_casadi import Mechanism, Scene
from lagrange_casadi.motion import harmonic, polynomial

def scene():
    m = Mechanism("crank")
    arm = m.link("arm", length=m.parameter("r", 0.1, "m"), mass=m.parameter("mass", 1.5, "kg"))
    hand = m.link("hand", length=0.1, mass=0.5)
    m.revolute("O", m.ground, arm)
    m.weld("fist", arm.tip, hand, angle=m.parameter("lean", 0.25, "rad"))
    m.prismatic("S", arm, m.point_mass("p", 0.1), axis=(1, 0))
    laws = {"O": polynomial(0.0, 2.0), "S": harmonic(0.05, 0.02, 6.0)}
    return Scene(m, laws, t=(0, 1, 5), wanted=["effort"])
"""
SAME = (
    "run crank.py --no-figures --set 'r={0.05|50 mm}' --set 'mass={2.5|2500 g}'",
    "run crank.py --no-figures --set lean={0.5235987755982988|30deg}",
    "run crank.py --no-figures --over 'O=0:{1.5|1.5 rad}:5'",
    "run crank.py --no-figures --t '0:{0.5|500 ms}:5'",
    "run {FOUR|four_bar} --no-figures --want effort --t 0:1:5",
    "info {FOUR|four_bar}",
    "export {FOUR|four_bar} --out c --want effort",
    "sweep crank.py --grid 'r={0.05:0.2|50 mm:200 mm}:3' --grid lean={0,0.25|0deg,0.25rad} --quiet",
    "optimise crank.py --minimise peak:effort:O --over 'r={0.05:0.2|5 cm:20 cm}' --set lean=0.5",
    "drive crank.py --drive S --lead '{0.005|5 mm}' --efficiency {0.95|95%}",
    "tolerances crank.py --tolerance 'r={0.001|1 mm}' --samples 20 --csv x.csv",
    "run crank.py --out x.h5 --figures f --svg {|}",
    "plot sweep.h5 --out f --over r --at lean={0.5|28.64788975654116deg}",
)
"""Lines with two spellings of one thing."""


def done(line, folder, capfd):
    """What a line prints and writes in a folder of its own."""
    folder.mkdir()
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        (folder / "crank.py").write_text(CRANK)
        if "sweep.h5" in line:
            swept = "sweep crank.py --grid r=0.1:0.2:3 --grid lean=0.4,0.5,0.6 --out sweep.h5"
            assert command(f"{swept} --quiet") == 0
        capfd.readouterr()
        assert command(line.replace("FOUR", str(CASES / "four_bar"))) == 0
    files = (path for path in folder.rglob("*.*") if path.is_file() and path.suffix != ".pyc")
    return capfd.readouterr(), {path.relative_to(folder): path.read_bytes() for path in files}


@pytest.mark.parametrize("line", SAME)
def test_two_spellings_do_the_same(tmp_path, capfd, interpreted, line):
    """The same text, and the same bytes."""
    found = [
        done(re.sub(r"\{(.*?)\|(.*?)\}", rf"\{k}", line), tmp_path / str(k), capfd) for k in (1, 2)
    ]
    assert found[0] == found[1]


def test_the_whole_of_the_papers_case(here, capfd):
    """Its figures, and its peaks, which are refined without a change of the file."""
    assert command("run CASE") == 0
    out = capfd.readouterr().out
    assert " -8.31361 N m  at t = 0.0076 s, xi/l = 0\n" in out
    assert " +- " not in out
    drawn = sorted(path.stem for path in (here / "slider_crank_figures").glob("*.png"))
    assert [name[:5] for name in drawn[:9]] == [f"fig{n:02}" for n in range(6, 15)]
    assert drawn[9:] == ["mechanism", "rod_maps"]
    index = (here / "slider_crank_figures" / "index.html").read_text()
    assert sorted(re.findall(r'<img src="(\w+)\.png"', index)) == drawn
    for out, more in (("plain", ""), ("refined", "--refine-peaks")):
        line = f"run CASE --t 0:0.08:41 --want effort --no-figures --out {out}.h5"
        assert command(f"{line} {more}") == 0
    plain, refined = re.findall(r"  effort:O +(\S+) N m  at", capfd.readouterr().out)
    assert Path("refined.h5").read_bytes() == Path("plain.h5").read_bytes()
    asked = {"t": (0, 0.08, 100_001), "wanted": ["effort"], "certificate": False}
    solution = evaluate(load_case(CASES / "slider_crank").scene, **asked)
    assert refined == f"{solution.peak('effort:O').value:.6g}" != plain
    assert command("run CASE --over O=0:360deg:37 --want effort --out o.h5 --no-figures") == 0
    with h5py.File("o.h5") as file:
        np.testing.assert_allclose(file["over"], math.tau * np.arange(37) / 36, rtol=1e-15)


@pytest.mark.parametrize("case", ["excavator", "stewart_gough"])
def test_a_run_fits_a_screen(here, capfd, case):
    """The rest is in the whole list, in which no name stands twice."""
    line = f"run {case} --no-figures --backend vm --no-certificate"
    assert command(line) == 0
    short = capfd.readouterr().out
    assert short.count("\n") < 40
    assert "--verbose lists all" in short
    assert command(f"{line} --verbose") == 0
    names = re.findall(r"^  (\w+:\S+)", capfd.readouterr().out.split("\n", 1)[1], re.MULTILINE)
    assert len(names) == len(set(names)) > 40


def test_cases_of_two_versions_write_files_of_their_own(here, interpreted):
    for version in ("press_1.2", "press_1.3"):
        (here / "cases" / version).mkdir(parents=True)
        (here / "cases" / version / "case.py").write_text(CRANK)
        assert command(f"run cases/{version}") == 0
        assert command(f"sweep cases/{version} --grid r=0.2,0.3 --quiet") == 0
    ends = (".h5", "_figures", "_sweep.h5")
    own = {f"press_1.{minor}{end}" for minor in (2, 3) for end in ends}
    assert {*os.listdir(here)} == {"cases", *own}


def test_copies_of_cases_are_whole_and_come_before_those_of_the_package(here):
    assert command("cases --copy mine") == 0
    for name in NAMES:
        files = [path.name for path in (CASES / name).iterdir() if path.is_file()]
        assert filecmp.cmpfiles(CASES / name, here / "mine" / name, files, shallow=False)[1:] == (
            [],
            [],
        )
        assert command(f"new own-{name} --like {name}") == 0
        own, like = load_case(f"own-{name}"), load_case(name)
        assert own.scene.mechanism.name == f"own_{name}"
        text = own.path.read_text()
        assert text.replace(f"own_{name}", name) == like.path.read_text()
    assert command("new four_bar --like arm") == 0
    assert load_case("four_bar").path == here / "four_bar" / "case.py"
    with pytest.raises(LagrangeCasadiError, match=f"case x: no such.*: {', '.join(NAMES)}$"):
        load_case("x")


def test_the_examples_of_the_help_run(here, capfd):
    Path("cases").symlink_to(CASES)
    assert command("sweep --help") == 0
    examples = re.findall(r"^ *lagrange-casadi (.*)$", capfd.readouterr().out, re.MULTILINE)
    assert [example.split()[0] for example in examples] == ["sweep", "best"]
    assert [command(example) for example in examples] == [0, 0]


COMPLETED = [
    ("bash", "lagrange-casadi r", "1", ["plain,report", "plain,run"]),
    ("bash", "lagrange-casadi run --prec", "2", ["plain,--precision"]),
    ("bash", "lagrange-casadi run x --precision ", "4", ["plain,double", "plain,single"]),
    ("bash", "lagrange-casadi run slider", "2", ["file,slider", "plain,slider_crank"]),
    ("bash", "lagrange-casadi no_command --", "2", ["plain,--version", "plain,--help"]),
    ("zsh", "lagrange-casadi cac", "1", ["plain", "cache", "Show the cache of graphs and"]),
    ("fish", "lagrange-casadi cac", "cac", ["plain,cache\tShow the cache of graphs and"]),
]


@pytest.mark.quick
@pytest.mark.parametrize(("shell", "line", "number", "offered"), COMPLETED)
def test_a_shell_completes(monkeypatch, capsys, shell, line, number, offered):
    monkeypatch.setenv("_LAGRANGE_CASADI_COMPLETE", f"{shell}_complete")
    monkeypatch.setenv("COMP_WORDS", line)
    monkeypatch.setenv("COMP_CWORD", number)
    assert main([]) == 0
    # Releases of click part a kind, a word and its help by commas, tabs or lines.
    found, starts = (
        re.split("[,\t\n]", text.strip()) for text in (capsys.readouterr().out, "\n".join(offered))
    )
    assert [word[: len(start)] for word, start in zip(found, starts, strict=True)] == starts
    monkeypatch.setenv("_LAGRANGE_CASADI_COMPLETE", f"{shell}_source")
    assert main([]) == 0
    assert f"_LAGRANGE_CASADI_COMPLETE={shell}_complete" in capsys.readouterr().out
