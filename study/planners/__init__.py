"""Planners of the papers, one file per paper: a search with the paper's constants; other searches in one file."""
