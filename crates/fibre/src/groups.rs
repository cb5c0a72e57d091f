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

use arrayvec::ArrayVec;
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
        let mut found =
            Self { numbers: [[0.0; N]; NUMBERS], size: [1.0; NUMBERS], variables: [[0.0; N]; N], count: 0 };
        // The rows of the numbers that move, relative to the number, so that a small one is not lost beside a
        // larger one.
        let mut rows: ArrayVec<(usize, [f64; N]), NUMBERS> = ArrayVec::new();
        net.each(|row, number| {
            if number.gradient().iter().any(|slope| *slope != 0.0) {
                let size = if number.value() == 0.0 { 1.0 } else { number.value().abs() };
                found.size[row] = size;
                rows.push((row, number.gradient().map(|slope| slope / size)));
            }
        });
        let norms = |rows: &[(usize, [f64; N])]| {
            let mut sums = [0.0; N];
            for (_, row) in rows {
                sums.iter_mut().zip(row).for_each(|(sum, value)| *sum += value * value);
            }
            sums.map(f64::sqrt)
        };
        let whole = norms(&rows);
        while found.count < N {
            let left = norms(&rows);
            let share = |i: usize| if whole[i] > 0.0 { left[i] / whole[i] } else { 0.0 };
            let Some(pivot) = (2..N).max_by(|a, b| share(*a).total_cmp(&share(*b))) else { break };
            if share(pivot) < REST {
                break;
            }
            let k = found.count;
            for (row, slopes) in &rows {
                found.numbers[*row][k] = slopes[pivot] / left[pivot];
            }
            let mut along = [0.0; N];
            for (row, slopes) in &rows {
                let direction = found.numbers[*row][k];
                along.iter_mut().zip(slopes).skip(2).for_each(|(sum, slope)| *sum += slope * direction);
            }
            for (row, slopes) in &mut rows {
                let direction = &mut found.numbers[*row][k];
                slopes.iter_mut().zip(along).for_each(|(slope, along)| *slope -= along * *direction);
                *direction *= found.size[*row];
            }
            found.variables[k] = along;
            found.count += 1;
        }
        found
    }

    /// How many groups there are.
    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// The net with the groups from `first` on as the variables 2 .., as many as there is room for.
    pub(crate) fn net<const M: usize>(&self, net: &Net<Dual<N>>, first: usize) -> Net<Dual<M>> {
        net.map(|row, number| {
            let slopes = &self.numbers[row];
            let slope =
                |i: usize| if i < 2 { 0.0 } else { slopes.get(first + i - 2).copied().unwrap_or(0.0) };
            Dual::new(number.value(), std::array::from_fn(slope))
        })
    }

    /// The derivatives by the numbers of the net along the directions of the groups, from the derivatives by
    /// the groups. Across these directions they are zero.
    pub(crate) fn by_number<const M: usize>(&self, by_group: &Total<M>, first: usize) -> [f64; OWN_NUMBERS] {
        std::array::from_fn(|row| {
            let slopes = self.numbers[row].iter().take(self.count).skip(first);
            let pairs = slopes.zip(by_group.by_parameter.iter().skip(2));
            pairs.map(|(slope, by)| slope * by).sum::<f64>() / (self.size[row] * self.size[row])
        })
    }

    /// The derivatives by the variables from those by the groups from `first` on.
    pub(crate) fn expand<const M: usize>(&self, by_group: &Total<M>, first: usize) -> Total<N> {
        let along = |i: usize| {
            let pairs = self.variables.iter().skip(first).zip(by_group.by_parameter.iter().skip(2));
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
        let few: Net<Dual<5>> = groups.net(&net, 0);
        let (mut expected, mut found) = (Vec::new(), Vec::new());
        net.each(|_, number| expected.push(number));
        few.each(|_, number| {
            let total =
                Total { value: number.value(), by_contraction: 0.0, by_parameter: *number.gradient() };
            found.push(groups.expand(&total, 0));
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
