from uqfold.problems.catalogue.folder import titles as titles
from uqfold.problems.catalogue.listing import (
    entry as entry,
    literature as literature,
    problem as problem,
)
from uqfold.problems.catalogue.record import KINDS as KINDS, Entry as Entry
