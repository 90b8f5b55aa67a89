"""A page on this machine that follows a case as its file is saved."""

from .following import follow
from .news import News
from .page import page
from .server import Server

__all__ = ["News", "Server", "follow", "page"]
