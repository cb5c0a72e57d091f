//! Builds a mesh from the nodes and elements of a file.

use super::super::{Block, CellKind, Mesh, MeshError};
use super::cursor::{Cursor, DAMAGED};
use bulge_muscles::shown::one_line;
use std::collections::{HashMap, HashSet};

/// The data read so far.
#[derive(Default)]
pub(super) struct Assembly {
    mesh: Mesh,
    /// Names of the physical groups by dimension and number.
    names: HashMap<(u8, u32), String>,
    /// Indices of nodes by their number in the file. A map, because the numbers may be sparse and huge.
    indices: HashMap<u64, usize>,
    /// Blocks by the number of their physical group and their kind.
    blocks: HashMap<(Option<u32>, CellKind), usize>,
    /// Blocks by the name of their group and their kind.
    named_blocks: HashMap<(String, CellKind), usize>,
    /// Whether each block belongs to a physical group.
    is_grouped: Vec<bool>,
}

/// The nodes of an element, as many as its kind has.
pub(super) struct Nodes {
    indices: [usize; 6],
    kind: CellKind,
}

impl Nodes {
    /// The cell, reversed if its physical group says so.
    fn ordered(&self, is_reversed: bool) -> impl Iterator<Item = usize> {
        const AHEAD: [usize; 6] = [0, 1, 2, 3, 4, 5];
        let order = match (is_reversed, self.kind) {
            (true, CellKind::Line2 | CellKind::Line3) => [1, 0, 2, 3, 4, 5],
            (true, CellKind::Triangle3 | CellKind::Triangle6) => [0, 2, 1, 5, 4, 3],
            _ => AHEAD,
        };
        let indices = self.indices;
        order.into_iter().take(self.kind.nodes()).filter_map(move |place| indices.get(place).copied())
    }
}

impl Assembly {
    pub(super) fn reserve_nodes(&mut self, count: usize) {
        self.mesh.nodes.reserve(count);
        self.mesh.numbers.reserve(count);
        self.indices.reserve(count);
    }

    /// Names a physical group; returns false if it has a name already.
    pub(super) fn name(&mut self, dimension: u8, group: u32, name: &str) -> bool {
        self.names.insert((dimension, group), one_line(name).into_owned()).is_none()
    }

    pub(super) fn add_node(
        &mut self,
        cursor: &Cursor,
        number: u64,
        place: [f64; 3],
    ) -> Result<(), MeshError> {
        if self.indices.insert(number, self.mesh.nodes.len()).is_some() {
            return Err(cursor.error(format_args!("node {number} stands in the file twice"), DAMAGED));
        }
        self.mesh.nodes.push(place);
        self.mesh.numbers.push(number);
        Ok(())
    }

    /// Reads the nodes of an element, each by `read`.
    pub(super) fn element(
        &self,
        cursor: &mut Cursor,
        kind: CellKind,
        number: u64,
        mut read: impl FnMut(&mut Cursor) -> Result<u64, MeshError>,
    ) -> Result<Nodes, MeshError> {
        let mut nodes = Nodes { indices: [usize::MAX; 6], kind };
        for place in 0..kind.nodes() {
            let node = read(cursor)?;
            let Some(index) = self.indices.get(&node) else {
                return Err(cursor.error(
                    format_args!("element {number} needs node {node}, which is not in the file"),
                    DAMAGED,
                ));
            };
            if nodes.indices.contains(index) {
                return Err(cursor.error(
                    format_args!("element {number} has node {node} twice"),
                    "remove the degenerate element: mesh again, or join the nodes before meshing",
                ));
            }
            if let Some(slot) = nodes.indices.get_mut(place) {
                *slot = *index;
            }
        }
        Ok(nodes)
    }

    /// The block for elements of a kind in a physical group; groups with the same name are merged.
    pub(super) fn block(&mut self, group: Option<u32>, kind: CellKind) -> usize {
        if let Some(block) = self.blocks.get(&(group, kind)) {
            return *block;
        }
        let name = group.map_or_else(String::new, |number| {
            let name = self.names.get(&(dimension(kind), number)).filter(|name| !name.is_empty());
            name.cloned().unwrap_or_else(|| number.to_string())
        });
        let next = self.mesh.blocks.len();
        let block = *self.named_blocks.entry((name.clone(), kind)).or_insert(next);
        if block == next {
            let (cells, numbers) = (Vec::new(), Vec::new());
            self.mesh.blocks.push(Block { group: name, kind, cells, numbers, pattern: None });
            self.is_grouped.push(group.is_some());
        }
        self.blocks.insert((group, kind), block);
        block
    }

