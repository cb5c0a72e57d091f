//! States of membrane finite elements as VTK XML unstructured grids (`.vtu`): as meshed, revolved, or completed to the whole muscle.

mod arrays;
mod check;
mod copies;
mod drawing;
mod folder;
mod map;
mod series;
mod writer;
mod xml;

pub use folder::CaseFolder;
pub use series::MembraneSeries;

use crate::error::check_extension;
use crate::{VtkError, whole_file};
use bulge_membrane::case::Case;
use bulge_membrane::{Fields, Part, State, Support};
use drawing::Drawing;
use std::path::Path;

/// One state of a membrane and how it is drawn. Coordinates are those of the mesh in metres, with the axis
/// along z.
///
/// Content of a file:
///
/// | where | arrays |
/// |---|---|
/// | points (in their present places) | `displacement_m` from the places in the mesh |
/// | cells | `group`, `membrane_force_1_N_per_m`, `membrane_force_2_N_per_m`, `stretch_1`, `stretch_2`, `direction_1`, `folded`, `wrinkle_state` (0 slack, 1 wrinkled, 2 taut, -1 no sheet), `fibre_tension_N`, `fibre_strain`, `fibre_angle_rad` |
/// | field data | `pressure_Pa`, `volume_m3`, `energy_J`, `force_N`, `unstable`, `TimeValue`, `groups` |
///
/// Force and stretch 1 are the larger principal values, along `direction_1`; for a membrane of revolution
/// they are the values along the meridian. Further sheets on the same membrane have arrays with `_2`, `_3` at
/// the end of their names, and so do further families of threads. A cell without a quantity has 0 in its
/// array. `group` is the index of a name in `groups`. A picture drawn as meshed can be read back as a mesh in
/// its present shape with [`bulge_membrane::Mesh::from_vtu`]. `force_N` is the force on the last fitting, 0
/// without one. Volume, energy and force are those of the whole, whatever part of it is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MembranePicture<'a> {
    /// Pressure, volume and forces.
    pub state: &'a State,
    /// The fields of its nodes and elements.
    pub fields: &'a Fields,
    /// The part or the whole to be drawn.
    pub whole: Whole,
    /// The time that ParaView shows: the number of the state, a contraction, or any other value that orders a
    /// series.
    pub time: f64,
}

/// What is drawn of a structure: the mesh itself, or the whole of which it is a part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Whole {
    /// The cells and nodes of the mesh: lines, quadratic edges, triangles, quadratic triangles.
    AsMeshed,
    /// Membranes of revolution as a surface of plane facets: one quadrangle along an element with two nodes,
    /// two along one with three, triangles at the axis. Cables and triangles are drawn as meshed.
    Revolved {
        /// Facets around the axis, 3 or more; [`Whole::FACETS`] look round.
        facets: u32,
        /// Position on the z axis \[m\] of the plane at which half a length is mirrored.
        middle: Option<f64>,
    },
    /// A sector that is rotated about the z axis, and mirrored before if needed: a quarter of a lobe becomes
    /// the whole muscle. Points at the seams are merged, and a cable in a seam is drawn once. A mirrored cell
    /// has its nodes in reverse order, so that its normal still points outward.
    Sector {
        /// Number of rotated copies, 1 or more; each is rotated by 1/`lobes` of a turn from the one before.
        lobes: u32,
        /// Normal of the plane through the z axis at which half a lobe is mirrored: (0, 1, 0) if it begins at
        /// y = 0.
        mirror: Option<[f64; 3]>,
        /// Position on the z axis \[m\] of the plane at which half a length is mirrored.
        middle: Option<f64>,
    },
}

impl Whole {
    /// Number of facets that looks round.
    pub const FACETS: u32 = 96;

    /// Half of one of `lobes` lobes, beginning at y = 0, over half the length, beginning at z = 0.
    #[must_use]
    pub const fn half_lobe(lobes: u32) -> Self {
        Self::Sector { lobes, mirror: Some([0.0, 1.0, 0.0]), middle: Some(0.0) }
    }

    /// The whole structure of a case, from its copies and its planes of symmetry; as meshed if these don't
    /// define it.
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
        // Copies can only be placed if a cyclic edge or a plane explains them.
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
/// A value isn't finite, the whole can't be drawn as requested, the name doesn't end in `.vtu`, its folder
/// doesn't exist, or the disk refuses. The message names the problem.
pub fn write_vtu(path: impl AsRef<Path>, picture: &MembranePicture) -> Result<(), VtkError> {
    let path = path.as_ref();
    check_extension(path, "vtu")?;
    check::check(picture)?;
    let bytes = xml::encode(Drawing::new(picture)?, picture);
    whole_file::write(path, &bytes)
}
