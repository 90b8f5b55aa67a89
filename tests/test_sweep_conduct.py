"""A sweep carried out: the same bytes however it was cut, stopped and resumed; and nothing half-written is believed."""

import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import textwrap
import threading

import h5py
import pytest
import sweeps

from lagrange_casadi.errors import BusyError, DeclarationError, PathError, SizeError, StoppedError, StoreError
from lagrange_casadi.sweep import sweep
from lagrange_casadi.sweep.parts import Folder
from lagrange_casadi.system.room import cores

GRID = {"l": (0.15, 0.4, 60), "r": (0.05, 0.1, 7)}
SIZE = 420


@pytest.fixture
def engine(monkeypatch):
    return sweeps.use(monkeypatch)


def run(path, grid=None, **keywords):
    return sweep(sweeps.scene(), GRID if grid is None else grid, out=path, **keywords).path.read_bytes()


@pytest.fixture
def whole(engine, tmp_path):
    """The bytes of an uninterrupted sweep."""
    return run(tmp_path / "whole.h5")


class _StopError(Exception):
    pass


def stop_after(count):
    """A progress that stops a sweep after so many reports of designs."""
    seen = iter(range(count))

    def progress(what, _done, _total):
        if what == "designs" and next(seen, None) is None:
            raise _StopError

    return progress


@pytest.mark.parametrize("workers", [1, 2, 5, None])
def test_the_same_bytes_whatever_the_workers(whole, engine, tmp_path, workers):
    engine.pause = 1e-3
    engine.calls.clear()
    assert run(tmp_path / "x.h5", workers=workers) == whole
    assert set(engine.threads) == {1}
    assert sum(size for size, _ in engine.calls) == SIZE
    threads, most = len({thread for _, thread in engine.calls}), workers or cores()
    assert min(most, 2) <= threads <= most


def test_the_same_bytes_whatever_the_stops(whole, tmp_path):
    path, chance, stops = tmp_path / "x.h5", random.Random(5), 0
    while not path.exists():
        try:
            run(path, resume=True, progress=stop_after(chance.randint(1, 6)))
        except _StopError:
            stops += 1
    assert stops > 3
    assert path.read_bytes() == whole


def test_the_order_of_blocks_does_not_matter(whole, tmp_path, monkeypatch):
    """Workers that give their blocks backwards."""
    from lagrange_casadi.sweep import sweeping

    class Backwards:
        def results(self, plan, queue):
            blocks = list(iter(queue.take, None))
            assert len(blocks) > 3
            for start, stop in blocks[::-1]:
                yield start, stop, plan.harvest.chunks(plan.block(start, stop), plan.room)

    monkeypatch.setattr(sweeping, "hired", lambda *_: Backwards())
    assert run(tmp_path / "x.h5") == whole


def test_what_is_committed_is_not_done_again(whole, engine, tmp_path):
    with pytest.raises(_StopError):
        run(tmp_path / "x.h5", progress=stop_after(3))
    kept = sum(part.stop - part.start for part in Folder(tmp_path / "x.h5").parts())
    engine.calls.clear()
    assert run(tmp_path / "x.h5", resume=True) == whole
    assert sum(size for size, _ in engine.calls) == SIZE - kept
    assert 0 < kept < SIZE


def test_a_part_lost_or_damaged_is_done_again(whole, tmp_path):
    path, folder = tmp_path / "x.h5", tmp_path / "x.h5.parts"
    with pytest.raises(_StopError):
        run(path, progress=stop_after(4))
    first, second, *_ = sorted(folder.glob("*.part"))
    first.unlink()
    content = bytearray(second.read_bytes())
    content[-3] ^= 1
    second.write_bytes(content)
    with pytest.raises(
        StoreError, match=r"was damaged, in column .*, and is deleted; \d+ of 420 designs are kept in .*resume=True"
    ):
        run(path, resume=True)
    assert run(path, resume=True) == whole


def test_a_finished_sweep_is_not_done_again(whole, engine, tmp_path):
    engine.calls.clear()
    assert run(tmp_path / "whole.h5", resume=True) == whole
    assert engine.calls == []
    assert os.listdir(tmp_path) == ["whole.h5"]


