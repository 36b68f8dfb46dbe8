"""A fair comparison: equal budgets and paired seeds, tests, an invariance audit, ablations and the papers' claims."""
