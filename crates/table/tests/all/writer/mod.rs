//! Tables for the tests, written only from the documentation of the format, and their expected values by dual
//! numbers.

#![expect(clippy::unwrap_used, reason = "a test that cannot be set up fails")]

use std::array;
use std::ops::{Add, Mul, Sub};

/// Bytes of the header, of an axis and of an output.
pub(crate) const RECORDS: [usize; 3] = [64, 96, 104];

/// One axis; linear if its pole is infinite.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Axis {
    pub(crate) low: f64,
    pub(crate) high: f64,
    pub(crate) pole: f64,
    pub(crate) nodes: usize,
    pub(crate) edge_nodes: usize,
}

/// A table before it becomes bytes.
#[derive(Debug, Clone)]
pub(crate) struct Draft {
    pub(crate) is_spline: bool,
    pub(crate) is_single: bool,
    pub(crate) is_root: bool,
    pub(crate) axes: Vec<Axis>,
    /// Exponents k and j of each output.
    pub(crate) factors: Vec<[bool; 2]>,
    /// 1/Q and c of a fitted edge at each of its nodes; empty without one.
    pub(crate) edge: Vec<f64>,
    pub(crate) coefficients: Vec<f64>,
    pub(crate) text: &'static str,
}

impl Draft {
    pub(crate) fn is_fitted(&self) -> bool {
        !self.edge.is_empty()
    }

    /// 1/Q of an axis.
    pub(crate) fn scale(&self, i: usize) -> f64 {
        let axis = self.axes[i];
        let width = axis.high - axis.low;
        let s = if i == 0 && self.is_root { width.sqrt() } else { width };
        if axis.pole.is_infinite() { 1.0 / s } else { (s + axis.pole) / s }
    }

    /// Offsets of the edge, the coefficients and the text.
    pub(crate) fn places(&self) -> [usize; 3] {
        let edge = RECORDS[0] + RECORDS[1] * self.axes.len() + RECORDS[2] * self.factors.len();
        let data = edge + 8 * self.edge.len();
        [edge, data, data + if self.is_single { 4 } else { 8 } * self.coefficients.len()]
    }

    pub(crate) fn bytes(&self) -> Vec<u8> {
        let [edge, data, text] = self.places();
        let word = |n: usize| u32::try_from(n).unwrap().to_le_bytes();
        let byte = |n: usize| u8::try_from(n).unwrap();
        let mut bytes = b"BulgeTab".to_vec();
        bytes.extend([1, 0, if self.is_spline { 1 } else { 2 }, if self.is_single { 4 } else { 8 }]);
        bytes.extend([byte(self.axes.len()), byte(self.factors.len()), 0, 0]);
        for place in [text + self.text.len() + 8, data, edge, text] {
            bytes.extend(word(place));
        }
        bytes.extend(1000_u64.to_le_bytes());
        bytes.extend(7_u64.to_le_bytes());
        bytes.extend(word(self.text.len()));
        bytes.extend([u8::from(self.is_root) + 2 * u8::from(self.is_fitted()), 0, 0, 0]);
        bytes.extend(1e-9_f64.to_le_bytes());
        for (i, axis) in self.axes.iter().enumerate() {
            named(&mut bytes, &format!("axis {i}"));
            for number in [axis.low, axis.high, axis.pole, self.scale(i)] {
                bytes.extend(number.to_le_bytes());
            }
            bytes.extend(word(axis.nodes));
            bytes.extend(word(axis.edge_nodes));
            bytes.extend([0; 8]);
        }
        for (o, factors) in self.factors.iter().enumerate() {
            named(&mut bytes, &format!("output {o}"));
            bytes.extend(factors.map(u8::from));
            bytes.extend([0; 6]);
            for number in [1e-6, 2e-6, 3e-6, 4e-6, 5e-6, 6.0_f64] {
                bytes.extend(number.to_le_bytes());
            }
        }
        assert_eq!(bytes.len(), edge);
        bytes.extend(self.edge.iter().flat_map(|number| number.to_le_bytes()));
        for number in &self.coefficients {
            if self.is_single {
                bytes.extend(single(*number).to_le_bytes());
            } else {
                bytes.extend(number.to_le_bytes());
            }
        }
        bytes.extend(self.text.bytes());
        bytes.extend([0; 8]);
        sealed(bytes)
    }

    /// Fills in the coefficients of polynomials in the coordinates, of at most third degree in each: the
    /// outputs, and 1/Q and c.
    pub(crate) fn fill(&mut self, outputs: &[Polynomial], edge: &[Polynomial]) {
        let nodes: Vec<usize> = self.axes.iter().map(|axis| axis.nodes).collect();
        self.coefficients = tensor(self.is_spline, &nodes, 0, outputs);
        let nodes: Vec<usize> = self.axes.iter().map(|axis| axis.edge_nodes).collect();
        self.edge = if edge.is_empty() { Vec::new() } else { tensor(true, &nodes, 1, edge) };
    }

