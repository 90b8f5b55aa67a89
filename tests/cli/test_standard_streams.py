"""The program: as a module; where its streams are closed, broken or full it does its work, and
nothing goes into its files.
"""

import os
import shlex
import shutil
import subprocess
import sys

import h5py
import pytest

from lagrange_casadi import check
from lagrange_casadi.cli import main

PROGRAM = f"{shlex.quote(sys.executable)} -m lagrange_casadi"
RUN = "run $CASE --t 0:1:9 --out x.h5"
SWEEP = "sweep $CASE --grid l=0.2:0.3:3 --t 0:1:9 --want effort --out y.h5"
CASE = """
from lagrange_casadi import Mechanism, Scene, motion

def scene():
    m = Mechanism("arm")
    m.revolute("J", m.ground, m.link("a", length=m.parameter("l", 0.2, "m"), mass=1))
    return Scene(m, {"J": motion.polynomial(0, 1)})
"""


@pytest.fixture(scope="module", autouse=True)
def _case(tmp_path_factory):
    """A case of few figures."""
    path = tmp_path_factory.mktemp("arm") / "arm.py"
    path.write_text(CASE)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("CASE", str(path))
        yield


def shell(line, **keywords):
    return subprocess.run(
        line, shell=True, capture_output=True, text=True, timeout=120, check=False, **keywords
    )


@pytest.mark.long
@pytest.mark.parametrize(
    "closed", ["2>&-", "<&-", "<&- 2>&-", ">&- 2>&-", "<&- >&- 2>&-", "2>/dev/full"]
)
def test_streams_that_are_closed_stop_nothing(here, closed):
    done = shell(f"{PROGRAM} {RUN} {closed} && {PROGRAM} {SWEEP} {closed}")
    assert (done.returncode, done.stderr) == (0, "")
    assert ("wrote x.h5" in done.stdout) == (">&- 2" not in closed)
    assert check("x.h5") == []
    with h5py.File("y.h5") as file:
        assert file.attrs["complete"]
    assert list(here.glob("*_figures/*.png"))


@pytest.mark.long
@pytest.mark.parametrize("closed", ["2>&-", "<&- >&- 2>&-", "2>/dev/full"])
def test_an_error_that_nobody_hears_has_its_status(here, closed):
    assert shell(f"{PROGRAM} run nothing {closed}").returncode == 2
    assert shell(f"{PROGRAM} {RUN} --newton 0 {closed}").returncode == 2
    assert not list(here.iterdir())


@pytest.mark.sampled(3)
@pytest.mark.parametrize("command", [RUN + " --no-figures", "cases", "--help"])
def test_a_reader_that_goes_early_is_no_error(here, command):
    """As head, or a pager that is left: no line says so, and what was computed is kept."""
    done = shell(f"{{ {PROGRAM} {command}; echo $? >status; }} | true")
    assert done.stderr == ""
    assert (here / "status").read_text() == "1\n"
    assert (here / "x.h5").exists() == command.startswith("run")


@pytest.mark.long
def test_a_warning_that_nobody_hears_stops_nothing(here):
    """As of a cache that cannot be written."""
    (here / "file").write_text("")
    done = shell(
        f"{PROGRAM} {RUN} --no-figures 2>/dev/full",
        env={**os.environ, "XDG_CACHE_HOME": str(here / "file")},
    )
    assert done.returncode == 0
    assert (here / "x.h5").exists()


@pytest.mark.long
@pytest.mark.parametrize(
    "backend",
    ["module://matplotlib_inline.backend_inline", "module://nowhere.at_all", "nonsense", "TkAgg"],
)
def test_a_backend_that_a_notebook_set_draws_all_the_same(here, backend):
    done = shell(f"{PROGRAM} {RUN} --figures f", env={**os.environ, "MPLBACKEND": backend})
    assert (done.returncode, done.stderr) == (0, "")
    assert list((here / "f").glob("*.png"))


LATE = """
from lagrange_casadi import Mechanism, Scene, motion
from lagrange_casadi.declare.motion import Motion

def law(t):
    raise {raised}

def scene():
    m = Mechanism("arm")
    m.revolute("J", m.ground, m.link("a", length=1, mass=1))
    return Scene(m, {{"J": Motion(law)}})
"""


@pytest.mark.parametrize(
    "raised", ["SystemExit('gone')", "BaseException('gone')", "ValueError('gone')"]
)
def test_what_a_case_raises_later_is_one_line(here, tmp_path_factory, capfd, raised):
    path = tmp_path_factory.mktemp("late") / "case.py"
    path.write_text(LATE.format(raised=raised))
    assert main(["run", str(path), "--no-figures"]) in (1, 2)
    out, err = capfd.readouterr()
    assert out == ""
    assert err.startswith("error: ")
    assert err.endswith(": gone\n")
    assert err.count("\n") == 1
    assert not list(here.iterdir())


def test_the_module_runs_as_a_program():
    command = [sys.executable, "-m", "lagrange_casadi", "--version"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stdout.startswith("lagrange-casadi, version")
    assert shutil.which("lagrange-casadi")
