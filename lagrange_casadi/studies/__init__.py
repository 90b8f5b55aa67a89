"""What is asked of results: peaks between instants, and what speed costs in accuracy."""
