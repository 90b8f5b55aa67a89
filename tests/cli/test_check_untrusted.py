"""Files of unknown origin are read in a process of their own: whatever that one does, a line and a
status come of it.
"""

import importlib
import os
import shutil
import subprocess
import sys

import h5py
import numpy as np
import pytest
from forging import forging
from internals import LostError, memory, run_apart

from lagrange_casadi import evaluate, save
from lagrange_casadi.cli import main

check = importlib.import_module("lagrange_casadi.cli.check")
process = importlib.import_module("lagrange_casadi.base.apart")


@pytest.fixture
def file(slider_crank, here):
    solution = evaluate(
        slider_crank.scene, t=(0, 0.08, 5), xi=(0, 1, 3), wanted=("effort",), backend="vm"
    )
    save(solution, here / "x.h5")
    return here / "x.h5"


def test_it_finds_what_check_finds_and_imports_nothing_from_here(file, here, capsys):
    for name in ("h5py", "json", "numpy", "lagrange_casadi"):
        (here / f"{name}.py").write_text("open('planted', 'w')")
    with forging(file) as h:
        h["effort/O"].attrs["units"] = "N\x1b[2J"
    assert main(["check", "x.h5"]) == 1
    usual = capsys.readouterr()
    assert main(["check", "--untrusted", "x.h5"]) == 1
    assert capsys.readouterr() == usual
    assert r"N\x1b[2J" in usual.err
    assert not (here / "planted").exists()


@pytest.mark.parametrize(
    ("program", "told"),
    [
        ("import os; os.abort()", "reading it crashed (Aborted): it is damaged or forged"),
        (
            "import os; os.kill(os.getpid(), 11)",
            "reading it crashed (Segmentation fault): it is damaged or forged",
        ),
        ("pass", "the process that reads it gave no answer (status 0)"),
        (
            "import sys; sys.exit('a\\nb\\x1b[2J')",
            r"the process that reads it gave no answer (status 1): b\x1b[2J",
        ),
        ("print('[' * 100_000)", "the process that reads it gave no answer (status 0)"),
        (
            "print('{{\"found\": [3]}}')",
            "answer[0] is not of the expected kind",
        ),
        (
            (
                "import signal, time\nfor n in (2, 15): signal.signal(n,"
                " signal.SIG_IGN)\ntime.sleep(1000)"
            ),
            "was not read within 0.5 s, so it is large or forged; --time-limit sets another limit",
        ),
    ],
)
def test_whatever_the_reader_does_is_a_line(here, capsys, monkeypatch, program, told):
    monkeypatch.setattr(process, "_PROGRAM", program)
    seconds = "0.5" if "sleep" in program else "30"
    assert main(["check", "--untrusted", "--time-limit", seconds, "x.h5"]) == 1
    assert capsys.readouterr() == ("", f"error: x.h5: {told}\n")


MEMORY = "x: takes more memory to read than half of what is free"
READS = {
    "__import__('numpy').ones(10**16)": MEMORY,
    "bytearray(FREE)": MEMORY,
    "[] + 1": 'x: cannot be read: TypeError: can only concatenate list (not "int") to list',
    "open('written', 'w').write('x' * 10**5)": "x: cannot be read: OSError: [Errno 27] File too",
    "(__import__('os').write(1, b'noise'), ['whole'])[1]": ["whole"],
    "['x'] * 10**6": ["x"] * 10**6,
    "list(__import__('resource').getrlimit(4))[:1]": [0],
    "__import__('pathlib').os.environ['PLACE']": "given",
}


@pytest.mark.parametrize("read", READS)
def test_a_function_answers_within_limits(read, here):
    """What it returns, or why it returned nothing."""
    expected, read = READS[read], read.replace("FREE", str(int(0.9 * memory())))
    limits = {"seconds": 30, "variables": {"PLACE": "given"}}
    if isinstance(expected, str) and expected.startswith("x: "):
        with pytest.raises(LostError) as error:
            run_apart(eval, read, folder=here, **limits)
        assert f"x: {error.value}".startswith(expected)
    else:
        assert run_apart(eval, read, folder=here, **limits) == expected


def test_findings_are_told_in_few_words(monkeypatch):
    monkeypatch.setattr(check, "_findings", lambda _: ["y" * 10**6] * 1000)
    assert check.found_in("x") == ["y" * 1000] * 100 + ["and 900 more"]


@pytest.mark.parametrize(
    "words",
    [
        ["--time-limit", "3"],
        *(["--untrusted", "--time-limit", n] for n in ("0", "-1", "nan", "inf")),
    ],
)
def test_limits_that_are_none_are_refused(here, capsys, words):
    assert main(["check", "x.h5", *words]) == 2
    assert capsys.readouterr().err.startswith("error: --time-limit")


def test_a_file_that_is_not_there_is_a_mistake_in_what_was_asked(here, capsys):
    assert main(["check", "--untrusted", "x.h5"]) == 2
    assert capsys.readouterr().err == "error: x.h5: no such file\n"


@pytest.mark.skipif(not shutil.which("cc"), reason="no compiler")
def test_a_file_makes_hdf5_load_no_filters(file, here, capsys, monkeypatch):
    """A filter that HDF5 does not know is looked for among plugins, all of which it loads: not for
    such a file.
    """
    (here / "p.c").write_text(
        "#include <stdio.h>\n__attribute__((constructor)) static void f(void) {"
        ' fclose(fopen("loaded", "w")); }\n'
    )
    (here / "plugins").mkdir()
    subprocess.run(["cc", "-shared", "-fPIC", "-o", "plugins/libh5p.so", "p.c"], check=True)
    with forging(file) as h:
        shape, kept = h["effort/O"].shape, dict(h["effort/O"].attrs)
        del h["effort/O"]
        layout = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
        layout.set_chunk(shape)
        layout.set_filter(32_123, h5py.h5z.FLAG_OPTIONAL)
        made = h5py.h5d.create(
            h.id, b"effort/O", h5py.h5t.NATIVE_DOUBLE, h5py.h5s.create_simple(shape), layout
        )
        made.write_direct_chunk((0,) * len(shape), np.zeros(shape).tobytes())
        for name in set(kept) - {"DIMENSION_LIST", "REFERENCE_LIST", "CLASS", "NAME"}:
            h["effort/O"].attrs[name] = kept[name]
    monkeypatch.setenv("HDF5_PLUGIN_PATH", str(here / "plugins"))
    assert main(["check", "--untrusted", "x.h5"]) == 1
    assert "x.h5" in capsys.readouterr().err
    assert not os.path.exists("loaded")
    subprocess.run(
        [sys.executable, "-c", "import h5py; h5py.File('x.h5')['effort/O'][()]"],
        capture_output=True,
        check=False,
    )
    assert os.path.exists("loaded")
