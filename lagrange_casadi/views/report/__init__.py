"""A report that opens in a browser: the mechanism moving, its forces on it, charts and tables, in
one file.
"""

from .comparison import write_comparison
from .live import Live
from .notebook import scene_summary, summary, view
from .page import (
    ENDINGS,
    assembled,
    page,
    scene_report,
    with_motion,
    write_page,
    write_report,
)

__all__ = [
    "ENDINGS",
    "Live",
    "assembled",
    "page",
    "scene_report",
    "scene_summary",
    "summary",
    "view",
    "with_motion",
    "write_comparison",
    "write_page",
    "write_report",
]
