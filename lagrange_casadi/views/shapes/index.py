"""Pages of figures: one that shows all figures of a folder, and what other such pages share."""

from __future__ import annotations

import html
from collections.abc import Iterable, Sequence
from pathlib import Path

from ...base.folders import Manifest

NAME = "index.html"
MANIFEST = Manifest(
    "figures.json",
    "lagrange-casadi figures",
    "draw into",
    "an earlier drawing",
    "move what you want to keep, or choose another folder",
)

_STYLE = """
:root { color-scheme: light dark; }
body { margin: 0 auto; max-width: 1700px; padding: 16px clamp(12px, 2vw, 32px);
  font: 15px/1.45 system-ui, sans-serif; }
h1 { font-size: 24px; margin: 0 0 4px; overflow-wrap: anywhere; }
nav { columns: 16em; margin: 10px 0 18px; font-size: 13.5px; }
nav a { display: block; overflow-wrap: anywhere; }
main { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 480px), 1fr));
  gap: 16px; align-items: start; }
figure { margin: 0; background: #fff; color: #222; border: 1px solid #8886; border-radius: 10px;
  padding: 8px; }
figure:target { outline: 3px solid #3b82f6; }
figure img { display: block; width: 100%; height: auto; }
figcaption { font-size: 13px; overflow-wrap: anywhere; }
@media print {
  nav { display: none; }
  main { grid-template-columns: 1fr 1fr; gap: 8px; }
  figure { break-inside: avoid; }
}
"""


def write_index(title: str, pictures: Sequence[Path], folder: Path) -> None:
    """Write ``index.html`` beside these pictures, in their order: a list of them, and
    all of them.
    """
    escaped = [(html.escape(path.stem), html.escape(path.name)) for path in pictures]
    links = "".join(f'<a href="#{name}">{name.replace("_", " ")}</a>\n' for name, _ in escaped)
    figures = "".join(
        f'<figure id="{name}"><a href="{file}"><img src="{file}" alt="{name.replace("_", " ")}"'
        f' loading="lazy"></a><figcaption>{file}</figcaption></figure>\n'
        for name, file in escaped
    )
    text = document(f"{title}: figures", title, f"<nav>\n{links}</nav>\n<main>\n{figures}</main>\n")
    (folder / NAME).write_text(text, encoding="utf-8")


def document(title: str, head: str, body: str, style: str = "") -> str:
    """Return a page with a ``title``, a first line, and a ``body``, which is HTML."""
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{html.escape(title)}</title>\n<style>{_STYLE}{style}</style>\n</head>\n<body>\n"
        f"<h1>{html.escape(head)}</h1>\n{body}</body>\n</html>\n"
    )


def html_table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table as HTML."""
    head = "".join(f"<th>{word}</th>" for word in heads)
    cells = ("".join(f"<td>{html.escape(cell)}</td>" for cell in row) for row in rows)
    body = "".join(f"<tr>{row}</tr>" for row in cells)
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
