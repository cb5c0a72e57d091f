"""Wilson's interval for a rate (E. B. Wilson 1927): centre (k + z^2/2)/(n + z^2), half width z sqrt(k (n - k)/n + z^2/4)/(n + z^2)."""

from math import sqrt

Z95 = 1.959963984540054


def interval(successes, trials, z=Z95):
    """Bounds of the rate; (0, 1) without trials."""
    if not trials:
        return 0.0, 1.0
    centre = (successes + z * z / 2.0) / (trials + z * z)
    half = z * sqrt(successes * (trials - successes) / trials + z * z / 4.0) / (trials + z * z)
    return max(0.0, centre - half), min(1.0, centre + half)
