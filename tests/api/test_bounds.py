"""Numbers without bound: said before anything starts, and refused if they cannot be meant or this
machine has no room.
"""

import importlib
import re
import resource
from pathlib import Path

import psutil
import pytest
from commands import command
from mechanisms import slider_crank
from stepped import iterated

from lagrange_casadi import evaluate
from lagrange_casadi.errors import SizeError

pytestmark = pytest.mark.usefixtures("interpreted")

HUGE = "99999999999999999999999"


COUNT = r"t: COUNT must be a whole number from 1 to 2\^63 - 1, got "


STEPS = (
    r"newton: expected a number of steps, from 1 to 1000 \(after some ten nothing changes\), got "
)


THREADS = "is not in the range 1<=x<=1024"


GRID = "--grid l=0.2:0.3:3"


FREE = r"GB, and this machine has \S+ GB free"


REFUSED = {
    "newton": ("run CASE --newton 1000000000", 2, STEPS + "1000000000"),
    "newton-huge": (f"run CASE --newton {HUGE}", 2, STEPS + HUGE),
    "newton-exported": ("export CASE --out x --newton 1000000000", 2, STEPS + "1000000000"),
    "newton-swept": (f"sweep CASE {GRID} --newton 1001", 2, STEPS + "1001"),
    "t": (
        "run CASE --t 0:0.08:100000000000",
        1,
        f"not enough memory for the outputs over time: .* {FREE}",
    ),
    "t-huge": (f"run CASE --t 0:0.08:{HUGE}", 2, COUNT + HUGE),
    "t-swept": (
        f"sweep CASE {GRID} --t 0:0.08:100000000000",
        1,
        f"not enough memory for the points from 0 to 0.08: .* {FREE}",
    ),
    "t-swept-huge": (f"sweep CASE {GRID} --t 0:0.08:{HUGE}", 2, COUNT),
    "t-traded": ("trade CASE --t 0:0.08:100000000000", 1, f"not enough memory for .* {FREE}"),
    "xi": (
        "run CASE --xi 0:1:100000000000 --t 0:0.08:9",
        1,
        f"not enough memory for the points from 0 to 1: .* {FREE}",
    ),
    "xi-swept": (
        f"sweep CASE {GRID} --xi 0:1:100000000000",
        1,
        f"not enough memory for the points from 0 to 1: .* {FREE}",
    ),
    "table": (
        "run CASE --table 1000000000",
        2,
        "table: expected a whole number of nodes from 8 to 16384",
    ),
    "table-exported": (
        f"export CASE --out x --table {HUGE}",
        2,
        "table: expected a whole number of nodes from 8 to 16384",
    ),
    "threads": ("run CASE --threads 1000000000", 2, THREADS),
    "workers": (f"sweep CASE {GRID} --workers 1000000000", 2, THREADS),
    "grid-unmeant": (
        "sweep CASE --grid l=0.2:0.3:2000000000",
        2,
        "2 000 000 000 designs, more than 10\\^9; if that is meant, say --yes",
    ),
    "grid-huge": (
        f"sweep CASE --yes --grid l=0.2:0.3:{HUGE}",
        2,
        "99 999 .* designs, and a sweep at most 10\\^12",
    ),
    "grid-product": (
        "sweep CASE --yes --grid l=0.2:0.3:10000000 --grid r=0.05:0.1:10000000",
        2,
        "100 000 000 000 000 designs, and a sweep at most 10\\^12",
    ),
    "grid-no-disk": (
        "sweep CASE --yes --grid l=0.2:0.3:1000000000000",
        1,
        r"takes about 8e\+03 GB, and the disk has \S+ GB left",
    ),
}


@pytest.fixture
def limited():
    """No more than 8 GB of addresses beside those that there are."""
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (psutil.Process().memory_info().vms + (8 << 30), hard))
    yield
    resource.setrlimit(resource.RLIMIT_AS, (soft, hard))


@pytest.mark.parametrize(("line", "status", "says"), REFUSED.values(), ids=REFUSED)
def test_a_number_that_cannot_be_meant_is_one_line(here, limited, capfd, line, status, says):
    """Within 8 GB of addresses, of which what computes would take more."""
    assert command(line) == status
    *notes, error = capfd.readouterr().err.splitlines()
    assert re.search(says, error), error
    assert error.startswith("error: ")
    assert all(note.startswith("note: ") for note in notes)
    assert list(here.iterdir()) == []


def test_what_takes_long_is_said_before_it_starts(monkeypatch):
    module = importlib.import_module("lagrange_casadi.studies.solving")
    monkeypatch.setattr(module, "_LONG", 1e-9)
    says = r"^1 001 instants of 5 Newton steps each take about \S+ s$"
    with pytest.warns(UserWarning, match=says):
        evaluate(iterated(), t=(0, 1, 1001), newton=5)
    monkeypatch.setattr(module, "_LONG", 60.0)
    evaluate(iterated(), t=(0, 1, 1001), newton=5)


MEMINFO = (
    "MemTotal: 64000000 kB\nMemFree: 100000 kB\nMemAvailable: 3200000 kB\nSwapFree: 100000 kB\n"
)


STAT = "anon 900\ninactive_file 4000000\ntotal_inactive_file 6000000\n"


ROOMS = {
    "3.38": {"/proc/meminfo": MEMINFO},
    "4.1": {"/proc/meminfo": "MemTotal: 5 kB\n"},
    "0.504": {  # a container has what its group has left
        "/proc/meminfo": MEMINFO,
        "/proc/self/cgroup": "0::/a.slice/b.scope\n",
        "/sys/fs/cgroup/a.slice/memory.max": "800000000\n",
        "/sys/fs/cgroup/a.slice/memory.current": "300000000\n",
        "/sys/fs/cgroup/a.slice/memory.stat": STAT,
        "/sys/fs/cgroup/a.slice/b.scope/memory.max": "max\n",
    },
    "0.206": {  # the older kind of groups, whose path is another one outside
        "/proc/meminfo": MEMINFO,
        "/proc/self/cgroup": "4:cpu,cpuacct:/\n3:memory:/docker/0123\n",
        "/sys/fs/cgroup/memory/memory.limit_in_bytes": "500000000\n",
        "/sys/fs/cgroup/memory/memory.usage_in_bytes": "300000000\n",
        "/sys/fs/cgroup/memory/memory.stat": STAT,
    },
}


@pytest.mark.parametrize("room", ROOMS)
def test_free_memory_is_what_the_system_and_its_groups_tell(room, monkeypatch):
    scene, files, read_text = slider_crank(), ROOMS[room], Path.read_text

    def read(path, *asked, **more):
        if not str(path).startswith(("/proc", "/sys")):
            return read_text(path, *asked, **more)
        if str(path) not in files:
            raise FileNotFoundError(path)
        return files[str(path)]

    monkeypatch.setattr(Path, "read_text", read)
    pages = {"SC_PAGE_SIZE": 4096, "SC_PHYS_PAGES": 1_000_000}
    monkeypatch.setattr("os.sysconf", pages.get)
    with pytest.raises(SizeError, match=rf"values are \S+ GB, and this machine has {room} GB free"):
        evaluate(scene, t=(0, 1, 10**9))
    evaluate(scene, t=(0, 0.08, 3))
