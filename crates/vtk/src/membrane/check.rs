//! Checks before anything is drawn.

use super::map::{dot, minus};
use super::{MembranePicture, Whole};
use crate::VtkError;
use bulge_membrane::{Fields, GroupFields, State};

/// Fewest facets around the axis.
const LEAST_FACETS: u32 = 3;

/// Checks the sizes, that values are finite, and that the part can be completed to the whole.
pub(super) fn check(picture: &MembranePicture) -> Result<(), VtkError> {
    check_sizes(picture.fields)?;
    check_values(picture)?;
    check_whole(picture)
}

/// The quantities of a state that go into a file, with their names there.
pub(super) fn numbers(state: &State, time: f64) -> [(&'static str, f64); 5] {
    [
        ("pressure_Pa", state.pressure),
        ("volume_m3", state.volume),
        ("energy_J", state.energy),
        ("force_N", state.forces.last().copied().unwrap_or_default()),
        ("TimeValue", time),
    ]
}

/// Checks the sizes of the fields. They are public, so they may come from elsewhere than a solver.
fn check_sizes(fields: &Fields) -> Result<(), VtkError> {
    let wrong =
        |what| Err(VtkError::Drawing(format!("the fields of the membrane don't fit together: {what}")));
    let nodes = fields.places.len();
    if fields.displacements.len() != nodes {
        return wrong(format!("{} displacements of {nodes} nodes", fields.displacements.len()));
    }
    if fields.groups.iter().all(|group| group.cells.is_empty()) {
        return wrong("there are no cells".to_owned());
    }
    for group in &fields.groups {
        let GroupFields { name, kind, cells, .. } = group;
        let count = cells.len() / kind.nodes();
        if !cells.len().is_multiple_of(kind.nodes()) {
            return wrong(format!("{} nodes of cells of {} in group `{name}`", cells.len(), kind.nodes()));
        }
        if let Some(node) = cells.iter().find(|node| **node as usize >= nodes) {
            return wrong(format!("node {node} of group `{name}`, where there are {nodes} nodes"));
        }
        let lengths = group.sheets.iter().map(Vec::len).chain(group.threads.iter().map(Vec::len));
        if let Some(length) = lengths.into_iter().find(|length| *length != count) {
            return wrong(format!("{length} values for {count} cells in group `{name}`"));
        }
    }
    Ok(())
}

fn check_values(picture: &MembranePicture) -> Result<(), VtkError> {
    if let Some((quantity, value)) =
        numbers(picture.state, picture.time).into_iter().find(|(_, value)| !value.is_finite())
    {
        return Err(VtkError::not_finite(quantity, value, ""));
    }
    let fields = picture.fields;
    for (quantity, vectors) in [("place_m", &fields.places), ("displacement_m", &fields.displacements)] {
        for (node, vector) in vectors.iter().enumerate() {
            finite(quantity, vector, || format!("node {node}"))?;
        }
    }
    for group in &fields.groups {
        let at = |cell: usize| format!("cell {cell} of group `{}`", group.name);
        for (cell, sheet) in group.sheets.iter().flat_map(|layer| layer.iter().enumerate()) {
            finite("membrane_force_1_N_per_m", &sheet.force[..1], || at(cell))?;
            finite("membrane_force_2_N_per_m", &sheet.force[1..], || at(cell))?;
            finite("stretch_1", &sheet.stretch[..1], || at(cell))?;
            finite("stretch_2", &sheet.stretch[1..], || at(cell))?;
            finite("direction_1", &sheet.direction, || at(cell))?;
            finite("folded", &[sheet.folded], || at(cell))?;
        }
        for (cell, thread) in group.threads.iter().flat_map(|layer| layer.iter().enumerate()) {
            finite("fibre_tension_N", &[thread.tension], || at(cell))?;
            finite("fibre_strain", &[thread.stretch - 1.0], || at(cell))?;
            finite("fibre_angle_rad", &[thread.angle], || at(cell))?;
        }
    }
    Ok(())
}

fn finite(quantity: &'static str, values: &[f64], place: impl Fn() -> String) -> Result<(), VtkError> {
    match values.iter().find(|value| !value.is_finite()) {
        Some(value) => Err(VtkError::not_finite(quantity, *value, &format!(" at {}", place()))),
        None => Ok(()),
    }
}

fn check_whole(picture: &MembranePicture) -> Result<(), VtkError> {
    let (mirror, middle) = match picture.whole {
        Whole::AsMeshed => return Ok(()),
        Whole::Revolved { facets, .. } if facets < LEAST_FACETS => {
            return Err(VtkError::facets(facets, LEAST_FACETS));
        }
        Whole::Revolved { middle, .. } => (None, middle),
        Whole::Sector { lobes: 0, .. } => return wrong("it has no lobes: give at least 1"),
        Whole::Sector { mirror, middle, .. } => {
            if let Some(group) = picture.fields.groups.iter().find(|group| group.is_revolved) {
                let name = &group.name;
                return wrong(&format!(
                    "group `{name}` is a membrane of revolution: draw it revolved, not as a sector"
                ));
            }
            (mirror, middle)
        }
    };
    if let Some(normal) = mirror {
        let is_upright = normal[2].abs() <= 1e-9 * normal[0].hypot(normal[1]);
        if !(is_upright && dot(normal, normal).is_normal()) {
            return wrong(&format!("the z axis doesn't lie in the plane with the normal {normal:?}"));
        }
        let size = dot(normal, normal).sqrt();
        one_side(picture.fields, "the plane of its lobe", |x| dot(x, normal) / size)?;
    }
    match middle {
        Some(z) if !z.is_finite() => wrong(&format!("its middle is at z = {z}")),
        Some(z) => one_side(picture.fields, "its middle", |x| x[2] - z),
        None => Ok(()),
    }
}

/// Checks that the mesh lies on one side of a plane; `distance` is the signed distance from it.
fn one_side(fields: &Fields, plane: &str, distance: impl Fn([f64; 3]) -> f64) -> Result<(), VtkError> {
    let used = fields.groups.iter().flat_map(|group| &group.cells).map(|node| *node as usize);
    // The undeformed places are checked: cloth may move beyond a plane of symmetry if nothing stops it, and
    // the drawing is still right.
    let from = |node: usize| distance(minus(fields.places[node], fields.displacements[node]));
    let (mut low, mut high) = ((0.0, 0), (0.0, 0));
    for node in used {
        let d = from(node);
        low = if d < low.0 { (d, node) } else { low };
        high = if d > high.0 { (d, node) } else { high };
    }
    if low.0 < -1e-6 * high.0 && high.0 > -1e-6 * low.0 {
        return wrong(&format!(
            "nodes {} and {} of the mesh lie on two sides of {plane}: mirrored, they would be drawn twice",
            low.1, high.1
        ));
    }
    Ok(())
}

/// The meshed part can't be completed to the requested whole.
fn wrong(what: &str) -> Result<(), VtkError> {
    Err(VtkError::Drawing(format!("the whole can't be drawn: {what}")))
}
