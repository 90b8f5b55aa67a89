"""A kill, or a full disk, at each moment at which something on the disk changes: what was there
stays, and the same command goes on to the same bytes.
"""

import contextlib
import errno
import io
import itertools
import os
import resource
import shutil
import signal
import threading
from pathlib import Path

import pytest
import sweeps
from commands import command
from matplotlib.figure import Figure
from mechanisms import pendulum
from sweeps import turning

from lagrange_casadi import evaluate, export, motion, optimise, read, save, save_model, sweep
from lagrange_casadi.errors import LagrangeCasadiError

GROWS = ("replace", "rename", "mkdir")
"""Changes that a full disk refuses; a kill may come at the others too."""

CHANGES = (*GROWS, "unlink", "rmdir")


def killed(number, action):
    """Kill a process that acts at a change by its number, first 0; whether it got there."""
    child = os.fork()
    if child == 0:
        try:
            with pytest.MonkeyPatch.context() as patch:
                meet(patch, number, lambda: os.kill(os.getpid(), signal.SIGKILL))
                action()
        except BaseException:
            os._exit(1)
        os._exit(0)
    _, status = os.waitpid(child, 0)
    assert os.WIFSIGNALED(status) or os.WEXITSTATUS(status) == 0
    return os.WIFSIGNALED(status)


def refused(number, action):
    """Fill the disk at a change by its number; whether it got there, which is told in one line."""
    with pytest.MonkeyPatch.context() as patch:
        meet(patch, number, full, GROWS)
        try:
            action()
        except LagrangeCasadiError as error:
            told = str(error)
        else:
            return False
    assert "No space left on device" in told
    assert "\n" not in told
    return True


def meet(patch, number, happens, changes=CHANGES):
    """Let something happen at a change, by its number."""
    seen = iter(range(10**6))

    def at(own):
        def called(*words, **named):
            if next(seen) == number:
                happens()
            return own(*words, **named)

        return called

    for name in changes:
        patch.setattr(os, name, at(getattr(os, name)))


def full():
    """What a full disk does."""
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def is_told(path):
    """Whether the bytes of a file are told; a workbook states when it was written."""
    return path.is_file() and path.suffix != ".xlsx"


def contents(folder):
    """All files by name, drafts and those of folders too."""
    return {
        str(path.relative_to(folder)): path.read_bytes() if is_told(path) else None
        for path in folder.rglob("*")
    }


def saved(folder, later):
    save(evaluate(turning(mass=1.0 + later), backend="vm"), folder / "x.h5")


def swept(folder, later):
    if later:
        grid = {"l": (0.15, 0.4, 2), "r": [0.05, 0.1]}
        words = {"out": folder / "x.h5", "resume": True, "workers": 1, "t": (0, 0.08, 7)}
        sweep(sweeps.scene(), grid, **words)


def searched(folder, later):
    over, words = {"T": (0.5, 2.0)}, {"starts": 2, "screen": 4}
    if later:
        out = {"out": folder / "x.h5", "resume": True}
        optimise(turning(), minimise="peak:effort:O", over=over, **words, **out)


def exported(folder, later):
    export(turning("effort", *(["motion"] * later)), folder / "c")


def drawn(folder, later):
    """Other figures than before, none of which takes long, of a file that is made once."""
    path = folder.parents[1] / f"{later}.h5"
    if not path.exists():
        save(evaluate(turning("reaction" if later else "effort"), backend="vm"), path)
    with contextlib.redirect_stderr(io.StringIO()) as said:
        status = command("plot", path, "--out", folder / "figures")
    if status:
        raise LagrangeCasadiError(said.getvalue().splitlines()[-1])


@pytest.mark.skipif(not hasattr(os, "fork"), reason="each kill is of a fork")
@pytest.mark.parametrize(
    ("act", "ends"),
    itertools.product([drawn, saved, swept, searched, exported], [killed, refused]),
)
def test_what_is_half_done_is_done_by_the_next(tmp_path, monkeypatch, act, ends):
    """Beside what was there before, and files of somebody else."""
    if act is swept:
        monkeypatch.setattr("lagrange_casadi.studies.sweep.columns._MOST", 3)
        sweeps.use(monkeypatch)
    monkeypatch.setattr(Figure, "savefig", lambda self, file, **_: Path(file).write_bytes(b"drawn"))
    before, whole = tmp_path / "before" / "in", tmp_path / "whole" / "in"
    before.mkdir(parents=True)
    (before / "notes.txt").write_text("mine")
    act(before, False)
    shutil.copytree(before, whole)
    act(whole, True)
    number, met = 0, True
    while met:
        place = tmp_path / f"{number}" / "in"
        shutil.copytree(before, place)
        met = ends(number, lambda place=place: act(place, True))
        act(place, True)
        assert contents(place) == contents(whole), number
        number += 1
    assert number > (1 if act is saved else 2)


@contextlib.contextmanager
def limited(size):
    """Let no file grow beyond so many bytes: what the system does stands for a full disk."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


LINES = {
    "run CASE --t 0:0.08:5 --want effort --no-figures --out x.h5 --csv x.csv": (0, 100, 9000),
    "sweep CASE --t 0:0.08:5 --grid l=0.2:0.4:40 --want effort --out x.h5": (500, 2900, 12_000),
    "optimise CASE --t 0:0.08:5 --minimise l --over l=.2:.4 --starts 1 --out x.h5 --figure x.svg": (
        0,
        100,
    ),
    "export CASE --out x": (0, 5000),
    "cases --copy x": (3000,),
    "report CASE --out x.html": (5000,),
    "table before.h5 --csv x.csv": (0, 100),
    "table before.h5 --csv x.xlsx": (100,),
}


@pytest.mark.parametrize("line", LINES)
def test_a_file_that_cannot_grow_is_one_line_and_the_next_command_goes_on(here, capsys, line):
    if "before.h5" in line:
        grid = "sweep CASE --t 0:0.08:5 --grid l=0.2:0.4:40 --want effort --out before.h5"
        assert command(grid) == 0
    assert command(line) == 0
    whole = contents(here)
    for limit in LINES[line]:
        for path in here.glob("x*"):
            shutil.rmtree(path) if path.is_dir() else path.unlink()
        capsys.readouterr()
        with limited(limit):
            assert command(line) == 1
        out, err = capsys.readouterr()
        assert (out, err.count("\n")) == ("", 1)
        assert err.startswith("error: cannot write ")
        assert "File too large" in err
        left = {path.name for path in here.iterdir()} - {"before.h5"}
        assert left <= {"x.h5.parts"}
        assert command(f"{line} --resume" if left else line) == 0
        assert contents(here) == whole


def test_many_writers_of_one_name_are_each_whole(tmp_path):
    """None takes another's draft for one that a kill has left."""
    target, failed = tmp_path / "x.json", []
    scenes = [pendulum(motion.polynomial(0.1 * k, 3.0)) for k in range(4)]

    def often(scene):
        try:
            for _ in range(10):
                save_model(scene, target)
                read(target)
        except BaseException as error:
            failed.append(error)

    threads = [threading.Thread(target=often, args=(scene,)) for scene in scenes]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not failed
    assert os.listdir(tmp_path) == ["x.json"]
