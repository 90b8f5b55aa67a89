"""A sweep that fails or is killed: what was done is kept, nothing half-written is believed, and it
is resumed to the same bytes.
"""

import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import textwrap

import pytest
import sweeps
from internals import Folder
from places import FOLDERS
from sweeps import GRID, StopError, run, stop_after

from lagrange_casadi.errors import DeclarationError, SizeError, StoreError


def test_after_a_failure_nothing_more_is_begun(engine, tmp_path, monkeypatch):
    def fail(*_):
        raise StoreError("no")

    engine.pause = 1e-3
    monkeypatch.setattr(Folder, "commit", fail)
    with pytest.raises(StoreError, match="no; nothing was done yet"):
        run(tmp_path / "x.h5", workers=2)
    assert len(engine.calls) <= 4
    assert os.listdir(tmp_path) == []


def test_out_of_memory_is_one_line_and_keeps_what_was_done(whole, engine, tmp_path, monkeypatch):
    fine, calls = engine.evaluate, []

    def fail(p, **keywords):
        calls.append(p)
        if len(calls) == 3:
            raise MemoryError
        return fine(p, **keywords)

    monkeypatch.setattr(engine, "evaluate", fail)
    with pytest.raises(
        SizeError,
        match=(
            r"out of memory: fewer workers take less; 28 of 420 designs are kept in .*resume=True"
        ),
    ):
        run(tmp_path / "x.h5", workers=1)
    assert run(tmp_path / "x.h5", resume=True) == whole


def test_a_part_that_cannot_be_read_is_named(whole, tmp_path, monkeypatch):
    path = tmp_path / "x.h5"
    with pytest.raises(StopError):
        run(path, progress=stop_after(4))
    lost = min(path.with_name("x.h5.parts").glob("*.part"))
    parts = Folder.parts

    def listed(self):
        found = parts(self)
        lost.unlink(missing_ok=True)
        return found

    with monkeypatch.context() as patch:
        patch.setattr(Folder, "parts", listed)
        with pytest.raises(
            StoreError,
            match=(
                rf"cannot read {lost}: .*No such file or directory.*; \d+ of 420 designs are kept"
            ),
        ):
            run(path, resume=True)
    assert run(path, resume=True) == whole


def test_an_engine_that_fails_leaves_what_was_committed(whole, engine, tmp_path, monkeypatch):
    fine, calls = engine.evaluate, []

    def fail(p, **keywords):
        calls.append(p)
        if len(calls) == 3:
            raise DeclarationError("no")
        return fine(p, **keywords)

    monkeypatch.setattr(engine, "evaluate", fail)
    with pytest.raises(DeclarationError, match="no"):
        run(tmp_path / "x.h5")
    assert run(tmp_path / "x.h5", resume=True) == whole


def test_a_disk_without_room_is_told_after_the_first_block(whole, engine, tmp_path, monkeypatch):
    monkeypatch.setattr(shutil, "disk_usage", lambda _: shutil._ntuple_diskusage(10**6, 0, 10**4))
    engine.calls.clear()
    with pytest.raises(
        StoreError,
        match=(
            r"the rest of the file takes about \S+ GB, and the disk has 1e-05 GB left; 14"
            r" of 420"
        ),
    ):
        run(tmp_path / "x.h5", workers=1)
    assert len(engine.calls) < 4
    monkeypatch.undo()
    sweeps.use(monkeypatch)
    assert run(tmp_path / "x.h5", resume=True) == whole


PROGRAM = """
    import sys, resource, signal
    sys.path[:0] = {folders!r}
    import sweeps
    from lagrange_casadi.errors import LagrangeCasadiError
    from lagrange_casadi.studies.sweep import sweep
    sweeps.DesignEngine.compiled = sweeps.Formula(pause={pause}).of
    # Python would leave bytecode cut off for others.
    sys.dont_write_bytecode = True
    resource.setrlimit(resource.RLIMIT_FSIZE, ({limit}, {limit}))
    print("ready", flush=True)
    try:
        sweep(sweeps.scene(), {grid!r}, out={out!r}, resume=True)
    except LagrangeCasadiError as error:
        print(error)
        sys.exit(error.exit_status)
"""


def program(out, *, pause=0.0, limit=resource.RLIM_INFINITY, grid=GRID):
    text = PROGRAM.format(folders=FOLDERS, out=str(out), pause=pause, limit=limit, grid=grid)
    return sweeps.process(sys.executable, "-c", textwrap.dedent(text))


@pytest.mark.sampled(5)
@pytest.mark.parametrize("limit", [500, 2_900, 30_000, 60_000])
def test_a_full_disk_is_one_line_and_loses_nothing(whole, tmp_path, limit):
    """Real writes that fail, of the plan, of a part, and at places of the file; the system's limit
    stands for a full disk.
    """
    path = tmp_path / "x.h5"
    with program(path, limit=limit) as full:
        out, err = full.communicate(timeout=60)
        assert full.returncode == 1
    assert err == ""
    assert out.startswith(f"ready\ncannot write {path}: File too large")
    assert not path.exists()
    kept = sum(1 for _ in tmp_path.glob("x.h5.parts/*.part"))
    assert (kept > 0) == (limit > 2_900)
    assert run(path, resume=True) == whole
    assert sorted(os.listdir(tmp_path)) == ["whole.h5", "x.h5"]


def test_killed_at_random_moments(whole, tmp_path):
    """kill -9, while blocks are evaluated, committed, joined and put in place; and resumed each
    time.
    """
    path, chance, phases = tmp_path / "x.h5", random.Random(20), set()
    kills = 0
    while kills < 4 or (kills < 24 and not phases >= {"beginning", "blocks"}):
        with program(path, pause=2e-4) as running:
            assert running.stdout.readline() == "ready\n"
            if kills % 2:
                sweeps.wait_for(
                    lambda: any(tmp_path.glob("x.h5.parts/*.part")) or running.poll() is not None
                )
            try:
                # The first time at once, before there is anything.
                running.wait(timeout=chance.uniform(0.0, 0.25) if kills else 0.0)
            except subprocess.TimeoutExpired:
                running.send_signal(signal.SIGKILL)
                running.wait()
                kills += 1
        folder = tmp_path / "x.h5.parts"
        parts = sum(1 for _ in folder.glob("*.part"))
        phases.add("beginning" if not parts else "blocks" if parts < 30 else "ending")
        if path.exists():
            assert path.read_bytes() == whole
            phases.add("done")
            path.unlink()
            shutil.rmtree(folder, ignore_errors=True)
    assert run(path, resume=True) == whole
    assert phases >= {"beginning", "blocks"}
