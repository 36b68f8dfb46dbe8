"""How fast the study's parts are, as ratios to peers measured in the same run; one file for each topic."""
