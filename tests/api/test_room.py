"""What this machine has room for: free memory, as the system and its control groups tell it."""

import math
from pathlib import Path

import pytest
from internals import space

from lagrange_casadi.errors import SizeError

pytestmark = pytest.mark.quick

MEMINFO = (
    "MemTotal:       64000000 kB\nMemFree:          100000 kB\nMemAvailable:   32000000"
    " kB\nSwapFree:        1000000 kB\n"
)
STAT = "anon 900\ninactive_file 4000000\ntotal_inactive_file 6000000\n"


@pytest.fixture
def system(monkeypatch):
    """What the system's files hold; others are not there."""
    files = {}

    def read(path):
        if str(path) not in files:
            raise FileNotFoundError(path)
        return files[str(path)]

    monkeypatch.setattr(Path, "read_text", read)
    monkeypatch.setattr(
        "os.sysconf", lambda name: {"SC_PAGE_SIZE": 4096, "SC_PHYS_PAGES": 10_000_000}[name]
    )
    return files


def test_memory_is_what_the_system_has_free(system):
    system["/proc/meminfo"] = MEMINFO
    assert space.memory() == 1024 * 33_000_000


def test_where_the_system_does_not_tell_it_is_all(system, monkeypatch):
    assert space.memory() == 4096 * 10_000_000
    system["/proc/meminfo"] = "MemTotal: 5 kB\n"
    assert space.memory() == 4096 * 10_000_000
    monkeypatch.delattr("os.sysconf")
    assert space.memory() == math.inf


def test_a_container_has_what_its_group_has_left(system):
    system |= {
        "/proc/meminfo": MEMINFO,
        "/proc/self/cgroup": "0::/a.slice/b.scope\n",
        "/sys/fs/cgroup/a.slice/memory.max": "8000000000\n",
        "/sys/fs/cgroup/a.slice/memory.current": "5000000000\n",
        "/sys/fs/cgroup/a.slice/memory.stat": STAT,
        "/sys/fs/cgroup/a.slice/b.scope/memory.max": "max\n",
    }
    assert space.memory() == 8e9 - 5e9 + 4e6


def test_so_has_one_whose_group_has_another_path_outside(system):
    """As with the older kind of groups, and where the container takes its own for the root."""
    system |= {
        "/proc/meminfo": MEMINFO,
        "/proc/self/cgroup": "4:cpu,cpuacct:/\n3:memory:/docker/0123\n",
        "/sys/fs/cgroup/memory/memory.limit_in_bytes": "2000000000\n",
        "/sys/fs/cgroup/memory/memory.usage_in_bytes": "1500000000\n",
        "/sys/fs/cgroup/memory/memory.stat": STAT,
    }
    assert space.memory() == 5e8 + 6e6


@pytest.mark.parametrize(
    ("shape", "says"),
    [
        (
            (3, 10**9),
            r"not enough memory for it: 3 x 1 000 000 000 values are 24 GB, and this machine has",
        ),
        (
            (10**400,),
            r"not enough memory for it: 1[ 0]+ values are inf GB, and this machine has 10 GB free",
        ),
    ],
)
def test_what_does_not_fit_is_refused_with_its_size(monkeypatch, shape, says):
    monkeypatch.setattr(space, "memory", lambda: 1e10)
    space.require("it", (10**9,))
    with pytest.raises(SizeError, match=says):
        space.require("it", shape)


def test_nobody_is_asked_for_what_is_little(monkeypatch):
    monkeypatch.setattr(space, "memory", lambda: pytest.fail("somebody was asked"))
    space.require("it", (1000, 1000))


@pytest.mark.parametrize(
    ("seconds", "words"),
    [
        (0.5, "0.5 s"),
        (90, "90 s"),
        (150, "2.5 min"),
        (7100, "118 min"),
        (8000, "2.2 h"),
        (200_000, "2.3 days"),
        (3e9, "95 years"),
        (math.inf, "inf years"),
    ],
)
def test_a_time_is_said_as_people_say_it(seconds, words):
    assert space.in_words(seconds) == words
