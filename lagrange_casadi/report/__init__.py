"""A report that opens in a browser: the mechanism moving, its forces on it, charts and tables, in one file."""

from .page import ENDINGS, page, write_report

__all__ = ["ENDINGS", "page", "write_report"]
