"""What is largest between instants: bounds of curves, what may be sharp, and the search."""
