"""What is said: mechanisms, their parts and what is possible of them, motions, scenes."""
