//! A pressure lowered by an effect. It stays positive so that the equilibrium exists.

use crate::effect::Jet;
use bulge_numerics::Real;

/// The smallest pressure that an effect leaves \[Pa\]: 1 mbar, which is below the resolution of the sensors
/// of force maps.
const LEAST: f64 = 100.0;

/// `p - by`, but not below [`LEAST`]. A pressure that is already below it stays unchanged, bit for bit.
pub(crate) fn lowered(pressure: Jet, by: Jet) -> Jet {
    let left = pressure - by;
    let least = if pressure.value() < LEAST { pressure } else { Jet::from(LEAST) };
    if left.value() < least.value() { least } else { left }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn something_is_left() {
        let run = |p: f64, by: f64| {
            let found = lowered(Jet::variable(p, 0), Jet::variable(by, 1));
            (found.value(), found.gradient()[0], found.gradient()[1])
        };
        assert_eq!(run(2e5, 3e4), (1.7e5, 1.0, -1.0));
        assert_eq!(run(2e5, 0.0), (2e5, 1.0, -1.0));
        assert_eq!(run(2e5, 3e5), (100.0, 0.0, 0.0));
        assert_eq!(run(30.0, 50.0), (30.0, 1.0, 0.0));
        assert_eq!(run(30.0, 0.0), (30.0, 1.0, -1.0));
        assert_eq!(run(0.0, -400.0), (400.0, 1.0, -1.0));
    }
}
