"""Notebooks made from pages of the documentation: no text is written twice."""

import base64
import mimetypes
import re

import nbformat
from nbformat import v4

CELL = re.compile(r"```python\n(?P<code>.*?)```\n(\n(?P<shown>( {4}[^\n]*\n|\n(?= {4}))+))?", re.DOTALL)
"""A block of code, and the indented block after it, which is what the code prints."""


def cells(page):
    """Split a page into triples: text, the code after it, and the printed lines that the page shows."""
    found, done = [], 0
    for match in CELL.finditer(page):
        found.append((page[done : match.start()], match["code"], match["shown"]))
        done = match.end()
    return [*found, (page[done:], None, None)]


def write(path, page, folder):
    """Write the notebook of a page whose pictures are in a folder."""
    made = []
    for text, code, shown in cells(page):
        made.append(prose(text, folder))
        if code is not None:
            printed = [v4.new_output("stream", text=re.sub(r"^ {4}", "", shown, flags=re.MULTILINE))] if shown else []
            made.append(v4.new_code_cell(code.rstrip("\n"), outputs=printed))
    for number, cell in enumerate(made):
        cell["id"] = f"cell-{number}"  # the same bytes in every build
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    nbformat.write(v4.new_notebook(cells=made, metadata={"kernelspec": kernel}), path)


def prose(text, folder):
    """Make a cell of text: pictures are part of it, links to other pages are plain text."""
    pictures = {
        name: {mimetypes.guess_type(name)[0]: base64.b64encode((folder / name).read_bytes()).decode()}
        for name in re.findall(r"!\[[^]]*\]\(([^):]+)\)", text)
    }
    text = re.sub(r"(!\[[^]]*\]\()([^):]+\))", r"\1attachment:\2", text)
    text = re.sub(r"(?<!!)\[([^]]*)\]\((?!https?:)[^)]*\)", r"\1", text)
    return v4.new_markdown_cell(text.strip("\n"), **({"attachments": pictures} if pictures else {}))
