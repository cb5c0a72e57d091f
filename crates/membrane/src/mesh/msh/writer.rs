//! Writes meshes as MSH 4.1 text for Gmsh.

use super::super::{Block, CellKind, Mesh};
use super::assembly::dimension;
use bulge_muscles::shown::one_line;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::fmt::Write as _;

impl Mesh {
    /// The mesh as a Gmsh file (MSH 4.1, text): each block is a discrete entity, each group name a physical
    /// group.
    ///
    /// Numbers of nodes and elements are kept if no two are equal. Otherwise they are renumbered from 1, as
    /// for a cell in several blocks. The format can't store the flat pattern. A block without a name is no
    /// physical group, so that [`Self::from_msh`] drops it if other blocks of its dimension have names.
    #[must_use]
    pub fn to_msh(&self) -> String {
        let mut out = String::from("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n");
        let groups = Groups::new(&self.blocks);
        // Writing to a String can't fail.
        let _ = self.write(&mut out, &groups);
        out
    }

    fn write(&self, out: &mut String, groups: &Groups) -> std::fmt::Result {
        if !groups.names.is_empty() {
            writeln!(out, "$PhysicalNames\n{}", groups.names.len())?;
            for (dimension, tag, name) in &groups.names {
                // A line break would end the name.
                let name = one_line(name);
                writeln!(out, "{dimension} {tag} \"{name}\"")?;
            }
            writeln!(out, "$EndPhysicalNames")?;
        }
        self.write_entities(out, groups)?;
        let numbers = unique(self.numbers.iter(), self.nodes.len());
        let (least, largest) = range(&numbers);
        // Nodes must belong to some entity; which one only matters for remeshing.
        let (dimension, tag) =
            groups.entities.iter().copied().max_by_key(|(dimension, _)| *dimension).unwrap_or((0, 1));
        let blocks = usize::from(!self.nodes.is_empty());
        writeln!(out, "$Nodes\n{blocks} {} {least} {largest}", self.nodes.len())?;
        if blocks > 0 {
            writeln!(out, "{dimension} {tag} 0 {}", self.nodes.len())?;
        }
        for number in &numbers {
            writeln!(out, "{number}")?;
        }
        for [x, y, z] in &self.nodes {
            writeln!(out, "{x:?} {y:?} {z:?}")?;
        }
        writeln!(out, "$EndNodes")?;
        self.write_elements(out, groups, &numbers)
    }

    fn write_entities(&self, out: &mut String, groups: &Groups) -> std::fmt::Result {
        let count = |wanted: u8| groups.entities.iter().filter(|(dimension, _)| *dimension == wanted).count();
        writeln!(out, "$Entities\n{} {} {} 0", count(0), count(1), count(2))?;
        for wanted in 0..=2 {
            for ((block, (dimension, tag)), group) in
                self.blocks.iter().zip(&groups.entities).zip(&groups.of_blocks)
            {
                if *dimension != wanted {
                    continue;
                }
                let (low, high) = self.bounds(block);
                write!(out, "{tag} {:?} {:?} {:?} ", low[0], low[1], low[2])?;
                if wanted > 0 {
                    write!(out, "{:?} {:?} {:?} ", high[0], high[1], high[2])?;
                }
                match group {
                    Some(group) => write!(out, "1 {group}")?,
                    None => write!(out, "0")?,
                }
                writeln!(out, "{}", if wanted > 0 { " 0" } else { "" })?;
            }
        }
        writeln!(out, "$EndEntities")
    }

    fn write_elements(&self, out: &mut String, groups: &Groups, nodes: &[u64]) -> std::fmt::Result {
        let total = self.blocks.iter().map(|block| block.cells.len() / block.kind.nodes()).sum();
        let numbers = unique(self.blocks.iter().flat_map(|block| &block.numbers), total);
        let (least, largest) = range(&numbers);
        writeln!(out, "$Elements\n{} {total} {least} {largest}", self.blocks.len())?;
        let mut numbers = numbers.into_iter();
        for (block, (dimension, tag)) in self.blocks.iter().zip(&groups.entities) {
            let cells = block.cells.chunks_exact(block.kind.nodes());
            writeln!(out, "{dimension} {tag} {} {}", element_type(block.kind), cells.len())?;
            for (cell, number) in cells.zip(numbers.by_ref()) {
                write!(out, "{number}")?;
                for node in cell {
                    write!(out, " {}", nodes.get(*node).copied().unwrap_or_default())?;
                }
                writeln!(out)?;
            }
        }
        writeln!(out, "$EndElements")
    }

    /// The bounding box of a block.
    fn bounds(&self, block: &Block) -> ([f64; 3], [f64; 3]) {
        let mut places = block.cells.iter().filter_map(|node| self.nodes.get(*node));
        let first = places.next().copied().unwrap_or_default();
        places.fold((first, first), |(low, high), place| {
            let axes = [0, 1, 2];
            (
                axes.map(|axis: usize| low[axis].min(place[axis])),
                axes.map(|axis: usize| high[axis].max(place[axis])),
            )
        })
    }
}

/// The physical groups and entities of a mesh during writing.
struct Groups {
    /// Dimension, number and name.
    names: Vec<(u8, usize, String)>,
    /// Number of the group of each block.
    of_blocks: Vec<Option<usize>>,
    /// Dimension and number of each block's entity.
    entities: Vec<(u8, usize)>,
}

impl Groups {
    fn new(blocks: &[Block]) -> Self {
        let mut groups = Self { names: Vec::new(), of_blocks: Vec::new(), entities: Vec::new() };
        let mut numbers = HashMap::new();
        let mut entities_of = [0_usize; 3];
        for block in blocks {
            let dimension = dimension(block.kind);
            let entities = &mut entities_of[usize::from(dimension)];
            *entities += 1;
            groups.entities.push((dimension, *entities));
            let tag = (!block.group.is_empty()).then(|| match numbers.entry((dimension, &block.group)) {
                Entry::Occupied(known) => *known.get(),
                Entry::Vacant(new) => {
                    let tag = groups.names.len() + 1;
                    groups.names.push((dimension, tag, block.group.clone()));
                    *new.insert(tag)
                }
            });
            groups.of_blocks.push(tag);
        }
        groups
    }
}

/// The given numbers if they are valid in a Gmsh file, otherwise numbers from 1.
fn unique<'a>(given: impl Iterator<Item = &'a u64>, count: usize) -> Vec<u64> {
    let given: Vec<u64> = given.copied().collect();
    let mut sorted = given.clone();
    sorted.sort_unstable();
    sorted.dedup();
    // Gmsh stores numbers in signed words.
    let fits = |number: &u64| (1..=i64::MAX as u64).contains(number);
    if given.len() == count && sorted.len() == count && sorted.iter().all(fits) {
        return given;
    }
    (1..=count as u64).collect()
}

fn range(numbers: &[u64]) -> (u64, u64) {
    (numbers.iter().copied().min().unwrap_or_default(), numbers.iter().copied().max().unwrap_or_default())
}

fn element_type(kind: CellKind) -> u8 {
    match kind {
        CellKind::Point => 15,
        CellKind::Line2 => 1,
        CellKind::Line3 => 8,
        CellKind::Triangle3 => 2,
        CellKind::Triangle6 => 9,
    }
}
