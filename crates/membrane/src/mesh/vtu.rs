//! Unstructured grids of VTK in XML (.vtu): <https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html>.

mod array;
mod document;

use super::{Block, CellKind, Mesh, MeshError};
use array::{Arrays, brief, name};
use document::CUT;
use roxmltree::{Document, Node};
use std::collections::HashMap;

impl Mesh {
    /// Reads an unstructured grid of VTK (.vtu) with vertices, lines and triangles of order 1 or 2: as text,
    /// inline or appended, uncompressed or zlib-compressed, of either byte order. `origin` is the file's name
    /// in messages.
    ///
    /// The group of a cell is its integer in the cell data `group`. If the field data have strings `groups`,
    /// it is the name at that index, counted from 0; otherwise the integer itself, such as `7`. Without
    /// `group`, the physical groups that meshio writes (`gmsh:physical`) are taken, where 0 is no group;
    /// without these as well, no block has a name. Blocks come in the order of their first cells. Point data
    /// `pattern` with two components (a third is ignored) give the positions in the flat pattern of the
    /// cloth. Several pieces are concatenated; nodes on their common boundary are not joined. Nodes and cells
    /// are numbered from 0, as ParaView shows them.
    ///
    /// # Errors
    ///
    /// If the file can't be read or isn't such a grid. The error has the line of the XML element.
    pub fn from_vtu(bytes: &[u8], origin: &str) -> Result<Self, MeshError> {
        let parts = document::parts(bytes, origin)?;
        document::check(&parts.xml, origin)?;
        let document = Document::parse(&parts.xml).map_err(|error| MeshError {
            file: format!("{origin}:{}", error.pos().row),
            what: format!("the XML can't be read: {}", brief(&error.to_string())),
            instead: CUT.to_owned(),
        })?;
        let arrays = Arrays::new(origin, &document, parts.appended, bytes.len())?;
        let grid = grid(&arrays, document.root_element())?;
        let names = match child(grid, "FieldData").and_then(|data| array_named(data, "groups")) {
            Some(array) if array.attribute("type") == Some("String") => arrays.strings(array)?,
            Some(array) => {
                return Err(arrays.error(
                    array,
                    "the field data `groups` are no strings",
                    "write type `String`",
                ));
            }
            None => Vec::new(),
        };
        let mut assembly = Assembly {
            names,
            mesh: Self::default(),
            blocks: HashMap::new(),
            named_blocks: HashMap::new(),
            cells: 0,
            has_pattern: None,
        };
        for piece in grid.children().filter(|node| node.has_tag_name("Piece")) {
            assembly.read_piece(&arrays, piece)?;
        }
        if assembly.mesh.blocks.is_empty() {
            return Err(arrays.error(
                grid,
                "the grid has no cells",
                "save a grid with triangles, lines or vertices",
            ));
        }
        Ok(assembly.mesh)
    }
}

/// The XML element of the grid, if the file is of this kind.
fn grid<'a, 'xml>(arrays: &Arrays, root: Node<'a, 'xml>) -> Result<Node<'a, 'xml>, MeshError> {
    if !root.has_tag_name("VTKFile") {
        let what = format!("the file is XML of <{}>, not of <VTKFile>", brief(root.tag_name().name()));
        return Err(arrays.error(root, what, "give an unstructured grid of VTK (.vtu)"));
    }
    let kind = root.attribute("type").unwrap_or_default();
    if kind != "UnstructuredGrid" {
        let instead = match kind {
            "PUnstructuredGrid"
            | "Collection"
            | "vtkMultiBlockDataSet"
            | "vtkPartitionedDataSetCollection" => {
                "it only names other files: give one of these, or open it with ParaView, apply `Merge Blocks` and save as .vtu"
            }
            _ => {
                "open it with ParaView, apply `Append Datasets` to get an unstructured grid, and save as .vtu"
            }
        };
        return Err(arrays.error(
            root,
            format!("the file is of type `{}`, not `UnstructuredGrid`", brief(kind)),
            instead,
        ));
    }
    child(root, kind).ok_or_else(|| arrays.error(root, "there is no element <UnstructuredGrid>", CUT))
}

/// The group of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
enum Group {
    #[default]
    None,
    /// From the array `group`: possibly the index of a name.
    Index(i64),
    /// From the array `gmsh:physical`.
    Physical(i64),
}

/// The data read so far.
struct Assembly {
    /// Names of groups by their index.
    names: Vec<String>,
    mesh: Mesh,
    /// Blocks by group and kind.
    blocks: HashMap<(Group, CellKind), usize>,
    /// Blocks by the name of their group and their kind.
    named_blocks: HashMap<(String, CellKind), usize>,
    /// Number of cells so far.
    cells: usize,
    /// Whether the pieces with cells have a pattern.
    has_pattern: Option<bool>,
}

