"""Ask/tell metaheuristics, one file each, and the one loop that drives them."""
