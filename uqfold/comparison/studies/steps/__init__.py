"""Analyses of a study other than comparisons, one file each; see `studies.registry`."""
