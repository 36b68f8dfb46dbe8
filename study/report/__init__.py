"""What the study leaves behind: tables, figures, page and recordings."""
