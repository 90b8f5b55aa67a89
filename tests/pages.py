"""``python tests pages FOLDER``: pictures of the pages of four cases, of two designs and of a
sweep, to be looked at.

Each page is there at three sizes of window, light and dark, and on A4 and letter as a PDF.
"""

import importlib.util
import sys
import time
from pathlib import Path

import browser

from lagrange_casadi.cli import main

CASES = ("slider_crank", "connecting_rod", "excavator", "delta")
SIZES = ((1400, 900), (900, 700), (400, 800))
PAPERS = {"a4": (8.27, 11.69), "letter": (8.5, 11.0)}


def told(*words):
    """Have the command line do something."""
    if main([*words]):
        sys.exit(" ".join(words))


def written(folder):
    """The pages, alive where ziglang is there."""
    live = ["--live"] if importlib.util.find_spec("ziglang") else []
    for name in CASES:
        page = folder / f"{name}.html"
        told("report", name, *live, "--out", str(page))
        yield page
    beside = ["--beside", "l=0.3", "--out", str(folder / "beside.html")]
    told("report", "slider_crank", *beside)
    yield folder / "beside.html"
    grid = ["--grid", "l=0.12:0.4:15", "--grid", "r=0.05:0.1:6"]
    told("sweep", "slider_crank", *grid, "--out", str(folder / "sweep.h5"), "--force")
    told("report", str(folder / "sweep.h5"), "--out", str(folder / "sweep.html"))
    yield folder / "sweep.html"


def taken(folder):
    """Open each page in each way, and take its picture; complaints of
    the browser end the program.
    """
    with browser.Browser() as one:
        for page in written(folder):
            for scheme in ("light", "dark"):
                one.prefer(prefers_reduced_motion="reduce", prefers_color_scheme=scheme)
                for width, height in SIZES:
                    one.size(width, height)
                    one.open(page)
                    time.sleep(1.0)
                    one.picture(page.with_suffix(f".{width}.{scheme}.png"), whole=True)
            for paper, size in PAPERS.items():
                one.printed(page.with_suffix(f".{paper}.pdf"), *size)
            if one.complaints:
                sys.exit(f"{page}: {one.complaints}")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    if browser.found() is None:
        sys.exit("no pictures: there is no Chromium here")
    Path(sys.argv[1]).mkdir(parents=True, exist_ok=True)
    taken(Path(sys.argv[1]).resolve())
