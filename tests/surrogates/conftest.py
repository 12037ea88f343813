"""Surfaces are fitted as methods fit them: on one BLAS thread, or threads wait for each other."""

from collections.abc import Iterator

import pytest

from uqfold.algebra import one_blas_thread


@pytest.fixture(autouse=True, scope="module")
def _one_blas_thread() -> Iterator[None]:
    with one_blas_thread():
        yield
