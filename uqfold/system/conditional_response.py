"""What one unit does while the shared inputs are held fixed, failed runs included."""

from __future__ import annotations

from dataclasses import dataclass

from uqfold.moments.conditional import ConditionalDistribution

_ROUNDING = 1e-9


@dataclass(frozen=True)
class ConditionalResponse:
    """Distribution of one unit's response given the shared inputs.

    Attributes
    ----------
    distribution
        Of the finite responses; None if there are none.
    p_never
        Probability of +inf: a unit that never gets there fails every criterion.
    p_always
        Probability of -inf: works by itself, but fails under a synchronization threshold, since
        its difference to any other unit is infinite (or undefined).
    p_missing
        Probability mass of failed runs, whose response is unknown.
    """

    distribution: ConditionalDistribution | None
    p_never: float = 0.0
    p_always: float = 0.0
    p_missing: float = 0.0

    def __post_init__(self) -> None:
        masses = (self.p_never, self.p_always, self.p_missing)
        if not all(0.0 <= mass <= 1.0 + _ROUNDING for mass in masses):
            raise ValueError(
                f"p_never {self.p_never}, p_always {self.p_always}, p_missing {self.p_missing}: "
                "each must lie in [0, 1]"
            )
        rest = 1.0 - sum(masses)
        if rest < -_ROUNDING:
            raise ValueError(f"p_never + p_always + p_missing = {sum(masses)} is above 1")
        if self.distribution is None and rest > _ROUNDING:
            raise ValueError(
                f"no distribution, but finite responses have probability {rest}; give their "
                "distribution or account for them in p_never, p_always or p_missing"
            )

    @property
    def p_finite(self) -> float:
        """Probability of a finite, known response."""
        if self.distribution is None:
            return 0.0
        return max(0.0, 1.0 - (self.p_never + self.p_always + self.p_missing))
