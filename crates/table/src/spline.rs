//! Cubic B-splines on equal cells: value and gradient per cell width from the 4^A coefficients of a cell.

/// The four basis functions that are non-zero in a cell and their derivatives, at position t in \[0, 1\] of
/// the cell.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Basis {
    pub(crate) value: [f64; 4],
    pub(crate) slope: [f64; 4],
}

impl Basis {
    /// ```text
    /// (1 - t)^3/6    2/3 - t^2 (1 - t/2)    2/3 - (1 - t)^2 (1 + t)/2    t^3/6
    /// ```
    #[inline]
    pub(crate) fn at(t: f64) -> Self {
        let r = 1.0 - t;
        let (tt, rr) = (t * t, r * r);
        Self {
            value: [
                rr * r * (1.0 / 6.0),
                2.0 / 3.0 - tt * (1.0 - 0.5 * t),
                2.0 / 3.0 - rr * (1.0 - 0.5 * r),
                tt * t * (1.0 / 6.0),
            ],
            slope: [-0.5 * rr, t * (1.5 * t - 2.0), r * (2.0 - 1.5 * r), 0.5 * tt],
        }
    }
}

/// A coefficient: a little-endian number of 4 or 8 bytes.
pub(crate) trait Number {
    const BYTES: usize;
    fn read(bytes: &[u8]) -> f64;
}

/// Single precision.
pub(crate) struct Single;
/// Double precision.
pub(crate) struct Double;

impl Number for Single {
    const BYTES: usize = 4;
    #[inline]
    fn read(bytes: &[u8]) -> f64 {
        bytes.first_chunk().map_or(f64::NAN, |chunk| f64::from(f32::from_le_bytes(*chunk)))
    }
}

impl Number for Double {
    const BYTES: usize = 8;
    #[inline]
    fn read(bytes: &[u8]) -> f64 {
        bytes.first_chunk().map_or(f64::NAN, |chunk| f64::from_le_bytes(*chunk))
    }
}

/// Values of `O` outputs with their derivatives by `A` coordinates.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Graded<const A: usize, const O: usize> {
    pub(crate) value: [f64; O],
    pub(crate) by: [[f64; O]; A],
}

impl<const A: usize, const O: usize> Graded<A, O> {
    pub(crate) const ZERO: Self = Self { value: [0.0; O], by: [[0.0; O]; A] };

    /// Converts derivatives per cell to derivatives per unit of the coordinates.
    pub(crate) fn per_unit(mut self, cells: [f64; A]) -> Self {
        for (by, cells) in self.by.iter_mut().zip(cells) {
            for number in by {
                *number *= cells;
            }
        }
        self
    }
}

/// A spline over `A` axes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Spline<'a, const A: usize> {
    pub(crate) data: &'a [u8],
    /// The first axis of the spline: 1 for an edge, which doesn't depend on axis 0.
    pub(crate) first: usize,
    /// Coefficients along each axis.
    pub(crate) nodes: [usize; A],
}

impl<const A: usize> Spline<'_, A> {
    /// Value and derivatives per cell at a position in a cell, for any number of axes.
    #[inline]
    pub(crate) fn at<N: Number, const O: usize>(
        &self,
        cells: [usize; A],
        basis: &[Basis; A],
    ) -> Graded<A, O> {
        // Bytes from one coefficient to the next along each axis.
        let mut stride = O * N::BYTES;
        let mut strides = [0; A];
        for i in (self.first..A).rev() {
            strides[i] = stride;
            stride *= self.nodes[i];
        }
        let start = (self.first..A).map(|i| cells[i] * strides[i]).sum();
        self.contracted::<N, O>(self.first, start, &strides, basis)
    }

    /// Sum over the axes from `axis` on, starting at the coefficient `start`.
    fn contracted<N: Number, const O: usize>(
        &self,
        axis: usize,
        start: usize,
        strides: &[usize; A],
        basis: &[Basis; A],
    ) -> Graded<A, O> {
        let mut sum = Graded::ZERO;
        if axis == A {
            let bytes = self.data.get(start..start + O * N::BYTES).unwrap_or_default();
            for (value, number) in sum.value.iter_mut().zip(bytes.chunks_exact(N::BYTES)) {
                *value = N::read(number);
            }
            return sum;
        }
        for k in 0..4 {
            let (weight, by) = (basis[axis].value[k], basis[axis].slope[k]);
            let part: Graded<A, O> =
                self.contracted::<N, O>(axis + 1, start + k * strides[axis], strides, basis);
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
