"""Reproduce the five papers: every printed number beside ours, each with a verdict that follows from a stated rule."""
