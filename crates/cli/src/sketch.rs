//! A meridian drawn to scale in the terminal with braille dots: both outlines and the fittings.

use bulge_fibre::MeridianPoint;

/// Dots per character cell of the braille block.
const DOTS: (usize, usize) = (2, 4);
/// Bit of each dot in a braille character, by row and column (Unicode 13, chapter 21.1).
const BITS: [[u32; 2]; 4] = [[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]];

/// The outline of a muscle `columns` characters wide, indented by two.
pub(crate) fn sketch(meridian: &[MeridianPoint], columns: usize) -> String {
    let length = meridian.last().map_or(0.0, |point| point.x_m);
    let radius = meridian.iter().map(|point| point.r_m).fold(0.0, f64::max);
    if length <= 0.0 || radius <= 0.0 || columns < 4 {
        return String::new();
    }
    // A very short or thick muscle would fill the screen, so the height is at most 20 lines.
    let dots_x = (columns * DOTS.0 - 1) as f64;
    let scale = (dots_x / length).min((20 * DOTS.1 - 1) as f64 / (2.0 * radius));
    let cell = |value: f64| -> usize {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a dot of a small picture, clamped at 0"
        )]
        let dot = value.max(0.0).round() as usize;
        dot
    };
    let height = cell(2.0 * radius * scale) + 1;
    let width = cell(length * scale) + 1;
    let (rows, columns) = (height.div_ceil(DOTS.1), width.div_ceil(DOTS.0));
    let mut cells = vec![0_u32; rows * columns];
    let mut dot = |x: usize, y: usize| {
        let (row, column) = (y / DOTS.1, x / DOTS.0);
        if row < rows && column < columns {
            cells[row * columns + column] |= BITS[y % DOTS.1][x % DOTS.0];
        }
    };
    let middle = radius * scale;
    for pair in meridian.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        let span = ((b.x_m - a.x_m).abs().max((b.r_m - a.r_m).abs()) * scale).ceil().max(1.0);
        let mut part = 0.0;
        while part <= 1.0 {
            let x = cell((a.x_m + part * (b.x_m - a.x_m)) * scale);
            let r = (a.r_m + part * (b.r_m - a.r_m)) * scale;
            dot(x, cell(middle - r));
            dot(x, cell(middle + r));
            part += 1.0 / span;
        }
    }
    for (end, x) in [(meridian.first(), 0), (meridian.last(), width - 1)] {
        let r = end.map_or(0.0, |point| point.r_m * scale);
        for y in cell(middle - r)..=cell(middle + r) {
            dot(x, y);
        }
    }
    let line = |row: &[u32]| {
        let drawn: String = row.iter().filter_map(|bits| char::from_u32(0x2800 + bits)).collect();
        format!("  {}\n", drawn.trim_end_matches('\u{2800}'))
    };
    cells.chunks(columns).map(line).collect()
}
