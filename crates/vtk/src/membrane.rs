//! States of membrane finite elements as VTK XML unstructured grids (`.vtu`): as meshed, revolved, or completed to the whole muscle.

mod arrays;
mod check;
mod copies;
mod drawing;
mod map;
mod series;
mod xml;

pub use series::MembraneSeries;

use crate::{VtkError, whole_file};
use bulge_membrane::case::Case;
use bulge_membrane::{Fields, Part, State, Support};
use drawing::Drawing;
use std::path::Path;

/// One state of a membrane and how it is drawn. Coordinates are those of the mesh, the axis along z, in metres.
///
/// What stands in a file:
///
/// | where | arrays |
/// |---|---|
/// | points (in their present places) | `displacement_m` from the places in the mesh |
/// | cells | `group`, `membrane_force_1_N_per_m`, `membrane_force_2_N_per_m`, `stretch_1`, `stretch_2`, `direction_1`, `folded`, `wrinkle_state` (0 slack, 1 wrinkled, 2 taut, -1 no sheet), `fibre_tension_N`, `fibre_strain`, `fibre_angle_rad` |
/// | field data | `pressure_Pa`, `volume_m3`, `energy_J`, `force_N`, `unstable`, `TimeValue`, `groups` |
///
/// Force and stretch 1 are the larger principal ones, along `direction_1`; of a membrane of revolution those along the meridian. Further sheets
/// on the same membrane have arrays with `_2`, `_3` at the end of their names, and so have further families of threads. A cell that an array
/// doesn't concern has 0 there. `group` is the index of a name in `groups`; [`bulge_membrane::Mesh::from_vtu`] reads what is drawn as meshed as a
/// mesh again, in its present shape. `force_N` is that on the last fitting, 0 without one; volume, energy and force are those of the whole, whatever
/// part of it is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MembranePicture<'a> {
    /// Pressure, volume, forces.
    pub state: &'a State,
    /// What its nodes and elements carry.
    pub fields: &'a Fields,
    /// What is drawn of it.
    pub whole: Whole,
    /// What ParaView shows as time: the number of the state, a contraction, or whatever orders a series.
    pub time: f64,
}

/// What is drawn of a structure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Whole {
    /// The mesh's own cells, at its own nodes: lines, quadratic edges, triangles, quadratic triangles.
    AsMeshed,
    /// Membranes of revolution as a surface of plane facets: one quadrangle along an element with two nodes, two along one with three, triangles at
    /// the axis. Cables and triangles, if there are any, as meshed.
    Revolved {
        /// Facets round the axis, 3 or more; [`Whole::FACETS`] look round.
        facets: u32,
        /// Place on the z axis of the plane at which it is mirrored, m, for half a length.
        middle: Option<f64>,
    },
    /// A sector turned round the z axis, perhaps mirrored before: a quarter of a lobe becomes the whole muscle. Points at the seams are merged; a
    /// cable in a seam is drawn once. A cell mirrored once has its nodes in the other order, so that its normal still points outward.
    Sector {
        /// How often it is turned by one of as many equal parts of a whole turn, 1 or more.
        lobes: u32,
        /// Normal of the plane through the z axis at which it is mirrored, for half a lobe: (0, 1, 0) if it begins at y = 0.
        mirror: Option<[f64; 3]>,
        /// Place on the z axis of the plane at which it is mirrored, m, for half a length.
        middle: Option<f64>,
    },
}

impl Whole {
    /// Facets that look round.
    pub const FACETS: u32 = 96;

    /// Half a lobe of `lobes`, which begins at y = 0, over half the length, from z = 0.
    #[must_use]
    pub const fn half_lobe(lobes: u32) -> Self {
        Self::Sector { lobes, mirror: Some([0.0, 1.0, 0.0]), middle: Some(0.0) }
    }

    /// The whole of a case, by its copies and its planes of symmetry; as meshed, where these don't say it.
    #[must_use]
    pub fn of(case: &Case) -> Self {
        let planes = case.supports.iter().filter_map(|(group, support)| match support {
            Support::Plane { normal } => Some((group, *normal)),
            _ => None,
        });
        let is_axial = |normal: &[f64; 3]| normal[0].hypot(normal[1]) <= 1e-9 * normal[2].abs();
        let is_upright = |normal: &[f64; 3]| normal[2].abs() <= 1e-9 * normal[0].hypot(normal[1]);
        let middle = planes
            .clone()
            .filter(|(_, normal)| case.copies.along > 1.5 && is_axial(normal))
            .find_map(|(group, _)| {
                let nodes = case.mesh.nodes_of(group)?;
                Some(case.mesh.nodes.get(*nodes.first()?)?[2])
            });
        if case.parts.iter().any(|(_, part)| matches!(part, Part::Revolved { .. })) {
            return Self::Revolved { facets: Self::FACETS, middle };
        }
        let around = case.copies.around.round();
        let is_cyclic = case.supports.iter().any(|(_, support)| matches!(support, Support::Cyclic { .. }));
        let upright = planes.map(|(_, normal)| normal).find(is_upright);
        let mirror = upright.filter(|_| !is_cyclic && around >= 2.0 && around % 2.0 == 0.0);
        // Copies that neither a cyclic edge nor a plane explains can't be placed.
        let turned = if mirror.is_some() {
            around / 2.0
        } else if is_cyclic {
            around
        } else {
            1.0
        };
        if turned <= 1.0 && mirror.is_none() && middle.is_none() {
            return Self::AsMeshed;
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a count; too many are refused"
        )]
        Self::Sector { lobes: turned as u32, mirror, middle }
    }
}

/// Writes one state; the file appears whole or not at all.
///
/// # Errors
/// A value isn't finite, the whole can't be drawn as asked, the name doesn't end in `.vtu`, its folder doesn't exist, or the disk refuses. The
/// message names what isn't right.
pub fn write_vtu(path: impl AsRef<Path>, picture: &MembranePicture) -> Result<(), VtkError> {
    let path = path.as_ref();
    if path.extension().is_none_or(|e| !e.eq_ignore_ascii_case("vtu")) {
        return Err(VtkError::GridExtension { path: path.to_path_buf() });
    }
    check::check(picture)?;
    let bytes = xml::encode(Drawing::new(picture)?, picture)
        .map_err(|reason| VtkError::Encode { path: path.to_path_buf(), reason })?;
    whole_file::write(path, &bytes)
}
