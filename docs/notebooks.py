"""Notebooks made from pages of the documentation: no text is written twice."""

import base64
import mimetypes
import re

import nbformat
from nbformat import v4

PAGES = ("tutorials/connecting_rod", "tutorials/air_damper", "tutorials/jigsaw")
"""The pages that can be downloaded as notebooks."""

CELL = re.compile(r"```python\n(.*?)```\n(?:\n```text\n(.*?)```\n)?", re.DOTALL)
"""A block of code, and the block of text right after it: the lines that the code prints."""


def cells(page):
    """Split a page into triples: text, the code after it, and the lines that the code prints."""
    found, done = [], 0
    for match in CELL.finditer(page):
        found.append((page[done : match.start()], *match.groups()))
        done = match.end()
    return [*found, (page[done:], None, None)]


def write(path, page, folder):
    """Write the notebook of a page whose pictures are in a folder."""
    made = []
    for text, code, shown in cells(page):
        made.append(prose(text, folder))
        if code is not None:
            printed = [v4.new_output("stream", text=shown)] if shown else []
            made.append(v4.new_code_cell(code.rstrip("\n"), outputs=printed))
    for number, cell in enumerate(made):
        cell["id"] = f"cell-{number}"  # the same bytes in every build
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    nbformat.write(v4.new_notebook(cells=made, metadata={"kernelspec": kernel}), path)


def prose(text, folder):
    """Make a cell of text: pictures are part of it, links to other pages are plain text."""
    pictures = {}
    for name in re.findall(r"!\[[^]]*\]\(([^):]+)\)", text):
        picture = base64.b64encode((folder / name).read_bytes()).decode()
        pictures[name] = {mimetypes.guess_type(name)[0]: picture}
    text = re.sub(r"(!\[[^]]*\]\()([^):]+\))", r"\1attachment:\2", text)
    text = re.sub(r"(?<!!)\[([^]]*)\]\((?!https?:)[^)]*\)", r"\1", text)
    return v4.new_markdown_cell(
        text.strip("\n"), **({"attachments": pictures} if pictures else {})
    )
