//! Lookups against known polynomials through all coordinates, at the borders of cells and at the ends of the
//! domain.

#![expect(clippy::unwrap_used, reason = "a test that cannot be set up fails")]

use crate::writer::{Axis, Draft, Dual, Kind, Polynomial, Random, single};
use bulge_table::{Form, Lookup, Sample, Table, TableError};

const PPAM: &[u8] = include_bytes!("../../examples/data/ppam.table");

/// Values, then gradients.
fn sample(table: &Table<'_>, point: &[f64]) -> Option<[Vec<f64>; 2]> {
    let mut all = [vec![f64::NAN; table.outputs()], vec![f64::NAN; table.outputs() * table.axes()]];
    let [values, gradients] = &mut all;
    table.sample(point, values, gradients)?;
    Some(all)
}

/// A point at the given fractions of the domain.
fn point_at(table: &Table<'_>, fractions: &[f64]) -> Vec<f64> {
    let mut point: Vec<f64> = (0..table.axes())
        .map(|i| {
            let axis = table.axis(i).unwrap();
            (axis.low + fractions[i] * (axis.high - axis.low)).clamp(axis.low, axis.high)
        })
        .collect();
    let (low, high) = (table.axis(0).unwrap().low, table.upper_end(&point).unwrap());
    point[0] = (low + fractions[0] * (high - low)).min(high);
    point
}

/// Axes from 0 to 1 with linear coordinates, and one output.
fn unit_draft(is_spline: bool, nodes: &[usize]) -> Draft {
    let axis =
        |nodes: &usize| Axis { low: 0.0, high: 1.0, pole: f64::INFINITY, nodes: *nodes, edge_nodes: 0 };
    Draft {
        is_spline,
        is_single: false,
        is_root: false,
        axes: nodes.iter().map(axis).collect(),
        factors: vec![[false; 2]],
        edge: Vec::new(),
        coefficients: Vec::new(),
        text: "",
    }
}

/// Every kind of table reproduces the polynomials it was written from, and their gradients through
/// coordinates, edge and factors.
#[test]
fn known_polynomials_are_exact() {
    let mut random = Random(1);
    let mut worst = [0.0_f64; 2];
    for kind in Kind::all(4, 8) {
        let known = kind.table(&mut random);
        let bytes = known.draft.bytes();
        let table = Table::from_bytes(&bytes).unwrap();
        for _ in 0..6 {
            let fractions: Vec<f64> = (0..4).map(|_| random.between(0.02, 0.98)).collect();
            let point = point_at(&table, &fractions);
            let [values, gradients] = sample(&table, &point).unwrap();
            let expected = known.draft.expected(&known.outputs, &known.edge, &point);
            for (o, expected) in expected.iter().enumerate() {
                let slopes = expected.by[..kind.axes].iter();
                let scale = 1.0 + slopes.clone().fold(expected.value.abs(), |most, by| most.max(by.abs()));
                let found = gradients[o * kind.axes..].iter();
                let off = slopes.zip(found).map(|(by, found)| (by - found).abs());
                let off = off.fold((values[o] - expected.value).abs(), f64::max) / scale;
                let worst = &mut worst[usize::from(kind.is_single)];
                *worst = worst.max(off);
            }
        }
    }
    println!("largest errors: {:.1e} in double, {:.1e} in single precision", worst[0], worst[1]);
    assert!(worst[0] < 1e-13 && worst[1] < 2e-6, "{worst:?}");
}

/// A cubic, its cells and its derivative, with the identity as coordinate.
#[test]
fn a_cubic_is_a_cubic() {
    let cubic = [Polynomial(vec![(2.0, [3, 0, 0, 0]), (-1.0, [1, 0, 0, 0]), (0.5, [0; 4])])];
    for is_spline in [true, false] {
        for nodes in [4, 5, 9, 64] {
            let mut draft = unit_draft(is_spline, &[nodes]);
            draft.fill(&cubic, &[]);
            let bytes = draft.bytes();
            let lookup = Table::from_bytes(&bytes).unwrap().lookup::<1, 1>().unwrap();
            for k in 0..=1000 {
                let x = f64::from(k) / 1000.0;
                let [found] = lookup.at([x]).unwrap();
                assert!((found.value - (2.0 * x.powi(3) - x + 0.5)).abs() < 1e-14, "{x}");
                assert!((found.gradient[0] - (6.0 * x * x - 1.0)).abs() < 1e-13 * nodes as f64, "{x}");
            }
        }
    }
}

