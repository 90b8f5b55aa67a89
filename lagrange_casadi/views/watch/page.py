"""The page that follows a case: the viewer of reports, which is built anew for what is new and
stays as its reader has it.
"""

from __future__ import annotations

from importlib import resources

from ..report.page import assembled, policy, script, viewer


def page(title: str) -> tuple[str, str]:
    """The text of the page, and the policy of content that it is sent with."""
    scripts = [
        *(script("dom"), "function viewer(before) {\n"),
        *viewer(live=True),
        *(_asset("kept.js"), "}\n", _asset("watch.js")),
    ]
    text = assembled(title, {}, scripts, wasm=True, connect=True)
    text = text.replace("</style>", f"{_asset('watch.css')}</style>", 1)
    asked = policy(scripts, wasm=True, connect=True)
    return text, f"{asked}; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"


def _asset(name: str) -> str:
    return (
        resources.files(__package__).joinpath("assets").joinpath(name).read_text(encoding="utf-8")
    )
