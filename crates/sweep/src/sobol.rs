//! Sobol's sequence in up to 16 dimensions. Any point can be computed without the points before it.

/// Bits of a coordinate. A double holds each multiple of 2^-52 below 1 exactly.
const BITS: usize = 52;
/// Most dimensions.
pub(crate) const DIMENSIONS: usize = 16;

/// For each dimension after the first: the inner coefficients of its primitive polynomial as bits, and its
/// first direction numbers, as many as the degree of the polynomial. Source: S. Joe and F. Y. Kuo,
/// Constructing Sobol sequences with better two-dimensional projections, SIAM J. Sci. Comput. 30 (2008) 2635;
/// file `new-joe-kuo-6.21201`.
const POLYNOMIALS: [(u64, &[u64]); DIMENSIONS - 1] = [
    (0, &[1]),
    (1, &[1, 3]),
    (1, &[1, 3, 1]),
    (2, &[1, 1, 1]),
    (1, &[1, 1, 3, 3]),
    (4, &[1, 3, 5, 13]),
    (2, &[1, 1, 5, 5, 17]),
    (4, &[1, 1, 5, 5, 5]),
    (7, &[1, 1, 7, 11, 19]),
    (11, &[1, 1, 5, 1, 1]),
    (13, &[1, 1, 1, 3, 11]),
    (14, &[1, 3, 5, 5, 31]),
    (1, &[1, 3, 3, 9, 7, 49]),
    (13, &[1, 1, 1, 15, 21, 21]),
    (16, &[1, 3, 1, 13, 27, 49]),
];

/// Sobol's sequence in a number of dimensions.
#[derive(Debug, Clone)]
pub(crate) struct Sobol {
    /// For each dimension, the direction numbers v_1, v_2, ... in units of 2^-52.
    directions: Vec<[u64; BITS]>,
}

impl Sobol {
    /// The sequence in the given number of dimensions, at most [`DIMENSIONS`].
    pub(crate) fn new(dimensions: usize) -> Self {
        let first = std::array::from_fn(|bit| 1 << (BITS - 1 - bit));
        let others = POLYNOMIALS.iter().map(|(inner, start)| directions(*inner, start));
        Self { directions: std::iter::once(first).chain(others).take(dimensions).collect() }
    }

    /// The point number `index` in the order of the Gray code (Antonov and Saleev 1979), each coordinate in
    /// \[0, 1). Number 0 is the corner. The points repeat after 2^52.
    pub(crate) fn point(&self, index: u64) -> impl Iterator<Item = f64> {
        let gray = index ^ index >> 1;
        self.directions.iter().map(move |directions| {
            let bits = directions.iter().enumerate();
            let chosen = bits.filter(|(bit, _)| gray >> bit & 1 == 1).fold(0, |sum, (_, v)| sum ^ v);
            chosen as f64 / (1_u64 << BITS) as f64
        })
    }
}

