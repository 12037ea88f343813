"""Sources that several limit states share."""

RPREPO = "Rozsas A, Slobbe A (2019), Reliability problems repository, as restated by otbenchmark"
WAARTS = (
    "Waarts PH (2000), Structural reliability using finite element analysis, thesis, TU Delft, "
    "Annex E, as restated by the tests of Hydra-Ring (Deltares)"
)
ECHARD_2011 = (
    "Echard B, Gayton N, Lemaire M (2011), AK-MCS: an active learning reliability method combining "
    "Kriging and Monte Carlo simulation, Struct. Saf. 33, 145-154"
)
GEYER = (
    "Geyer S, Papaioannou I, Straub D (2019), Cross entropy-based importance sampling using "
    "Gaussian densities revisited, Struct. Saf. 76, 15-27"
)
OPENTURNS = "OpenTURNS"
