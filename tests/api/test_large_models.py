"""The time that a model file takes grows as the file does: 3000 links take seconds."""

import time

import pytest
from internals import case_of
from model_files import (
    DAMPED,
    SPRUNG,
    joint,
    link,
    mjcf,
    mjcf_body,
    own,
    own_body,
    own_joint,
    sdf,
    sdf_joint,
    sdf_link,
    urdf,
)


def chain(count):
    """The numbers of an arm's links, each link's parent or none, and the axis of its joint."""
    return [(k, f"l{k - 1}" if k else "", f"0 {k % 2} 1") for k in range(count)]


def branches(count):
    """Arms of MuJoCo of 100 links each."""
    for first in range(0, count, 100):
        text = ""
        for k in reversed(range(first, min(first + 100, count))):
            text = mjcf_body(f"l{k}", text, axis=f"0 {k % 2} 1")
        yield text


LARGE = {
    "urdf": lambda count: urdf(
        '<link name="base"/>',
        *(
            link(f"l{k}", 1 + k % 7)
            + joint(f"j{k}", above or "base", f"l{k}", f"0.{k % 7 + 1} 0 0", axis, more=DAMPED)
            for k, above, axis in reversed(chain(count))
        ),
    ),
    "sdf": lambda count: sdf(
        *(
            sdf_link(f"l{k}", f"0.{k} 0 0 0 0 0", f' relative_to="{above}"' if k % 90 else "")
            + sdf_joint(f"j{k}", above or "world", f"l{k}", axis, more=SPRUNG)
            for k, above, axis in chain(count)
        )
    ),
    "json": lambda count: own(
        [own_body(f"l{k}", (0.2 * k, 0, 0)) for k in range(count)],
        [
            own_joint(f"j{k}", above or "ground", f"l{k}", (0.2 * bool(k), 0, 0), (0, k % 2, 1))
            for k, above, _ in chain(count)
        ],
        motions={f"j{k}": "sin(t)" for k in range(0, count, 2)},
    ),
    "xml": lambda count: mjcf(*branches(count)),
}


def seconds(path, text):
    """The processor time that the case of a file takes [s], the least of two."""
    path.write_text(text)
    found = []
    for _ in range(2):
        start = time.process_time()
        case_of(path)
        found.append(time.process_time() - start)
    return min(found)


LONG = pytest.param(600, 3000, marks=pytest.mark.long)


@pytest.mark.parametrize(("few", "many"), [(40, 240), LONG])
@pytest.mark.parametrize("ending", LARGE)
def test_time_grows_as_the_file_does(ending, few, many, tmp_path):
    """But for half of that; a square law would take as much again."""
    if ending == "xml":
        pytest.importorskip("mujoco", reason="MuJoCo is not installed")
    path = tmp_path / f"large.{ending}"
    small, large = (seconds(path, LARGE[ending](count)) for count in (few, many))
    assert large < 1.6 * many / few * small
