"""From graphs to arrays: how an instant is evaluated, what is refused, tables over a cycle, the law
of sections.
"""
