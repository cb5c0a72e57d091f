//! Cubic Hermite splines on equal cells: value and gradient per cell width from 2^A derivatives at the 2^A corners.

/// The four basis functions at t in \[0, 1\] (value and slope at 0, value and slope at 1), and their derivatives.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Basis {
    pub(crate) value: [f64; 4],
    pub(crate) slope: [f64; 4],
}

impl Basis {
    /// ```text
    /// H0 = (1 + 2t)(1 - t)^2    G0 = t (1 - t)^2    H1 = t^2 (3 - 2t)    G1 = -t^2 (1 - t)
    /// ```
    #[inline]
    pub(crate) fn at(t: f64) -> Self {
        let r = 1.0 - t;
        let (tt, rr, tr) = (t * t, r * r, t * r);
        let bend = 6.0 * tr;
        Self {
            value: [(1.0 + 2.0 * t) * rr, t * rr, tt * (3.0 - 2.0 * t), -tt * r],
            slope: [-bend, rr - 2.0 * tr, bend, tt - 2.0 * tr],
        }
    }
}

/// Coefficients of a node: little-endian numbers of 4 or 8 bytes.
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

/// `O` outputs with derivatives by `A` coordinates.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Graded<const A: usize, const O: usize> {
    pub(crate) value: [f64; O],
    pub(crate) by: [[f64; O]; A],
}

impl<const A: usize, const O: usize> Graded<A, O> {
    pub(crate) const ZERO: Self = Self { value: [0.0; O], by: [[0.0; O]; A] };
}

/// A spline over `A` axes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Spline<'a, const A: usize> {
    pub(crate) data: &'a [u8],
    /// The first axis that it has: 1 for an edge, which doesn't depend on axis 0.
    pub(crate) first: usize,
    /// Nodes along each axis.
    pub(crate) nodes: [usize; A],
}

impl<const A: usize> Spline<'_, A> {
    /// Value and derivatives per cell at places in a cell, for any number of axes.
    #[inline]
    pub(crate) fn at<N: Number, const O: usize>(
        &self,
        cells: [usize; A],
        basis: &[Basis; A],
    ) -> Graded<A, O> {
        // Bytes from a node to the next along each axis.
        let mut stride = (O * N::BYTES) << (A - self.first);
        let mut strides = [0; A];
        for i in (self.first..A).rev() {
            strides[i] = stride;
            stride *= self.nodes[i];
        }
        let start = (self.first..A).map(|i| cells[i] * strides[i]).sum();
        self.contracted::<N, O>(self.first, start, 0, &strides, basis)
    }

    /// The sum over the axes from `axis` on, from the node at `start` and the derivative bits `which` of the axes before.
    fn contracted<N: Number, const O: usize>(
        &self,
        axis: usize,
        start: usize,
        which: usize,
        strides: &[usize; A],
        basis: &[Basis; A],
    ) -> Graded<A, O> {
        let mut sum = Graded::ZERO;
        if axis == A {
            let from = start + which * O * N::BYTES;
            let bytes = self.data.get(from..from + O * N::BYTES).unwrap_or_default();
            for (value, number) in sum.value.iter_mut().zip(bytes.chunks_exact(N::BYTES)) {
                *value = N::read(number);
            }
            return sum;
        }
        for corner in 0..2 {
            for slope in 0..2 {
                let weight = basis[axis].value[2 * corner + slope];
                let by = basis[axis].slope[2 * corner + slope];
                let next = start + corner * strides[axis];
                let part: Graded<A, O> =
                    self.contracted::<N, O>(axis + 1, next, 2 * which + slope, strides, basis);
                for o in 0..O {
                    sum.value[o] += weight * part.value[o];
                    sum.by[axis][o] += by * part.value[o];
                    for later in axis + 1..A {
                        sum.by[later][o] += weight * part.by[later][o];
                    }
                }
            }
        }
        sum
    }
}

impl Spline<'_, 2> {
    /// The same for two axes, unrolled: along the second axis first, for the value and the slope at both sides of the cell.
    #[inline]
    pub(crate) fn in_plane<N: Number, const O: usize>(
        &self,
        cells: [usize; 2],
        [across, along]: &[Basis; 2],
    ) -> Option<Graded<2, O>> {
        let node = 4 * O * N::BYTES;
        let row = node * self.nodes[1];
        let mut found = Graded::<2, O>::ZERO;
        for side in 0..2 {
            let start = (cells[0] + side) * row + cells[1] * node;
            let both = self.data.get(start..start + 2 * node)?;
            for slope in 0..2 {
                let number = |corner: usize, by: usize, o: usize| {
                    N::read(&both[corner * node + ((2 * slope + by) * O + o) * N::BYTES..])
                };
                let (weight, steep) = (across.value[2 * side + slope], across.slope[2 * side + slope]);
                for o in 0..O {
                    let knots = [number(0, 0, o), number(0, 1, o), number(1, 0, o), number(1, 1, o)];
                    let value = dot(along.value, knots);
                    let by = dot(along.slope, knots);
                    found.value[o] += weight * value;
                    found.by[0][o] += steep * value;
                    found.by[1][o] += weight * by;
                }
            }
        }
        Some(found)
    }
}

/// Two numbers along the axis 1 of two, in double precision: what an edge is there.
#[inline]
pub(crate) fn on_line<const A: usize>(data: &[u8], cell: usize, basis: &Basis) -> Option<Graded<A, 2>> {
    let both: &[u8; 64] = data.get(32 * cell..)?.first_chunk()?;
    let mut found = Graded::ZERO;
    for o in 0..2 {
        let number = |i: usize| Double::read(&both[16 * i + 8 * o..]);
        let knots = [number(0), number(1), number(2), number(3)];
        found.value[o] = dot(basis.value, knots);
        found.by[1][o] = dot(basis.slope, knots);
    }
    Some(found)
}

#[inline]
fn dot(a: [f64; 4], b: [f64; 4]) -> f64 {
    (a[0] * b[0] + a[1] * b[1]) + (a[2] * b[2] + a[3] * b[3])
}
