"""Files that appear whole or not at all."""

import os
import signal
import sys
import threading
from pathlib import Path

import h5py
import pytest
import sweeps
from internals import check_writable, filling, replacing, uninterrupted

from lagrange_casadi.errors import PathError

pytestmark = pytest.mark.quick


def test_a_folder_keeps_what_else_is_in_it(tmp_path):
    folder = tmp_path / "figures"
    folder.mkdir()
    (folder / "notes.txt").write_text("mine")
    (folder / "a.png").write_text("old")
    with filling(folder) as draft:
        (draft / "a.png").write_text("new")
    assert {path.name: path.read_text() for path in folder.iterdir()} == {
        "notes.txt": "mine",
        "a.png": "new",
    }
    assert os.listdir(tmp_path) == ["figures"]


@pytest.mark.parametrize("path", [".", "..", "notes/.."])
def test_the_working_folder_is_a_folder(path, tmp_path, monkeypatch):
    (tmp_path / "figures" / "notes").mkdir(parents=True)
    monkeypatch.chdir(tmp_path / "figures")
    with filling(Path(path)) as draft:
        (draft / "a.png").write_text("new")
    folder = tmp_path if path == ".." else tmp_path / "figures"
    assert sorted(os.listdir(folder)) == sorted(["a.png", "figures" if path == ".." else "notes"])


def test_a_failure_publishes_nothing(tmp_path):
    def fail(draft):
        (draft / "a.png").write_text("new")
        raise RuntimeError

    with pytest.raises(RuntimeError), filling(tmp_path / "figures") as draft:
        fail(draft)
    assert os.listdir(tmp_path) == []


def test_replacing_keeps_the_old_until_the_new_is_whole(tmp_path):
    target = tmp_path / "x.txt"
    target.write_text("old")
    with replacing(target) as draft:
        draft.write_text("new")
        assert target.read_text() == "old"
    assert target.read_text() == "new"
    assert os.listdir(tmp_path) == ["x.txt"]


def test_what_is_in_the_way_is_named(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(PathError, match="it is a file, not a folder"):
        check_writable(tmp_path / "file", folder=True)
    with pytest.raises(PathError, match="it is a folder"):
        check_writable(tmp_path)


def test_only_an_hdf5_file_replaces_another(tmp_path):
    target = tmp_path / "x.h5"
    with h5py.File(target, "w") as file:
        file["a"] = 1.0
    before = target.read_bytes()
    with (
        pytest.raises(
            PathError, match=r"cannot write .*x\.h5: it is an HDF5 file; choose another name"
        ),
        replacing(target),
    ):
        pass
    assert target.read_bytes() == before
    check_writable(target, hdf5=True)
    target.write_text("l\n0.2\n")
    check_writable(target)


def test_an_interrupt_waits_until_it_is_let_through():
    reached = []

    def work(*, breathes):
        with uninterrupted() as breathe:
            os.kill(os.getpid(), signal.SIGINT)
            reached.append("after the signal")
            if breathes:
                breathe()
            reached.append("at the end")

    with pytest.raises(KeyboardInterrupt):
        work(breathes=True)
    assert reached == ["after the signal"]
    with pytest.raises(KeyboardInterrupt):
        work(breathes=False)
    assert reached[1:] == ["after the signal", "at the end"]
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


HELD = """
import sys, time
from pathlib import Path
from lagrange_casadi.base.publish import filling, replacing
with {"file": replacing, "folder": filling}[sys.argv[1]](Path("x.out")) as draft:
    (draft / "a" if draft.is_dir() else draft).write_text("half")
    print("ready", flush=True)
    time.sleep(60)
"""


@pytest.mark.parametrize("kind", ["file", "folder"])
def test_what_a_kill_has_left_goes_with_the_next_of_its_name(tmp_path, monkeypatch, kind):
    """Not what a process that lives is writing, nor what only looks like it."""
    monkeypatch.chdir(tmp_path)
    others = {".x.out.notes", ".x.out.abcdefgh.00000000", ".y.out.abcdefgh"}
    for name in others:
        (tmp_path / name).mkdir()
    with (
        sweeps.process(sys.executable, "-c", HELD, kind) as killed,
        sweeps.process(sys.executable, "-c", HELD, kind) as living,
    ):
        assert [killed.stdout.readline(), living.stdout.readline()] == ["ready\n"] * 2
        both = set(os.listdir(tmp_path)) - others
        assert len(both) == 2
        killed.send_signal(signal.SIGKILL)
        killed.wait()
        with replacing(tmp_path / "x.txt") as draft:
            draft.write_text("another")
            assert both < set(os.listdir(tmp_path))
        with replacing(tmp_path / "x.out") as draft:
            draft.write_text("whole")
        left = set(os.listdir(tmp_path)) - others - {"x.out", "x.txt"}
        assert len(left) == 1
        assert left < both
    (tmp_path / "x.out").unlink()
    with replacing(tmp_path / "x.out") as draft:
        draft.write_text("whole")
    assert set(os.listdir(tmp_path)) == others | {"x.out", "x.txt"}


def test_many_drafts_of_one_name_at_once_are_each_whole(tmp_path):
    """None takes another's for one that was left, not even before that is locked."""
    target, failed = tmp_path / "x.txt", []

    def often(text):
        try:
            for _ in range(30):
                with replacing(target) as draft:
                    draft.write_text(text)
                    assert draft.read_text() == text
        except BaseException as error:
            failed.append(error)

    threads = [threading.Thread(target=often, args=(str(k) * 10,)) for k in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not failed
    assert os.listdir(tmp_path) == ["x.txt"]
