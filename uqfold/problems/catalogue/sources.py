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
OPENTURNS = "OpenTURNS, as of 2026"
ERA = "ERA-Software (Engineering Risk Analysis Group, TU Munich), version 2023-12"
LIU_DER_KIUREGHIAN = (
    "Liu PL, Der Kiureghian A (1991), Optimization algorithms for structural reliability, "
    "Struct. Saf. 9, 161-177"
)
LI_2018 = (
    "Li X, Gong C, Gu L, Gao W, Jing Z, Su H (2018), A sequential surrogate method for reliability "
    "analysis based on radial basis function, Struct. Saf. 73, 42-53"
)
RARE_EVENT_ESTIMATION = "rareeventestimation, as of 2024"
