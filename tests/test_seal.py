"""The seal: what it says, what it finds, and what is not even opened."""

import gzip
import hashlib
import os
import re
import shutil
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray
from conftest import ROOT
from forging import flip, unseal
from hypothesis import given
from hypothesis import strategies as st

from lagrange_casadi import Sweep, check, evaluate, load, save
from lagrange_casadi.cli import main
from lagrange_casadi.errors import PathError, StoreError
from lagrange_casadi.store import runs as store
from lagrange_casadi.sweep.checking import check_sweep
from lagrange_casadi.system import seal

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
    lines = f"lagrange-casadi seal 1\nof something\nbytes {length}\nSHA-256 of the SHA-256 of every MiB {digest}\n"
    assert whole[length:].decode("ascii").rstrip(" \n") + "\n" == lines
    assert whole[-1:] == b"\n"
    assert seal.kind_of(path) == "something"
    assert seal.verify(path).sealed


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
    (block,) = re.findall(r"```python\n(.*?)```", (ROOT / "docs" / "schema.md").read_text(), re.DOTALL)
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
    assert seal.verify(sealed).sealed


@given(st.integers(0, 2 * MIB + 999), st.integers(0, 7))
def test_every_bit_before_it_counts(tmp_path_factory, place, bit):
    path = tmp_path_factory.getbasetemp() / "bits.bin"
    if not path.exists():
        path.write_bytes(np.random.default_rng(1).bytes(2 * MIB + 1000))
        seal.seal(path, "something")
    flip(path, place, 1 << bit)
    with pytest.raises(StoreError, match=r"bits\.bin: damaged: its bytes are not those that were written$"):
        seal.verify(path)
    flip(path, place, 1 << bit)
    assert seal.verify(path).sealed


@pytest.mark.parametrize("cut", [1, 255, 256, 257, 1000, 2 * MIB])
def test_a_file_that_was_cut_is_refused(sealed, cut):
    content = sealed.read_bytes()
    for damaged in (content[:-cut], content[cut:], content[:1000] + content[1000 + cut :], content[:-256] + content[-cut:]):
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
    assert not replace(seen, sealed=False).is_at(sealed)


@pytest.mark.parametrize("read", [load, check, store.figure_specs, Sweep.open, check_sweep, seal.verify])
def test_pipes_and_folders_are_not_opened(tmp_path, read):
    os.mkfifo(tmp_path / "x.h5")
    with pytest.raises(PathError, match=r"x\.h5: is a device or a pipe, not a file$"):
        read(tmp_path / "x.h5")
    with pytest.raises(PathError, match=r"is a folder, not a file$"):
        read(tmp_path)
    with pytest.raises(PathError, match=r"no such file$"):
        read(tmp_path / "nothing.h5")


def test_other_readers_go_on(run):
    """A seal is no part of HDF5: what the first bytes tell, and every library that reads it, are as ever."""
    assert run.read_bytes()[:8] == seal.SIGNATURE
    for engine in ("h5netcdf", "netcdf4", None):
        with xarray.open_dataset(run, engine=engine, group="effort") as effort:
            np.testing.assert_array_equal(effort["O"], load(run).effort("O"))


@pytest.mark.skipif(not shutil.which("h5dump"), reason="needs h5dump, of hdf5-tools")
def test_h5dump_goes_on(run):
    import subprocess

    done = subprocess.run(["h5dump", "-d", "/t", str(run)], capture_output=True, text=True, check=True)
    assert "(0): 0, 0.0001" in done.stdout
    assert done.stderr == ""


def test_to_change_a_file_takes_its_seal(run, tmp_path):
    path = tmp_path / "x.h5"
    shutil.copy(run, path)
    with h5py.File(path, "r+") as file:
        file.attrs["mine"] = 1
    with pytest.raises(StoreError, match=r"x\.h5: damaged: it has lost its seal, as where another program has changed it$"):
        load(path)


def of_before(name, folder):
    """A file of schema version 1, as the package wrote it then."""
    path = folder / name
    path.write_bytes(gzip.decompress((Path(__file__).parent / "data" / f"{name}.gz").read_bytes()))
    return path


def test_a_run_of_schema_version_1_is_read(tmp_path, capsys, slider_crank):
    path = of_before("run_1.h5", tmp_path)
    found, now = load(path), evaluate(slider_crank.scene, t=(0, 0.08, 5), xi=(0, 1, 3))
    for name in found.names():
        expected = now.array(name)
        np.testing.assert_allclose(found.array(name), expected, atol=1e-12 * np.abs(expected).max(), err_msg=name)
    assert check(path) == []
    assert not seal.verify(path).sealed
    assert main(["check", str(path)]) == 0
    told = "whole and consistent, as far as can be told: files of schema version 1 have no digest of all of it"
    assert capsys.readouterr().out == f"{path}: {told}\n"


def test_a_sweep_of_schema_version_1_is_read(tmp_path, capsys):
    path = of_before("sweep_1.h5", tmp_path)
    found = Sweep.open(path)
    assert found.shape == (2, 2)
    assert found["status"].tolist() == [[0, 4], [0, 0]]
    assert check_sweep(path) == []
    assert main(["check", str(path)]) == 0
    assert "as far as can be told" in capsys.readouterr().out


def test_a_chunk_that_an_unsealed_sweep_lacks_is_counted(tmp_path):
    """HDF5 would make up its numbers."""
    path = of_before("sweep_1.h5", tmp_path)
    with h5py.File(path, "r+") as file:
        name = "peak/section/rod/axial"
        old = file[name]
        attributes, scales = dict(old.attrs), [dim[0] for dim in old.dims]
        del file[name]
        new = file.create_dataset(name, (2, 2), np.float64, chunks=(2, 2), fillvalue=0)
        for key in ("units", "long_name", "sign"):
            new.attrs[key] = attributes[key]
        for dim, scale in zip(new.dims, scales, strict=True):
            dim.attach_scale(scale)
    with pytest.raises(StoreError, match=r"sweep_1\.h5: damaged: /peak/section/rod/axial has 0 bytes of 32$"):
        Sweep.open(path)


@pytest.mark.parametrize("keep", [20, 47, 48, 100, 50_000])
def test_an_unsealed_file_that_was_cut_is_refused(tmp_path, keep):
    path = of_before("run_1.h5", tmp_path)
    path.write_bytes(path.read_bytes()[:keep])
    with pytest.raises(
        StoreError, match=rf"run_1\.h5: not a whole HDF5 file of this package: it has {keep} bytes and no seal at their"
    ):
        load(path)


def test_a_seal_is_not_got_rid_of(run, tmp_path):
    """Without it, a file of now is not taken for one of before."""
    path = tmp_path / "x.h5"
    shutil.copy(run, path)
    unseal(path)
    with pytest.raises(StoreError, match="has lost its seal"):
        load(path)
