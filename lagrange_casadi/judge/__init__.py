"""Whether a result is right, and to how many digits."""
