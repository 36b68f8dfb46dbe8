"""Answers of `plan` and `compare` in a notebook: cards, figures and the recording in place."""
