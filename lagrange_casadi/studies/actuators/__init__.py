"""Motors of drives: the requirements of a cycle, and the smallest motor of a catalogue that meets
them.
"""
