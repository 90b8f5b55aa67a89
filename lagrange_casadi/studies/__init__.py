"""Studies of results: peaks between instants, and the accuracy of faster evaluations."""
