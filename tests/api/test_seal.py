"""The seal: what it says, what it finds, and what is not even opened."""

import hashlib
import os
import re
import shutil

import h5py
import numpy as np
import pytest
import sweeps
import xarray
from conftest import ROOT
from forging import flip, unseal
from hypothesis import given
from hypothesis import strategies as st
from internals import base_seal as seal
from internals import check_sweep, is_sweep
from internals import file as optimum
from internals import runs as store

from lagrange_casadi import Sweep, check, load, save, sweep
from lagrange_casadi.cli import main
from lagrange_casadi.errors import PathError, StoreError

MIB = 1 << 20


def plain(kind, content):
    """The same digest, written down as the documentation says it."""
    pieces = [hashlib.sha256(content[at : at + MIB]).digest() for at in range(0, len(content), MIB)]
    return hashlib.sha256(f"{kind} {len(content)}\n".encode() + b"".join(pieces)).hexdigest()


@pytest.fixture
def sealed(tmp_path):
    """A file of a little more than two pieces."""
    path = tmp_path / "x.bin"
    path.write_bytes(np.random.default_rng(1).bytes(2 * MIB + 1000))
    seal.seal(path, "something")
    return path


@pytest.fixture(scope="module")
def run(solution, tmp_path_factory):
    path = tmp_path_factory.mktemp("run") / "press.h5"
    save(solution.during(slice(0, 5)), path)
    return path


@pytest.mark.parametrize("length", [0, 1, MIB - 1, MIB, MIB + 1, 23 * MIB + 7])
def test_the_digest_is_what_the_documentation_says(tmp_path, length):
    """Of any length, however many threads share it."""
    content = np.random.default_rng(length).bytes(length)
    path = tmp_path / "x.bin"
    path.write_bytes(content)
    seal.seal(path, "something")
    whole = path.read_bytes()
    assert whole[:length] == content
    assert len(whole) == length + seal.SIZE
    digest = plain("something", content)
    lines = (
        f"lagrange-casadi seal 1\nof something\nbytes {length}\nSHA-256 of the SHA-256 of every MiB"
        f" {digest}\n"
    )
    assert whole[length:].decode("ascii").rstrip(" \n") + "\n" == lines
    assert whole[-1:] == b"\n"
    assert seal.kind_of(path) == "something"
    seal.verify(path)


@pytest.mark.parametrize("error", [OSError("gone"), KeyboardInterrupt()])
def test_after_a_failure_no_thread_goes_on(monkeypatch, error):
    """An interrupt does not wait for the rest of a large file."""
    monkeypatch.setattr(seal, "cores", lambda: 4)
    asked = []

    class File:
        def seek(self, place):
            pass

        def readinto(self, buffer):
            asked.append(len(buffer))
            if len(asked) == 5:
                raise error
            return len(buffer)

    with pytest.raises(type(error)):
        seal.Seal.of(File(), "something", 1000 * MIB)
    assert len(asked) < 100


def test_the_documentation_verifies_a_file(run, tmp_path, monkeypatch):
    (block,) = re.findall(
        r"```python\n(.*?)```", (ROOT / "docs" / "schema.md").read_text(), re.DOTALL
    )
    shutil.copy(run, tmp_path)
    monkeypatch.chdir(tmp_path)
    exec(compile(block, "schema.md", "exec"), {})
    flip(tmp_path / "press.h5", 5000)
    with pytest.raises(AssertionError):
        exec(compile(block, "schema.md", "exec"), {})


def test_every_byte_of_a_seal_counts(sealed):
    """By one of its bits, each of them in turn."""
    content = sealed.read_bytes()
    for place in range(len(content) - seal.SIZE, len(content)):
        flip(sealed, place, 1 << place % 8)
        with pytest.raises(StoreError, match=r"x\.bin: "):
            seal.verify(sealed)
        sealed.write_bytes(content)
    seal.verify(sealed)


@given(st.integers(0, 2 * MIB + 999), st.integers(0, 7))
def test_every_bit_before_it_counts(tmp_path_factory, place, bit):
    path = tmp_path_factory.getbasetemp() / "bits.bin"
    if not path.exists():
        path.write_bytes(np.random.default_rng(1).bytes(2 * MIB + 1000))
        seal.seal(path, "something")
    flip(path, place, 1 << bit)
    with pytest.raises(
        StoreError, match=r"bits\.bin: damaged: its bytes are not those that were written$"
    ):
        seal.verify(path)
    flip(path, place, 1 << bit)
    seal.verify(path)


@pytest.mark.parametrize("cut", [1, 255, 256, 257, 1000, 2 * MIB])
def test_a_file_that_was_cut_is_refused(sealed, cut):
    content = sealed.read_bytes()
    for damaged in (
        content[:-cut],
        content[cut:],
        content[:1000] + content[1000 + cut :],
        content[:-256] + content[-cut:],
    ):
        sealed.write_bytes(damaged)
        if damaged != content:
            with pytest.raises(StoreError, match=r"x\.bin: "):
                seal.verify(sealed)


def test_a_file_that_goes_on_after_its_seal_is_refused(sealed):
    content = sealed.read_bytes()
    for more in (b"\0", content[-256:], content):
        sealed.write_bytes(content + more)
        with pytest.raises(StoreError, match=r"x\.bin: "):
            seal.verify(sealed)


