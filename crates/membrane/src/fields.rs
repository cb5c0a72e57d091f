//! Fields of a state: positions of the nodes, and forces of every element.

use crate::element::{Carried, CarriedByRing, Vector, norm};
use crate::material::Tension;
use crate::mesh::CellKind;
use crate::set::{Element, Set};
use crate::solver::Solver;
use crate::state::State;
use crate::structure::Group;
use serde::Serialize;

/// The fields of a state.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Fields {
    /// Position of each node, m.
    pub places: Vec<Vector>,
    /// Displacement of each node from its position in the mesh, m.
    pub displacements: Vec<Vector>,
    /// Forces in the elements of each group, in the order of the groups.
    pub groups: Vec<GroupFields>,
}

/// The elements of one group.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GroupFields {
    /// Its name.
    pub name: String,
    /// Its cells.
    pub kind: CellKind,
    /// Whether the cells are revolved about z.
    pub is_revolved: bool,
    /// Nodes of each cell.
    pub cells: Vec<u32>,
    /// Stress-free area of each cell, m^2 (0 for cables); over the full circumference for a membrane of
    /// revolution.
    pub areas: Vec<f64>,
    /// The sheets, layer by layer; triangles have one or none.
    pub sheets: Vec<Vec<SheetField>>,
    /// The families of threads, or the cable.
    pub threads: Vec<Vec<ThreadField>>,
}

/// Forces of a sheet in the middle of an element.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SheetField {
    /// Principal forces per current length, N/m, the larger first; in a membrane of revolution along the
    /// meridian and around.
    pub force: [f64; 2],
    /// Stretches: in the same directions for a membrane of revolution, otherwise the principal ones, the
    /// larger first.
    pub stretch: [f64; 2],
    /// Unit vector along the first force; zero for a membrane of revolution.
    pub direction: Vector,
    /// Taut, wrinkled or slack. For a sheet that doesn't wrinkle: tension in two directions, in one, or in
    /// none; it carries compression in the others.
    pub tension: Tension,
    /// The fraction of the cloth's width that is folded away; 0 if it is taut.
    pub folded: f64,
}

/// Forces of a thread in the middle of an element.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ThreadField {
    /// Tension of each thread, N.
    pub tension: f64,
    /// Its stretch.
    pub stretch: f64,
    /// Angle to the meridian, rad; 0 for a cable.
    pub angle: f64,
}

/// Scalar results of a state, as for a line of a table.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Summary {
    /// Largest distance from the z axis, m.
    pub radius: f64,
    /// Fractions of the sheets' stress-free area that are taut, wrinkled and slack.
    pub shares: [f64; 3],
    /// Smallest and largest principal force of the sheets, N/m.
    pub forces: [f64; 2],
    /// Smallest and largest tension of a thread, N.
    pub threads: [f64; 2],
}

impl Solver {
    /// Positions, forces and stretches of a state.
    #[must_use]
    pub fn fields(&mut self, state: &State) -> Fields {
        self.restore(state);
        let mut places = Vec::new();
        self.structure.dofs.places(&state.y, &mut places);
        let displacements = places
            .iter()
            .zip(&self.structure.places)
            .map(|(now, before)| [now[0] - before[0], now[1] - before[1], now[2] - before[2]])
            .collect();
        let groups =
            self.structure.groups.iter().map(|(name, group)| self.group(name, group, &places)).collect();
        Fields { places, displacements, groups }
    }

    fn group(&self, name: &str, group: &Group, x: &[Vector]) -> GroupFields {
        let (kind, is_revolved) = match group {
            Group::Cable2(_) => (CellKind::Line2, false),
            Group::Cable3(_) => (CellKind::Line3, false),
            Group::Ring2(_) => (CellKind::Line2, true),
            Group::Ring3(_) => (CellKind::Line3, true),
            Group::Triangle3(_) => (CellKind::Triangle3, false),
            Group::Triangle6(_) => (CellKind::Triangle6, false),
        };
        let mut out = GroupFields {
            name: name.to_owned(),
            kind,
            is_revolved,
            cells: Vec::new(),
            areas: Vec::new(),
            sheets: Vec::new(),
            threads: Vec::new(),
        };
        match group {
            Group::Cable2(set) => self.cables(set, x, &mut out),
            Group::Cable3(set) => self.cables(set, x, &mut out),
            Group::Ring2(set) => self.rings(set, x, &mut out),
            Group::Ring3(set) => self.rings(set, x, &mut out),
            Group::Triangle3(set) => triangles(set, x, &mut out),
            Group::Triangle6(set) => triangles(set, x, &mut out),
        }
        out
    }

