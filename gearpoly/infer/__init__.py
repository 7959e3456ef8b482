"""Evidence: how probable each explanation of a place is, a physics of the catalogue or a cause that nobody knows.

From the bottom up: ``evidence`` (one number), ``prior`` (how large, how often), ``unknown`` (what may be at a place
without a cause), ``posterior`` (probabilities at one place).
"""
