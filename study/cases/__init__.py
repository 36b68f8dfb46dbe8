"""Cases and where they come from: paper files, own files, published numbers and the ledger of the papers' misprints."""