def test_a_kill_between_the_file_and_the_end_of_its_parts(whole, engine, tmp_path, monkeypatch):
    monkeypatch.setattr(Folder, "remove", lambda self: None)
    assert run(tmp_path / "x.h5") == whole
    assert (tmp_path / "x.h5.parts" / "plan.json").exists()
    monkeypatch.undo()
    sweeps.use(monkeypatch)
    assert run(tmp_path / "x.h5", resume=True) == whole
    assert not (tmp_path / "x.h5.parts").exists()


def test_resume_starts_where_there_is_nothing(whole, tmp_path):
    assert run(tmp_path / "x.h5", resume=True) == whole


def test_what_is_there_is_not_overwritten(whole, tmp_path):
    path = tmp_path / "whole.h5"
    with pytest.raises(PathError, match=r"whole\.h5 exists: force=True replaces it, resume=True goes on"):
        run(path)
    assert path.read_bytes() == whole
    with pytest.raises(_StopError):
        run(path, force=True, progress=stop_after(2))
    assert path.read_bytes() == whole
    with pytest.raises(PathError, match=r"whole\.h5\.parts holds an unfinished sweep: go on with resume=True, or start anew"):
        run(path)
    assert run(path, resume=True) == whole
    assert run(path, force=True) == whole
    with pytest.raises(DeclarationError, match="resume and force exclude each other"):
        run(path, force=True, resume=True)
    with pytest.raises(_StopError):
        run(tmp_path / "notes.h5", progress=stop_after(2))
    (tmp_path / "notes.h5").write_text("mine")
    with pytest.raises(PathError, match=r"notes\.h5 is there now, which was not when the sweep began"):
        run(tmp_path / "notes.h5", resume=True)
    shutil.rmtree(tmp_path / "notes.h5.parts")
    for keywords, says in (({}, "exists"), ({"resume": True}, "not a whole HDF5 file")):
        with pytest.raises((PathError, StoreError), match=says):
            run(tmp_path / "notes.h5", **keywords)
    assert (tmp_path / "notes.h5").read_text() == "mine"
    assert sorted(os.listdir(tmp_path)) == ["notes.h5", "whole.h5"]


def test_a_file_that_another_program_writes_is_left_alone(whole, tmp_path):
    path = tmp_path / "whole.h5"
    before = path.stat().st_ino
    program = f"import h5py, sys; h = h5py.File({str(path)!r}, 'r+'); print('open', flush=True); sys.stdin.read()"
    with sweeps.process(sys.executable, "-c", program, stdin=subprocess.PIPE) as holder:
        assert holder.stdout.readline() == "open\n"
        for keywords in ({}, {"force": True}, {"resume": True}):
            with pytest.raises(BusyError, match=r"cannot write .*whole\.h5: another program has it open to write"):
                run(path, **keywords)
    assert path.stat().st_ino == before
    assert os.listdir(tmp_path) == ["whole.h5"]


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"grid": {"l": (0.15, 0.4, 61), "r": (0.05, 0.1, 7)}}, "grid l was 0.15:0.4:60 and is 0.15:0.4:61"),
        ({"grid": {"l": (0.15, 0.4, 60)}}, "grid r was there, and is not"),
        ({"grid": {"r": (0.05, 0.1, 7), "l": (0.15, 0.4, 60)}}, "the axes of the grid were l, r and are r, l"),
        ({"parameters": {"m3": 0.2}}, "mechanism parameters m3 value was 0.1 and is 0.2"),
        ({"wanted": ["effort"]}, "wanted reactions was "),
        ({"t": (0, 0.08, 9)}, "t was [0.0, 0.08, 7] and is [0.0, 0.08, 9]"),
        ({"keep": "histories"}, "keep was peaks and is histories"),
        ({"xi": (0, 1, 3)}, "xi was null and is [0.0, 1.0, 3]"),
    ],
)
@pytest.mark.parametrize("finished", [True, False])
def test_another_sweep_is_refused_with_the_difference(whole, tmp_path, change, says, finished):
    path = tmp_path / "whole.h5"
    if not finished:
        path = tmp_path / "x.h5"
        with pytest.raises(_StopError):
            run(path, progress=stop_after(2))
    with pytest.raises(StoreError) as caught:
        run(path, resume=True, **change)
    assert f"is of another sweep: {says}" in str(caught.value)
    assert str(caught.value).endswith("; start anew with force=True, or write another file")


