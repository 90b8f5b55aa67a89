"""The operating system's side: memory, the cache folder, interrupts, streams, and files that are
put in place whole.
"""
