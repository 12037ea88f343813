import pytest


@pytest.fixture(autouse=True, scope="module")
def _as_in_methods(one_blas_thread: None) -> None:
    """Fit all surfaces of this room on one BLAS thread."""
