//! A structure: the elements of a mesh, and the supports of its nodes.

mod bending;
mod held;
mod mirrors;
mod rigid;

pub(crate) use bending::Stars;

use crate::dofs::Dofs;
use crate::element::{Cable, Contact, Ring, RingLayer, Triangle, Vector};
use crate::error::MembraneError;
use crate::material::{Sheet, Thread};
use crate::mesh::{Block, CellKind, Mesh};
use crate::set::{Element, Elements, Set, packed};
use crate::surface::{Rims, backwards, oriented};
use serde::Serialize;

/// Type of the cells of a group.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub enum Part {
    /// Triangles in space.
    Membrane {
        /// Its material; `None`: it only transmits the pressure.
        sheet: Option<Sheet>,
        /// Direction of the sheet's first axis (warp), in the pattern if there is one.
        warp: Vector,
    },
    /// Lines in the half-plane y = 0, x > 0, revolved about z.
    Revolved {
        /// The layers on it.
        layers: Vec<RingLayer>,
    },
    /// Lines in space.
    Cable {
        /// Its material.
        thread: Thread,
        /// The fraction of it that belongs to the structure: 1/2 if it lies in a plane of symmetry.
        share: f64,
    },
}

/// Support of the nodes of a group.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub enum Support {
    /// The nodes don't move.
    Fixed,
    /// The nodes don't move along this direction: they stay in a plane of symmetry orthogonal to it.
    Plane {
        /// Normal of the plane.
        normal: Vector,
    },
    /// The nodes stay on the z axis.
    Axis,
    /// The nodes keep their distance from the z axis and their angle about it, and may slide along it.
    Slide,
    /// The nodes are attached to a rigid end fitting, which moves along z.
    Fitting {
        /// Index of the fitting, from 0.
        fitting: usize,
    },
    /// The nodes follow those of another group, rotated about z: the far edge of a cyclic sector.
    Cyclic {
        /// The group that they follow.
        partner: String,
        /// Angle from the partner to this group, rad.
        angle: f64,
    },
}

/// Motion of an end fitting.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub enum Fitting {
    /// Its position is prescribed; the force on it is a result.
    Placed,
    /// The force on it is prescribed; its position is a result.
    Loaded,
}

/// Elements of one block, for results.
#[derive(Debug)]
pub(crate) enum Group {
    Cable2(Set<Cable<2>, 2>),
    Cable3(Set<Cable<3>, 3>),
    Ring2(Set<Ring<2>, 2>),
    Ring3(Set<Ring<3>, 3>),
    Triangle3(Set<Triangle<3>, 3>),
    Triangle6(Set<Triangle<6>, 6>),
}

macro_rules! each {
    ($group:expr, $set:ident => $body:expr) => {
        match $group {
            Group::Cable2($set) => $body,
            Group::Cable3($set) => $body,
            Group::Ring2($set) => $body,
            Group::Ring3($set) => $body,
            Group::Triangle3($set) => $body,
            Group::Triangle6($set) => $body,
        }
    };
}

impl Group {
    pub(crate) fn elements(&self) -> &dyn Elements {
        each!(self, set => set)
    }

    pub(crate) fn elements_mut(&mut self) -> &mut dyn Elements {
        each!(self, set => set)
    }
}

/// Elements and supports of an equilibrium problem.
#[derive(Debug)]
pub struct Structure {
    pub(crate) groups: Vec<(String, Group)>,
    /// Nodes that planes of symmetry stop.
    pub(crate) contacts: Set<Contact, 1>,
    /// Nodes of sheets that resist bending.
    pub(crate) stars: Stars,
    pub(crate) dofs: Dofs,
    /// Values of the degrees of freedom at the positions of the mesh.
    pub(crate) start: Vec<f64>,
    pub(crate) places: Vec<Vector>,
    pub(crate) fittings: Vec<Fitting>,
}

