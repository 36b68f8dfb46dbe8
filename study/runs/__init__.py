"""Running planners in worker processes: line-up, pool, runner and Dask."""
