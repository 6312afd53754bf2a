"""Whole processes measured beside each other: the parts of `compare.py`, in the order in which it uses them."""
