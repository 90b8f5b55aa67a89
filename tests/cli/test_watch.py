"""A page that follows a case: it shows what was saved, or what is wrong with it, and stays as its
reader has it; whatever a case does, the program goes on; nobody else reads the page.
"""

import http.client
import json
import os
import re
import signal
import subprocess
import sys
import time
from contextlib import contextmanager
from urllib.parse import urlsplit

import alive
import browser
import pytest
import sweeps

from lagrange_casadi import load_case

CASE = (sweeps.CASE / "case.py").read_text()
HALF = CASE[: CASE.index('    m.revolute("B"')] + "    return m\n"


@contextmanager
def following(case, *more, **keywords):
    """The program that follows a case, and its address."""
    words = [sys.executable, "-m", "lagrange_casadi", "watch", str(case), "--no-browser", *more]
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True, **keywords) as process:
        try:
            yield process, re.search(r"http:\S+/", process.stdout.readline())[0]
        finally:
            process.send_signal(signal.SIGINT)


def answer(address, path=None, **heads):
    """What a server answers."""
    place = urlsplit(address)
    link = http.client.HTTPConnection(place.hostname, place.port, timeout=60)
    link.request("GET", place.path if path is None else path, headers=heads)
    return link.getresponse()


def states(address, what="state", seconds=60.0):
    """What is said of the case, one state or drawing after the other, for so long at most."""
    event, end = "", time.monotonic() + seconds
    for line in answer(address, urlsplit(address).path + "news"):
        if time.monotonic() > end:
            return
        name, _, text = line.decode().partition(": ")
        event = text.strip() if name == "event" else event
        if name == "data" and event == what:
            yield json.loads(text)


@pytest.fixture(scope="module")
def followed(tmp_path_factory):
    """A case that is followed: its file, the address, and a function that saves a text."""
    case = tmp_path_factory.mktemp("followed") / "crank.py"
    case.write_text("")
    with following(case) as (_, address):

        def save(text):
            other = case.with_suffix(".new")
            other.write_text(text)
            other.replace(case)  # as editors do

        yield case, address, save


def test_only_this_machine_reads_only_the_page(followed):
    _, address, _ = followed
    place = urlsplit(address)
    here, news = place.netloc, f"{place.path}news"
    rows = [
        ({}, 200),
        ({"Host": f"localhost:{place.port}"}, 200),
        ({"Origin": f"http://{here}"}, 200),
        ({"path": place.path[:-2] + "/"}, 404),
        ({"path": "/"}, 404),
        ({"path": f"{place.path}../case.py"}, 404),
        ({"Host": "example.com"}, 403),
        ({"Host": f"example.com:{place.port}"}, 403),
        ({"path": news, "Host": f"example.com:{place.port}"}, 403),
        ({"path": news, "Origin": "http://example.com"}, 403),
        ({"path": news, "Origin": "null"}, 403),
    ]
    assert [answer(address, **asked).status for asked, _ in rows] == [wanted for _, wanted in rows]
    heads = answer(address).headers
    assert heads["Access-Control-Allow-Origin"] is None
    assert heads["Cross-Origin-Resource-Policy"] == "same-origin"
    policy = heads["Content-Security-Policy"]
    assert policy.startswith("default-src 'none'; script-src 'sha256-")
    assert "frame-ancestors 'none'" in policy
    assert "'unsafe-eval'" not in policy


ENDS = {
    "import os; os._exit(7)": "the process that ran the case has ended: status 7",
    "import os; os.kill(os.getpid(), 11)": "has ended: Segmentation fault",
    "held = bytearray(10**10)": "out of memory: the case takes more than there is (case ",
    "import sys; sys.exit(3)": "line 1: SystemExit: 3",
    "": "has no function scene()",
    "def scene(:": "line 1: SyntaxError",
    "import parts": "No module named 'parts'",
}


def test_whatever_a_case_does_the_program_goes_on(followed):
    case, address, save = followed
    told = states(address)
    for text, words in ENDS.items():
        save(text + "\n")
        assert any(words in state.get("error", "") for state in told), text
    case.with_name("parts.py").write_text("raise ValueError('in parts')\n")
    assert any("in parts" in state["error"] for state in told)
    save("while True: pass\n")
    assert any(state["doing"] == "loading the case" for state in told)
    save(CASE)
    assert any(not state["doing"] and not state["error"] for state in told)


def test_a_drawing_is_of_the_instant_asked_or_of_all_ways_left_open(tmp_path):
    case = tmp_path / "crank.py"
    case.write_text(CASE)
    with following(case, "--t", "0.01:0.03:3") as (_, address):
        expected = load_case(case).scene.draw(t=0.01).svg
        assert next(states(address, "drawing"))["svg"] == expected
        four_bar = (sweeps.CASE.parent / "four_bar" / "case.py").read_text()
        case.write_text(re.sub(", posture={.*}", "", four_bar))
        assert any("2 ways to assemble" in one["svg"] for one in states(address, "drawing"))
        assert any("  2  posture={'r" in one.get("error", "") for one in states(address))