def test_another_version_is_refused(whole, engine, tmp_path, monkeypatch):
    from dataclasses import replace

    monkeypatch.setattr(engine, "provenance", replace(engine.provenance, versions={"lagrange_casadi": "9.9"}))
    with pytest.raises(StoreError, match=r"another sweep: versions lagrange_casadi was .* and is 9\.9"):
        run(tmp_path / "whole.h5", resume=True)


def test_another_law_of_motion_is_refused(whole, tmp_path):
    from lagrange_casadi import Scene
    from lagrange_casadi.declare.motion import polynomial

    scene = sweeps.scene()
    other = Scene(scene.mechanism, {"O": polynomial(0, 1)}, t=scene.t, posture=scene.posture)
    with pytest.raises(StoreError, match="an expression, a law of motion or the posture of the scene has changed"):
        sweep(other, GRID, out=tmp_path / "whole.h5", resume=True)


@pytest.mark.parametrize("keywords", [{}, {"resume": True}, {"force": True}])
def test_what_no_sweep_put_into_the_folder_is_not_touched(engine, tmp_path, keywords):
    folder = tmp_path / "x.h5.parts"
    folder.mkdir()
    (folder / "thesis.txt").write_text("mine")
    with pytest.raises(PathError, match=r"x\.h5\.parts holds 'thesis\.txt', which is no sweep's"):
        run(tmp_path / "x.h5", **keywords)
    assert os.listdir(folder) == ["thesis.txt"]


@pytest.mark.parametrize("keywords", [{}, {"resume": True}])
def test_parts_of_nobody_knows_what_are_not_touched(whole, tmp_path, keywords):
    path, folder = tmp_path / "x.h5", tmp_path / "x.h5.parts"
    with pytest.raises(_StopError):
        run(path, progress=stop_after(4))
    (folder / "plan.json").unlink()
    (folder / "000000000900-000000000901.part").write_text("damaged")
    before = sorted(os.listdir(folder))
    with pytest.raises(PathError, match=r"x\.h5\.parts holds parts, and no plan\.json that tells what they are of: force=True"):
        run(path, **keywords)
    assert sorted(os.listdir(folder)) == before
    assert run(path, force=True) == whole


def test_an_interrupt_after_the_end_stops_nothing(whole, tmp_path, monkeypatch):
    publish = Folder.publish

    def late(self):
        publish(self)
        signal.raise_signal(signal.SIGINT)

    monkeypatch.setattr(Folder, "publish", late)
    assert run(tmp_path / "x.h5") == whole
    assert not (tmp_path / "x.h5.parts").exists()


def test_what_waited_for_an_earlier_block_is_joined_in_the_end(whole, tmp_path):
    path, told = tmp_path / "x.h5", []
    with pytest.raises(_StopError):
        run(path, progress=stop_after(25))
    min(path.with_name("x.h5.parts").glob("*.part")).unlink()
    assert run(path, resume=True, progress=lambda *words: told.append(words)) == whole
    ends = [done for what, done, total in told if what == "file" and total == SIZE]
    assert ends == sorted(ends)
    assert len(ends) > 3
    assert ends[-1] == SIZE


def test_two_sweeps_into_one_file(whole, engine, tmp_path):
    """The second is refused while the first goes on undisturbed."""
    engine.pause = 1e-3
    first = []
    thread = threading.Thread(target=lambda: first.append(run(tmp_path / "x.h5")))
    thread.start()
    sweeps.wait_for((tmp_path / "x.h5.parts" / "plan.json").exists)
    for keywords in ({}, {"resume": True}, {"force": True}):
        with pytest.raises(BusyError, match=r"another sweep is writing .*x\.h5"):
            run(tmp_path / "x.h5", **keywords)
    thread.join()
    assert first == [whole]


