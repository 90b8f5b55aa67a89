"""A machine left to itself: its motion under a drive's law, its steady cycle, and its flywheel."""