    /// Values and gradients at a point, evaluated directly from the polynomials.
    pub(crate) fn expected(&self, outputs: &[Polynomial], edge: &[Polynomial], point: &[f64]) -> Vec<Dual> {
        let mut at = [Dual::ZERO; 4];
        for i in (0..self.axes.len()).rev() {
            let s = Dual::variable(point[i] - self.axes[i].low, i);
            let s = if i == 0 && self.is_root { s.root() } else { s };
            let pole = self.axes[i].pole;
            at[i] = if i == 0 && self.is_fitted() {
                s * (s + edge[1].at(&at)).inverse() * edge[0].at(&at)
            } else if pole.is_infinite() {
                s * Dual::number(self.scale(i))
            } else {
                s * (s + Dual::number(pole)).inverse() * Dual::number(self.scale(i))
            };
        }
        let u = at[0];
        let factors = self.factors.iter();
        let all = outputs.iter().zip(factors).map(|(output, [is_singular, vanishes])| {
            let mut y = output.at(&at);
            if *vanishes {
                y = y * (Dual::number(1.0) - u);
            }
            if *is_singular { y * u.inverse() } else { y }
        });
        all.collect()
    }
}

/// The number rounded to single precision, as it is stored.
#[expect(clippy::cast_possible_truncation, reason = "what single precision means")]
pub(crate) fn single(number: f64) -> f32 {
    number as f32
}

fn named(bytes: &mut Vec<u8>, name: &str) {
    let mut field = [0; 48];
    field[..name.len()].copy_from_slice(name.as_bytes());
    field[32] = b'1';
    bytes.extend(field);
}

/// Corrects the checksum: CRC-64/XZ bit by bit, by its definition.
pub(crate) fn sealed(mut bytes: Vec<u8>) -> Vec<u8> {
    let body = bytes.len() - 8;
    let mut rest = u64::MAX;
    for byte in &bytes[..body] {
        rest ^= u64::from(*byte);
        for _ in 0..8 {
            rest = if rest & 1 == 1 { rest >> 1 ^ 0xC96C_5795_D787_0F42 } else { rest >> 1 };
        }
    }
    bytes[body..].copy_from_slice(&(!rest).to_le_bytes());
    bytes
}

/// The coefficients over the axes from `first` on, the last one fastest, with all polynomials at each index.
fn tensor(is_spline: bool, nodes: &[usize], first: usize, polynomials: &[Polynomial]) -> Vec<f64> {
    let count: usize = nodes[first..].iter().product();
    let mut all = Vec::new();
    for place in 0..count {
        let (mut rest, mut index) = (place, [0; 4]);
        for i in (first..nodes.len()).rev() {
            index[i] = rest % nodes[i];
            rest /= nodes[i];
        }
        for polynomial in polynomials {
            let part = |term: &(f64, [usize; 4])| {
                let along = (first..nodes.len()).map(|i| {
                    if is_spline {
                        of_spline(nodes[i], index[i], term.1[i])
                    } else {
                        of_chebyshev(index[i], term.1[i])
                    }
                });
                term.0 * along.product::<f64>()
            };
            all.push(polynomial.0.iter().map(part).sum());
        }
    }
    all
}

/// Coefficient `j` of v^p as a spline: its blossom at the three knots inside the B-spline, whose middle is
/// the knot j - 1.
fn of_spline(nodes: usize, j: usize, p: usize) -> f64 {
    let [a, b, c] = [0.0, 1.0, 2.0].map(|k| (j as f64 - 2.0 + k) / (nodes as f64 - 3.0));
    [1.0, (a + b + c) / 3.0, (a * b + b * c + c * a) / 3.0, a * b * c][p]
}

/// Coefficient of `T_j(2 u - 1)` in u^p.
fn of_chebyshev(j: usize, p: usize) -> f64 {
    let rows =
        [[32.0, 0.0, 0.0, 0.0], [16.0, 16.0, 0.0, 0.0], [12.0, 16.0, 4.0, 0.0], [10.0, 15.0, 6.0, 1.0]];
    rows[p].get(j).map_or(0.0, |number| number / 32.0)
}

/// A polynomial in the coordinates: factors with their powers.
#[derive(Debug, Clone)]
pub(crate) struct Polynomial(pub(crate) Vec<(f64, [usize; 4])>);

impl Polynomial {
    /// `terms` terms with powers of the coordinates `first..axes`, and a constant.
    pub(crate) fn random(
        random: &mut Random,
        constant: f64,
        terms: usize,
        [first, axes]: [usize; 2],
    ) -> Self {
        let mut term = |_| {
            let mut powers = [0; 4];
            powers[first..axes].fill_with(|| random.below(4));
            (random.between(-0.15, 0.15), powers)
        };
        let mut all: Vec<_> = (0..terms).map(&mut term).collect();
        all.push((constant, [0; 4]));
        Self(all)
    }

    pub(crate) fn at(&self, coordinates: &[Dual; 4]) -> Dual {
        let part = |(factor, powers): &(f64, [usize; 4])| {
            let all = powers.iter().zip(coordinates).flat_map(|(power, v)| std::iter::repeat_n(*v, *power));
            all.fold(Dual::number(*factor), Mul::mul)
        };
        self.0.iter().map(part).fold(Dual::ZERO, Add::add)
    }
}

