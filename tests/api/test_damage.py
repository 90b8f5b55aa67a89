"""Files damaged at random: every one is refused in one line, and none crashes, hangs, or is
believed.
"""

import subprocess
import sys

import pytest
import sweeps
from internals import sweep
from places import TESTS

from lagrange_casadi import evaluate, save

FEW, MANY, AT_ONCE = 120, 10_000, 1000
_SECONDS = 20.0


def damage(file, folder, seed, count):
    """What the program that damages a file says of so many attempts, and how it ended."""
    folder.mkdir()
    command = [sys.executable, str(TESTS), "damaging", str(file), str(seed), str(count)]
    # Each attempt has a limit of its own; this one is for what goes wrong besides.
    limit = 600 + _SECONDS * count
    done = subprocess.run(
        command,
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=limit,
        check=False,
    )
    return done.stdout.splitlines(), done


@pytest.fixture
def run(slider_crank, tmp_path):
    solution = evaluate(
        slider_crank.scene,
        t=(0, 0.08, 21),
        xi=(0, 1, 5),
        wanted=("effort", "section:rod"),
        backend="vm",
    )
    save(solution, tmp_path / "run.h5")
    return tmp_path / "run.h5"


@pytest.fixture
def swept(monkeypatch, tmp_path):
    sweeps.use(monkeypatch)
    return sweep(
        sweeps.scene(),
        {"l": (0.15, 0.4, 60), "r": (0.05, 0.1, 20)},
        out=tmp_path / "sweep.h5",
        xi=(0, 1, 3),
    ).path


@pytest.mark.sampled(2)
@pytest.mark.parametrize("kind", ["run", "swept"])
@pytest.mark.parametrize("count", [FEW, pytest.param(MANY, marks=pytest.mark.long)])
def test_damage_is_refused(request, tmp_path, kind, count):
    file = request.getfixturevalue(kind)
    for seed in range(0, count, AT_ONCE):
        several = min(AT_ONCE, count - seed)
        lines, done = damage(file, tmp_path / str(seed), seed, several)
        assert done.returncode == 0, (lines[-1:], done.returncode, done.stderr[-2000:])
        assert lines == [str(number) for number in range(several)]
        assert done.stderr == ""


@pytest.mark.sampled(2)
@pytest.mark.parametrize("kind", ["run", "swept"])
def test_what_is_whole_is_believed(request, tmp_path, kind):
    """The same program finds that every reader takes the file as it was written, so it would find a
    reader that takes another.
    """
    lines, done = damage(request.getfixturevalue(kind), tmp_path / "whole", 0, 0)
    assert done.returncode == 0, done.stderr
    accepted = [f"0: {number}: accepted" for number in range(6 if kind == "run" else 7)]
    assert lines[:-1] == ["0", *accepted]
    assert lines[-1].startswith("left: ")