/// The spline at v along one axis by de Boor's algorithm on its local knots -2, -1, .. 3, with its derivative.
fn de_boor(coefficients: &[Dual], v: f64) -> [Dual; 2] {
    let cells = coefficients.len() - 3;
    let along = v * cells as f64;
    let cell = (0..cells).rev().find(|cell| *cell as f64 <= along).unwrap();
    let t = along - cell as f64;
    let mut d: Vec<Dual> = coefficients[cell..cell + 4].to_vec();
    let mut slope = Dual::ZERO;
    for r in 1..=3 {
        if r == 3 {
            slope = (d[1] - d[0]) * Dual::number(3.0 * cells as f64);
        }
        for j in 0..=3 - r {
            // Knots of the interval of this combination: from j + r - 3 to j + 1.
            let part = (t - (j + r) as f64 + 3.0) / (4 - r) as f64;
            d[j] = d[j] * Dual::number(1.0 - part) + d[j + 1] * Dual::number(part);
        }
    }
    [d[0], slope]
}

/// The unrolled path of two axes and the general one against de Boor's algorithm, for random coefficients.
#[test]
fn splines_agree_with_de_boor() {
    let mut random = Random(2);
    for (nodes, outputs, is_single) in
        [([4, 4], 1, false), ([9, 6], 2, true), ([5, 12], 3, false), ([81, 69], 2, true), ([7, 4], 8, true)]
    {
        let mut draft = unit_draft(true, &nodes);
        draft.is_single = is_single;
        draft.factors = vec![[false; 2]; outputs];
        draft.coefficients = (0..nodes[0] * nodes[1] * outputs).map(|_| random.between(-1.0, 1.0)).collect();
        let stored = |at: usize| {
            let number = draft.coefficients[at];
            Dual::number(if is_single { f64::from(single(number)) } else { number })
        };
        let bytes = draft.bytes();
        let table = Table::from_bytes(&bytes).unwrap();
        for k in 0..300 {
            let mut v = [random.between(0.0, 1.0), random.between(0.0, 1.0)];
            if k < 4 {
                v = [f64::from(k & 1), f64::from(k >> 1)];
            }
            let [values, gradients] = sample(&table, &v).unwrap();
            for o in 0..outputs {
                let row = |i: usize| -> Vec<Dual> {
                    (0..nodes[1]).map(|j| stored((i * nodes[1] + j) * outputs + o)).collect()
                };
                let rows: Vec<[Dual; 2]> = (0..nodes[0]).map(|i| de_boor(&row(i), v[1])).collect();
                let part = |p: usize| de_boor(&rows.iter().map(|row| row[p]).collect::<Vec<_>>(), v[0]);
                let ([value, by_0], [by_1, _]) = (part(0), part(1));
                assert!((values[o] - value.value).abs() < 1e-14);
                assert!((gradients[2 * o] - by_0.value).abs() < 2e-14 * nodes[0] as f64);
                assert!((gradients[2 * o + 1] - by_1.value).abs() < 2e-14 * nodes[1] as f64);
            }
        }
    }
}

