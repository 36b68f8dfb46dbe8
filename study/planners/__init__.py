"""The papers' planners: a search with the paper's constants, one file per paper."""