impl Assembly {
    fn read_piece(&mut self, arrays: &Arrays, piece: Node) -> Result<(), MeshError> {
        let points = arrays.count(piece, "NumberOfPoints")?;
        let cells = arrays.count(piece, "NumberOfCells")?;
        let first = self.mesh.nodes.len();
        if points > 0 {
            let array = child(piece, "Points").and_then(|points| points.children().find(Node::is_element));
            let Some(array) = array.filter(|array| array.attribute("NumberOfComponents") == Some("3")) else {
                return Err(arrays.error(piece, "there is no array of points with three components", CUT));
            };
            let places = arrays.numbers(array, Some(points.saturating_mul(3)))?;
            self.mesh.nodes.extend(places.as_chunks().0);
            self.mesh.numbers.extend((first..self.mesh.nodes.len()).map(|number| number as u64));
        }
        if cells == 0 {
            return Ok(());
        }
        let pattern = pattern(arrays, piece, points)?;
        if self.has_pattern.is_some_and(|has_pattern| has_pattern != pattern.is_some()) {
            let what = "some pieces have the point data `pattern`, others haven't";
            return Err(arrays.error(piece, what, "give all of them a pattern, or none"));
        }
        self.has_pattern = Some(pattern.is_some());
        let groups = self.groups(arrays, piece, cells)?;
        let data =
            child(piece, "Cells").ok_or_else(|| arrays.error(piece, "there is no element <Cells>", CUT))?;
        let of_cells = |name: &str, expected| {
            let array = array_named(data, name)
                .ok_or_else(|| arrays.error(data, format!("there is no array `{name}`"), CUT))?;
            arrays.integers(array, expected)
        };
        let types = of_cells("types", Some(cells))?;
        let offsets = of_cells("offsets", Some(cells))?;
        let connectivity = of_cells("connectivity", None)?;
        let mut rest = connectivity.as_slice();
        let mut end = 0;
        for (cell, (cell_type, offset)) in types.into_iter().zip(offsets).enumerate() {
            let number = self.cells + cell;
            let kind = kind(arrays, data, cell_type, number)?;
            end += kind.nodes();
            let nodes = rest.split_at_checked(kind.nodes()).filter(|_| i64::try_from(end) == Ok(offset));
            let Some((nodes, after)) = nodes else {
                let what =
                    format!("cell {number} ends at offset {offset} of {}, not at {end}", connectivity.len());
                return Err(arrays.error(data, what, CUT));
            };
            rest = after;
            let block = self.block(groups.get(cell).copied().unwrap_or_default(), kind, pattern.is_some());
            self.add_cell(block, number, nodes, (first, points), pattern.as_deref())
                .map_err(|what| arrays.error(data, what, "remove or correct the cell: mesh again"))?;
        }
        if !rest.is_empty() {
            let what =
                format!("the array `connectivity` has {} entries more than the cells need", rest.len());
            return Err(arrays.error(data, what, CUT));
        }
        self.cells += cells;
        Ok(())
    }

    /// The group of each cell; empty if the piece has none.
    fn groups(&self, arrays: &Arrays, piece: Node, cells: usize) -> Result<Vec<Group>, MeshError> {
        let Some(data) = child(piece, "CellData") else {
            return Ok(Vec::new());
        };
        if let Some(ghosts) = array_named(data, "vtkGhostType") {
            let ghosts_of_cells = arrays.integers(ghosts, Some(cells))?;
            if let Some(cell) = ghosts_of_cells.iter().position(|ghost| *ghost != 0) {
                let what =
                    format!("cell {} is a ghost: it stands for one of another piece", self.cells + cell);
                return Err(arrays.error(ghosts, what, "save the grid without ghost cells"));
            }
        }
        if let Some(array) = array_named(data, "group") {
            let groups = arrays.integers(array, Some(cells))?;
            return Ok(groups.into_iter().map(Group::Index).collect());
        }
        if let Some(array) = array_named(data, "gmsh:physical") {
            let groups = arrays.integers(array, Some(cells))?;
            let group = |tag| if tag == 0 { Group::None } else { Group::Physical(tag) };
            return Ok(groups.into_iter().map(group).collect());
        }
        Ok(Vec::new())
    }

