//! How a shape is drawn: number of fibres, kind of surface, and resolution around the axis.

use crate::VtkError;
use crate::mesh::Mesh;
use bulge_fibre::{MeridianPoint, Response, Shape};
use bulge_muscles::Muscle;
use std::f64::consts::PI;

/// What is drawn between the fibres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Style {
    /// A surface of revolution through the fibres.
    Revolution,
    /// Cloth of constant width between neighbouring fibres: pleats where there is more of it than needed,
    /// lobes where the pressure has unfolded them, flat panels where it is taut. The fibres must be straight.
    Pleats {
        /// Circumference of the unfolded cloth \[m\]. With `None` the cloth is just unfolded (a polygon) at
        /// the largest radius.
        cloth_circumference: Option<f64>,
    },
}

impl Style {
    /// Pleats for a pleated muscle with straight fibres of known number, else a surface of revolution.
    #[must_use]
    pub fn natural(muscle: &Muscle, shape: &Shape, cloth_circumference: Option<f64>) -> Self {
        let turns = shape.meridian.last().is_some_and(|end| end.turn_rad != 0.0);
        if muscle.is_pleated() && muscle.fibres().is_some() && !turns {
            Self::Pleats { cloth_circumference }
        } else {
            Self::Revolution
        }
    }

    /// A number of facets that looks round: 96 around the axis, or 12 per pleat.
    #[must_use]
    pub fn default_facets(self) -> u32 {
        match self {
            Self::Revolution => 96,
            Self::Pleats { .. } => 12,
        }
    }
}

/// An equilibrium shape and how to draw it.
///
/// Fibres that turn about the axis (braids) are drawn as two opposite families of helices with half of the
/// fibres each. Straight fibres lie in meridian planes.
///
/// ```no_run
/// # fn draw(shape: &bulge_fibre::Shape) -> Result<(), bulge_vtk::VtkError> {
/// use bulge_vtk::{Bulge, Style, write_vtp};
/// let style = Style::Pleats { cloth_circumference: None };
/// let bulge = Bulge { shape, fibres: 40, style, facets: style.default_facets() };
/// write_vtp("muscle.vtp", &bulge)
/// # }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bulge<'a> {
    /// The equilibrium, in SI units.
    pub shape: &'a Shape,
    /// Number of fibres drawn: at least 3 with pleats, may be 0 for a surface of revolution.
    pub fibres: u32,
    /// The surface drawn between them.
    pub style: Style,
    /// Segments around the axis, at least 4: per pleat, or over the whole circumference of a surface of
    /// revolution.
    pub facets: u32,
}

const LEAST_FACETS: u32 = 4;
const LEAST_PLEATS: u32 = 3;
/// Fibres drawn if the muscle file doesn't give their number: enough to show the net.
const SHOWN: u32 = 32;

impl<'a> Bulge<'a> {
    /// A shape of a muscle, drawn with the fibres of the muscle.
    #[must_use]
    pub fn of(muscle: &Muscle, shape: &'a Shape, style: Style) -> Self {
        Self { shape, fibres: muscle.fibres().unwrap_or(SHOWN), style, facets: style.default_facets() }
    }
}

impl Bulge<'_> {
    /// The points, quadrangles and polylines with their fields: the content of the file that
    /// [`crate::write_vtp`] writes.
    ///
    /// # Errors
    /// The bulge can't be drawn.
    pub fn mesh(&self) -> Result<Mesh, VtkError> {
        self.check()?;
        Ok(Mesh::new(self))
    }

    /// Points of the cloth around the axis.
    pub(crate) fn columns(&self) -> usize {
        let facets = self.facets as usize;
        match self.style {
            Style::Revolution => facets,
            Style::Pleats { .. } => facets.saturating_mul(self.fibres as usize),
        }
    }

    /// Whether the fibres turn about the axis.
    pub(crate) fn is_braided(&self) -> bool {
        largest_turn(self.shape) > 0.0
    }

    /// Width of the cloth between two fibres \[m\]: s = C/n, or the chord at the largest radius.
    pub(crate) fn cloth_width(&self, cloth_circumference: Option<f64>) -> f64 {
        let n = f64::from(self.fibres);
        cloth_circumference.map_or_else(
            || 2.0 * (PI / n).sin() * self.shape.meridian.iter().map(|p| p.r_m).fold(0.0, f64::max),
            |c| c / n,
        )
    }

    /// Rejects a bulge that can't be drawn.
    pub(crate) fn check(&self) -> Result<(), VtkError> {
        self.check_drawing()?;
        check_shape(self.shape)?;
        let (stations, around) =
            (self.shape.meridian.len(), self.columns().saturating_add(self.fibres as usize));
        // Each quadrangle has four vertices, and the format counts in 32 bits.
        let most = u32::MAX / 4;
        if stations.checked_mul(around).is_none_or(|points| points > most as usize) {
            return Err(VtkError::Drawing(format!(
                "{stations} rings of {around} points are more than a file holds ({most}): draw fewer facets or fibres"
            )));
        }
        Ok(())
    }

    fn check_drawing(&self) -> Result<(), VtkError> {
        if self.facets < LEAST_FACETS {
            return Err(VtkError::facets(self.facets, LEAST_FACETS));
        }
        let Style::Pleats { cloth_circumference } = self.style else { return Ok(()) };
        let wrong = |what: String| Err(VtkError::Drawing(what));
        if self.fibres < LEAST_PLEATS {
            let found = self.fibres;
            return wrong(format!(
                "pleats need at least {LEAST_PLEATS} fibres to stand between, found {found}"
            ));
        }
        if self.is_braided() {
            let turn = largest_turn(self.shape);
            return wrong(format!(
                "pleats stand between straight fibres, but these turn by {turn} rad about the axis: draw a surface of revolution"
            ));
        }
        match cloth_circumference {
            Some(value) if !(value > 0.0 && value.is_finite()) => {
                wrong(format!("the cloth circumference is {value} m: it must be positive and finite"))
            }
            _ => Ok(()),
        }
    }
}

