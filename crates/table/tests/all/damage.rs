//! Any bytes give a table or the right error. Any point gives a finite value or none. Nothing panics.

#![expect(clippy::unwrap_used, reason = "a test that cannot be set up fails")]

use std::ops::Range;

use crate::writer::{Kind, RECORDS, Random, sealed};
use bulge_table::{Sample, Table, TableError};
use proptest::prelude::*;

const PPAM: &[u8] = include_bytes!("../../examples/data/ppam.table");
const KIND: Kind = Kind {
    axes: 2,
    outputs: 2,
    is_spline: true,
    is_single: false,
    is_root: true,
    is_fitted: true,
    has_factors: true,
};
/// Where the records of two axes and two outputs begin.
const OUTPUTS: usize = RECORDS[0] + 2 * RECORDS[1];
const ODD: [f64; 16] = [
    0.0,
    -0.0,
    5e-324,
    -5e-324,
    f64::MIN_POSITIVE,
    1e-200,
    1e-9,
    1.0,
    -1.0,
    1.5,
    1e9,
    f64::MAX,
    f64::MIN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::NAN,
];

fn malformed(field: &'static str) -> TableError {
    TableError::Malformed { field }
}

/// The error of bytes that must not form a table.
fn error(bytes: &[u8]) -> TableError {
    Table::from_bytes(bytes).unwrap_err()
}

/// The same bytes with others from an offset on, and the checksum corrected.
fn rewritten(bytes: &[u8], at: usize, with: &[u8]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    bytes[at..at + with.len()].copy_from_slice(with);
    sealed(bytes)
}

/// Small tables of very different kinds.
fn tables() -> Vec<Vec<u8>> {
    let mut random = Random(11);
    Kind::all(3, 2).into_iter().map(|kind| kind.table(&mut random).draft.bytes()).collect()
}

/// Queries everything of a table at points on, near and far from its ends. `is_sound`: it was written
/// correctly, so all values are finite.
fn ask(table: &Table<'_>, random: &mut Random, points: usize, is_sound: bool) {
    let (axes, outputs) = (table.axes(), table.outputs());
    let (mut values, mut gradients) = (vec![0.0; outputs], vec![0.0; outputs * axes]);
    let _ = (table.checks(), table.edge_error(), table.text(), table.form().name(), table.coefficients());
    assert!((0..axes).all(|i| table.axis(i).is_some_and(|axis| axis.low < axis.high)));
    assert!((0..outputs).all(|o| table.output(o).is_some_and(|output| !output.name.is_empty())));
    for _ in 0..points {
        let coordinate = |i: usize| {
            let axis = table.axis(i).unwrap();
            let inside = random.between(axis.low, axis.high);
            let odd = ODD[random.below(ODD.len())];
            let all = [axis.low, axis.high, axis.low.next_up(), axis.high.next_up(), axis.low + odd, odd];
            *all.get(random.below(12)).unwrap_or(&inside)
        };
        let mut point: Vec<f64> = (0..axes).map(coordinate).collect();
        let end = table.upper_end(&point);
        if let (Some(end), 0..3) = (end, random.below(6)) {
            point[0] = [end.next_down(), end, end.next_up()][random.below(3)];
        }
        let found = table.sample(&point, &mut values, &mut gradients);
        if is_sound {
            assert!(end.is_none_or(f64::is_finite));
            assert!(found.is_none() || values.iter().all(|value| value.is_finite()), "{point:?} {values:?}");
            assert!(found.is_none() || gradients.iter().all(|by| !by.is_nan()), "{point:?} {gradients:?}");
        }
        if point.iter().any(|x| !x.is_finite()) {
            assert!(found.is_none());
        }
    }
}

#[test]
fn every_truncation() {
    for bytes in tables().iter().map(Vec::as_slice).chain([PPAM]) {
        for length in 0..bytes.len() {
            let TableError::Truncated { found, needed } = error(&bytes[..length]) else { panic!("{length}") };
            // The first bytes, then a whole header with a checksum, then what the header says.
            let shortest = if length < 8 { RECORDS[0] } else { RECORDS[0] + 8 };
            assert_eq!(
                (found, needed),
                (length, if length < RECORDS[0] + 8 { shortest } else { bytes.len() })
            );
        }
        // The shortened bytes don't form a table of their own.
        let short = rewritten(bytes, 16, &u32::try_from(bytes.len() - 1).unwrap().to_le_bytes());
        assert_ne!(error(&sealed(short[..bytes.len() - 1].to_vec())), TableError::NoTable);
    }
}

