"""Files of unknown origin, results and models, are read in a process of their own: each command
ends soon, in one line, reads nothing outside of a model's folder, and leaves nothing.
"""

import os
import random
import shutil
import subprocess
import sys
import tempfile

import h5py
import numpy as np
import pytest
from commands import command
from forging import forging

from lagrange_casadi import errors, read
from lagrange_casadi.cli import main

pytest.importorskip("mujoco", reason="MuJoCo is not installed")

BODY = '<body name="{}"><joint axis="0 1 0"/><geom size="0.1"/>{}</body>'
SECRET = BODY.format("part", BODY.format("SECRET", ""))
ATTACH = '<frame><attach model="q" body="part" prefix="p"/></frame>'
HUGE = (
    '<worldbody><replicate count="1000000000"><geom size="1"/></replicate></worldbody>',
    '<size nkey="1000000000"/>',
    '<size nuserdata="2000000000" memory="1000G"/>',
    '<asset><hfield name="h" nrow="100000" ncol="100000" size="1 1 1 1"/></asset>',
    '<asset><texture name="t" type="2d" builtin="flat" width="60000" height="60000"/></asset>',
    '<worldbody><composite type="grid" count="30000 30000 1" spacing="1"/></worldbody>',
    '<worldbody><flexcomp name="f" type="grid" count="900 900 900" radius="0.1"/></worldbody>',
)
NUMBERS = ("inf", "nan", "-1", "1e308", "1e-320", "1" * 400, "x", "")


def part(chance, places):
    """A part of a model that does harm."""
    where, number = chance.choice(places), chance.choice(NUMBERS)
    mesh = f'<mesh file="{chance.choice(places)}"/>'
    body = f'<inertial pos="0 0 0" mass="{number}" diaginertia="{number} 1 1"/>'
    parts = [
        f'<include file="{where}"/>',
        f'<asset><model name="q" file="{where}"/></asset><worldbody>{ATTACH}</worldbody>',
        f'<compiler meshdir="{where}"/><asset>{mesh}</asset>',
        f'<asset><hfield name="h" file="{where}" size="1 1 1 1"/></asset>',
        f'<asset><texture name="t" type="2d" file="{where}"/></asset>',
        chance.choice(HUGE),
        f'<worldbody><body><joint axis="{number} 0 1"/>{body}</body></worldbody>',
        f'<option gravity="0 0 {number}"/>',
        "<worldbody>" + "<body>" * 150 + "</body>" * 150 + "</worldbody>",
        "<worldbody>" + "<frame>" * 9000 + "</frame>" * 9000 + "</worldbody>",
        f'<default><geom size="{number}"/></default>',
        f"<!DOCTYPE x [<!ENTITY a SYSTEM '{where}'>]>",
    ]
    return chance.choice(parts)


def hostile(seed, folder):
    """Write models that do harm; return the folder that they may read."""
    chance, model = random.Random(seed), folder / "model"
    (model / "sub").mkdir(parents=True)
    (folder / "secret.xml").write_text(f"<mujoco><worldbody>{SECRET}</worldbody></mujoco>")
    links = {"to_secret.xml": folder / "secret.xml", "to_all": folder, "loop": "loop"}
    for name, to in links.items():
        (model / name).symlink_to(to)
    os.mkfifo(model / "fifo.xml")
    places = ["../secret.xml", str(folder / "secret.xml"), "to_secret.xml", "fifo.xml", "loop"]
    places += ["to_all/secret.xml", "sub/part.xml", "part.xml", "model.xml", "/dev/zero"]
    places += ["sub/../../secret.xml", "/proc/self/environ", "a" * 5000, "sub", "."]
    for name in ("sub/part.xml", "part.xml", "model.xml"):
        parts = [part(chance, places) for _ in range(chance.randrange(1, 4))]
        more = f"<worldbody>{BODY.format('arm', '')}</worldbody>"
        (model / name).write_text(f"<mujoco>{''.join(parts)}{more}</mujoco>")
    return model