    fn cables<const N: usize>(
        &self,
        set: &Set<crate::element::Cable<N>, N>,
        x: &[Vector],
        out: &mut GroupFields,
    ) {
        let mut all = Vec::new();
        for (element, at) in each(set, x, out) {
            let (tension, stretch) = element.tension(&at, self.penalty);
            all.push(ThreadField { tension, stretch, angle: 0.0 });
        }
        out.areas = vec![0.0; all.len()];
        out.threads.push(all);
    }

    fn rings<const N: usize>(
        &self,
        set: &Set<crate::element::Ring<N>, N>,
        x: &[Vector],
        out: &mut GroupFields,
    ) {
        for (element, at) in each(set, x, out) {
            out.areas.push(element.area());
            let (mut sheet, mut thread) = (0, 0);
            for carried in element.carried(&at, self.penalty) {
                match carried {
                    CarriedByRing::Sheet { force, stretch, tension, folded } => {
                        let field = SheetField { force, stretch, direction: [0.0; 3], tension, folded };
                        put(&mut out.sheets, sheet, field);
                        sheet += 1;
                    }
                    CarriedByRing::Threads { tension, stretch, angle } => {
                        put(&mut out.threads, thread, ThreadField { tension, stretch, angle });
                        thread += 1;
                    }
                }
            }
        }
    }
}

fn triangles<const N: usize>(set: &Set<crate::element::Triangle<N>, N>, x: &[Vector], out: &mut GroupFields) {
    for (element, at) in each(set, x, out) {
        out.areas.push(element.area());
        if let Some(Carried { force, stretch, direction, tension, folded }) = element.carried(&at) {
            put(&mut out.sheets, 0, SheetField { force, stretch, direction, tension, folded });
        }
    }
}

fn put<T>(layers: &mut Vec<Vec<T>>, layer: usize, value: T) {
    if layers.len() <= layer {
        layers.push(Vec::new());
    }
    layers[layer].push(value);
}

/// Each element with the positions of its nodes; their numbers are recorded.
fn each<'a, E: Element<N>, const N: usize>(
    set: &'a Set<E, N>,
    x: &[Vector],
    out: &mut GroupFields,
) -> Vec<(&'a E, [Vector; N])> {
    out.cells = set.nodes.as_flattened().to_vec();
    set.elements
        .iter()
        .zip(&set.nodes)
        .map(|(element, nodes)| (element, nodes.map(|node| x[node as usize])))
        .collect()
}

impl Fields {
    /// The scalar results.
    #[must_use]
    pub fn summary(&self) -> Summary {
        let mut is_used = vec![false; self.places.len()];
        let mut areas = [0.0; 3];
        let mut forces = [f64::INFINITY, f64::NEG_INFINITY];
        let mut threads = forces;
        for group in &self.groups {
            for node in &group.cells {
                is_used[*node as usize] = true;
            }
            for sheet in &group.sheets {
                for (field, area) in sheet.iter().zip(&group.areas) {
                    let at = match field.tension {
                        Tension::Taut => 0,
                        Tension::Wrinkled => 1,
                        Tension::Slack => 2,
                    };
                    areas[at] += area;
                    forces[0] = forces[0].min(field.force[0].min(field.force[1]));
                    forces[1] = forces[1].max(field.force[0].max(field.force[1]));
                }
            }
            for thread in group.threads.iter().flatten() {
                threads = [threads[0].min(thread.tension), threads[1].max(thread.tension)];
            }
        }
        let used = self.places.iter().zip(&is_used).filter(|(_, is_used)| **is_used);
        let radius = used.fold(0.0_f64, |a, (x, _)| a.max(norm([x[0], x[1], 0.0])));
        let all: f64 = areas.iter().sum();
        let shares = areas.map(|area| if all > 0.0 { area / all } else { 0.0 });
        let known = |range: [f64; 2]| if range[0] <= range[1] { range } else { [0.0; 2] };
        Summary { radius, shares, forces: known(forces), threads: known(threads) }
    }
}
