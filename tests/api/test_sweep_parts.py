"""Parts: whole or not there; and the lock."""

import os
import signal
import sys
import textwrap

import pytest
import sweeps
from internals import ColumnsColumn as Column
from internals import Folder

from lagrange_casadi.errors import BusyError, StoreError

pytestmark = pytest.mark.quick

COLUMNS = (
    Column("status", "1", {}, dtype="|i1"),
    Column("peak:a", "N", {}),
    Column("history:b", "N", {}, ("t",), (3,)),
)


def contents(start, stop):
    return [f"{column.name} of {start} to {stop}".encode() * (stop - start) for column in COLUMNS]


@pytest.fixture
def folder(tmp_path):
    folder = Folder(tmp_path / "x.h5")
    with folder.locked():
        folder.begin(sweeps.identity())
        yield folder


def commit(folder, *blocks):
    for start, stop in blocks:
        folder.commit(start, stop, COLUMNS, contents(start, stop))


def test_what_is_committed_is_read(folder):
    commit(folder, (4, 9), (0, 4))
    parts = folder.parts()
    assert [(part.start, part.stop) for part in parts] == [(0, 4), (4, 9)]
    for part in parts:
        assert part.read() == contents(part.start, part.stop)
        assert part.size == sum(map(len, part.read()))
    assert folder.identity == sweeps.identity()


@pytest.mark.parametrize("keep", [0.0, 0.02, 0.5, 0.999])
def test_a_part_cut_short_is_not_believed(folder, keep):
    commit(folder, (0, 50), (50, 60))
    path = folder.parts()[0].path
    content = path.read_bytes()
    path.write_bytes(content[: int(keep * len(content))])
    assert [part.start for part in folder.parts()] == [50]
    assert not path.exists()


def test_every_flipped_byte_is_found(folder):
    commit(folder, (0, 2))
    (part,) = folder.parts()
    assert list(folder.flaws()) == []
    path, content = part.path, part.path.read_bytes()
    for place in range(len(content)):
        damaged = bytearray(content)
        damaged[place] ^= 0x10
        path.write_bytes(damaged)
        assert len(list(folder.flaws())) == 1
        with pytest.raises(StoreError, match=r"was damaged, in (head|column .*), and is deleted"):
            part.read()
        assert not path.exists(), place
        path.write_bytes(damaged)
        found = folder.parts()
        if found:
            with pytest.raises(StoreError, match=r"was damaged, in column .*, and is deleted"):
                found[0].read()
        assert not path.exists(), place


def test_drafts_and_overlaps_are_cleared(folder):
    commit(folder, (0, 4), (2, 6), (6, 8))
    (folder.path / "000000000008-000000000009.part.draft").write_bytes(b"half")
    assert [(part.start, part.stop) for part in folder.parts()] == [(0, 4), (6, 8)]
    assert sorted(path.name for path in folder.path.iterdir() if path.suffix != ".part") == [
        "lock",
        "plan.json",
    ]


def test_to_begin_anew_removes_what_is_there(folder):
    commit(folder, (0, 4))
    folder.begin(sweeps.identity("y"))
    assert folder.parts() == []
    assert folder.identity == sweeps.identity("y")


def test_a_damaged_plan_is_one_line(folder):
    (folder.path / "plan.json").write_text("{")
    with pytest.raises(StoreError, match=r"plan\.json: damaged: .*; start anew with force=True"):
        _ = folder.identity


def test_a_lock_that_led_to_nothing_leaves_nothing(tmp_path):
    with Folder(tmp_path / "x.h5").locked():
        assert os.listdir(tmp_path) == ["x.h5.parts"]
    assert os.listdir(tmp_path) == []


def test_the_second_is_refused(folder):
    with (
        pytest.raises(BusyError, match=r"another sweep is writing .*x\.h5"),
        Folder(folder.target).locked(),
    ):
        pass
    assert folder.begun


def test_a_lock_dies_with_its_process(tmp_path):
    target = tmp_path / "x.h5"
    program = f"""
        import time
        from pathlib import Path
        from lagrange_casadi.studies.sweep.parts import Folder
        folder = Folder(Path({str(target)!r}))
        with folder.locked():
            folder.begin({{}})
            print("held", flush=True)
            time.sleep(60)
    """
    with sweeps.process(sys.executable, "-c", textwrap.dedent(program)) as holder:
        assert holder.stdout.readline() == "held\n"
        with pytest.raises(BusyError), Folder(target).locked():
            pass
        holder.send_signal(signal.SIGKILL)
        holder.wait()
        with Folder(target).locked():
            assert Folder(target).begun