@pytest.mark.sampled(20)
@pytest.mark.parametrize("seed", range(300))
def test_hostile_models_end_in_one_line(seed, tmp_path, monkeypatch):
    file = hostile(seed, tmp_path) / "model.xml"
    empty = tmp_path / "temporary"
    empty.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(empty))
    began = sum(os.times()[:4])
    try:
        told = " ".join(read(file).mechanism.bodies)
    except errors.LagrangeCasadiError as error:
        told = str(error)
    assert "\n" not in told
    assert "SECRET" not in told
    assert sum(os.times()[:4]) - began < 20
    assert not list(empty.iterdir())


ONES = {
    "an include of an include": (
        {"a.xml": '<mujoco><include file="sub/n.xml"/></mujoco>',
         "sub/n.xml": '<mujocoinclude><include file="../secret.xml"/></mujocoinclude>'},
        "file '../secret.xml' leads out of its folder",
    ),
    "a model": (
        {"a.xml": '<mujoco><asset><model name="q" file="inner.xml"/></asset></mujoco>',
         "inner.xml": "<mujoco><include file='{}/secret.xml'/></mujoco>"},
        "leads out of its folder",
    ),
    "a link": (
        {"a.xml": '<mujoco><compiler meshdir="to_all"/><asset><mesh file="m.obj"/></asset>'
                  "</mujoco>"},
        "file 'm.obj' leads out of its folder",
    ),
    "itself": (
        {"a.xml": '<mujoco><asset><model name="q" file="a.xml"/></asset></mujoco>'},
        "a.xml: reading it crashed",
    ),
    "an encoding": (
        {"a.xml": '<mujoco><include file="b.xml"/></mujoco>',
         "b.xml": '<?xml version="1.0" encoding="rot13"?><mujocoinclude/>'},
        "b.xml",
    ),
    "a pipe": ({"a.xml": '<mujoco><include file="fifo.xml"/></mujoco>'}, "fifo.xml"),
}  # fmt: skip


@pytest.mark.parametrize("what", ONES)
def test_what_is_refused(what, tmp_path):
    files, says = ONES[what]
    folder = hostile(0, tmp_path)
    (tmp_path / "m.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n")
    for name, text in files.items():
        (folder / name).write_text(text.replace("{}", str(tmp_path)))
    with pytest.raises(errors.ModelFileError) as error:
        read(folder / "a.xml")
    assert says in str(error.value)
    assert "\n" not in str(error.value)


@pytest.fixture
def file(here, capfd, interpreted):
    assert command("run CASE --t 0:0.08:5 --xi 0:1:3 --want effort --out x.h5 --no-figures") == 0
    capfd.readouterr()
    return here / "x.h5"


def test_it_finds_what_check_finds_and_imports_nothing_from_here(file, here, capfd):
    for name in ("h5py", "json", "numpy", "lagrange_casadi"):
        (here / f"{name}.py").write_text("open('planted', 'w')")
    with forging(file) as h:
        h["effort/O"].attrs["units"] = "N\x1b[2J"
    assert main(["check", "x.h5"]) == 1
    usual = capfd.readouterr()
    assert main(["check", "--untrusted", "x.h5"]) == 1
    assert capfd.readouterr() == usual
    assert r"N\x1b[2J" in usual.err
    assert not (here / "planted").exists()


def test_a_file_that_is_read_too_long_is_a_line(file, capfd):
    assert main(["check", "--untrusted", "--time-limit", "1e-3", "x.h5"]) == 1
    says = "was not read within 0.001 s, so it is large or forged; --time-limit sets another limit"
    assert capfd.readouterr() == ("", f"error: x.h5: {says}\n")
    assert main(["check", "x.h5", "--time-limit", "3"]) == 2
    assert main(["check", "--untrusted", "y.h5"]) == 2
    told = capfd.readouterr().err
    assert told.startswith("error: --time-limit")
    assert told.endswith("error: y.h5: no such file\n")


@pytest.mark.skipif(not shutil.which("cc"), reason="no compiler")
def test_a_file_makes_hdf5_load_no_filters(file, here, capfd, monkeypatch):
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
    assert "x.h5" in capfd.readouterr().err
    assert not os.path.exists("loaded")
    subprocess.run(
        [sys.executable, "-c", "import h5py; h5py.File('x.h5')['effort/O'][()]"],
        capture_output=True,
        check=False,
    )
    assert os.path.exists("loaded")
