"""The report: tables, figures and pages, one for each case."""
