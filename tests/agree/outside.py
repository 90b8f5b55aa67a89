"""A function that has no expression, as those of other programs have none."""

import casadi as ca


class Doubled(ca.Callback):
    """Twice its argument."""

    def __init__(self):
        ca.Callback.__init__(self)
        self.construct("doubled", {"enable_fd": True})

    def eval(self, arguments):
        return [2 * arguments[0]]


doubled = Doubled()