/// A number with its derivatives by the axes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Dual {
    pub(crate) value: f64,
    pub(crate) by: [f64; 4],
}

impl Dual {
    pub(crate) const ZERO: Self = Self::number(0.0);

    pub(crate) const fn number(value: f64) -> Self {
        Self { value, by: [0.0; 4] }
    }

    fn variable(value: f64, i: usize) -> Self {
        let mut variable = Self::number(value);
        variable.by[i] = 1.0;
        variable
    }

    fn mapped(self, value: f64, slope: f64) -> Self {
        Self { value, by: self.by.map(|by| slope * by) }
    }

    fn inverse(self) -> Self {
        self.mapped(1.0 / self.value, -1.0 / (self.value * self.value))
    }

    fn root(self) -> Self {
        self.mapped(self.value.sqrt(), 0.5 / self.value.sqrt())
    }
}

impl Add for Dual {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { value: self.value + other.value, by: array::from_fn(|i| self.by[i] + other.by[i]) }
    }
}

impl Sub for Dual {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self { value: self.value - other.value, by: array::from_fn(|i| self.by[i] - other.by[i]) }
    }
}

impl Mul for Dual {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let [first, second] = [self.mapped(0.0, other.value), other.mapped(0.0, self.value)];
        Self { value: self.value * other.value, ..first + second }
    }
}

/// SplitMix64: the same numbers in every run.
#[derive(Debug)]
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ self.0 >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ z >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ z >> 31
    }

    pub(crate) fn below(&mut self, end: usize) -> usize {
        usize::try_from(self.bits() % end as u64).unwrap()
    }

    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// A table of one kind with its contents.
#[derive(Debug)]
pub(crate) struct Known {
    pub(crate) draft: Draft,
    pub(crate) outputs: Vec<Polynomial>,
    pub(crate) edge: Vec<Polynomial>,
}

/// The properties of a table. A fitted edge needs two axes.
#[derive(Debug, Clone, Copy)]
#[expect(clippy::struct_excessive_bools, reason = "all combinations are tested")]
pub(crate) struct Kind {
    pub(crate) axes: usize,
    pub(crate) outputs: usize,
    pub(crate) is_spline: bool,
    pub(crate) is_single: bool,
    pub(crate) is_root: bool,
    pub(crate) is_fitted: bool,
    /// Whether the first outputs have factors.
    pub(crate) has_factors: bool,
}

impl Kind {
    /// All kinds with at most this many axes and outputs.
    pub(crate) fn all(axes: usize, outputs: usize) -> Vec<Self> {
        let mut kinds = Vec::new();
        for axes in 1..=axes {
            for outputs in 1..=outputs {
                for bits in 0..32 {
                    let is = |bit: u32| bits >> bit & 1 == 1;
                    let [is_spline, is_single, is_root, is_fitted, has_factors] = [0, 1, 2, 3, 4].map(is);
                    if axes > 1 || !is_fitted {
                        kinds.push(Self {
                            axes,
                            outputs,
                            is_spline,
                            is_single,
                            is_root,
                            is_fitted,
                            has_factors,
                        });
                    }
                }
            }
        }
        kinds
    }

    /// A table of this kind: known polynomials over random axes.
    pub(crate) fn table(self, random: &mut Random) -> Known {
        let linear = random.below(self.axes + 1);
        let axis = |i| {
            // Only near zero do numbers at tiny distances exist.
            let low = if random.below(2) == 0 { 0.0 } else { random.between(-2.0, 2.0) };
            Axis {
                low,
                high: low + random.between(0.3, 5.0),
                pole: if i == linear { f64::INFINITY } else { random.between(0.2, 3.0) },
                nodes: 4 + random.below(if self.axes > 2 { 2 } else { 5 }),
                edge_nodes: if i > 0 && self.is_fitted { 4 + random.below(3) } else { 0 },
            }
        };
        let axes: Vec<Axis> = (0..self.axes).map(axis).collect();
        let over = [0, self.axes];
        let outputs: Vec<_> = (0..self.outputs).map(|_| Polynomial::random(random, 1.0, 4, over)).collect();
        let edge = if self.is_fitted {
            [1.9, 1.3].map(|constant| Polynomial::random(random, constant, 3, [1, self.axes])).to_vec()
        } else {
            Vec::new()
        };
        let factors = [[true, true], [false, false], [true, false], [false, true]];
        let mut draft = Draft {
            is_spline: self.is_spline,
            is_single: self.is_single,
            is_root: self.is_root,
            axes,
            factors: (0..self.outputs).map(|o| factors[o % 4].map(|has| has && self.has_factors)).collect(),
            edge: Vec::new(),
            coefficients: Vec::new(),
            text: "{\"muscle\": \"of a test\"}",
        };
        draft.fill(&outputs, &edge);
        Known { draft, outputs, edge }
    }
}
