"""Commands that a kill, or a full disk, meets just before one of the moments at which they change
what is there.
"""

import errno
import os
import signal

import pytest

CHANGES = ("replace", "rename", "unlink", "mkdir", "rmdir")


def killed(number, action):
    """Kill a process that acts at a change by its number, first 0; whether it got there."""
    child = os.fork()
    if child == 0:
        try:
            with pytest.MonkeyPatch.context() as patch:
                meet(patch, number, lambda: os.kill(os.getpid(), signal.SIGKILL))
                action()
        except BaseException:
            os._exit(1)
        os._exit(0)
    _, status = os.waitpid(child, 0)
    assert os.WIFSIGNALED(status) or os.WEXITSTATUS(status) == 0
    return os.WIFSIGNALED(status)


def meet(patch, number, happens):
    """Let something happen at a change, by its number."""
    seen = iter(range(10**6))

    def at(own):
        def called(*words, **named):
            if next(seen) == number:
                happens()
            return own(*words, **named)

        return called

    for name in CHANGES:
        patch.setattr(os, name, at(getattr(os, name)))


def full():
    """What a full disk does."""
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
