"""Cases and where they come from: paper files, own files, published numbers and the ledger of the papers' misprints."""

import study.datafiles  # noqa: F401  imported first, because it names a missing package in one sentence
