//! Fewer derivatives: the independent combinations of variables through which a net depends on them.
//!
//! A dimensionless net has fewer groups than the muscle has numbers: a braid with bladder depends on length,
//! radius, wall, angle, both rubber constants and pressure through four of them. The cost of an integration
//! grows with the number of derivatives that it carries. It therefore carries the derivatives by the groups,
//! and the chain rule does the rest:
//!
//! ```text
//! d(net)/d(variables) = C B        d(answer)/d(variables) = d(answer)/d(groups) B
//! ```
//!
//! C has as many columns as the net has independent derivatives. Gram and Schmidt's method with pivots finds
//! them.

use bulge_numerics::{Dual, Real};

use crate::net::{NUMBERS, Net, OWN_NUMBERS};
use crate::shooting::Total;

/// Part of a derivative that may be left unexplained.
const REST: f64 = 1e-11;

/// The derivatives of a net by its `N` - 2 variables, in two factors.
pub(crate) struct Groups<const N: usize> {
    /// C, row by row in the places of [`Net::map`].
    numbers: [[f64; N]; NUMBERS],
    /// Sizes of the numbers. The columns of C are orthonormal over them.
    size: [f64; NUMBERS],
    /// B.
    variables: [[f64; N]; N],
    count: usize,
}

impl<const N: usize> Groups<N> {
    pub(crate) fn of(net: &Net<Dual<N>>) -> Self {
        let (mut size, mut rows) = ([1.0; NUMBERS], [[0.0; N]; NUMBERS]);
        net.each(|row, number| {
            // Relative to the number, so that a small one is not lost beside a larger one.
            size[row] = if number.value() == 0.0 { 1.0 } else { number.value().abs() };
            rows[row] = number.gradient().map(|slope| slope / size[row]);
        });
        let rows = &mut rows[..net.places()];
        let norm = |rows: &[[f64; N]], i: usize| rows.iter().map(|row| row[i] * row[i]).sum::<f64>().sqrt();
        let whole: [f64; N] = std::array::from_fn(|i| norm(rows, i));
        let mut found = Self { numbers: [[0.0; N]; NUMBERS], size, variables: [[0.0; N]; N], count: 0 };
        while found.count < N {
            let share = |i: usize| if whole[i] > 0.0 { norm(rows, i) / whole[i] } else { 0.0 };
            let Some(pivot) = (2..N).max_by(|a, b| share(*a).total_cmp(&share(*b))) else { break };
            if share(pivot) < REST {
                break;
            }
            let (k, length) = (found.count, norm(rows, pivot));
            let mut direction = [0.0; NUMBERS];
            for (along, row) in direction.iter_mut().zip(&*rows) {
                *along = row[pivot] / length;
            }
            for i in 2..N {
                let along: f64 = rows.iter().zip(&direction).map(|(row, d)| row[i] * d).sum();
                found.variables[k][i] = along;
                for (row, d) in rows.iter_mut().zip(&direction) {
                    row[i] -= along * d;
                }
            }
            for (row, (d, size)) in found.numbers.iter_mut().zip(direction.iter().zip(size)) {
                row[k] = d * size;
            }
            found.count += 1;
        }
        found
    }

    /// How many groups there are.
    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// The net with the groups as the variables 2 ..; there must be room for all of them.
    pub(crate) fn net<const M: usize>(&self, net: &Net<Dual<N>>) -> Net<Dual<M>> {
        net.map(|row, number| {
            let slopes = &self.numbers[row];
            let slope = |i: usize| if i < 2 { 0.0 } else { slopes.get(i - 2).copied().unwrap_or(0.0) };
            Dual::new(number.value(), std::array::from_fn(slope))
        })
    }

    /// The derivatives by the numbers of the net along the directions of the groups, from the derivatives by
    /// the groups. Across these directions they are zero.
    pub(crate) fn by_number<const M: usize>(&self, by_group: &Total<M>) -> [f64; OWN_NUMBERS] {
        std::array::from_fn(|row| {
            let pairs = self.numbers[row].iter().zip(by_group.by_parameter.iter().skip(2)).take(self.count);
            pairs.map(|(slope, by)| slope * by).sum::<f64>() / (self.size[row] * self.size[row])
        })
    }

    /// The derivatives by the variables from those by the groups.
    pub(crate) fn expand<const M: usize>(&self, by_group: &Total<M>) -> Total<N> {
        let along = |i: usize| {
            let pairs = self.variables.iter().zip(by_group.by_parameter.iter().skip(2));
            pairs.map(|(slopes, by)| slopes[i] * by).sum()
        };
        Total {
            value: by_group.value,
            by_contraction: by_group.by_contraction,
            by_parameter: std::array::from_fn(along),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::net::tests::rich;

    /// A net whose numbers move with four variables. One of these does what two others do together, and one
    /// does nothing.
    fn moving() -> Net<Dual<7>> {
        let v = |i: usize| Dual::<7>::variable(0.0, 2 + i);
        let mut net: Net<Dual<7>> = rich();
        let both = v(0) * 3.0 + v(1) * 1e4 + v(2);
        net.half_fibre += both * 0.7;
        net.compliance += both * 1e-5 - v(1) * 2e-3;
        net.depth = v(2) * 0.0 + (v(1) * -1.0 + v(4)) * 0.1;
        net
    }

    #[test]
    fn both_factors_make_the_derivatives() {
        let net = moving();
        let groups = Groups::of(&net);
        assert_eq!(groups.count(), 3);
        let few: Net<Dual<5>> = groups.net(&net);
        let (mut expected, mut found) = (Vec::new(), Vec::new());
        net.each(|_, number| expected.push(number));
        few.each(|_, number| {
            let total =
                Total { value: number.value(), by_contraction: 0.0, by_parameter: *number.gradient() };
            found.push(groups.expand(&total));
        });
        for (expected, found) in expected.iter().zip(&found) {
            assert_eq!(expected.value().to_bits(), found.value.to_bits());
            for (a, b) in expected.gradient().iter().zip(&found.by_parameter) {
                assert!((a - b).abs() <= 1e-12 * a.abs() + 1e-15, "{expected:?} {found:?}");
            }
        }
    }

    #[test]
    fn no_derivatives_no_groups() {
        assert_eq!(Groups::of(&rich::<Dual<6>>()).count(), 0);
    }
}
