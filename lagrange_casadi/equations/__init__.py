"""From what is declared to graphs: kinematics of loops, Lagrange's terms, internal forces."""
