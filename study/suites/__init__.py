"""The benchmark beyond the papers: generators of its problems, best known times, measures, law and page."""
