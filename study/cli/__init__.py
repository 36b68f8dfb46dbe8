"""The command `study` and its tables in the terminal."""
