"""Many designs at once: their peaks, means and states."""
