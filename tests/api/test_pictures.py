"""Pictures as files: the same figure gives the same bytes, whatever draws it and whenever."""

import io
import warnings
from pathlib import Path

import pytest
from internals import PICTURES
from internals import pictures_save as save
from matplotlib.figure import Figure

import lagrange_casadi

pytestmark = pytest.mark.quick


def saved(ending):
    figure = Figure()
    axes = figure.subplots()
    axes.plot([0, 1], [2, 3], "o-", label="a line")
    axes.fill_between([0, 1], [2, 3], hatch="/")
    file = io.BytesIO()
    save(figure, file, ending)
    return file.getvalue()


@pytest.mark.parametrize("ending", PICTURES)
def test_neither_clocks_nor_programs_nor_chance(ending):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        content = saved(ending)
    assert content == saved(ending)
    assert not any(word in content for word in (b"Date", b"<dc:date>", b"Matplotlib", b"Software"))


def test_every_picture_is_saved_there():
    package = Path(lagrange_casadi.__file__).parent
    found = [
        path.relative_to(package).as_posix()
        for path in package.rglob("*.py")
        if ".savefig(" in path.read_text()
    ]
    assert found == ["shapes/pictures.py"]
