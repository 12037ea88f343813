"""The contract that every reliability method keeps, for authors of methods to run on their own.

>>> from uqfold.methods import FFNISaddlepoint
>>> from uqfold.testing import check_method
>>> check_method(FFNISaddlepoint(), only=["evaluations_are_counted_per_sample"])
['evaluations_are_counted_per_sample']
"""

from typing import TYPE_CHECKING

from uqfold.lazy import lazy_exports

if TYPE_CHECKING:
    from uqfold.testing.contract import CHECKS, ContractError, check_method
    from uqfold.testing.linear_normal import LinearNormalSystem

__all__ = ["CHECKS", "ContractError", "LinearNormalSystem", "check_method"]

__getattr__, __dir__ = lazy_exports(
    __name__,
    globals(),
    {
        "CHECKS": "uqfold.testing.contract",
        "ContractError": "uqfold.testing.contract",
        "LinearNormalSystem": "uqfold.testing.linear_normal",
        "check_method": "uqfold.testing.contract",
    },
)
