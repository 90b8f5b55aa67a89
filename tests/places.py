"""Folders of the tests whose modules import each other by their names alone."""

from pathlib import Path

TESTS = Path(__file__).parent
FOLDERS = [str(TESTS), *sorted(str(path) for path in TESTS.iterdir() if path.is_dir())]