def test_a_seal_of_another_kind_does_not_fit(sealed):
    content = sealed.read_bytes()
    sealed.write_bytes(content.replace(b"of something\n", b"of somethinh\n"))
    assert seal.kind_of(sealed) == "somethinh"
    with pytest.raises(StoreError, match="damaged"):
        seal.verify(sealed)


def test_what_was_seen_is_told_from_what_came_after(sealed):
    seen = seal.verify(sealed)
    assert seen.is_at(sealed)
    other = sealed.with_name("other")
    shutil.copy(sealed, other)
    assert not seen.is_at(other)
    assert not seen.is_at(sealed.with_name("nothing"))
    times = os.stat(sealed)
    os.utime(sealed, ns=(times.st_atime_ns, times.st_mtime_ns + 1))
    assert not seen.is_at(sealed)


@pytest.mark.parametrize(
    "read", [load, check, store.figure_specs, Sweep.open, check_sweep, seal.verify]
)
def test_pipes_and_folders_are_not_opened(tmp_path, read):
    os.mkfifo(tmp_path / "x.h5")
    with pytest.raises(PathError, match=r"x\.h5: is a device or a pipe, not a file$"):
        read(tmp_path / "x.h5")
    with pytest.raises(PathError, match=r"is a folder, not a file$"):
        read(tmp_path)
    with pytest.raises(PathError, match=r"no such file$"):
        read(tmp_path / "nothing.h5")


def test_other_readers_go_on(run):
    """A seal is no part of HDF5: what the first bytes tell, and every library that reads it, are as
    ever.
    """
    assert run.read_bytes()[:8] == seal.SIGNATURE
    for engine in ("h5netcdf", "netcdf4", None):
        with xarray.open_dataset(run, engine=engine, group="effort") as effort:
            np.testing.assert_array_equal(effort["O"], load(run).effort("O"))


@pytest.mark.skipif(not shutil.which("h5dump"), reason="needs h5dump, of hdf5-tools")
def test_h5dump_goes_on(run):
    import subprocess

    done = subprocess.run(
        ["h5dump", "-d", "/t", str(run)], capture_output=True, text=True, check=True
    )
    assert "(0): 0, 0.0001" in done.stdout
    assert done.stderr == ""


def test_to_change_a_file_takes_its_seal(run, tmp_path):
    path = tmp_path / "x.h5"
    shutil.copy(run, path)
    with h5py.File(path, "r+") as file:
        file.attrs["mine"] = 1
    with pytest.raises(StoreError, match=r"x\.h5: it has no seal: .*; run it again$"):
        load(path)


@pytest.fixture(params=["run", "sweep", "search"])
def unsealed(request, run, monkeypatch, tmp_path):
    """A file without its seal, and what reads such a file otherwise."""
    path = tmp_path / "x.h5"
    if request.param == "run":
        shutil.copy(run, path)
        readers = (load, check, store.figure_specs)
    elif request.param == "sweep":
        sweeps.use(monkeypatch)
        sweep(sweeps.scene(), {"l": [0.2, 0.3]}, out=path)
        readers = (Sweep.open, check_sweep)
    else:
        with h5py.File(path, "w") as file:
            file.attrs.update(
                {"schema": optimum.SCHEMA, "schema_version": optimum.VERSION, "complete": True}
            )
            file.attrs.update({"stopped": False, "feasible": True, "converged": True})
            file.create_group("points")
        seal.seal(path, optimum.SCHEMA)
        readers = (optimum.check_optimum,)
    for read in readers:
        read(path)
    unseal(path)
    return path, readers


@pytest.mark.parametrize("version", [None, 1])
def test_what_has_no_seal_is_to_be_run_again(unsealed, capsys, monkeypatch, version):
    """Of whatever version it says it is: HDF5 never sees it."""
    path, readers = unsealed
    if version:
        with h5py.File(path, "r+") as file:
            file.attrs["schema_version"] = version
    told = (
        f"{path}: it has no seal: cut short, changed by another program, or from before there were"
        " seals; run it again"
    )

    def opened(*_arguments, **_keywords):
        raise AssertionError("HDF5 saw it")

    monkeypatch.setattr(h5py, "File", opened)
    for read in readers:
        with pytest.raises(StoreError, match=f"^{re.escape(told)}$"):
            read(path)
    for command in ("check", "info", "report", "best", "table"):
        assert (
            main(
                [
                    command,
                    str(path),
                    *(("--minimise", "peak:effort:O") if command == "best" else ()),
                ]
            )
            == 1
        )
        assert capsys.readouterr() == ("", f"error: {told}\n")
    assert not is_sweep(path)
    assert not optimum.is_optimum(path)


def test_an_unsealed_file_is_not_replaced(unsealed, solution):
    with pytest.raises(
        PathError,
        match=r"it is an HDF5 file of something else, or without its seal; choose another name$",
    ):
        save(solution, unsealed[0])


@pytest.mark.parametrize("schema", [store.SCHEMA, "lagrange-casadi-sweep", optimum.SCHEMA])
def test_other_versions_are_to_be_run_again(tmp_path, schema):
    path = tmp_path / "x.h5"
    read = {store.SCHEMA: load, optimum.SCHEMA: optimum.check_optimum}.get(schema, Sweep.open)
    for version in (0, 99):
        with h5py.File(path, "w") as file:
            file.attrs.update({"schema": schema, "schema_version": version, "complete": True})
        seal.seal(path, schema)
        with pytest.raises(
            StoreError,
            match=(rf"schema version {version}.*, this program reads version 1: run it again$"),
        ):
            read(path)
