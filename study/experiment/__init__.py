"""From cases and planners to stored, judged results."""