#[test]
fn every_changed_byte() {
    let mut random = Random(12);
    for bytes in [KIND.table(&mut random).draft.bytes(), tables()[0].clone(), tables()[1].clone()] {
        for at in 0..bytes.len() {
            for change in [1_u8, 2, 4, 8, 16, 32, 64, 128, 255, 0x5A] {
                let mut changed = bytes.clone();
                changed[at] ^= change;
                let error = error(&changed);
                let is_right = match at {
                    0..8 => error == TableError::NoTable,
                    8..10 => matches!(error, TableError::Version { .. }),
                    16..20 => matches!(error, TableError::Truncated { .. }) || error == malformed("length"),
                    _ => matches!(error, TableError::Checksum { stored, computed } if stored != computed),
                };
                assert!(is_right, "{at}: {error}");
            }
        }
    }
}

#[test]
fn bytes_after_the_end() {
    for mut bytes in tables() {
        bytes.push(0);
        assert_eq!(error(&bytes), malformed("length"));
        bytes.extend_from_within(..);
        assert_eq!(error(&bytes), malformed("length"));
    }
}

#[test]
fn other_files_and_versions() {
    for bytes in [b"PAR1".as_slice(), b"bulgeTab", b"BulgeTax 0123456789", b"\0", &[255; 4000]] {
        assert_eq!(error(bytes), TableError::NoTable);
    }
    assert_eq!(error(b""), TableError::Truncated { found: 0, needed: RECORDS[0] });
    for found in [0, 2, 256, u16::MAX] {
        assert_eq!(error(&rewritten(PPAM, 8, &found.to_le_bytes())), TableError::Version { found });
    }
    assert_eq!(
        error(&rewritten(PPAM, 8, &[2, 0])).to_string(),
        "this table has version 2 of the format; only version 1 is known"
    );
}

#[test]
fn odd_bytes_in_the_header() {
    let bytes = KIND.table(&mut Random(13)).draft.bytes();
    let cases: [(usize, &[u8], &str); 8] = [
        (10, &[0, 3, 255], "form"),
        (11, &[0, 1, 2, 3, 5, 16, 255], "number of bytes of a coefficient"),
        (11, &[4], "number of coefficients"),
        (12, &[0, 5, 255], "number of axes or outputs"),
        (13, &[0, 9, 255], "number of axes or outputs"),
        (14, &[1, 255], "reserved bytes"),
        (15, &[1, 255], "reserved bytes"),
        (52, &[4, 7, 128], "header"),
    ];
    for (at, all, field) in cases {
        for byte in all {
            assert_eq!(error(&rewritten(&bytes, at, &[*byte])), malformed(field), "{at} {byte}");
        }
    }
    // Other plausible numbers of axes and outputs, with everything else unchanged.
    for (at, count) in [(12, 1), (12, 3), (12, 4), (13, 1), (13, 3), (13, 8)] {
        assert!(matches!(error(&rewritten(&bytes, at, &[count])), TableError::Malformed { .. }));
    }
    // Without its flag an edge must be empty.
    assert_eq!(error(&rewritten(&bytes, 52, &[1])), malformed("number of nodes of the edge"));
    for odd in [-1.0, f64::NAN, f64::NEG_INFINITY] {
        assert_eq!(error(&rewritten(&bytes, 56, &odd.to_le_bytes())), malformed("error of the edge"));
    }
}

