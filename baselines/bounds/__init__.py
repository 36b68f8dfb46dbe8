"""Lower bounds on the duration and certified optima."""
