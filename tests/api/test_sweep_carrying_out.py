"""A sweep carried out: the same bytes however it was cut, stopped and resumed; and nothing
half-written is believed.
"""

import os
import random
import shutil
import signal
import subprocess
import sys
import threading

import h5py
import pytest
import sweeps
from internals import Folder, cores, sweep
from sweeps import GRID, SIZE, StopError, run, stop_after

from lagrange_casadi.errors import BusyError, DeclarationError, PathError, StoppedError, StoreError


@pytest.mark.sampled(5)
@pytest.mark.parametrize("workers", [1, 2, 5, None])
def test_the_same_bytes_whatever_the_workers(whole, engine, tmp_path, workers):
    engine.pause = 1e-3
    engine.calls.clear()
    assert run(tmp_path / "x.h5", workers=workers) == whole
    assert set(engine.threads) == {1}
    assert sum(size for size, _ in engine.calls) == SIZE
    threads, most = len({thread for _, thread in engine.calls}), workers or cores()
    assert min(most, 2) <= threads <= most


@pytest.mark.quick
def test_the_same_bytes_whatever_the_stops(whole, tmp_path):
    path, chance, stops = tmp_path / "x.h5", random.Random(5), 0
    while not path.exists():
        try:
            run(path, resume=True, progress=stop_after(chance.randint(1, 6)))
        except StopError:
            stops += 1
    assert stops > 3
    assert path.read_bytes() == whole


def test_the_order_of_blocks_does_not_matter(whole, tmp_path, monkeypatch):
    """Workers that give their blocks backwards."""
    from internals import sweeping

    class Backwards:
        def results(self, plan, queue):
            blocks = list(iter(queue.take, None))
            assert len(blocks) > 3
            for start, stop in blocks[::-1]:
                yield start, stop, plan.harvest.chunks(plan.block(start, stop), plan.capacity)

    monkeypatch.setattr(sweeping, "hired", lambda *_: Backwards())
    assert run(tmp_path / "x.h5") == whole


def test_what_is_committed_is_not_done_again(whole, engine, tmp_path):
    with pytest.raises(StopError):
        run(tmp_path / "x.h5", progress=stop_after(3))
    kept = sum(part.stop - part.start for part in Folder(tmp_path / "x.h5").parts())
    engine.calls.clear()
    assert run(tmp_path / "x.h5", resume=True) == whole
    assert sum(size for size, _ in engine.calls) == SIZE - kept
    assert 0 < kept < SIZE


def test_a_part_lost_or_damaged_is_done_again(whole, tmp_path):
    path, folder = tmp_path / "x.h5", tmp_path / "x.h5.parts"
    with pytest.raises(StopError):
        run(path, progress=stop_after(4))
    first, second, *_ = sorted(folder.glob("*.part"))
    first.unlink()
    content = bytearray(second.read_bytes())
    content[-3] ^= 1
    second.write_bytes(content)
    with pytest.raises(
        StoreError,
        match=(
            r"was damaged, in column .*, and is deleted; \d+ of 420 designs are kept in"
            r" .*resume=True"
        ),
    ):
        run(path, resume=True)
    assert run(path, resume=True) == whole


@pytest.mark.quick
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
    with pytest.raises(
        PathError, match=r"whole\.h5 exists: force=True replaces it, resume=True continues"
    ):
        run(path)
    assert path.read_bytes() == whole
    with pytest.raises(StopError):
        run(path, force=True, progress=stop_after(2))
    assert path.read_bytes() == whole
    with pytest.raises(
        PathError,
        match=r"whole\.h5\.parts holds an unfinished sweep: continue with resume=True, or start",
    ):
        run(path)
    assert run(path, resume=True) == whole
    assert run(path, force=True) == whole
    with pytest.raises(DeclarationError, match="resume and force exclude each other"):
        run(path, force=True, resume=True)
    with pytest.raises(StopError):
        run(tmp_path / "notes.h5", progress=stop_after(2))
    (tmp_path / "notes.h5").write_text("mine")
    with pytest.raises(PathError, match=r"notes\.h5 has appeared since the sweep began"):
        run(tmp_path / "notes.h5", resume=True)
    shutil.rmtree(tmp_path / "notes.h5.parts")
    for keywords, says in (({}, "exists"), ({"resume": True}, "not a file of this program")):
        with pytest.raises((PathError, StoreError), match=says):
            run(tmp_path / "notes.h5", **keywords)
    assert (tmp_path / "notes.h5").read_text() == "mine"
    assert sorted(os.listdir(tmp_path)) == ["notes.h5", "whole.h5"]