    fn block(&mut self, group: Group, kind: CellKind, has_pattern: bool) -> usize {
        if let Some(block) = self.blocks.get(&(group, kind)) {
            return *block;
        }
        let named = |index: i64| usize::try_from(index).ok().and_then(|index| self.names.get(index));
        let name = match group {
            Group::None => String::new(),
            Group::Physical(tag) => tag.to_string(),
            Group::Index(index) => {
                named(index).filter(|name| !name.is_empty()).cloned().unwrap_or_else(|| index.to_string())
            }
        };
        let next = self.mesh.blocks.len();
        let block = *self.named_blocks.entry((name.clone(), kind)).or_insert(next);
        if block == next {
            let (cells, numbers) = (Vec::new(), Vec::new());
            let pattern = has_pattern.then(Vec::new);
            self.mesh.blocks.push(Block { group: name, kind, cells, numbers, pattern });
        }
        self.blocks.insert((group, kind), block);
        block
    }

    /// Adds a cell to a block; its node numbers are relative to the first node of the piece.
    fn add_cell(
        &mut self,
        block: usize,
        number: usize,
        nodes: &[i64],
        (first, points): (usize, usize),
        pattern: Option<&[[f64; 2]]>,
    ) -> Result<(), String> {
        let Some(block) = self.mesh.blocks.get_mut(block) else {
            return Ok(());
        };
        for (place, node) in nodes.iter().enumerate() {
            let Some(index) = usize::try_from(*node).ok().filter(|index| *index < points) else {
                return Err(format!("cell {number} has point {node}, but there are only {points} points"));
            };
            if nodes.iter().take(place).any(|earlier| earlier == node) {
                return Err(format!("cell {number} has point {node} twice"));
            }
            block.cells.push(first + index);
            if let (Some(to), Some(from)) =
                (&mut block.pattern, pattern.and_then(|pattern| pattern.get(index)))
            {
                to.push(*from);
            }
        }
        block.numbers.push(number as u64);
        Ok(())
    }
}

/// The position of each point in the flat pattern.
fn pattern(arrays: &Arrays, piece: Node, points: usize) -> Result<Option<Vec<[f64; 2]>>, MeshError> {
    let Some(array) = child(piece, "PointData").and_then(|data| array_named(data, "pattern")) else {
        return Ok(None);
    };
    let components = match array.attribute("NumberOfComponents") {
        Some("2") => 2,
        Some("3") => 3,
        other => {
            let what = format!("{} has {} components", name(array), brief(other.unwrap_or("1")));
            return Err(arrays.error(array, what, "give it two: the places in the flat pattern, in m"));
        }
    };
    let values = arrays.numbers(array, Some(points.saturating_mul(components)))?;
    let place = |values: &[f64]| values.first_chunk().copied();
    Ok(Some(values.chunks_exact(components).filter_map(place).collect()))
}

/// The cell kind of VTK's cell type.
fn kind(arrays: &Arrays, data: Node, cell_type: i64, number: usize) -> Result<CellKind, MeshError> {
    let triangles = "mesh with triangles (in ParaView: `Triangulate`)";
    let volume = "save only the surface (in ParaView: `Extract Surface`, then `Append Datasets`)";
    let split = "write each point, line or triangle of it as a cell of its own (in ParaView: `Triangulate`)";
    let order = "mesh with order 1 or 2";
    let (what, instead) = match cell_type {
        1 => return Ok(CellKind::Point),
        3 => return Ok(CellKind::Line2),
        21 => return Ok(CellKind::Line3),
        5 => return Ok(CellKind::Triangle3),
        22 => return Ok(CellKind::Triangle6),
        2 => ("several vertices in one", split),
        4 => ("a polyline", split),
        6 => ("a strip of triangles", split),
        7 | 36 => ("a polygon", triangles),
        8 | 9 => ("a 4-node quadrangle", triangles),
        23 => ("an 8-node quadrangle", triangles),
        28 | 30 => ("a quadratic quadrangle", triangles),
        34 => ("a 7-node triangle", order),
        35 | 68 | 75 => ("a line of higher order", order),
        69 | 76 => ("a triangle of higher order", order),
        70 | 77 => ("a quadrangle of higher order", triangles),
        10..=16 | 24..=27 | 29 | 31..=33 | 37 | 42 | 71..=74 | 78..=81 => ("a volume", volume),
        _ => ("no cell of a membrane", "mesh with vertices, lines and triangles of order 1 or 2"),
    };
    Err(arrays.error(data, format!("cell {number} is {what} (type {cell_type} of VTK)"), instead))
}

fn child<'a, 'xml>(node: Node<'a, 'xml>, tag: &str) -> Option<Node<'a, 'xml>> {
    node.children().find(|child| child.has_tag_name(tag))
}

fn array_named<'a, 'xml>(data: Node<'a, 'xml>, name: &str) -> Option<Node<'a, 'xml>> {
    data.children().find(|array| array.is_element() && array.attribute("Name") == Some(name))
}