    pub(super) fn add_cell(&mut self, block: usize, number: u64, nodes: &Nodes, is_reversed: bool) {
        if let Some(block) = self.mesh.blocks.get_mut(block) {
            block.cells.extend(nodes.ordered(is_reversed));
            block.numbers.push(number);
        }
    }

    /// The mesh. Elements without a physical group are only kept if there are no physical groups, as when
    /// Gmsh saves.
    pub(super) fn finish(mut self, cursor: &Cursor) -> Result<Mesh, MeshError> {
        if self.mesh.blocks.is_empty() {
            return Err(cursor.error_of_file(
                "the mesh has no elements",
                "mesh the geometry before saving it (`gmsh -2` for surfaces, `gmsh -1` for lines)",
            ));
        }
        let grouped: HashSet<u8> = (self.mesh.blocks.iter().zip(&self.is_grouped))
            .filter(|(_, is_grouped)| **is_grouped)
            .map(|(block, _)| dimension(block.kind))
            .collect();
        let mut is_grouped = self.is_grouped.into_iter();
        self.mesh.blocks.retain(|block| {
            is_grouped.next().unwrap_or_default() || !grouped.contains(&dimension(block.kind))
        });
        Ok(self.mesh)
    }
}

/// Dimension of a cell: point, curve or surface.
pub(super) fn dimension(kind: CellKind) -> u8 {
    match kind {
        CellKind::Point => 0,
        CellKind::Line2 | CellKind::Line3 => 1,
        CellKind::Triangle3 | CellKind::Triangle6 => 2,
    }
}

/// The cell kind of Gmsh's element type. The error for a type without use in a membrane names the element.
pub(super) fn kind(cursor: &Cursor, element_type: i32, number: u64) -> Result<CellKind, MeshError> {
    let surface = "mesh with triangles (in Gmsh: without `Recombine`)";
    let volume = "save only the surfaces: mesh in two dimensions, or put them into physical groups and save without \
                  \"Save all elements\"";
    let order = "mesh with order 1 or 2 (in Gmsh: `Mesh.ElementOrder`)";
    let (what, instead) = match element_type {
        15 => return Ok(CellKind::Point),
        1 => return Ok(CellKind::Line2),
        8 => return Ok(CellKind::Line3),
        2 => return Ok(CellKind::Triangle3),
        9 => return Ok(CellKind::Triangle6),
        3 => ("a 4-node quadrangle", surface),
        10 => ("a 9-node quadrangle", surface),
        16 => ("an 8-node quadrangle", surface),
        4 => ("a 4-node tetrahedron", volume),
        5 => ("an 8-node hexahedron", volume),
        6 => ("a 6-node prism", volume),
        7 => ("a 5-node pyramid", volume),
        11 => ("a 10-node tetrahedron", volume),
        12 => ("a 27-node hexahedron", volume),
        13 => ("an 18-node prism", volume),
        14 => ("a 14-node pyramid", volume),
        17 => ("a 20-node hexahedron", volume),
        18 => ("a 15-node prism", volume),
        19 => ("a 13-node pyramid", volume),
        20 => ("a 9-node triangle", order),
        21 => ("a 10-node triangle", order),
        22 => ("a 12-node triangle", order),
        23 | 24 => ("a 15-node triangle", order),
        25 => ("a 21-node triangle", order),
        26 => ("a 4-node line", order),
        27 => ("a 5-node line", order),
        28 => ("a 6-node line", order),
        29 => ("a 20-node tetrahedron", volume),
        other => {
            let instead = "mesh with points, lines and triangles of order 1 or 2";
            return Err(cursor.error(format_args!("element {number} is of type {other} of Gmsh"), instead));
        }
    };
    Err(cursor.error(format_args!("element {number} is {what}"), instead))
}
