"""Live pages: the engine's package, and pages whose inner parts a test can reach."""

import importlib.util
import os
import re
import time
from pathlib import Path

import browser
import pytest

THERE = importlib.util.find_spec("ziglang") is not None

NEEDS_BROWSER = pytest.mark.skipif(browser.found() is None, reason="there is no Chromium here")
NEEDS_ENGINE = pytest.mark.skipif(not THERE, reason="ziglang is not installed")

# A session's own cache would have ziglang build its C library anew, in half a minute; it is no part
# of what is tested.
os.environ.setdefault("ZIG_GLOBAL_CACHE_DIR", str(Path.home() / ".cache" / "zig"))


@pytest.fixture(scope="module")
def chromium():
    """A browser whose user wants neither motion nor darkness."""
    with browser.Browser() as one:
        one.prefer(prefers_reduced_motion="reduce", prefers_color_scheme="light")
        yield one


def opened(one, path, text):
    """Open a page with its inner parts in ``window.page``, and wait until its engine runs.

    A script that is changed is no longer the one whose digest the page tells, so the page must not
    tell any.
    """
    text = re.sub(r"<meta http-equiv=[^>]*>", "", text)
    parts = "live, contents, array, sections, sectionForce, player, deck, C"
    assert text.count("buildPage();\n})();") == 1
    path.write_text(
        text.replace("buildPage();\n})();", f"buildPage();\nwindow.page = {{ {parts} }};\n}})();")
    )
    one.open(path)
    wait(one, "window.page.live.engine !== null")


def wait(one, condition, seconds=20.0):
    """Wait until something is so in a page."""
    end = time.monotonic() + seconds
    while not one.run(condition):
        assert time.monotonic() < end, (condition, one.complaints)
        time.sleep(0.02)