def test_a_file_that_another_program_writes_is_left_alone(whole, tmp_path):
    path = tmp_path / "whole.h5"
    before = path.stat().st_ino
    program = (
        f"import h5py, sys; h = h5py.File({str(path)!r}, 'r+'); print('open', flush=True);"
        " sys.stdin.read()"
    )
    with sweeps.process(sys.executable, "-c", program, stdin=subprocess.PIPE) as holder:
        assert holder.stdout.readline() == "open\n"
        for keywords in ({}, {"force": True}, {"resume": True}):
            with pytest.raises(
                BusyError, match=r"cannot write .*whole\.h5: another program has it open to write"
            ):
                run(path, **keywords)
    assert path.stat().st_ino == before
    assert os.listdir(tmp_path) == ["whole.h5"]


@pytest.mark.sampled(9)
@pytest.mark.parametrize(
    ("change", "says"),
    [
        (
            {"grid": {"l": (0.15, 0.4, 61), "r": (0.05, 0.1, 7)}},
            "grid l was 0.15:0.4:60 and is 0.15:0.4:61",
        ),
        ({"grid": {"l": (0.15, 0.4, 60)}}, "grid r was there, and is not"),
        (
            {"grid": {"r": (0.05, 0.1, 7), "l": (0.15, 0.4, 60)}},
            "the axes of the grid were l, r and are r, l",
        ),
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
        with pytest.raises(StopError):
            run(path, progress=stop_after(2))
    with pytest.raises(StoreError) as caught:
        run(path, resume=True, **change)
    assert f"is of another sweep: {says}" in str(caught.value)
    assert str(caught.value).endswith("; start anew with force=True, or write another file")


def test_another_version_is_refused(whole, engine, tmp_path, monkeypatch):
    from dataclasses import replace

    monkeypatch.setattr(
        engine, "provenance", replace(engine.provenance, versions={"lagrange_casadi": "9.9"})
    )
    with pytest.raises(
        StoreError, match=r"another sweep: versions lagrange_casadi was .* and is 9\.9"
    ):
        run(tmp_path / "whole.h5", resume=True)


def test_another_law_of_motion_is_refused(whole, tmp_path):
    from lagrange_casadi import Scene
    from lagrange_casadi.motion import polynomial

    scene = sweeps.scene()
    other = Scene(scene.mechanism, {"O": polynomial(0, 1)}, t=scene.t, posture=scene.posture)
    with pytest.raises(
        StoreError, match="an expression, a law of motion or the posture of the scene has changed"
    ):
        sweep(other, GRID, out=tmp_path / "whole.h5", resume=True)


@pytest.mark.parametrize("keywords", [{}, {"resume": True}, {"force": True}])
def test_what_no_sweep_put_into_the_folder_is_not_touched(engine, tmp_path, keywords):
    folder = tmp_path / "x.h5.parts"
    folder.mkdir()
    (folder / "thesis.txt").write_text("mine")
    with pytest.raises(
        PathError, match=r"x\.h5\.parts holds 'thesis\.txt', which is not part of a sweep"
    ):
        run(tmp_path / "x.h5", **keywords)
    assert os.listdir(folder) == ["thesis.txt"]


@pytest.mark.parametrize("keywords", [{}, {"resume": True}])
def test_parts_of_nobody_knows_what_are_not_touched(whole, tmp_path, keywords):
    path, folder = tmp_path / "x.h5", tmp_path / "x.h5.parts"
    with pytest.raises(StopError):
        run(path, progress=stop_after(4))
    (folder / "plan.json").unlink()
    (folder / "000000000900-000000000901.part").write_text("damaged")
    before = sorted(os.listdir(folder))
    with pytest.raises(
        PathError,
        match=(r"x\.h5\.parts holds parts, and no plan\.json that describes them: force=True"),
    ):
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
    with pytest.raises(StopError):
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

    says = r"stopped; \d+ of 420 designs are kept in .*x\.h5\.parts: continue with resume=True"
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
