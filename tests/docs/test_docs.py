"""The documentation's links, notebooks and tables are as the code has them."""

import inspect
import re
import subprocess
import sys
from pathlib import Path

import nbformat
import pytest
from internals import Status

import lagrange_casadi
from lagrange_casadi import errors, export, load_case

pytestmark = pytest.mark.quick

ROOT = Path(__file__).parents[2]
sys.path.append(str(ROOT / "docs"))

import notebooks  # noqa: E402 - it lies beside the pages

WRITTEN = sorted(page for page in (ROOT / "docs").rglob("*.md") if "generated" not in page.parts)
PROSE = ["README.md", "CONTRIBUTING.md", *(page.relative_to(ROOT).as_posix() for page in WRITTEN)]


@pytest.mark.parametrize("name", notebooks.PAGES)
def test_a_notebook_has_the_code_and_the_pictures_of_its_page(name, tmp_path):
    page = ROOT / "docs" / f"{name}.md"
    text = page.read_text()
    notebooks.write(tmp_path / "made.ipynb", text, page.parent)
    made = nbformat.read(tmp_path / "made.ipynb", as_version=4)
    nbformat.validate(made)
    code = [cell.source for cell in made.cells if cell.cell_type == "code"]
    assert [f"{source}\n" for source in code] == re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    assert sum(len(cell.get("attachments", ())) for cell in made.cells) == text.count("![") > 0


@pytest.mark.parametrize("page", ["README.md", "docs/export.md"])
def test_the_exported_c_is_called_as_shown(page, tmp_path):
    (block,) = re.findall(r"```c\n(.*?)```", (ROOT / page).read_text(), re.DOTALL)
    export(load_case(ROOT / "cases" / "slider_crank").scene, tmp_path)
    body = block.replace("slider_crank_prepare(", "slider_crank_status s = slider_crank_prepare(")
    checked = re.sub(
        r"^slider_crank_(evaluate|section)\(",
        r"s = s ? s : slider_crank_\1(",
        body,
        flags=re.MULTILINE,
    )
    program = (
        f'#include "slider_crank.h"\nint main(void) {{\n{checked}\nreturn s || forces.bending =='
        " 0;\n}\n"
    )
    (tmp_path / "shown.c").write_text(program)
    command = [
        "cc",
        "-std=c99",
        tmp_path / "shown.c",
        tmp_path / "slider_crank.c",
        "-o",
        tmp_path / "shown",
        "-lm",
    ]
    subprocess.run(command, check=True)
    subprocess.run([tmp_path / "shown"], check=True)


ELSEWHERE = {
    *("Array", "Condition", "Expression", "Figure", "None", "Numeric", "NumericDensity", "Self"),
    *("ParameterConstraints", "RestLaw", "Term", "Thing", "Timetable", "Timing", "Wanted"),
    "__version__",
}
"""Names that others define, and classes that are the package's own."""


def test_the_reference_has_every_public_name():
    """And the classes that public functions return. The names of public modules are listed by the
    build.
    """
    page = (ROOT / "docs" / "reference" / "python.md").read_text()
    listed = re.findall(r"^   (?:\w+\.)*(\w+)$", page, re.MULTILINE)
    api = (ROOT / "tests" / "structure" / "golden" / "api.txt").read_text()
    listed += re.findall(r"^lagrange_casadi\.\w+\.(\w+)", api, re.MULTILINE)
    returned = re.findall(r"^ *[\w.]+\(.*\) -> ([A-Z]\w+)$", api, re.MULTILINE)
    named = {
        name
        for name in lagrange_casadi.__all__
        if not inspect.ismodule(getattr(lagrange_casadi, name))
    }
    assert {*named, *returned} - set(listed) == ELSEWHERE


def rows_of(page):
    """Cells of the rows of a page's tables, code without its marks."""
    lines = (ROOT / page).read_text().splitlines()
    return [
        [cell.strip(" `") for cell in line.strip("|").split("|")]
        for line in lines
        if line.startswith("|")
    ]


def test_every_error_and_every_status_has_a_cure(tmp_path):
    cells = {row[0]: row[1:] for row in rows_of("docs/reference/errors.md")}
    for name, error in vars(errors).items():
        if (
            inspect.isclass(error)
            and issubclass(error, errors.LagrangeCasadiError)
            and error is not errors.LagrangeCasadiError
        ):
            assert cells[name][0] == str(error.exit_status)
            assert all(cells[name])
    export(load_case(ROOT / "cases" / "slider_crank").scene, tmp_path)
    header = (tmp_path / "slider_crank.h").read_text().partition("_status;")[0]
    answers = re.findall(r"SLIDER_CRANK_([A-Z_]+) = (\d+) /\* (.*) \*/", header)
    sentences = {name: said for name, _, said in answers}
    for status in Status:
        number, meaning, cure, exported = cells[status.name]
        assert number == str(status.value)
        assert meaning
        assert cure or status == Status.OK
        assert status.meaning in sentences.get(exported, status.meaning)
        assert exported in sentences or (exported, status.meaning in sentences.values()) == ("-", 0)
    told = {cells[status.name][3] for status in Status}
    for name, number, _ in answers:
        if name not in told:
            assert cells[name][0] == number
            assert all(cells[name])


def test_every_case_has_a_picture():
    cases = {page.parent.name for page in (ROOT / "cases").glob("*/case.py")}
    assert {picture.stem for picture in (ROOT / "docs" / "gallery").glob("*.svg")} == cases


@pytest.mark.parametrize("page", PROSE)
def test_pages_keep_to_their_width(page):
    """Prose to 120 columns, Python to 88; a row of a table cannot break, and keeps to 160."""
    text = (ROOT / page).read_text()
    for number, line in enumerate(text.splitlines(), 1):
        assert len(line) <= (160 if line.startswith("|") else 120), (
            f"{page}:{number}: {len(line)} columns"
        )
    for block in re.findall(r"^```python\n(.*?)```", text, re.DOTALL | re.MULTILINE):
        assert max(map(len, block.splitlines())) <= (88 if page.startswith("docs") else 100)


def anchor(heading):
    """What a heading is called in a link, as GitHub has it."""
    return re.sub(r"[^a-z0-9 _-]", "", heading.lower()).replace(" ", "-")


def headings(page):
    """The headings of a page; what begins with # in its code is none."""
    prose = re.sub(r"^```.*?^```$", "", (ROOT / page).read_text(), flags=re.DOTALL | re.MULTILINE)
    return re.findall(r"^#+ (.*)", prose, re.MULTILINE)


@pytest.mark.parametrize("page", [*PROSE, "cases/slider_crank/README.md"])
def test_links_lead_to_files_and_headings(page):
    for target, name in re.findall(r"\]\(([^)#:]*)#?([^)]*)\)", (ROOT / page).read_text()):
        if ":" not in name:
            other = ((ROOT / page).parent / target) if target else ROOT / page
            assert other.exists(), f"{page}: {target}"
            assert not name or name in map(anchor, headings(other)), f"{page}: {target}#{name}"
