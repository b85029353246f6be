"""Mutants of the independent reader: one rule of the text changed at a time.

A mutant that agrees with all conformance files of its part shows a rule that no file tests. `__main__.py` applies
the mutants, and the other modules list them: `playing`, `assets`, `libraries` and `baked`.
"""