/// T_i(cos x) = cos(i x), up to the highest order.
#[test]
fn chebyshev_polynomials_are_cosines() {
    let mut random = Random(3);
    for nodes in [[1, 1], [2, 7], [25, 16], [96, 96]] {
        let mut draft = unit_draft(false, &nodes);
        draft.coefficients = (0..nodes[0] * nodes[1]).map(|_| random.between(-1.0, 1.0)).collect();
        let bytes = draft.bytes();
        let lookup = Table::from_bytes(&bytes).unwrap().lookup::<2, 1>().unwrap();
        for _ in 0..100 {
            let angles = [0, 1].map(|_| random.between(0.1, 3.0));
            let (mut value, mut by, mut most) = (0.0, [0.0; 2], 1.0);
            for (at, coefficient) in draft.coefficients.iter().enumerate() {
                let order = [at / nodes[1], at % nodes[1]].map(|order| order as f64);
                let wave = |i: usize| (order[i] * angles[i]).cos();
                let slope = |i: usize| 2.0 * order[i] * (order[i] * angles[i]).sin() / angles[i].sin();
                value += coefficient * wave(0) * wave(1);
                by[0] += coefficient * slope(0) * wave(1);
                by[1] += coefficient * wave(0) * slope(1);
                most += coefficient.abs();
            }
            let [found] = lookup.at(angles.map(|angle| f64::midpoint(1.0, angle.cos()))).unwrap();
            assert!((found.value - value).abs() < 1e-12 * most);
            for (found, by) in found.gradient.iter().zip(by) {
                assert!((found - by).abs() < 1e-10 * most, "{found} {by}");
            }
        }
    }
}

/// Gradients against finite differences, for every kind of table and for the table of the pleated muscle.
#[test]
fn gradients_are_those_of_the_values() {
    let mut random = Random(4);
    let tables = Kind::all(4, 4).into_iter().filter(|kind| kind.outputs == 4);
    let all: Vec<Vec<u8>> = tables.map(|kind| kind.table(&mut random).draft.bytes()).collect();
    for bytes in all.iter().map(Vec::as_slice).chain([PPAM]) {
        let table = Table::from_bytes(bytes).unwrap();
        let axes = table.axes();
        for _ in 0..20 {
            let fractions: Vec<f64> = (0..4).map(|_| random.between(0.2, 0.8)).collect();
            let point = point_at(&table, &fractions);
            let [_, gradients] = sample(&table, &point).unwrap();
            for i in 0..axes {
                let width = table.axis(i).unwrap().high - table.axis(i).unwrap().low;
                let moved = |h: f64| {
                    let mut point = point.clone();
                    point[i] += h * width;
                    let [values, _] = sample(&table, &point).unwrap();
                    values
                };
                let h = 1e-4;
                let near = [moved(-h), moved(h), moved(-2.0 * h), moved(2.0 * h)];
                for o in 0..table.outputs() {
                    let [a, b, c, d] = [0, 1, 2, 3].map(|k: usize| near[k][o]);
                    let by = (8.0 * (b - a) - (d - c)) / (12.0 * h * width);
                    let found = gradients[o * axes + i];
                    assert!((found - by).abs() < 1e-7 * (a.abs() + 1.0) / width, "{found} {by}");
                }
            }
        }
    }
}

/// Value and gradient are continuous across the borders of cells, for random coefficients.
#[test]
fn splines_are_smooth_across_borders() {
    let mut random = Random(5);
    for pole in [f64::INFINITY, 0.4] {
        let mut draft = unit_draft(true, &[11, 8]);
        draft.axes[0].pole = pole;
        draft.axes[1].pole = pole;
        draft.coefficients = (0..88).map(|_| random.between(-1.0, 1.0)).collect();
        let bytes = draft.bytes();
        let lookup = Table::from_bytes(&bytes).unwrap().lookup::<2, 1>().unwrap();
        let border = |k: usize, cells: usize, scale: f64| {
            let q = k as f64 / cells as f64 / scale;
            if pole.is_infinite() { q } else { pole * q / (1.0 - q) }
        };
        for (axis, cells) in [(0, 8), (1, 5)] {
            for k in 1..cells {
                let mut point = [random.between(0.0, 1.0), random.between(0.0, 1.0)];
                let at = border(k, cells, draft.scale(axis));
                let mut side = |x: f64| {
                    point[axis] = x;
                    lookup.at(point).unwrap()[0]
                };
                let [below, above] = [side(at * (1.0 - 1e-14)), side(at * (1.0 + 1e-14))];
                assert!((below.value - above.value).abs() < 1e-12);
                for i in 0..2 {
                    assert!((below.gradient[i] - above.gradient[i]).abs() < 1e-10);
                }
            }
        }
    }
}

