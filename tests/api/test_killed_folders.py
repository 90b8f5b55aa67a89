"""A kill, or a full disk, at each moment at which a folder changes: the next run of the same
command goes on.
"""

import os
import random
import shutil

import pytest
from internals import FOLDER_MANIFEST as EXPORT
from internals import INDEX_MANIFEST as FIGURES
from kills import full, killed, meet

from lagrange_casadi.errors import StoreError

pytestmark = [
    pytest.mark.usefixtures("interpreted"),
    pytest.mark.skipif(not hasattr(os, "fork"), reason="each kill is of a fork"),
]


def contents(folder):
    """All files by name, drafts and those of folders too."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file()
    }


def drawn(chance):
    """Files of a few names."""
    names = chance.sample(["a.png", "b.png", "index.html", "u.png", "z.c"], chance.randint(1, 5))
    return {name: chance.choice(["one", "two", "three"]) for name in names}


def fill(manifest, folder, files):
    with manifest.filling(folder, {"more": len(files)}, alone=manifest is EXPORT) as draft:
        for name, text in files.items():
            (draft / name).write_text(text)


def begin(before, folder):
    """A folder as it was before, if there was one."""
    if before.exists():
        shutil.copytree(before, folder)


def refused(number, action):
    """Fill the disk at a change by its number; whether it got there.

    What is raised is one line of ours.
    """
    with pytest.MonkeyPatch.context() as patch:
        meet(patch, number, full)
        try:
            action()
        except StoreError as error:
            return str(error).endswith(": No space left on device")
    return False


@pytest.mark.parametrize(
    "seed", [*range(3), *(pytest.param(seed, marks=pytest.mark.long) for seed in range(3, 20))]
)
@pytest.mark.parametrize("manifest", [FIGURES, EXPORT], ids=["figures", "export"])
@pytest.mark.parametrize("ends", ["kill", "full disk"])
def test_a_folder_that_is_half_filled_is_filled_by_the_next(tmp_path, manifest, ends, seed):
    chance = random.Random(seed)
    earlier, hidden = [drawn(chance) for _ in range(seed % 3)], chance.random() < 0.3
    files, number, met = drawn(chance), 0, True
    before, whole = tmp_path / "before", tmp_path / "whole"
    if hidden:
        before.mkdir()
        (before / ".gitignore").write_text("*")
    for one in earlier:
        fill(manifest, before, one)
    begin(before, whole)
    fill(manifest, whole, files)
    expected = contents(whole)
    while met:
        place = tmp_path / f"{number}"
        place.mkdir()
        broken = place / "broken"
        begin(before, broken)
        if ends == "kill":
            met = killed(number, lambda broken=broken: fill(manifest, broken, files))
        else:
            met = refused(number, lambda broken=broken: fill(manifest, broken, files))
        fill(manifest, broken, files)
        assert contents(broken) == expected
        assert os.listdir(place) == ["broken"]
        number += 1
    assert number > 2
