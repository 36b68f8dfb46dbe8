"""Other people's packages as planners, one thin file each, set up as their users would; they run only when asked for.

A peer takes part in no tier and no usual line-up: `study run --suite robots --lineup peers` and `--planners NAME` run
it. What its package leaves in the motion stays there, and the judge shows it. Packages are imported when one is
asked.
"""