/// Both ends are inside, except a lower end where an output or the derivative of the root is infinite; the
/// next number is outside.
#[test]
fn the_ends_are_inside() {
    let mut random = Random(6);
    let mut refused = 0;
    for kind in Kind::all(4, 3).repeat(20) {
        let bytes = kind.table(&mut random).draft.bytes();
        let table = Table::from_bytes(&bytes).unwrap();
        let fractions: Vec<f64> = (0..4).map(|_| random.between(0.1, 0.9)).collect();
        let inside = point_at(&table, &fractions);
        if !kind.is_fitted {
            assert_eq!(table.upper_end(&inside), Some(table.axis(0).unwrap().high));
        }
        let is_inside = |i: usize, x: f64| {
            let mut point = inside.clone();
            point[i] = x;
            // The upper end depends on the other axes.
            if let (true, Some(end)) = (i > 0, table.upper_end(&point)) {
                let low = table.axis(0).unwrap().low;
                point[0] = low + 0.5 * (end - low);
            }
            let found = sample(&table, &point);
            assert!(found.iter().flatten().flatten().all(|number| number.is_finite()), "{kind:?} {point:?}");
            found.is_some()
        };
        for i in 0..kind.axes {
            let axis = table.axis(i).unwrap();
            let is_open = i == 0 && (kind.is_root || kind.has_factors);
            assert_eq!(is_inside(i, axis.low), !is_open, "{kind:?}");
            assert!(!is_inside(i, axis.low.next_down()));
            if i == 0 && kind.is_fitted {
                let end = table.upper_end(&inside).unwrap();
                // The end is subject to rounding: a few units in the last place of the distance.
                let tolerance = 1e-14 * (end - axis.low).max(end.abs());
                assert!(is_inside(0, end - tolerance) && !is_inside(0, end + 10.0 * tolerance));
                refused += usize::from(!is_inside(0, end));
            } else {
                assert!(is_inside(i, axis.high), "{kind:?}");
                assert!(!is_inside(i, axis.high.next_up()));
            }
            for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX, f64::MIN] {
                assert!(!is_inside(i, x));
            }
        }
    }
    assert_eq!(refused, 0, "times a table's own upper end was outside");
}

/// Zero and minus zero are the same end.
#[test]
fn the_sign_of_zero_is_no_matter() {
    let mut draft = unit_draft(true, &[5, 5]);
    draft.coefficients = (0..25).map(f64::from).collect();
    let bytes = draft.bytes();
    let lookup = Table::from_bytes(&bytes).unwrap().lookup::<2, 1>().unwrap();
    assert_eq!(lookup.at([0.0, 0.0]), lookup.at([-0.0, -0.0]));
    assert!(lookup.at([f64::MIN_POSITIVE / 4.0, 0.0]).is_some());
    assert!(lookup.at([-f64::MIN_POSITIVE / 4.0, 0.0]).is_none());
}

fn bits(numbers: &[f64]) -> Vec<u64> {
    numbers.iter().map(|number| number.to_bits()).collect()
}