fn largest_turn(shape: &Shape) -> f64 {
    shape.meridian.iter().map(|p| p.turn_rad.abs()).fold(0.0, f64::max)
}

/// The quantities of a whole shape that go into a file, with their names there.
pub(crate) fn whole(response: &Response) -> [(&'static str, f64); 5] {
    [
        ("pressure_Pa", response.pressure_pa),
        ("force_N", response.force_n),
        ("length_m", response.length_m),
        ("contraction", response.contraction),
        ("volume_m3", response.volume_m3),
    ]
}

fn check_shape(shape: &Shape) -> Result<(), VtkError> {
    if shape.meridian.len() < 2 {
        let found = shape.meridian.len();
        let what = format!("a surface needs at least 2 meridian points, the shape has {found}");
        return Err(VtkError::Drawing(what));
    }
    if let Some((quantity, value)) = whole(&shape.response).into_iter().find(|(_, value)| !value.is_finite())
    {
        return Err(VtkError::not_finite(quantity, value, ""));
    }
    shape.meridian.iter().enumerate().try_for_each(|(station, point)| check_point(station, point))
}

fn check_point(station: usize, point: &MeridianPoint) -> Result<(), VtkError> {
    let drawn = [
        ("x_m", point.x_m),
        ("r_m", point.r_m),
        ("slope_rad", point.slope_rad),
        ("braid_angle_rad", point.braid_angle_rad),
        ("fibre_tension_N", point.fibre_tension_n),
        ("fibre_strain", point.fibre_strain),
        ("membrane_force_N_per_m", point.membrane_force_n_per_m),
        ("fibre_length_m", point.fibre_length_m),
        ("turn_rad", point.turn_rad),
    ];
    if let Some((quantity, value)) = drawn.into_iter().find(|(_, value)| !value.is_finite()) {
        return Err(VtkError::Drawing(format!(
            "{quantity} is {value} at meridian point {station}: only finite values can be drawn"
        )));
    }
    if point.r_m <= 0.0 {
        return Err(VtkError::Drawing(format!(
            "the radius is {} m at meridian point {station}: it must be positive",
            point.r_m
        )));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analytic::barrel;

    const PLEATS: Style = Style::Pleats { cloth_circumference: None };

    fn message(shape: &Shape, fibres: u32, style: Style, facets: u32) -> String {
        Bulge { shape, fibres, style, facets }.check().unwrap_err().to_string()
    }

    #[test]
    fn refuses_what_can_not_be_drawn_and_says_why() {
        let (straight, braided) = (barrel(8, 0.0), barrel(8, 1.5));
        assert!(message(&straight, 40, PLEATS, 3).contains("3 facets"));
        assert!(message(&straight, 2, PLEATS, 12).contains("found 2"));
        assert!(message(&braided, 40, PLEATS, 12).contains("1.5 rad"));
        let wrong = Style::Pleats { cloth_circumference: Some(f64::NAN) };
        assert!(message(&straight, 40, wrong, 12).contains("NaN"));
        assert!(message(&straight, u32::MAX, PLEATS, u32::MAX).contains("more than a file holds"));
    }

    #[test]
    fn refuses_a_value_that_is_not_finite_and_names_it() {
        let mut shape = barrel(8, 0.0);
        shape.meridian[3].fibre_strain = f64::INFINITY;
        assert_eq!(
            message(&shape, 40, PLEATS, 12),
            "fibre_strain is inf at meridian point 3: only finite values can be drawn"
        );
        let mut shape = barrel(8, 0.0);
        shape.response.force_n = f64::NAN;
        assert!(message(&shape, 40, PLEATS, 12).contains("force_N is NaN"));
        shape = barrel(8, 0.0);
        shape.meridian[2].r_m = 0.0;
        assert!(message(&shape, 0, Style::Revolution, 12).contains("meridian point 2"));
        shape.meridian.truncate(1);
        assert!(message(&shape, 0, Style::Revolution, 12).contains("has 1"));
    }
}