#[test]
fn lengths_and_places_that_cross() {
    let draft = KIND.table(&mut Random(14)).draft;
    let (bytes, [edge, data, text]) = (draft.bytes(), draft.places());
    let length = bytes.len();
    for odd in [0, 1, 63, 71, length - 1] {
        let odd = u32::try_from(odd).unwrap().to_le_bytes();
        assert_eq!(error(&rewritten(&bytes, 16, &odd)), malformed("length"));
    }
    for needed in [length + 1, u32::MAX as usize] {
        let odd = u32::try_from(needed).unwrap().to_le_bytes();
        assert_eq!(error(&rewritten(&bytes, 16, &odd)), TableError::Truncated { found: length, needed });
    }
    let odd = [0, 1, RECORDS[0], edge - 1, edge, data - 8, data, text - 1, text, length - 8, length];
    for at in [20, 24, 28] {
        let right = bytes[at..at + 4].to_vec();
        for odd in odd.iter().flat_map(|at| [*at, at + 1]).chain([1 << 31, u32::MAX as usize]) {
            let odd = u32::try_from(odd).unwrap().to_le_bytes();
            if odd != right[..] {
                let error = error(&rewritten(&bytes, at, &odd));
                let fields = ["header", "number of coefficients"];
                assert!(fields.iter().any(|field| error == malformed(field)), "{at}: {error}");
            }
        }
    }
    // All places are eight bytes too small, so that the edge begins within the records of the outputs.
    let less = |at: usize| (u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) - 8).to_le_bytes();
    let text_length = u32::from_le_bytes(bytes[48..52].try_into().unwrap()) + 8;
    let moved = [20, 24, 28].iter().fold(bytes.clone(), |moved, at| rewritten(&moved, *at, &less(*at)));
    assert_eq!(error(&rewritten(&moved, 48, &text_length.to_le_bytes())), malformed("header"));
    for odd in [0, 1, u32::MAX] {
        assert_eq!(error(&rewritten(&bytes, 48, &odd.to_le_bytes())), malformed("header"));
    }
}

/// In these tables all numbers are in range but the coordinate is not a number: 0/0, or an overflow.
#[test]
fn a_coordinate_that_is_no_number_is_outside() {
    let kind = Kind { is_root: false, is_fitted: false, has_factors: false, ..KIND };
    let mut flat = Kind { is_fitted: true, ..kind }.table(&mut Random(17)).draft;
    flat.edge.iter_mut().skip(1).step_by(2).for_each(|c| *c = 0.0);
    let mut huge = flat.clone();
    huge.edge.iter_mut().step_by(2).for_each(|scale| *scale = 1e308);
    for (name, draft) in [("an edge without pole", flat), ("a huge edge", huge)] {
        let bytes = draft.bytes();
        let table = Table::from_bytes(&bytes).unwrap_or_else(|error| panic!("{name}: {error}"));
        let lookup = table.lookup::<2, 2>().unwrap();
        let second = 0.5 * (draft.axes[1].low + draft.axes[1].high);
        let point = [draft.axes[0].low, second];
        let mut found = [Some([Sample { value: 7.0, gradient: [7.0; 2] }; 2]); 5];
        lookup.at_each(&[point; 5], &mut found);
        assert_eq!((lookup.at(point), found), (None, [None; 5]), "{name}");
        assert!(lookup.curve::<16>(point).is_none_or(|curve| curve.at(point[0]).is_none()), "{name}");
    }
}

#[test]
fn odd_numbers_in_the_records() {
    let bytes = KIND.table(&mut Random(15)).draft.bytes();
    let axis = |i: usize, offset: usize| RECORDS[0] + i * RECORDS[1] + offset;
    let check = |at: usize, odd: f64, field| {
        assert_eq!(error(&rewritten(&bytes, at, &odd.to_le_bytes())), malformed(field), "{at} {odd}");
    };
    for i in 0..2 {
        let ends = [(48, "lower end of an axis"), (56, "upper end of an axis")];
        for (offset, field) in ends.into_iter().chain([(64, "pole of an axis"), (72, "scale of an axis")]) {
            check(axis(i, offset), f64::NAN, field);
        }
        for odd in [f64::INFINITY, f64::NEG_INFINITY] {
            check(axis(i, 48), odd, "range of an axis");
            check(axis(i, 56), odd, "range of an axis");
        }
        check(axis(i, 48), 1e9, "range of an axis");
        check(axis(i, 56), -1e9, "range of an axis");
        check(axis(i, 56), 1e91, "range of an axis");
        // The last four are finite, but not everything computed from them is.
        for odd in [0.0, -0.0, -1.0, f64::NEG_INFINITY, 5e-324, 1e-91, 1e91, f64::MAX] {
            check(axis(i, 64), odd, "range of an axis");
        }
        for odd in [0.0, -1.0, f64::INFINITY] {
            check(axis(i, 72), odd, "scale of an axis");
        }
        for (offset, odd, field) in [(0, 0, "name"), (32, 0, "unit"), (0, 255, "name"), (40, 255, "unit")] {
            let changed = rewritten(&bytes, axis(i, offset), &[odd]);
            // What follows the end of a name isn't read.
            if offset == 40 {
                assert!(Table::from_bytes(&changed).is_ok());
            } else {
                let field = if field == "name" { "name of an axis" } else { "unit of an axis" };
                assert_eq!(error(&changed), malformed(field));
            }
        }
        assert_eq!(error(&rewritten(&bytes, axis(i, 95), &[1])), malformed("reserved bytes"));
    }
    // The true ends with a wrong scale: the coordinate would end early or late.
    check(axis(1, 72), 1e-3, "scale of an axis");
    check(axis(1, 72), 1e3, "scale of an axis");
    check(axis(1, 56), 1e6, "scale of an axis");
    for offset in [48, 49] {
        for odd in [2, 255] {
            let changed = rewritten(&bytes, OUTPUTS + offset, &[odd]);
            assert_eq!(error(&changed), malformed("factors of an output"));
        }
    }
    for offset in 50..56 {
        assert_eq!(error(&rewritten(&bytes, OUTPUTS + offset, &[1])), malformed("reserved bytes"));
    }
    for (offset, field) in [(0, "name of an output"), (32, "unit of an output")] {
        for odd in [0, 0xC0] {
            assert_eq!(error(&rewritten(&bytes, OUTPUTS + RECORDS[2] + offset, &[odd])), malformed(field));
        }
    }
    for (i, odd) in (0..6).flat_map(|i| [f64::NAN, -1.0].map(|odd| (i, odd))) {
        check(OUTPUTS + 56 + 8 * i, odd, "errors of an output");
    }
}

