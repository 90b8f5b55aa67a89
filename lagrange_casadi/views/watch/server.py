"""The server of the page: for this machine alone, and for who knows its address."""

from __future__ import annotations

import secrets
import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

from .news import News

_HOST = "127.0.0.1"
_PATIENCE = 10.0
"""Seconds after which a browser that has heard nothing is asked whether it is still there."""


class Server(ThreadingHTTPServer):
    """Serves a page at an ``address`` that holds a secret, and the news that the page follows;
    nothing else, and nothing to pages of other sites.
    """

    daemon_threads = True
    block_on_close = False

    def __init__(self, text: str, policy: str, news: News, port: int = 0) -> None:
        """Serve on a port, of which 0 is any that is free. Raises ``OSError`` where it is taken."""
        super().__init__((_HOST, port), _Request)
        self.text, self.policy, self.news = text.encode(), policy, news
        self.root = f"/{secrets.token_urlsafe(24)}/"
        self.hosts = [f"{name}:{self.server_port}" for name in (_HOST, "localhost")]
        self.address = f"http://{self.hosts[0]}{self.root}"

    def __enter__(self) -> Server:
        threading.Thread(target=self.serve_forever, daemon=True).start()
        return self

    def __exit__(self, *_: object) -> None:
        self.shutdown()
        self.server_close()

    def handle_error(self, *_: object) -> None:
        """A browser that has gone is no error."""


class _Request(BaseHTTPRequestHandler):
    server: Server

    def do_GET(self) -> None:
        """Answer with the page or the news."""
        host, origin = self.headers.get("Host"), self.headers.get("Origin")
        if host not in self.server.hosts or origin not in (None, f"http://{host}"):
            self.send_error(403)
        elif secrets.compare_digest(self.path.encode(), self.server.root.encode()):
            self._begin("text/html; charset=utf-8")
            self.wfile.write(self.server.text)
        elif secrets.compare_digest(self.path.encode(), f"{self.server.root}news".encode()):
            self._begin("text/event-stream")
            self._tell()
        else:
            self.send_error(404)

    def _begin(self, kind: str) -> None:
        self.send_response(200)
        self.send_header("Content-Type", kind)
        self.end_headers()

    def end_headers(self) -> None:
        """End the heads that every answer has."""
        for name, value in (
            ("Content-Security-Policy", self.server.policy),
            ("Cache-Control", "no-store"),
            ("Cross-Origin-Resource-Policy", "same-origin"),
            ("Cross-Origin-Opener-Policy", "same-origin"),
            ("Referrer-Policy", "no-referrer"),
            ("X-Content-Type-Options", "nosniff"),
        ):
            self.send_header(name, value)
        super().end_headers()

    def _tell(self) -> None:
        """Send the news that there are, and each that comes."""
        number = 0
        while True:
            self.wfile.write(b":\n\n")
            number, parts = self.server.news.after(number, _PATIENCE)
            for name, text in parts:
                self.wfile.write(f"event: {name}\ndata: {text}\n\n".encode())

    def log_message(self, *_: object) -> None:
        """Say nothing."""