impl Structure {
    /// The structure over `mesh`, with `parts` and `supports` by the names of its groups, which must exist.
    ///
    /// # Errors
    /// An unknown group, an element without length or area, an open edge, contradictory supports, a part that
    /// isn't held, or a structure with nothing to solve for.
    pub fn new(
        mesh: &Mesh,
        parts: &[(String, Part)],
        supports: &[(String, Support)],
        fittings: &[Fitting],
    ) -> Result<Self, MembraneError> {
        let turned = oriented(mesh, parts, &Rims::new(mesh, supports)?)?;
        let mut groups = Vec::new();
        let mut is_used = vec![false; mesh.nodes.len()];
        let mut is_flat = vec![false; mesh.nodes.len()];
        for (name, part) in parts {
            let mut is_known = false;
            for (b, block) in mesh.blocks.iter().enumerate().filter(|(_, block)| block.group == *name) {
                is_known = true;
                if block.kind == CellKind::Point {
                    continue;
                }
                let source = Source { mesh, block, is_turned: &|cell| turned.is_turned(b, cell) };
                groups.push((name.clone(), source.group(part)?));
                for node in &block.cells {
                    is_used[*node] = true;
                    is_flat[*node] |= matches!(part, Part::Revolved { .. });
                }
            }
            if !is_known {
                return Err(MembraneError::unknown_group(name, mesh));
            }
        }
        let (dofs, start) = held::dofs(mesh, supports, fittings, &is_used, &is_flat)?;
        if dofs.free == 0 {
            return Err(MembraneError::nothing_moves());
        }
        rigid::check(mesh, &groups, &dofs, &is_flat)?;
        let contacts = Set::new(Vec::new(), Vec::new());
        let (stars, places, fittings) = (Stars::default(), mesh.nodes.clone(), fittings.to_vec());
        Self { groups, contacts, stars, dofs, start, places, fittings }.with_room()
    }

    /// The same with planes of symmetry that stop the triangles, because their mirror image is on the other side: the
    /// groups of `supports` that are edges held in such a plane. A plane on which the whole mesh lies stops nothing.
    ///
    /// # Errors
    /// An unknown group, cloth on both sides of a plane, or no triangles.
    pub fn stopped(
        mut self,
        mesh: &Mesh,
        supports: &[(String, Support)],
        groups: &[String],
    ) -> Result<Self, MembraneError> {
        self.contacts = mirrors::contacts(mesh, &self.groups, supports, groups)?;
        Ok(self)
    }

    /// The same with sheets that resist bending: groups of triangles with three nodes, and their bending stiffness D \[N m\].
    /// They are free of stress when flat, stretch little, and go on beyond planes of symmetry that they cross (within 30
    /// degrees of the normal); at other supports they hinge freely, along straight lines.
    ///
    /// # Errors
    /// An unknown group, triangles with six nodes, a mesh that is curved without a pattern, an edge or a fold that nothing holds,
    /// a node with more than 16 neighbours, or a sector whose edges follow each other.
    pub fn resisting_bending(
        mut self,
        mesh: &Mesh,
        supports: &[(String, Support)],
        groups: &[(String, f64)],
    ) -> Result<Self, MembraneError> {
        self.stars = bending::stars(mesh, supports, groups)?;
        self.with_room()
    }

    /// Refuses more numbers than the assembly can count.
    fn with_room(self) -> Result<Self, MembraneError> {
        let numbers: usize = self.sets().iter().map(|set| set.count() * packed(3 * set.each())).sum();
        if numbers > u32::MAX as usize / 2 {
            return Err(MembraneError::Memory { unknowns: self.dofs.free });
        }
        Ok(self)
    }

    /// Everything that has energy or volume.
    pub(crate) fn sets(&self) -> Vec<&dyn Elements> {
        let contacts: &dyn Elements = &self.contacts;
        self.groups
            .iter()
            .map(|(_, group)| group.elements())
            .chain([contacts])
            .chain(self.stars.sets())
            .collect()
    }

