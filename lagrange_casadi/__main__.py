"""``python -m lagrange_casadi``."""

import sys

from .cli import main

sys.exit(main())
