"""Compute how many participants a study needs: the power of a repeated-measures design (within
factors, one group), as in G*Power 3.1.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass

from scipy import stats

METHOD = (
    "F-test of repeated measures within factors, one group, as G*Power 3.1: lambda = f^2 N m epsilon / (1 - rho), degrees of "
    "freedom (m - 1) epsilon and (N - 1) (m - 1) epsilon"
)
#: The largest number of participants that is tried.
_MOST = 100_000


@dataclass(frozen=True)
class Power:
    """The power of a study with a given number of participants."""

    participants: int
    power: float
    effect_f: float
    measurements: int
    alpha: float
    correlation: float
    epsilon: float
    #: Noncentrality parameter of the F distribution.
    lambda_: float
    df: tuple[float, float]
    #: The F ratio above which the test is significant.
    critical_f: float
    method: str = METHOD

    def to_dict(self) -> dict[str, object]:
        """Return the values that ``htex study power --json`` prints."""
        return {key.rstrip("_"): value for key, value in asdict(self).items()}

    def __str__(self) -> str:
        """Return the text that ``htex study power`` prints."""
        df1, df2 = (f"{df:g}" for df in self.df)
        return (
            f"{self.participants} participants: power {self.power:.4f}\n"
            f"F({df1}, {df2}) above {self.critical_f:.4f}, lambda {self.lambda_:.4f}\n{self.method}"
        )


def power(
    effect: float,
    measurements: int,
    *,
    power: float | None = None,
    participants: int | None = None,
    alpha: float = 0.05,
    correlation: float = 0.5,
    epsilon: float = 1.0,
) -> Power:
    """Return the smallest number of participants that reaches ``power`` (default 0.8). If
    ``participants`` is given, return the power with this number instead.

    ``effect`` is Cohen's f: 0.1 is small, 0.25 medium, 0.4 large. ``measurements`` is the number of
    measurements per participant: textures times models. ``correlation`` is the correlation among
    these measurements. ``epsilon`` corrects for nonsphericity.

    >>> power(0.25, 25).participants
    8
    """
    if power is not None and participants is not None:
        raise ValueError("give the power or the participants, not both")
    _within("the number of measurements", measurements, 2, _MOST, "it is 2 to 100000")
    _within("the effect size f", effect, 1e-6, 100, "it is 0.000001 to 100")
    _between("alpha", alpha, 1e-12, 1, "it is above 1e-12 and below 1")
    least, most = -1 / (measurements - 1), 1 - 1e-9
    _between("the correlation", correlation, least, most, "it is above -1 / (measurements - 1) and below 1")
    _within("epsilon", epsilon, 1 / (measurements - 1) - 1e-9, 1, "it is 1 / (measurements - 1) to 1")

    def of(count: int) -> Power:
        df1 = (measurements - 1) * epsilon
        df2 = (count - 1) * df1
        noncentrality = effect**2 * count * measurements * epsilon / (1 - correlation)
        critical = float(stats.f.isf(alpha, df1, df2))
        found = float(stats.ncf.sf(critical, df1, df2, noncentrality))
        found = min(found, 1.0) if found == found else 1.0
        settings = (effect, measurements, alpha, correlation, epsilon)
        return Power(count, found, *settings, noncentrality, (df1, df2), critical)

    if participants is not None:
        _within("the number of participants", participants, 2, _MOST, "it is 2 to 100000")
        return of(participants)
    wanted = 0.8 if power is None else power
    _between("the power", wanted, 0, 1, "it is above 0 and below 1")
    low, high = 1, 2
    while of(high).power < wanted:
        if high == _MOST:
            advice = "expect a larger effect or ask for less power"
            raise LookupError(f"a power of {wanted:g} is not reached with {_MOST} participants; {advice}")
        low, high = high, min(2 * high, _MOST)
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if of(middle).power < wanted else (low, middle)
    return of(high)


def _within(name: str, value: float, low: float, high: float, allowed: str) -> None:
    if not low <= value <= high:
        raise ValueError(f"{name} is {value:g}; {allowed}")


def _between(name: str, value: float, low: float, high: float, allowed: str) -> None:
    if not low < value < high:
        raise ValueError(f"{name} is {value:g}; {allowed}")
