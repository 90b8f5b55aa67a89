"""Hostile models of MuJoCo: each command ends soon, in one line, reads nothing outside of the
model's folder, and leaves nothing.
"""

import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import pytest
from commands import words
from internals import MODEL_LIMITS

from lagrange_casadi import errors, read

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


class Hostile:
    """A folder with a model that its author wants to do harm with."""

    def __init__(self, seed, folder):
        self.chance, self.folder = random.Random(seed), folder / "model"
        (self.folder / "sub").mkdir(parents=True)
        (folder / "secret.xml").write_text(f"<mujoco><worldbody>{SECRET}</worldbody></mujoco>")
        (self.folder / "to_secret.xml").symlink_to(folder / "secret.xml")
        (self.folder / "to_all").symlink_to(folder)
        (self.folder / "loop").symlink_to("loop")
        os.mkfifo(self.folder / "fifo.xml")
        places = ["../secret.xml", str(folder / "secret.xml"), "to_secret.xml", "fifo.xml", "loop"]
        places += ["to_all/secret.xml", "sub/part.xml", "part.xml", "model.xml", "/dev/zero"]
        self.places = [
            *places,
            "sub/../../secret.xml",
            "/proc/self/environ",
            "a" * 5000,
            "sub",
            ".",
        ]
        for name in ("sub/part.xml", "part.xml", "model.xml"):
            (self.folder / name).write_text(self.model(4))
        self.file = self.folder / "model.xml"

    def model(self, deep):
        parts = [self.part(deep) for _ in range(self.chance.randrange(1, 4))]
        more = f"<worldbody>{BODY.format('arm', '')}</worldbody>"
        return f"<mujoco>{''.join(parts)}{more}</mujoco>"

    def part(self, deep):
        where = self.chance.choice(self.places)
        number = self.chance.choice(NUMBERS)
        mesh = f'<mesh file="{self.chance.choice(self.places)}"/>'
        body = f'<inertial pos="0 0 0" mass="{number}" diaginertia="{number} 1 1"/>'
        parts = [
            f'<include file="{where}"/>',
            f'<asset><model name="q" file="{where}"/></asset><worldbody>{ATTACH}</worldbody>',
            f'<compiler meshdir="{where}"/><asset>{mesh}</asset>',
            f'<asset><hfield name="h" file="{where}" size="1 1 1 1"/></asset>',
            f'<asset><texture name="t" type="2d" file="{where}"/></asset>',
            self.chance.choice(HUGE),
            f'<worldbody><body><joint axis="{number} 0 1"/>{body}</body></worldbody>',
            f'<option gravity="0 0 {number}"/>',
            "<worldbody>" + "<body>" * 150 + "</body>" * 150 + "</worldbody>",
            "<worldbody>" + "<frame>" * 9000 + "</frame>" * 9000 + "</worldbody>",
            f'<default><geom size="{number}"/></default>',
            f"<!DOCTYPE x [<!ENTITY a SYSTEM '{where}'>]>",
        ]
        return self.chance.choice(parts)


@pytest.mark.sampled(20)
@pytest.mark.parametrize("seed", range(300))
def test_hostile_models_end_in_one_line(seed, tmp_path, monkeypatch):
    hostile = Hostile(seed, tmp_path)
    empty = tmp_path / "temporary"
    empty.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(empty))
    began = sum(os.times()[:4])
    try:
        told = " ".join(read(hostile.file).mechanism.bodies)
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
    **{
        f"huge {k}": ({"a.xml": f"<mujoco>{part}</mujoco>"}, "a.xml: ")
        for k, part in enumerate(HUGE)
    },
}  # fmt: skip


@pytest.mark.parametrize("what", ONES)
def test_what_is_refused(what, tmp_path, monkeypatch):
    files, words = ONES[what]
    monkeypatch.setitem(MODEL_LIMITS, "busy", 4.0)
    hostile = Hostile(0, tmp_path)
    (tmp_path / "m.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n")
    for name, text in files.items():
        (hostile.folder / name).write_text(text.replace("{}", str(tmp_path)))
    with pytest.raises(errors.ModelFileError) as error:
        read(hostile.folder / "a.xml")
    assert words in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="no list of processes")
def test_an_interrupt_ends_it_at_once(tmp_path):
    (tmp_path / "a.xml").write_text(f"<mujoco>{HUGE[0]}</mujoco>")
    (tmp_path / "temporary").mkdir()
    command = [sys.executable, *words("-m lagrange_casadi new x --from a.xml")]
    told = {**os.environ, "TMPDIR": str(tmp_path / "temporary")}
    with subprocess.Popen(
        command, cwd=tmp_path, env=told, stderr=subprocess.PIPE, text=True
    ) as process:
        tasks = Path(f"/proc/{process.pid}/task/{process.pid}/children")
        while not (children := tasks.read_text().split()):
            time.sleep(0.05)
        time.sleep(1.0)
        process.send_signal(signal.SIGINT)
        _, told = process.communicate(timeout=30)
    assert process.returncode == 130
    assert told.count("\n") == 1
    assert not any(Path(f"/proc/{child}").exists() for child in children)
    assert not list((tmp_path / "temporary").iterdir())
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.xml", "temporary"]
