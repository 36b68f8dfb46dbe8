"""One file for each paper: what must be run, and a ruling on everything that it prints."""
