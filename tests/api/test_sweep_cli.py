"""Sweeps from the command line: what they write and say, and the examples of their help."""

import re
from pathlib import Path

import numpy as np
from commands import command
from sweeps import ASKED, CASE

from lagrange_casadi import Sweep


def test_sweep_takes_options(here, capfd):
    options = "--grid m3=0.1:10:3:log --set l=0.3 --xi 0:1:3 --keep histories --backend c"
    assert command(f"{ASKED} {options} --workers 1 --quiet --out x.h5") == 0
    found = Sweep.open("x.h5")
    np.testing.assert_allclose(found["m3"], [0.1, 1.0, 10.0], rtol=1e-15)
    assert found["history:section:rod:bending"].shape == (3, 21, 3)
    assert found.identity["backend"] == "c"
    assert found.identity["mechanism"]["parameters"]["l"]["value"] == 0.3
    capfd.readouterr()
    assert command(f"{ASKED} {options} --workers 1 --resume --out x.h5") == 0
    assert capfd.readouterr().out.splitlines()[1:] == [
        "x.h5 was complete already: nothing was done"
    ]


def test_the_examples_of_the_help_run(here, capfd):
    Path("cases").symlink_to(CASE.parent)
    assert command("sweep --help") == 0
    examples = re.findall(r"^ *lagrange-casadi (.*)$", capfd.readouterr().out, re.MULTILINE)
    assert [example.split()[0] for example in examples] == ["sweep", "best"]
    for example in examples:
        assert command(example) == 0


def test_of_all_the_motion_is_left_out_and_alone_it_is_kept(here, capfd):
    """As the help says."""
    for wanted in ("all", "motion"):
        line = f"sweep CASE --t 0:0.08:9 --grid l=0.2 --want {wanted} --out {wanted}.h5"
        assert command(line) == 0
        moving = {
            name.split(":")[1] for name in Sweep.open(f"{wanted}.h5").columns if name != "status"
        } & {"motion", "pose"}
        assert moving == (set() if wanted == "all" else {"motion", "pose"})