    /// Number of degrees of freedom that are solved for.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        self.dofs.free
    }

    /// Number of elements.
    #[must_use]
    pub fn elements(&self) -> usize {
        self.groups.iter().map(|(_, group)| group.elements().count()).sum()
    }

    /// The largest number of threads that pull side by side.
    pub(crate) fn threads(&self) -> f64 {
        let count = |layers: &[crate::element::Layer]| {
            layers.iter().map(crate::element::Layer::count).fold(0.0, f64::max)
        };
        let groups = self.groups.iter().map(|(_, group)| match group {
            Group::Ring2(set) => set.elements.first().map_or(0.0, |ring| count(&ring.layers)),
            Group::Ring3(set) => set.elements.first().map_or(0.0, |ring| count(&ring.layers)),
            _ => 0.0,
        });
        groups.fold(0.0, f64::max)
    }

    /// The size of the structure: the diagonal of the bounding box of its nodes.
    pub(crate) fn size(&self) -> f64 {
        let mut range = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
        for place in &self.places {
            for (range, x) in range.iter_mut().zip(place) {
                *range = [range[0].min(*x), range[1].max(*x)];
            }
        }
        range.iter().map(|[low, high]| (high - low).powi(2)).sum::<f64>().sqrt()
    }
}

/// A block before its elements are built.
struct Source<'a> {
    mesh: &'a Mesh,
    block: &'a Block,
    is_turned: &'a dyn Fn(usize) -> bool,
}

impl Source<'_> {
    /// The stress-free positions of a cell's nodes.
    fn stress_free<const N: usize>(&self, cell: usize) -> [Vector; N] {
        core::array::from_fn(|i| match &self.block.pattern {
            Some(pattern) => {
                let [u, v] = pattern[cell * N + i];
                [u, v, 0.0]
            }
            None => self.mesh.nodes[self.block.cells[cell * N + i]],
        })
    }

    #[expect(
        clippy::cast_possible_truncation,
        reason = "a mesh has fewer than 2^31 nodes: checked when it is read"
    )]
    fn built<E: Element<N>, const N: usize>(
        &self,
        what: &'static str,
        element: impl Fn(&[Vector; N]) -> Option<E>,
    ) -> Result<Set<E, N>, MembraneError> {
        let (cells, _) = self.block.cells.as_chunks::<N>();
        let mut nodes = Vec::with_capacity(cells.len());
        let mut elements = Vec::with_capacity(cells.len());
        for (i, cell) in cells.iter().enumerate() {
            let (mut places, mut cell) = (self.stress_free(i), cell.map(|node| node as u32));
            if (self.is_turned)(i) {
                (places, cell) = (backwards(self.block.kind, places), backwards(self.block.kind, cell));
            }
            elements.push(element(&places).ok_or_else(|| {
                let (number, group) = (self.block.numbers.get(i), &self.block.group);
                MembraneError::Structure(format!(
                    "element {} of `{group}` has no {what}, or folds over itself: give it nodes that lie apart",
                    number.copied().unwrap_or(i as u64 + 1)
                ))
            })?);
            nodes.push(cell);
        }
        Ok(Set::new(nodes, elements))
    }

    fn group(&self, part: &Part) -> Result<Group, MembraneError> {
        const OFF_AXIS: &str = "length off the axis";
        match (part, self.block.kind) {
            (Part::Membrane { sheet, warp }, CellKind::Triangle3) => {
                Ok(Group::Triangle3(self.built("area", |x| Triangle::new(x, *warp, *sheet))?))
            }
            (Part::Membrane { sheet, warp }, CellKind::Triangle6) => {
                Ok(Group::Triangle6(self.built("area", |x| Triangle::new(x, *warp, *sheet))?))
            }
            (Part::Revolved { layers }, CellKind::Line2) => {
                Ok(Group::Ring2(self.built(OFF_AXIS, |x| Ring::new(x, layers))?))
            }
            (Part::Revolved { layers }, CellKind::Line3) => {
                Ok(Group::Ring3(self.built(OFF_AXIS, |x| Ring::new(x, layers))?))
            }
            (Part::Cable { thread, share }, CellKind::Line2) => {
                Ok(Group::Cable2(self.built("length", |x| Cable::new(x, *thread, *share))?))
            }
            (Part::Cable { thread, share }, CellKind::Line3) => {
                Ok(Group::Cable3(self.built("length", |x| Cable::new(x, *thread, *share))?))
            }
            (_, kind) => Err(MembraneError::Structure(format!(
                "`{}` has cells of the kind {kind:?}: membranes are made of triangles, cables and membranes of revolution of lines",
                self.block.group
            ))),
        }
    }
}