fn both_agree<const A: usize, const O: usize>(random: &mut Random) {
    for kind in Kind::all(A, O).into_iter().filter(|kind| (kind.axes, kind.outputs) == (A, O)) {
        let bytes = kind.table(random).draft.bytes();
        let table = Table::from_bytes(&bytes).unwrap();
        let lookup = table.lookup::<A, O>().unwrap();
        for _ in 0..5 {
            let fractions: Vec<f64> = (0..4).map(|_| random.between(-0.05, 1.05)).collect();
            let point: [f64; A] = std::array::from_fn(|i| {
                let axis = table.axis(i).unwrap();
                axis.low + fractions[i] * (axis.high - axis.low)
            });
            let found = sample(&table, &point);
            assert_eq!(lookup.at(point).is_some(), found.is_some());
            assert_eq!(lookup.upper_end(point), table.upper_end(&point));
            for (all, [values, gradients]) in lookup.at(point).iter().zip(found) {
                for (o, sample) in all.iter().enumerate() {
                    assert_eq!(sample.value.to_bits(), values[o].to_bits());
                    assert_eq!(sample.gradient.map(f64::to_bits)[..], *bits(&gradients[o * A..][..A]));
                }
            }
        }
        curve_agrees(&lookup, &table, random);
        each_agrees(&lookup, &table, random);
        let shape = TableError::Shape { axes: A, outputs: O };
        assert!(table.lookup::<5, 1>().is_err_and(|error| error == shape));
        assert!(table.lookup::<A, 9>().is_err_and(|error| error == shape));
        let (mut values, mut gradients) = (vec![0.0; O + 1], vec![0.0; O * A]);
        let point = point_at(&table, &[0.5; 4]);
        assert!(table.sample(&point, &mut values, &mut gradients).is_none());
        assert!(table.sample(&point, &mut values[..O], &mut gradients[1..]).is_none());
        assert!(table.sample(&point[1..], &mut values[..O], &mut gradients).is_none());
        assert!(table.upper_end(&point[1..]).is_none());
        assert!(table.sample(&point, &mut values[..O], &mut gradients).is_some());
        assert!(table.axis(A).is_none() && table.output(O).is_none());
    }
}

/// Many points at once give the same as the points one by one, whatever their number and neighbours, and
/// nothing is written beyond them.
fn each_agrees<const A: usize, const O: usize>(
    lookup: &Lookup<'_, A, O>,
    table: &Table<'_>,
    random: &mut Random,
) {
    let odd = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX, f64::MIN, -0.0, 0.0];
    for count in [0, 1, 2, 3, 31, 32, 33, 70] {
        let points: Vec<[f64; A]> = (0..count)
            .map(|i| {
                let mut point: [f64; A] = std::array::from_fn(|k| {
                    let axis = table.axis(k).unwrap();
                    axis.low + random.between(-0.05, 1.05) * (axis.high - axis.low)
                });
                if i % 5 == 1 {
                    point[i % A] = odd[i / 5 % odd.len()];
                }
                point
            })
            .collect();
        let untouched = Some([Sample { value: 7.0, gradient: [7.0; A] }; O]);
        let mut found = vec![untouched; count + 2];
        lookup.at_each(&points, &mut found);
        for (point, found) in points.iter().zip(&found) {
            let of = |all: Option<[Sample<A>; O]>| {
                all.map(|all| all.map(|s| (s.value.to_bits(), s.gradient.map(f64::to_bits))))
            };
            assert_eq!(of(lookup.at(*point)), of(*found), "{point:?}");
        }
        assert!(found[count..].iter().all(|found| *found == untouched));
        let mut short = vec![None; count / 2];
        lookup.at_each(&points, &mut short);
        assert_eq!(short, found[..count / 2]);
    }
}

