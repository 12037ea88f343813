"""Every registered method keeps the contract."""

import pytest

from uqfold.methods import available
from uqfold.testing import CHECKS, check_method

METHODS = available()


@pytest.mark.parametrize("check", CHECKS)
@pytest.mark.parametrize("name", METHODS)
def test_registered_method_keeps_the_contract(name: str, check: str) -> None:
    method = METHODS[name]()
    assert method.name == name
    assert check_method(method, only=[check]) == [check]


def test_unknown_check_is_refused() -> None:
    with pytest.raises(ValueError, match="no check is named 'speed'"):
        check_method(METHODS["mc"](), only=["speed"])
