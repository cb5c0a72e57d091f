//! Arrays of the cells of a drawing, read from their elements.

use super::drawing::{Cell, Drawing};
use super::map::{Vector, unit};
use crate::xml::{Array, Values};
use bulge_membrane::{Fields, SheetField, Tension, ThreadField};

/// Name of an array, and the function that reads its values.
type Reader<T> = (&'static str, fn(&T) -> f64);

/// Wrinkle state of a cell without a sheet.
const NO_SHEET: i32 = -1;

/// Names of the groups, each once, and for each group of the fields the index of its name.
pub(super) fn group_names(fields: &Fields) -> (Vec<&str>, Vec<i32>) {
    let mut names: Vec<&str> = Vec::new();
    let mut indices = Vec::new();
    for group in &fields.groups {
        let index = names.iter().position(|name| *name == group.name).unwrap_or_else(|| {
            names.push(&group.name);
            names.len() - 1
        });
        indices.push(i32::try_from(index).unwrap_or(i32::MAX));
    }
    (names, indices)
}

/// All arrays of the cells.
pub(super) fn of_cells(drawing: &Drawing, fields: &Fields) -> Vec<Array> {
    let (_, indices) = group_names(fields);
    let group: Vec<i32> = drawing.cells.iter().map(|cell| indices[cell.group]).collect();
    let mut arrays = vec![Array::scalars("group", Values::Int32(group))];
    let layers = |count: fn(&bulge_membrane::GroupFields) -> usize| {
        // The arrays of the first layer are in every file, so that a reader can rely on them.
        fields.groups.iter().map(count).fold(1, usize::max)
    };
    for layer in 0..layers(|group| group.sheets.len()) {
        arrays.extend(sheets(drawing, fields, layer));
    }
    for layer in 0..layers(|group| group.threads.len()) {
        arrays.extend(threads(drawing, fields, layer));
    }
    arrays
}

/// The name of an array in a layer.
fn name(base: &str, layer: usize) -> String {
    if layer == 0 { base.to_owned() } else { format!("{base}_{}", layer + 1) }
}

fn sheets(drawing: &Drawing, fields: &Fields, layer: usize) -> Vec<Array> {
    let sheet = |cell: &Cell| fields.groups[cell.group].sheets.get(layer)?.get(cell.element);
    let readers: [Reader<SheetField>; 5] = [
        ("membrane_force_1_N_per_m", |sheet| sheet.force[0]),
        ("membrane_force_2_N_per_m", |sheet| sheet.force[1]),
        ("stretch_1", |sheet| sheet.stretch[0]),
        ("stretch_2", |sheet| sheet.stretch[1]),
        ("folded", |sheet| sheet.folded),
    ];
    let mut arrays: Vec<Array> = readers
        .into_iter()
        .map(|(base, read)| {
            let values: Vec<f64> = drawing.cells.iter().map(|cell| sheet(cell).map_or(0.0, read)).collect();
            Array::scalars(name(base, layer), Values::Float64(values))
        })
        .collect();
    let direction = |cell: &Cell| -> Vector {
        let Some(sheet) = sheet(cell) else { return [0.0; 3] };
        let own = if fields.groups[cell.group].is_revolved { cell.meridian } else { sheet.direction };
        // The mean direction over the points of a quadratic triangle is shorter than 1.
        drawing.maps[cell.map].of(unit(own))
    };
    let directions: Vec<f64> = drawing.cells.iter().flat_map(direction).collect();
    arrays.push(Array::vectors(name("direction_1", layer), directions));
    let states: Vec<i32> = drawing
        .cells
        .iter()
        .map(|cell| sheet(cell).map_or(NO_SHEET, |sheet| number(sheet.tension)))
        .collect();
    arrays.push(Array::scalars(name("wrinkle_state", layer), Values::Int32(states)));
    arrays
}

fn number(tension: Tension) -> i32 {
    match tension {
        Tension::Slack => 0,
        Tension::Wrinkled => 1,
        Tension::Taut => 2,
    }
}

fn threads(drawing: &Drawing, fields: &Fields, layer: usize) -> Vec<Array> {
    let thread = |cell: &Cell| fields.groups[cell.group].threads.get(layer)?.get(cell.element);
    let readers: [Reader<ThreadField>; 3] = [
        ("fibre_tension_N", |thread| thread.tension),
        ("fibre_strain", |thread| thread.stretch - 1.0),
        ("fibre_angle_rad", |thread| thread.angle),
    ];
    readers
        .into_iter()
        .map(|(base, read)| {
            let values: Vec<f64> = drawing.cells.iter().map(|cell| thread(cell).map_or(0.0, read)).collect();
            Array::scalars(name(base, layer), Values::Float64(values))
        })
        .collect()
}