def test_ctrl_c_finishes_the_blocks_under_way_and_says_how_to_go_on(whole, engine, tmp_path):
    path, told = tmp_path / "x.h5", []

    def progress(what, done, _total):
        told.append(what)
        if done and what == "designs":
            signal.raise_signal(signal.SIGINT)

    says = r"stopped; \d+ of 420 designs are kept in .*x\.h5\.parts: go on with resume=True"
    engine.pause = 1e-3
    with pytest.raises(StoppedError, match=says) as caught:
        run(path, workers=2, progress=progress)
    kept = int(str(caught.value).split()[1])
    assert 14 <= kept <= 4 * 14
    assert told.count("stopping") == 1
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    engine.calls.clear()
    assert run(path, resume=True) == whole
    assert sum(size for size, _ in engine.calls) == SIZE - kept


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
    with pytest.raises(SizeError, match=r"out of memory: fewer workers take less; 28 of 420 designs are kept in .*resume=True"):
        run(tmp_path / "x.h5", workers=1)
    assert run(tmp_path / "x.h5", resume=True) == whole


def test_a_part_that_cannot_be_read_is_named(whole, tmp_path, monkeypatch):
    path = tmp_path / "x.h5"
    with pytest.raises(_StopError):
        run(path, progress=stop_after(4))
    lost = min(path.with_name("x.h5.parts").glob("*.part"))
    parts = Folder.parts

    def listed(self):
        found = parts(self)
        lost.unlink(missing_ok=True)
        return found

    with monkeypatch.context() as patch:
        patch.setattr(Folder, "parts", listed)
        with pytest.raises(StoreError, match=rf"cannot read {lost}: .*No such file or directory.*; \d+ of 420 designs are kept"):
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
        StoreError, match=r"what is still to be written takes about \S+ GB, and the disk has 1e-05 GB left; 14 of 420"
    ):
        run(tmp_path / "x.h5", workers=1)
    assert len(engine.calls) < 4
    monkeypatch.undo()
    sweeps.use(monkeypatch)
    assert run(tmp_path / "x.h5", resume=True) == whole


PROGRAM = """
    import sys, resource, signal
    sys.path.insert(0, {tests!r})
    import sweeps
    from lagrange_casadi.errors import LagrangeCasadiError
    from lagrange_casadi.sweep import plan, sweep
    plan.compiled = lambda *_: sweeps.Formula(pause={pause})
    resource.setrlimit(resource.RLIMIT_FSIZE, ({limit}, {limit}))
    print("ready", flush=True)
    try:
        sweep(sweeps.scene(), {grid!r}, out={out!r}, resume=True)
    except LagrangeCasadiError as error:
        print(error)
        sys.exit(error.exit_status)
"""


def program(out, *, pause=0.0, limit=resource.RLIM_INFINITY, grid=GRID):
    text = PROGRAM.format(tests=os.path.dirname(__file__), out=str(out), pause=pause, limit=limit, grid=grid)
    return sweeps.process(sys.executable, "-c", textwrap.dedent(text))


@pytest.mark.parametrize("limit", [500, 2_900, 30_000, 60_000])
def test_a_full_disk_is_one_line_and_loses_nothing(whole, tmp_path, limit):
    """Real writes that fail, of the plan, of a part, and at places of the file; the system's limit stands for a full disk."""
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


def test_killed_at_twenty_random_moments(whole, tmp_path):
    """kill -9, while blocks are evaluated, committed, joined and put in place; and resumed each time."""
    path, chance, phases = tmp_path / "x.h5", random.Random(20), set()
    kills = 0
    while kills < 20:
        with program(path, pause=2e-4) as running:
            assert running.stdout.readline() == "ready\n"
            if kills % 2:
                sweeps.wait_for(lambda: any(tmp_path.glob("x.h5.parts/*.part")) or running.poll() is not None)
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


def test_a_file_survives_being_replaced(whole, tmp_path):
    """Until the new one is whole, the old one stays."""
    path = tmp_path / "whole.h5"
    seen = []

    def progress(what, done, total):
        seen.append(path.read_bytes() == whole)

    changed = {"l": (0.15, 0.4, 60), "r": (0.05, 0.1, 6)}
    run(path, grid=changed, force=True, progress=progress)
    assert all(seen)
    with h5py.File(path) as h:
        assert h["status"].shape == (60, 6)
