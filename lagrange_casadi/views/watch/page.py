"""The page that follows a case: the viewer of reports, which is built anew for what is new and
stays as its reader has it.
"""

from __future__ import annotations

from ..report.page import assembled, asset, policy, script, viewer


def page(title: str) -> tuple[str, str]:
    """The text of the page, and the policy of content that it is sent with."""
    scripts = [
        *(script("dom"), "function viewer(before) {\n"),
        *viewer(live=True),
        *(asset("kept.js", __package__), "}\n", asset("watch.js", __package__)),
    ]
    text = assembled(title, {}, scripts, wasm=True, connect=True)
    text = text.replace("</style>", f"{asset('watch.css', __package__)}</style>", 1)
    asked = policy(scripts, wasm=True, connect=True)
    return text, f"{asked}; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
