"""Parts of the command `study` that have a file of their own."""
