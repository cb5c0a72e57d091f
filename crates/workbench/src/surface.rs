//! The bulge of a muscle: points, triangles and fields, as in VTK files.

use bulge_fibre::{Approach, Given};
use bulge_model::{Equilibrium, MuscleWithEffects};
use bulge_muscles::{Muscle, Pressure, Quantity};
use bulge_vtk::{Bulge, Style, vtp_bytes};
use serde::Serialize;

use crate::refusal::{Place, Refusal};
use crate::server::Shaped;

/// Points of a meridian: enough to look smooth on any screen.
const POINTS: usize = 81;

/// The state of a muscle whose shape is shown.
#[derive(Debug, Clone, Copy)]
pub(crate) struct State {
    /// Gauge pressure \[Pa\].
    pub(crate) pressure_pa: f64,
    /// Contraction.
    pub(crate) contraction: f64,
}

#[derive(Debug, Serialize)]
struct Field {
    name: String,
    unit: &'static str,
    values: Vec<f32>,
}

/// A surface of triangles with fields on its points.
#[derive(Debug, Serialize)]
pub(crate) struct Surface {
    schema: &'static str,
    points: Vec<f32>,
    triangles: Vec<usize>,
    /// Vertices of each fibre from one fitting to the other.
    fibres: Vec<Vec<usize>>,
    fields: Vec<Field>,
    force_n: f64,
    length_m: f64,
    radius_m: f64,
    contraction: f64,
    pressure_pa: f64,
    contraction_limit: Option<f64>,
}

/// The equilibrium of a muscle with the effects in its file.
fn equilibrium(shaped: &Shaped, state: State) -> Result<(Muscle, Equilibrium), Refusal> {
    let extended = MuscleWithEffects::new(&shaped.0, &shaped.1).map_err(Refusal::at(Place::Shape))?;
    let given = Given::Contraction(state.contraction);
    let pressure = Pressure::from_si(state.pressure_pa);
    let found = Equilibrium::new(&extended, pressure, given, Approach::Auto, POINTS);
    Ok((extended.muscle().clone(), found.map_err(Refusal::at(Place::Shape))?))
}

/// The surface for the page.
pub(crate) fn surface(shaped: &Shaped, state: State) -> Result<Surface, Refusal> {
    let (muscle, found) = equilibrium(shaped, state)?;
    let shape = &found.shape;
    let mesh = Bulge::of(&muscle, shape, Style::natural(&muscle, shape, None))
        .mesh()
        .map_err(Refusal::at(Place::Shape))?;
    Ok(Surface {
        schema: "bulge.surface/1",
        points: short(&mesh.points.concat()),
        triangles: mesh.quads.iter().flat_map(|[a, b, c, d]| [*a, *b, *c, *a, *c, *d]).collect(),
        fibres: mesh.fibres,
        fields: mesh.point_fields.into_iter().map(|(name, values)| field(name, &values)).collect(),
        force_n: shape.response.force_n,
        length_m: shape.response.length_m,
        radius_m: shape.meridian.iter().map(|point| point.r_m).fold(0.0, f64::max),
        contraction: shape.response.contraction,
        pressure_pa: state.pressure_pa,
        contraction_limit: found.contraction_limit,
    })
}

/// Units at the end of the names of fields, and their usual notation.
const UNITS: [(&str, &str); 4] = [("_N_per_m", "N/m"), ("_rad", "rad"), ("_m", "m"), ("_N", "N")];

/// A field for the page, with name and unit separated.
fn field(name: &str, values: &[f64]) -> Field {
    let found = UNITS.iter().find_map(|(end, unit)| Some((name.strip_suffix(end)?, *unit)));
    let (name, unit) = found.unwrap_or((name, "1"));
    Field { name: name.replace('_', " "), unit, values: short(values) }
}

/// Single precision suffices for a picture.
#[expect(clippy::cast_possible_truncation, reason = "a picture")]
fn short(values: &[f64]) -> Vec<f32> {
    values.iter().map(|value| *value as f32).collect()
}

/// The surface as a VTK file.
pub(crate) fn vtp(shaped: &Shaped, state: State) -> Result<Vec<u8>, Refusal> {
    let (muscle, found) = equilibrium(shaped, state)?;
    let shape = &found.shape;
    vtp_bytes(&Bulge::of(&muscle, shape, Style::natural(&muscle, shape, None)))
        .map_err(Refusal::at(Place::Shape))
}
