from uqfold.testing.contract import (
    CHECKS as CHECKS,
    ContractError as ContractError,
    check_method as check_method,
)
from uqfold.testing.linear_normal import LinearNormalSystem as LinearNormalSystem