def test_a_run_has_a_limit_and_ctrl_c_leaves_nothing(tmp_path):
    case, there = tmp_path / "endless" / "case.py", tmp_path / "temporary"
    for folder in (case.parent, there):
        folder.mkdir()
    case.write_text("while True: pass\n")
    places = {**os.environ, "TMPDIR": str(there)}
    with following(case, "--time-limit", "1", env=places, stderr=subprocess.PIPE) as (one, address):
        told = states(address)
        words = "the case takes more than 1 s to draw: it was ended"
        assert any(state.get("error") == words for state in told)
        case.write_text(
            "import os, signal, subprocess, time\nsignal.signal(signal.SIGTERM, signal.SIG_IGN)\n"
            "other = subprocess.Popen(['sleep', '600'])\n"
            "open('pids', 'w').write(f'{os.getpid()} {other.pid}')\nwhile True: pass\n".replace(
                "'pids'", repr(str(tmp_path / "pids"))
            )
        )
        sweeps.wait_for((tmp_path / "pids").exists)
        one.send_signal(signal.SIGINT)
        _, said = one.communicate(timeout=20)
    assert one.returncode == 130
    assert said == "error: interrupted; no file was left incomplete\n"
    for pid in (tmp_path / "pids").read_text().split():
        sweeps.wait_for(lambda pid=pid: not running(pid))
    assert [*there.iterdir(), *case.parent.iterdir()] == [case]


def running(pid):
    """Whether a process does anything."""
    try:
        with open(f"/proc/{pid}/stat") as file:
            return file.read().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


@alive.NEEDS_BROWSER
def test_a_page_follows_what_is_saved_and_stays_as_its_reader_has_it(followed):
    _, address, save = followed
    with browser.Browser() as one:
        one.prefer(prefers_reduced_motion="reduce")
        save("")
        one.call("Page.navigate", url=address)
        text = "(document.querySelector('.watching')?.innerText ?? '')"
        alive.wait(one, f"{text}.includes('has no function scene()')")
        save(HALF)
        alive.wait(one, f"{text}.includes('scene() returned Mechanism')")
        drawing = "(document.querySelector('.now svg')?.textContent ?? '')"
        assert all(part in one.run(drawing) for part in ("crank", "rod", "slider"))
        save(CASE.replace('"guide", m.ground', '"guide", m.ground.at(0, 1)'))
        alive.wait(one, f"{text}.includes('cannot be closed at the start')")
        assert "the ends of rod are 1 m apart" in one.run(drawing)

        def shown(text):
            """Save a text, and wait until the page shows it."""
            before = one.run("Number(document.querySelector('#report').dataset.save ?? 0)")
            save(text)
            of = "document.querySelector('#report').dataset.save"
            done = "document.querySelector('.watching p').textContent === 'up to date'"
            alive.wait(one, f"Number({of}) > {before} && {done}")

        shown(CASE)
        if alive.THERE:
            alive.wait(one, "document.querySelectorAll('.sliders label').length === 5", 60.0)
        torque = "document.querySelector('.glance b').textContent"
        assert one.run(torque) == "8.314\u00a0N·m"
        one.run(
            "[...document.querySelectorAll('.card [title=\"Remove this plot\"]')].slice(1)"
            ".forEach((button) => button.click())"
        )
        bar = "document.querySelector('.transport input')"
        one.run(f"{{ {bar}.value = 300; {bar}.dispatchEvent(new Event('input')); }}")
        one.run("document.querySelector('.views [title^=Nearer]').click()")
        one.run("document.querySelector('.shows .reaction input').click()")
        looks = (
            "[document.querySelector('.picture').toDataURL(),"
            f" document.querySelectorAll('.cards .card').length, {bar}.value]"
        )
        before = one.run(looks)
        assert before[1:] == [1, "300"]
        shown(CASE + "# the same\n")
        assert one.run(looks) == before
        shown(CASE.replace('"r", 0.1', '"r", 0.12'))
        assert one.run(torque) == "13.44\u00a0N·m"
        assert one.run(looks)[0] != before[0]
        save(CASE.replace("m.revolute", "m.revolut", 1))
        alive.wait(one, f"{text}.includes(\"'revolut'\")")
        assert one.run(f"document.querySelector('.picture') !== null && {bar}.value") == "300"
        for k in range(30):
            save(CASE + f"# {k}\n")
            time.sleep(0.02)
        shown(CASE + "# the last\n")
        assert one.run(looks) == before
        assert one.complaints == []