/// The direction numbers of a primitive polynomial of degree s with inner coefficients a_1 ... a_(s-1) (eq. 3
/// of Joe and Kuo, in units of 2^-52):
///
/// ```text
/// v_k = a_1 v_(k-1) xor ... xor a_(s-1) v_(k-s+1) xor v_(k-s) xor v_(k-s)/2^s
/// ```
fn directions(inner: u64, start: &[u64]) -> [u64; BITS] {
    let degree = start.len();
    let mut v = [0; BITS];
    for k in 0..BITS {
        v[k] = if let Some(m) = start.get(k) {
            m << (BITS - 1 - k)
        } else {
            let last = v[k - degree];
            let middle = (1..degree).filter(|i| inner >> (degree - 1 - i) & 1 == 1);
            middle.fold(last ^ last >> degree, |sum, i| sum ^ v[k - i])
        };
    }
    v
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Coordinates in units of 2^-52 from scipy 1.17.1, `scipy.stats.qmc.Sobol(16, scramble=False, bits=52)`,
    /// which uses the same direction numbers in the same order.
    const PINNED: [(u64, [u64; DIMENSIONS]); 3] = [
        (
            6,
            [
                2_814_749_767_106_560,
                562_949_953_421_312,
                3_940_649_673_949_184,
                2_814_749_767_106_560,
                2_814_749_767_106_560,
                3_940_649_673_949_184,
                562_949_953_421_312,
                562_949_953_421_312,
                562_949_953_421_312,
                1_688_849_860_263_936,
                562_949_953_421_312,
                2_814_749_767_106_560,
                562_949_953_421_312,
                3_940_649_673_949_184,
                2_814_749_767_106_560,
                2_814_749_767_106_560,
            ],
        ),
        (
            1000,
            [
                989_560_464_998_400,
                435_406_604_599_296,
                2_335_362_697_396_224,
                3_047_846_232_195_072,
                1_262_239_348_686_848,
                4_085_785_208_815_616,
                206_708_186_021_888,
                4_050_600_836_726_784,
                2_256_197_860_196_352,
                312_261_302_288_384,
                382_630_046_466_048,
                1_147_890_139_398_144,
                725_677_674_332_160,
                1_728_432_278_863_872,
                646_512_837_132_288,
                1_666_859_627_708_416,
            ],
        ),
        (
            1_000_000,
            [
                119_232_587_104_256,
                1_404_759_248_470_016,
                3_728_963_620_831_232,
                3_009_513_649_078_272,
                2_831_229_556_621_312,
                3_580_641_220_231_168,
                4_371_851_505_565_696,
                75_630_079_115_264,
                1_352_953_352_945_664,
                1_145_721_180_913_664,
                2_874_789_114_937_344,
                4_193_644_722_520_064,
                1_230_460_885_663_744,
                2_401_964_755_255_296,
                2_923_313_655_447_552,
                3_225_009_338_187_776,
            ],
        ),
    ];

    #[test]
    fn points_are_those_of_scipy() {
        let sobol = Sobol::new(DIMENSIONS);
        for (index, units) in PINNED {
            let found: Vec<f64> = sobol.point(index).collect();
            let wanted: Vec<f64> = units.iter().map(|unit| *unit as f64 / 2_f64.powi(52)).collect();
            assert_eq!(found, wanted, "{index}");
        }
        assert_eq!(Sobol::new(2).point(3).collect::<Vec<_>>(), [0.25, 0.75]);
        assert!(Sobol::new(3).point(0).eq([0.0; 3]));
    }

    /// Property of every (t, s)-net in base 2: 2^k points from a multiple of 2^k on hit each of the 2^k
    /// layers of each axis once. In the first two dimensions (t = 0) they also hit each elementary box of any
    /// shape once.
    #[test]
    fn points_are_stratified() {
        let sobol = Sobol::new(DIMENSIONS);
        let points: Vec<Vec<f64>> = (256..512).map(|index| sobol.point(index).collect()).collect();
        let count_boxes = |of: &dyn Fn(&[f64]) -> u64| {
            let mut boxes: Vec<u64> = points.iter().map(|point| of(point)).collect();
            boxes.sort_unstable();
            boxes.dedup();
            boxes.len()
        };
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "below 256")]
        let layer = |x: f64, layers: u32| (x * f64::from(layers)) as u64;
        for axis in 0..DIMENSIONS {
            assert_eq!(count_boxes(&|point| layer(point[axis], 256)), 256, "{axis}");
        }
        for bits in 0..=8 {
            let box_of = |point: &[f64]| layer(point[0], 1 << bits) * 256 + layer(point[1], 256 >> bits);
            assert_eq!(count_boxes(&box_of), 256, "{bits}");
        }
    }

    /// Every m in v_k = m 2^-k is odd, so no direction number is a sum of others.
    #[test]
    fn directions_are_independent() {
        for v in &Sobol::new(DIMENSIONS).directions {
            for (bit, direction) in v.iter().enumerate() {
                assert_eq!(direction.trailing_zeros() as usize, BITS - 1 - bit);
            }
        }
    }
}
