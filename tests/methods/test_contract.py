"""Every registered method keeps the contract."""

import pytest

from uqfold.methods import available
from uqfold.testing import CHECKS, check_method

METHODS = available()
# thirty surfaces each
SLOW = {(name, "stated_errors_are_honest") for name in ("kriging", "pce", "ak-mcs")}
CASES = [
    pytest.param(name, check, marks=[pytest.mark.slow] if (name, check) in SLOW else [])
    for name in METHODS
    for check in CHECKS
]


@pytest.mark.parametrize(("name", "check"), CASES)
def test_registered_method_keeps_the_contract(name: str, check: str) -> None:
    method = METHODS[name]()
    assert method.name == name
    assert check_method(method, only=[check]) == [check]


def test_unknown_check_is_refused() -> None:
    with pytest.raises(ValueError, match="no check is named 'speed'"):
        check_method(METHODS["mc"](), only=["speed"])
