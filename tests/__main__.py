"""``python tests PROGRAM ...`` runs a program that belongs to the tests: ``pages``, ``estimates``,
``extremes``, ``cortex_m4f``, and those that tests start.
"""

import runpy
import sys

from places import FOLDERS

if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    sys.path += FOLDERS[1:]
    del sys.argv[0]
    runpy.run_module(sys.argv[0], run_name="__main__", alter_sys=True)
