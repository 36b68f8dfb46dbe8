"""Metaheuristics with the ask-and-tell interface, one file each, and the loop that runs them."""