#[test]
fn a_name_may_fill_its_field() {
    let bytes = KIND.table(&mut Random(16)).draft.bytes();
    let name = "a".repeat(32);
    let changed = rewritten(&bytes, RECORDS[0], name.as_bytes());
    assert_eq!(Table::from_bytes(&changed).unwrap().axis(0).unwrap().name, name);
    let changed = rewritten(&bytes, RECORDS[0], &[0xE2; 32]);
    assert_eq!(error(&changed), malformed("name of an axis"));
}

#[test]
fn odd_numbers_of_nodes() {
    for is_spline in [true, false] {
        let bytes = Kind { is_spline, ..KIND }.table(&mut Random(17)).draft.bytes();
        let write = |i: usize, offset: usize, count: u32| {
            error(&rewritten(&bytes, RECORDS[0] + i * RECORDS[1] + offset, &count.to_le_bytes()))
        };
        let few: &[u32] = if is_spline { &[0, 1, 3, (1 << 20) + 1] } else { &[0, 97] };
        for i in 0..2 {
            for count in few.iter().copied().chain([1 << 31, u32::MAX]) {
                assert_eq!(write(i, 80, count), malformed("number of nodes"));
            }
            assert_eq!(write(i, 80, 96), malformed("number of coefficients"));
            for count in [3, (1 << 20) + 1, u32::MAX] {
                assert_eq!(write(i, 84, count), malformed("number of nodes of the edge"));
            }
        }
        assert_eq!(write(1, 84, 0), malformed("number of nodes of the edge"));
        assert_eq!(write(1, 84, 1 << 20), malformed("number of coefficients"));
    }
}

/// Four axes of 2^20 nodes: their product exceeds 64 bits.
#[test]
fn products_beyond_all_numbers() {
    let kind = Kind { axes: 4, ..KIND };
    let mut bytes = kind.table(&mut Random(18)).draft.bytes();
    for i in 0..4 {
        let at = RECORDS[0] + i * RECORDS[1] + 80;
        bytes[at..at + 4].copy_from_slice(&(1_u32 << 20).to_le_bytes());
    }
    assert_eq!(error(&sealed(bytes)), malformed("number of nodes"));
}

#[test]
fn a_single_axis_has_no_fitted_edge() {
    let kind = Kind { axes: 1, is_fitted: false, ..KIND };
    let bytes = kind.table(&mut Random(19)).draft.bytes();
    assert_eq!(error(&rewritten(&bytes, 52, &[2])), malformed("fitted edge of a single axis"));
}

#[test]
fn coefficients_and_text() {
    for (is_spline, is_single) in [(true, true), (true, false), (false, true), (false, false)] {
        let draft = Kind { is_spline, is_single, ..KIND }.table(&mut Random(20)).draft;
        let (bytes, [edge, data, text]) = (draft.bytes(), draft.places());
        let each = if is_single { 4 } else { 8 };
        for (range, each) in [(edge..data, 8), (data..text, each)] {
            let Range { start, end } = range;
            for at in (start..end).step_by(each) {
                for odd in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                    let wrong = malformed("coefficient (not finite)");
                    let (single, double) = (crate::writer::single(odd).to_le_bytes(), odd.to_le_bytes());
                    let odd = if each == 4 { &single[..] } else { &double[..] };
                    assert_eq!(error(&rewritten(&bytes, at, odd)), wrong);
                }
            }
        }
        for at in text..bytes.len() - 8 {
            assert_eq!(error(&rewritten(&bytes, at, &[0xFF])), malformed("text"));
        }
    }
}

