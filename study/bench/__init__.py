"""Speed of the parts of the study, as ratios to peers measured in the same run; one file for each topic."""
