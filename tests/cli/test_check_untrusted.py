"""Files of unknown origin are read in a process of their own: whatever that one does, a line and a
status come of it.
"""

import importlib
import json
import os
import shutil
import subprocess
import sys

import h5py
import numpy as np
import pytest
from forging import forging

from lagrange_casadi import evaluate, save
from lagrange_casadi.cli import main

check = importlib.import_module("lagrange_casadi.cli.check")


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
            'print(\'{"findings": [3], "refused": "", "status": 1}\')',
            "the process that reads it gave no answer (status 0)",
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
    monkeypatch.setattr(check, "_PROGRAM", program)
    seconds = "0.5" if "sleep" in program else "30"
    assert main(["check", "--untrusted", "--time-limit", seconds, "x.h5"]) == 1
    assert capsys.readouterr() == ("", f"error: x.h5: {told}\n")


READS = {
    "np.ones(10**16)": {
        "findings": [],
        "refused": "x: takes more memory to read than half of what is free",
        "status": 1,
    },
    "bytearray(FREE)": {
        "findings": [],
        "refused": "x: takes more memory to read than half of what is free",
        "status": 1,
    },
    "[] + 1": {
        "findings": [],
        "refused": 'x: cannot be read: TypeError: can only concatenate list (not "int") to list',
        "status": 1,
    },
    "(os.write(1, b'noise'), ['x' * 10**6])[1]": {
        "findings": ["x" * 1000],
        "refused": "",
        "status": 1,
    },
    "['y'] * 1000": {"findings": ["y"] * 100 + ["and 900 more"], "refused": "", "status": 1},
    "[str(resource.getrlimit(resource.RLIMIT_CORE)[0])]": {
        "findings": ["0"],
        "refused": "",
        "status": 1,
    },
}


def test_the_reader_answers_in_few_words_and_within_limits():
    program = f"""
import importlib, os, resource, sys, numpy as np
import lagrange_casadi.cli
from lagrange_casadi.base.space import memory
module, FREE = importlib.import_module("lagrange_casadi.cli.check"), int(0.9 * memory())
for read in {list(READS)}:
    if os.fork() == 0:
        module._findings = lambda _: eval(read)
        module.answer("x")
        os._exit(0)
    os.wait()
    print(flush=True)
"""
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True, timeout=120
    )
    assert [json.loads(line) for line in done.stdout.splitlines()] == list(READS.values())


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
