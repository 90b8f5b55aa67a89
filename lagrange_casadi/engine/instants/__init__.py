"""Evaluation of a program over instants: refusals, tables over a cycle, the law of sections."""