/// Each number of the header and the records is set to each odd value in turn: the table is refused, or
/// looked up without a panic.
#[test]
fn every_field_is_every_odd_value() {
    let mut random = Random(21);
    let counts = [0, 1, 3, 4, 5, 95, 96, 97, 1 << 20, u32::MAX - 8, u32::MAX].map(u32::to_le_bytes);
    for bytes in tables() {
        let end = u32::from_le_bytes(bytes[24..28].try_into().unwrap()) as usize;
        for at in (8..end).step_by(4) {
            let words = counts.iter().map(|count| rewritten(&bytes, at, count));
            let doubles = ODD.iter().map(|odd| rewritten(&bytes, at, &odd.to_le_bytes()));
            for changed in words.chain(doubles.filter(|_| at + 8 <= end)) {
                if let Ok(table) = Table::from_bytes(&changed) {
                    ask(&table, &mut random, 2, false);
                }
            }
        }
    }
}

#[test]
fn a_sound_table_gives_finite_numbers_everywhere() {
    let mut random = Random(22);
    let kinds = Kind::all(4, 4);
    let all: Vec<_> = kinds.into_iter().map(|kind| kind.table(&mut random).draft.bytes()).collect();
    for bytes in all.iter().map(Vec::as_slice).chain([PPAM]) {
        ask(&Table::from_bytes(bytes).unwrap(), &mut random, 300, true);
    }
}

#[test]
fn errors_are_words() {
    for (error, words) in [
        (malformed("text"), "the table is malformed: its text makes no sense"),
        (TableError::NoTable, "this is no table: it doesn't begin with `BulgeTab`"),
        (
            TableError::Truncated { found: 3, needed: 64 },
            "the table is truncated: it has 3 bytes of at least 64",
        ),
        (TableError::Shape { axes: 2, outputs: 3 }, "the table has 2 axes and 3 outputs: ask for as many"),
    ] {
        assert_eq!(error.to_string(), words);
    }
}

fn cases() -> ProptestConfig {
    ProptestConfig { cases: 1000, failure_persistence: None, ..ProptestConfig::default() }
}

proptest! {
    #![proptest_config(cases())]

    #[test]
    fn random_bytes(bytes in prop::collection::vec(any::<u8>(), 0..400), has_start in any::<bool>()) {
        let mut bytes = bytes;
        if has_start {
            let start = b"BulgeTab\x01\x00";
            bytes.splice(..start.len().min(bytes.len()), *start);
        }
        prop_assert!(Table::from_bytes(&bytes).is_err());
    }

    #[test]
    fn random_changes_with_a_right_checksum(
        kind in any::<prop::sample::Index>(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<[u8; 8]>(), 1_usize..9), 1..6),
        is_in_records in any::<bool>(),
        seed in any::<u64>(),
    ) {
        let mut random = Random(seed);
        let kinds = Kind::all(4, 8);
        let draft = kinds[kind.index(kinds.len())].table(&mut random).draft;
        let mut bytes = draft.bytes();
        let end = if is_in_records { draft.places()[0] } else { bytes.len() - 8 };
        for (at, with, count) in changes {
            let at = 8 + at.index(end - 8);
            let count = count.min(bytes.len() - at);
            bytes[at..at + count].copy_from_slice(&with[..count]);
        }
        if let Ok(table) = Table::from_bytes(&sealed(bytes)) {
            ask(&table, &mut random, 30, false);
        }
    }

    #[test]
    fn random_points(kind in any::<prop::sample::Index>(), seed in any::<u64>(), point in any::<[f64; 4]>()) {
        let mut random = Random(seed);
        let kinds = Kind::all(4, 8);
        let bytes = kinds[kind.index(kinds.len())].table(&mut random).draft.bytes();
        let table = Table::from_bytes(&bytes).unwrap();
        ask(&table, &mut random, 50, true);
        let (mut values, mut gradients) = (vec![0.0; table.outputs()], vec![0.0; table.outputs() * table.axes()]);
        let found = table.sample(&point[..table.axes()], &mut values, &mut gradients);
        prop_assert!(found.is_none() || values.iter().all(|value| value.is_finite()));
    }
}
