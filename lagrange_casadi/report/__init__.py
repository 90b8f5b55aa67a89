"""A report that opens in a browser: the mechanism moving, its forces on it, charts and tables, in one file."""

from .notebook import View, scene_summary, summary, view
from .page import ENDINGS, page, write_report

__all__ = ["ENDINGS", "View", "page", "scene_summary", "summary", "view", "write_report"]
