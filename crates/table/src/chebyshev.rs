//! Tensor products of Chebyshev polynomials over the whole domain.

use crate::spline::{Graded, Number};

/// Most orders along an axis; their values fit on a small stack.
pub const MOST_ORDERS: usize = 96;

/// T_i(2u - 1) of the first orders and their derivatives by u.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Basis {
    value: [f64; MOST_ORDERS],
    slope: [f64; MOST_ORDERS],
}

impl Basis {
    /// Evaluates the recurrence T_{i+1} = 2 x T_i - T_{i-1} and its derivative.
    pub(crate) fn at(u: f64, orders: usize) -> Self {
        let x = 2.0 * u - 1.0;
        let mut basis = Self { value: [0.0; MOST_ORDERS], slope: [0.0; MOST_ORDERS] };
        let orders = orders.min(MOST_ORDERS);
        let (mut before, mut now) = ([1.0, 0.0], [x, 2.0]);
        for i in 0..orders {
            [basis.value[i], basis.slope[i]] = before;
            let next = [2.0 * x * now[0] - before[0], 2.0 * x * now[1] - before[1] + 4.0 * now[0]];
            (before, now) = (now, next);
        }
        basis
    }
}

/// A polynomial over `A` axes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Polynomial<'a, const A: usize> {
    pub(crate) data: &'a [u8],
    /// Orders along each axis.
    pub(crate) orders: [usize; A],
}

impl<const A: usize> Polynomial<'_, A> {
    /// Value and derivatives by the coordinates.
    pub(crate) fn at<N: Number, const O: usize>(&self, coordinates: [f64; A]) -> Graded<A, O> {
        let mut basis = [Basis::at(0.0, 0); A];
        for (basis, (u, orders)) in basis.iter_mut().zip(coordinates.into_iter().zip(self.orders)) {
            *basis = Basis::at(u, orders);
        }
        self.contracted::<N, O>(0, 0, &basis)
    }

    /// Sum over the axes from `axis` on. `block` is the number of the block of coefficients, counted over the
    /// orders of the axes before.
    fn contracted<N: Number, const O: usize>(
        &self,
        axis: usize,
        block: usize,
        basis: &[Basis; A],
    ) -> Graded<A, O> {
        let mut sum = Graded::ZERO;
        let orders = self.orders[axis];
        if axis + 1 == A {
            let each = O * N::BYTES;
            let row = self.data.get(block * orders * each..(block + 1) * orders * each).unwrap_or_default();
            let weights = basis[axis].value.iter().zip(&basis[axis].slope);
            for (numbers, (weight, by)) in row.chunks_exact(each).zip(weights) {
                for (o, number) in numbers.chunks_exact(N::BYTES).enumerate() {
                    let coefficient = N::read(number);
                    sum.value[o] += weight * coefficient;
                    sum.by[axis][o] += by * coefficient;
                }
            }
            return sum;
        }
        for order in 0..orders {
            let part: Graded<A, O> = self.contracted::<N, O>(axis + 1, block * orders + order, basis);
            let (weight, by) = (basis[axis].value[order], basis[axis].slope[order]);
            for o in 0..O {
                sum.value[o] += weight * part.value[o];
                sum.by[axis][o] += by * part.value[o];
                for later in axis + 1..A {
                    sum.by[later][o] += weight * part.by[later][o];
                }
            }
        }
        sum
    }
}