/// A curve is the lookup with the other axes fixed, inside and outside.
fn curve_agrees<const A: usize, const O: usize>(
    lookup: &Lookup<'_, A, O>,
    table: &Table<'_>,
    random: &mut Random,
) {
    let fractions: Vec<f64> = (0..A).map(|_| random.between(0.1, 0.9)).collect();
    let point: [f64; A] = *point_at(table, &fractions).first_chunk().unwrap();
    let Some(curve) = lookup.curve::<16>(point) else {
        return assert!(table.form() == Form::Chebyshev);
    };
    assert!(lookup.curve::<3>(point).is_none(), "more coefficients than fit");
    let axis = table.axis(0).unwrap();
    for _ in 0..9 {
        let mut there = point;
        there[0] = axis.low + random.between(-0.1, 1.1) * (axis.high - axis.low);
        let (exact, found) = (lookup.at(there), curve.at(there[0]));
        assert_eq!(exact.is_some(), found.is_some(), "{there:?}");
        for (a, b) in exact.iter().flatten().zip(found.iter().flatten()) {
            let size = a.gradient.iter().fold(a.value.abs(), |size, by| size.max(by.abs()));
            assert!((a.value - b.value).abs() <= 1e-12 * size);
            for (a, b) in a.gradient.iter().zip(b.gradient) {
                assert!((a - b).abs() <= 1e-11 * size, "{there:?}: {a} {b}");
            }
        }
    }
    let mut outside = point;
    if A > 1 {
        outside[A - 1] = table.axis(A - 1).unwrap().high * 1.5 + 1.0;
        assert!(lookup.curve::<16>(outside).is_none());
    }
}

#[test]
fn both_ways_of_asking_give_the_same() {
    let mut random = Random(7);
    macro_rules! all {
        ($($axes:literal)*) => {$(
            both_agree::<$axes, 1>(&mut random);
            both_agree::<$axes, 2>(&mut random);
            both_agree::<$axes, 3>(&mut random);
            both_agree::<$axes, 8>(&mut random);
        )*};
    }
    all!(1 2 3 4);
}

/// The header and the records are read back.
#[test]
fn the_records_are_read() {
    let mut random = Random(8);
    for kind in Kind::all(4, 8) {
        let draft = kind.table(&mut random).draft;
        let bytes = draft.bytes();
        let table = Table::from_bytes(&bytes).unwrap();
        assert_eq!([table.axes(), table.outputs()], [kind.axes, kind.outputs]);
        assert_eq!(table.precision(), if kind.is_single { 4 } else { 8 });
        assert_eq!([table.is_root(), table.is_fitted()], [kind.is_root, kind.is_fitted]);
        assert_eq!(table.form().code(), if kind.is_spline { 1 } else { 2 });
        assert_eq!((table.checks(), table.edge_error().to_bits()), ([1000, 7], 1e-9_f64.to_bits()));
        assert_eq!((table.text(), table.bytes()), (draft.text, bytes.as_slice()));
        let [edge, data, text] = draft.places();
        assert_eq!(table.coefficients(), [&bytes[edge..data], &bytes[data..text]]);
        for (i, axis) in draft.axes.iter().enumerate() {
            let read = table.axis(i).unwrap();
            assert_eq!((read.name, read.unit), (format!("axis {i}").as_str(), "1"));
            let all = [read.low, read.high, read.pole, read.scale].map(f64::to_bits);
            assert_eq!(all, [axis.low, axis.high, axis.pole, draft.scale(i)].map(f64::to_bits));
            assert_eq!([read.nodes, read.edge_nodes], [axis.nodes, axis.edge_nodes]);
        }
        for (o, factors) in draft.factors.iter().enumerate() {
            let read = table.output(o).unwrap();
            assert_eq!(read.name, format!("output {o}"));
            assert_eq!([read.is_singular, read.vanishes], *factors);
            assert!(read.certificate.gradient_max > 2e-6 && read.certificate.scale > 5.0);
        }
    }
}

/// Bytes that were checked are a table again without another check; other bytes are checked.
#[test]
fn checked_bytes_are_a_table_again() {
    let table = Table::from_bytes(PPAM).unwrap();
    let (checked, point) = (table.checked(), point_at(&table, &[0.3, 0.6, 0.5, 0.5]));
    let again = Table::again(PPAM, checked).unwrap();
    assert!(sample(&table, &point).is_some());
    assert_eq!((sample(&again, &point), again.text()), (sample(&table, &point), table.text()));
    let mut damaged = PPAM.to_vec();
    *damaged.last_mut().unwrap() ^= 1;
    assert!(matches!(Table::again(&damaged, checked), Err(TableError::Checksum { .. })));
    assert!(Table::again(&PPAM[..PPAM.len() - 1], checked).is_err());
}
