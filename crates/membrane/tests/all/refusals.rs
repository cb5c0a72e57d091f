//! Input that is refused before anything is solved: supports that contradict each other, planes beside the
//! axis, parts that aren't held, sectors that don't make a full turn, cables that miss nodes. Similar but
//! valid input is accepted.

#![expect(clippy::unwrap_used, clippy::panic, reason = "a test that cannot be set up fails")]

use bulge_membrane::case::Case;
use bulge_membrane::mesher::{Grading, Surface, grid, revolved};
use bulge_membrane::{
    Block, CellKind, Cloth, Fitting, Law, Mesh, Part, RingLayer, Sheet, Structure, Support, Thread,
};
use core::f64::consts::FRAC_PI_2;
use tempfile::TempDir;

fn rubber() -> Sheet {
    Sheet { cloth: Cloth::Isotropic(Law::NeoHooke { shear: 1.0 }), wrinkles: true, residual: 0.0 }
}

fn membrane() -> Part {
    Part::Membrane { sheet: Some(rubber()), warp: [1.0, 0.0, 0.0] }
}

fn tube() -> Part {
    Part::Revolved { layers: vec![RingLayer::Sheet { sheet: rubber(), fullness: 1.0 }] }
}

fn plane(normal: [f64; 3]) -> Support {
    Support::Plane { normal }
}

fn ride(fitting: usize) -> Support {
    Support::Fitting { fitting }
}

fn follow(partner: &str, angle: f64) -> Support {
    Support::Cyclic { partner: partner.to_owned(), angle }
}

/// Node numbers in the file that differ from the indices.
fn numbered(mut mesh: Mesh) -> Mesh {
    mesh.numbers.iter_mut().for_each(|number| *number += 1000);
    for (i, block) in mesh.blocks.iter_mut().enumerate() {
        block.numbers.iter_mut().for_each(|number| *number += 100 * (i as u64 + 50));
    }
    mesh
}

fn named<T: Clone>(all: &[(&str, T)]) -> Vec<(String, T)> {
    all.iter().map(|(name, what)| ((*name).to_owned(), what.clone())).collect()
}

fn build(
    mesh: &Mesh,
    part: (&str, Part),
    supports: &[(&str, Support)],
    fittings: &[Fitting],
) -> Result<Structure, String> {
    Structure::new(mesh, &named(&[part]), &named(supports), fittings).map_err(|error| error.to_string())
}

#[track_caller]
fn refused<T>(built: Result<T, String>, parts: &[&str]) {
    let error = built.err().unwrap_or_else(|| panic!("{parts:?}"));
    println!("{error}");
    for part in parts {
        assert!(error.contains(part), "{error}\n  does not say {part:?}");
    }
}

/// A point of the mesh as a group.
fn point(mesh: &mut Mesh, group: &str, node: usize) {
    let group = group.to_owned();
    mesh.blocks.push(Block {
        group,
        kind: CellKind::Point,
        cells: vec![node],
        numbers: vec![1],
        pattern: None,
    });
}

/// A quarter of a pillow with its corner at (x, y).
fn pillow(x: f64, y: f64) -> Mesh {
    let place = |u: f64, v: f64| [x + 0.4 * u, y + 0.4 * v, 0.0];
    numbered(grid(&Surface { place: &place, pattern: None, cells: [4, 4], is_quadratic: false }))
}

fn of_pillow() -> [(&'static str, Support); 4] {
    let level = plane([0.0, 0.0, 1.0]);
    [("u0", plane([1.0, 0.0, 0.0])), ("v0", plane([0.0, 1.0, 0.0])), ("u1", level.clone()), ("v1", level)]
}

/// A line from the lower end to the upper, 10 elements.
fn line() -> Mesh {
    numbered(revolved(|t| [0.01, 0.06 * t], 10, false, Grading::Even))
}

/// A whole tube in triangles about an axis at (x, y); groups `wall`, `low`, `high`.
fn whole_tube(x: f64, y: f64) -> Mesh {
    let (round, high) = (8, 4);
    let mut mesh = Mesh::default();
    for j in 0..=high {
        for i in 0..round {
            let (sin, cos) = (FRAC_PI_2 * f64::from(i) / 2.0).sin_cos();
            mesh.nodes.push([x + cos, y + sin, f64::from(j)]);
            mesh.numbers.push(u64::try_from(mesh.nodes.len()).unwrap());
        }
    }
    let at = |i: i32, j: i32| usize::try_from(j * round + i % round).unwrap();
    let mut block = |group: &str, kind: CellKind, cells: Vec<usize>| {
        let numbers = (1..=(cells.len() / kind.nodes()) as u64).collect();
        mesh.blocks.push(Block { group: group.to_owned(), kind, cells, numbers, pattern: None });
    };
    let quads = (0..high).flat_map(|j| (0..round).map(move |i| (i, j)));
    let halves = quads.flat_map(|(i, j)| {
        [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j), at(i + 1, j + 1), at(i, j + 1)]
    });
    block("wall", CellKind::Triangle3, halves.collect());
    block("low", CellKind::Point, (0..round).map(|i| at(i, 0)).collect());
    block("high", CellKind::Point, (0..round).map(|i| at(i, high)).collect());
    numbered(mesh)
}

/// A closed cube, 20 mm, or more of them side by side.
fn cubes(count: usize) -> Mesh {
    let mut mesh = Mesh::default();
    let faces = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
    let mut cells = Vec::new();
    for k in 0..count {
        for corner in 0..8_usize {
            let side = |bit: usize| if corner & bit == 0 { -0.01 } else { 0.01 };
            mesh.nodes.push([side(1) + 0.1 * k as f64, side(2), side(4)]);
            mesh.numbers.push(mesh.nodes.len() as u64);
        }
        cells.extend(faces.iter().flat_map(|[a, b, c, d]| [*a, *b, *c, *a, *c, *d].map(|node| node + 8 * k)));
    }
    let numbers = (1..=12 * count as u64).collect();
    mesh.blocks.push(Block {
        group: "skin".to_owned(),
        kind: CellKind::Triangle3,
        cells,
        numbers,
        pattern: None,
    });
    numbered(mesh)
}

#[test]
fn planes_of_symmetry_beside_the_axis() {
    assert!(build(&pillow(0.0, 0.0), ("cloth", membrane()), &of_pillow(), &[]).is_ok());
    for (x, y, parts) in [
        (1.0, 0.0, ["`u0`", "by 1.000000e0 m at node 1001", "contains the z axis"]),
        (-0.4, -0.4, ["`v0`", "by 4.000000e-1 m at node 1001", "contains the z axis"]),
        (0.0, 1e-5, ["`v0`", "by 1.000000e-5 m", "contains the z axis"]),
    ] {
        refused(build(&pillow(x, y), ("cloth", membrane()), &of_pillow(), &[]), &parts);
    }
    // As accurate as a mesher is.
    assert!(build(&pillow(1e-10, 1e-9), ("cloth", membrane()), &of_pillow(), &[]).is_ok());
    let mut supports = of_pillow();
    supports[0].1 = plane([1.0, 0.0, 0.3]);
    refused(build(&pillow(0.0, 0.0), ("cloth", membrane()), &supports, &[]), &["`u0` is oblique"]);
    // A level plane whose nodes aren't at one height.
    let place = |u: f64, v: f64| [0.4 * u, 0.4 * v, 0.1 * u * v];
    let mesh = grid(&Surface { place: &place, pattern: None, cells: [4, 4], is_quadratic: false });
    refused(
        build(&mesh, ("cloth", membrane()), &of_pillow(), &[]),
        &["`u1` lie at different heights", "nodes 5 and 10"],
    );
}

#[test]
fn an_open_edge_between_two_supports_is_a_hole() {
    // The corner between two planes is cut off: both ends of the edge are held, but each in another plane.
    let mut mesh = pillow(0.0, 0.0);
    mesh.blocks[0].cells.drain(..6);
    mesh.blocks[0].numbers.drain(..2);
    refused(
        build(&mesh, ("cloth", membrane()), &of_pillow(), &[]),
        &["open edge", "`cloth`", "the gas would leave"],
    );
}

#[test]
fn supports_that_contradict_a_fitting() {
    let ends = [("first", ride(0)), ("last", ride(1))];
    let with = |more: (&'static str, Support)| [ends.to_vec(), vec![more]].concat();
    let both = [Fitting::Placed, Fitting::Placed];
    assert!(build(&line(), ("wall", tube()), &ends, &both).is_ok());
    // Supports that a fitting implies anyway.
    for more in [("last", Support::Slide), ("last", plane([1.0, 0.0, 0.0])), ("last", ride(1))] {
        assert!(build(&line(), ("wall", tube()), &with(more), &both).is_ok());
    }
    for more in [("last", Support::Fixed), ("last", plane([0.0, 0.0, 1.0])), ("last", plane([1.0, 0.0, 1.0]))]
    {
        let parts =
            ["node 1011 rides on a fitting, by `last`", "held along z, by `last`", "keep one of the two"];
        refused(build(&line(), ("wall", tube()), &with(more.clone()), &both), &parts);
        // Also in the reverse order.
        let mut turned = with(more);
        turned.reverse();
        refused(build(&line(), ("wall", tube()), &turned, &both), &parts);
    }
    refused(
        build(&line(), ("wall", tube()), &with(("last", ride(0))), &both),
        &["node 1011 rides on two fittings, by `last` and by `last`", "take it out"],
    );
}

#[test]
fn a_loaded_fitting_without_nodes() {
    let mut mesh = line();
    mesh.nodes.push([0.0; 3]);
    mesh.numbers.push(99);
    point(&mut mesh, "centre", 11);
    let supports = [("first", ride(0)), ("last", Support::Slide), ("centre", ride(1))];
    assert!(build(&mesh, ("wall", tube()), &supports, &[Fitting::Placed; 2]).is_ok());
    let built = build(&mesh, ("wall", tube()), &supports, &[Fitting::Placed, Fitting::Loaded]);
    refused(built, &["no element has a node on the loaded fitting 1", "hold a group of a part by it"]);
}

/// A quarter of a tube, whose edges at x = 0 and y = 0 are to follow each other.
fn quarter() -> Mesh {
    numbered(bulge_membrane::mesher::tube(0.01, 0.06, [4, 4], false, Grading::Even))
}

#[test]
fn supports_that_contradict_a_cyclic_edge() {
    let ends = [("first", ride(0)), ("last", ride(1))];
    let with = |more: &[(&'static str, Support)]| {
        build(&quarter(), ("wall", membrane()), &[&ends, more].concat(), &[Fitting::Placed, Fitting::Loaded])
    };
    assert!(with(&[("right", follow("left", FRAC_PI_2))]).is_ok());
    assert!(with(&[("right", follow("left", FRAC_PI_2)), ("right", follow("left", FRAC_PI_2))]).is_ok());
    assert!(with(&[("right", follow("left", FRAC_PI_2)), ("left", plane([0.0, 1.0, 0.0]))]).is_ok());
    refused(
        with(&[("right", follow("left", 0.0))]),
        &["`right` is to follow `left` turned by 0.000000", "the other edge"],
    );
    refused(with(&[("right", follow("left", 4.0 * FRAC_PI_2))]), &["turned by 360.000000 degrees"]);
    refused(
        with(&[("right", follow("left", FRAC_PI_2)), ("left", follow("left", FRAC_PI_2))]),
        &["`left` is to follow `left`", "the other edge"],
    );
    refused(
        with(&[("right", follow("left", FRAC_PI_2)), ("left", follow("right", -FRAC_PI_2))]),
        &["is the partner of a node of `left` and follows another itself, by `right`", "node 1005"],
    );
    // The far edge on a moving fitting, with its partner fixed.
    refused(
        with(&[("right", follow("left", FRAC_PI_2)), ("left", Support::Fixed)]),
        &["rides on a fitting, by `first`, and is held along z, by `left`"],
    );
    // Two partners for one node: a third edge that lies on the first.
    let mut mesh = quarter();
    let left = mesh.blocks.iter().find(|block| block.group == "left").unwrap().clone();
    let copies: Vec<usize> = (0..mesh.nodes.len()).filter(|node| left.cells.contains(node)).collect();
    let shift = mesh.nodes.len();
    for node in &copies {
        mesh.nodes.push(mesh.nodes[*node]);
        mesh.numbers.push(5000 + *node as u64);
    }
    let moved = |node: &usize| shift + copies.iter().position(|other| other == node).unwrap();
    let cells = left.cells.iter().map(moved).collect();
    mesh.blocks.push(Block { group: "again".to_owned(), cells, ..left });
    let parts =
        named(&[("wall", membrane()), ("again", Part::Cable { thread: Thread::Inextensible, share: 1.0 })]);
    let follows = [("right", follow("left", FRAC_PI_2)), ("right", follow("again", FRAC_PI_2))];
    let supports = named(&[&ends[..], &follows[..]].concat());
    let built = Structure::new(&mesh, &parts, &supports, &[Fitting::Placed, Fitting::Placed]);
    refused(built.map_err(|error| error.to_string()), &["follows two nodes, by `right` and by `right`"]);
}

#[test]
fn nodes_of_a_fitting_without_elements_may_be_held_twice() {
    // The middle of the end disc, which has no elements.
    let mut mesh = whole_tube(0.0, 0.0);
    mesh.nodes.push([0.0, 0.0, 4.0]);
    mesh.numbers.push(99);
    let middle = mesh.nodes.len() - 1;
    point(&mut mesh, "high", middle);
    point(&mut mesh, "centre", middle);
    let supports = [("low", Support::Fixed), ("high", ride(0)), ("centre", Support::Fixed)];
    assert!(build(&mesh, ("wall", membrane()), &supports, &[Fitting::Loaded]).is_ok());
}

#[test]
fn parts_that_nothing_holds() {
    // A closed cube, held at one corner, at two, and at three.
    let mut cube = cubes(1);
    refused(
        build(&cube, ("skin", membrane()), &[], &[]),
        &["of `skin`", "move along x", "turn about z", "`[[support]]`"],
    );
    point(&mut cube, "p", 0);
    point(&mut cube, "q", 1);
    point(&mut cube, "s", 2);
    let mut supports = vec![("p", Support::Fixed)];
    refused(build(&cube, ("skin", membrane()), &supports, &[]), &["turn about the line through"]);
    supports.extend([("q", plane([0.0, 1.0, 0.0])), ("q", plane([0.0, 0.0, 1.0]))]);
    refused(
        build(&cube, ("skin", membrane()), &supports, &[]),
        &["turn about the line", "(0, -0.01, -0.01) m", "(1, 0, 0)"],
    );
    supports.push(("s", plane([0.0, 0.0, 1.0])));
    assert!(build(&cube, ("skin", membrane()), &supports, &[]).is_ok());
    // Another one beside it.
    let mut two = cubes(2);
    for (group, node) in [("p", 0), ("q", 1), ("s", 2)] {
        point(&mut two, group, node);
    }
    refused(build(&two, ("skin", membrane()), &supports, &[]), &["node 1009 of `skin`", "move along x"]);
    // A tube with both ends on planes can rotate and slide.
    let level = plane([0.0, 0.0, 1.0]);
    let levels = [("low", level.clone()), ("high", level)];
    let tube_at = |x, y, supports: &[(&str, Support)], fittings: &[Fitting]| {
        build(&whole_tube(x, y), ("wall", membrane()), supports, fittings)
    };
    refused(tube_at(0.0, 0.0, &levels, &[]), &["it can move along x, move along y, turn about z;"]);
    assert!(tube_at(0.0, 0.0, &[("low", Support::Fixed), ("high", Support::Slide)], &[]).is_ok());
    // One loaded fitting is held by the other end; two aren't.
    let ends = [("low", ride(0)), ("high", ride(1))];
    assert!(tube_at(0.0, 0.0, &ends, &[Fitting::Placed, Fitting::Loaded]).is_ok());
    let free = tube_at(0.0, 0.0, &ends, &[Fitting::Loaded, Fitting::Loaded]);
    refused(free, &["move along z with its loaded fitting", "`wall`"]);
    // Its own axis may lie beside z.
    assert!(tube_at(0.5, 0.5, &ends, &[Fitting::Placed, Fitting::Placed]).is_ok());
}

#[test]
fn a_line_of_revolution_can_only_move_along_the_axis() {
    let level = plane([0.0, 0.0, 1.0]);
    let with = |supports: &[(&str, Support)], fittings: &[Fitting]| {
        build(&line(), ("wall", tube()), supports, fittings)
    };
    assert!(with(&[("first", level.clone()), ("last", Support::Slide)], &[]).is_ok());
    let parts = ["of `wall`", "can move along z;"];
    refused(with(&[("first", Support::Slide), ("last", Support::Slide)], &[]), &parts);
    assert!(with(&[("first", level), ("last", ride(0))], &[Fitting::Loaded]).is_ok());
    let ends = [("first", ride(0)), ("last", ride(1))];
    refused(with(&ends, &[Fitting::Loaded, Fitting::Loaded]), &["can move along z with its loaded fitting"]);
}

#[test]
fn a_cyclic_sector_can_turn_and_slide() {
    let cyclic = ("right", follow("left", FRAC_PI_2));
    let level = plane([0.0, 0.0, 1.0]);
    let with = |supports: &[(&str, Support)]| build(&quarter(), ("wall", membrane()), supports, &[]);
    let levels = [("first", level.clone()), ("last", level)];
    refused(with(&[&levels[..], core::slice::from_ref(&cyclic)].concat()), &["it can turn about z;"]);
    let slides = [("first", Support::Slide), ("last", Support::Slide)];
    refused(with(&[&slides[..], core::slice::from_ref(&cyclic)].concat()), &["it can move along z;"]);
    assert!(with(&[("first", Support::Fixed), ("last", Support::Slide), cyclic]).is_ok());
}

#[test]
fn a_straight_cable_need_not_be_kept_from_turning_about_itself() {
    let nodes = vec![[0.01, 0.0, 0.0], [0.01, 0.0, 0.01], [0.01, 0.0, 0.02]];
    let cells = vec![0, 1, 1, 2];
    let cable =
        Block { group: "rope".to_owned(), kind: CellKind::Line2, cells, numbers: vec![1, 2], pattern: None };
    let mut mesh = Mesh { nodes, numbers: vec![1, 2, 3], blocks: vec![cable] };
    point(&mut mesh, "a", 0);
    point(&mut mesh, "b", 2);
    let rope = || ("rope", Part::Cable { thread: Thread::Elastic { stiffness: 1.0 }, share: 1.0 });
    let ends = [("a", Support::Fixed), ("b", ride(0))];
    assert!(build(&mesh, rope(), &ends, &[Fitting::Loaded]).is_ok());
    refused(build(&mesh, rope(), &ends[..1], &[]), &["node 3 of `rope`", "turn about"]);
}

#[test]
fn cables_that_miss_the_middles_of_edges() {
    let place = |u: f64, v: f64| [0.4 * u, 0.4 * v, 0.0];
    for is_quadratic in [false, true] {
        let mut mesh = numbered(grid(&Surface { place: &place, pattern: None, cells: [2, 2], is_quadratic }));
        let edge = mesh.blocks.iter().find(|block| block.group == "u0").unwrap().clone();
        let (kind, cells) = if is_quadratic {
            (CellKind::Line2, edge.cells.chunks(3).flat_map(|cell| [cell[0], cell[1]]).collect())
        } else {
            // A middle node of its own for each.
            let middle = mesh.nodes.len();
            mesh.nodes.extend([[0.0, 0.1, 0.0], [0.0, 0.3, 0.0]]);
            mesh.numbers.extend([71, 72]);
            let with = |(i, cell): (usize, &[usize])| [cell[0], cell[1], middle + i];
            (CellKind::Line3, edge.cells.chunks(2).enumerate().flat_map(with).collect())
        };
        let wrong = Block { group: "rope".to_owned(), kind, cells, numbers: vec![801, 802], pattern: None };
        mesh.blocks.push(wrong);
        let build = |group: &str| {
            let cable = Part::Cable { thread: Thread::Elastic { stiffness: 1.0 }, share: 0.5 };
            let parts = named(&[("cloth", membrane()), (group, cable)]);
            Structure::new(&mesh, &parts, &named(&of_pillow()), &[]).map_err(|error| error.to_string())
        };
        assert!(build("u0").is_ok());
        refused(
            build("rope"),
            &["element 801 of `rope` and element 500", "not the node in its middle", "the nodes 1001 and 10"],
        );
    }
}

// ---- cases

/// A folder for a case, perhaps with a mesh; deleted at the end.
struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn with(mesh: &Mesh) -> Self {
        let folder = Self::new();
        std::fs::write(folder.0.path().join("m.msh"), mesh.to_msh()).unwrap();
        folder
    }

    fn read(&self, text: &str) -> Result<Case, String> {
        Case::from_toml(text, "case.toml", Some(self.0.path())).map_err(|error| error.to_string())
    }
}

const MADE: &str = "[mesher]\nkind = \"tube\"\nradius = \"10 mm\"\nlength = \"60 mm\"\ncells = [10]\n";
const RUBBER: &str =
    "[[material]]\nname = \"rubber\"\nlaw = \"neo-hooke\"\nthickness = \"1 mm\"\nshear = \"0.4 MPa\"\n";
const STEP: &str = "[[step]]\npressure = \"1 kPa\"\n";

fn part(group: &str, kind: &str) -> String {
    format!("{RUBBER}[[part]]\ngroup = \"{group}\"\nkind = \"{kind}\"\nmaterial = \"rubber\"\n")
}

fn support(group: &str, rest: &str) -> String {
    format!("[[support]]\ngroup = \"{group}\"\n{rest}\n")
}

fn scaled(scale: &str) -> String {
    format!("mesh = \"m.msh\"\n[scale]\nunit = \"m\"\n{scale}\n")
}

#[test]
fn sectors_that_do_not_go_round() {
    let planes = support("u0", "kind = \"plane\"\nnormal = [1, 0, 0]")
        + &support("v0", "kind = \"plane\"\nnormal = [0, 1, 0]")
        + &support("u1", "kind = \"plane\"\nnormal = [0, 0, 1]")
        + &support("v1", "kind = \"plane\"\nnormal = [0, 0, 1]");
    let folder = Folder::with(&pillow(0.0, 0.0));
    let read = |scale: &str| folder.read(&(scaled(scale) + &part("cloth", "membrane") + &planes + STEP));
    assert!(read("around = 4\nalong = 2").is_ok());
    for (scale, place) in [("around = 7", ":4:10"), ("around = 1", ":4:10"), ("along = 2", ":2:")] {
        let parts = [place, "a sector of 90 degrees", "write `around = 4`"];
        refused(read(scale), &parts);
    }
    // Three quarters.
    let folder = Folder::with(&quarter());
    let read = |scale: &str, angle: &str| {
        let cyclic = format!("kind = \"cyclic\"\npartner = \"left\"\nangle = \"{angle}\"");
        let ends = support("first", "kind = \"fixed\"") + &support("last", "kind = \"slide\"");
        folder.read(&(scaled(scale) + &part("wall", "membrane") + &support("right", &cyclic) + &ends + STEP))
    };
    assert!(read("around = 4", "90 deg").is_ok());
    assert!(read("around = 4", "-270 deg").is_ok());
    refused(read("around = 3", "90 deg"), &[":4:10", "3 make 270", "write `around = 4`"]);
    refused(read("around = 4", "100 deg"), &["a sector of 100 degrees", "over a whole number"]);
    refused(read("around = 4", "0 deg"), &["`angle` is no turn", "360 degrees over"]);
    refused(read("around = 4", "360 deg"), &["`angle` is no turn"]);
    // A line is revolved by a full turn.
    let folder = Folder::with(&line());
    let ends = support("first", "kind = \"fixed\"") + &support("last", "kind = \"slide\"");
    let read = |scale: &str| folder.read(&(scaled(scale) + &part("wall", "sheet") + &ends + STEP));
    assert!(read("along = 2").is_ok());
    refused(read("around = 2"), &["a sector of 360 degrees", "write `around = 1`"]);
}

#[test]
fn half_a_tube_is_a_sector_of_180_degrees() {
    // The upper half: both edges in one plane.
    let place = |u: f64, v: f64| {
        let (sin, cos) = (2.0 * FRAC_PI_2 * u).sin_cos();
        [0.01 * cos, if u >= 1.0 { 0.0 } else { 0.01 * sin }, 0.06 * v]
    };
    let mesh = grid(&Surface { place: &place, pattern: None, cells: [8, 4], is_quadratic: true });
    let folder = Folder::with(&mesh);
    let plane = "kind = \"plane\"\nnormal = [0, 1, 0]";
    let supports = support("u0", plane)
        + &support("u1", plane)
        + &support("v0", "kind = \"fixed\"")
        + &support("v1", "kind = \"slide\"");
    let read = |scale: &str| folder.read(&(scaled(scale) + &part("cloth", "membrane") + &supports + STEP));
    assert!(read("around = 2").is_ok());
    assert!(read("around = 2").unwrap().start().is_ok());
    refused(read("around = 4"), &["a sector of 180 degrees", "write `around = 2`"]);
}

#[test]
fn a_fitting_has_one_motion() {
    let motion = |motion: &str| {
        support("last", &format!("kind = \"fitting\"\nfitting = \"top\"\nmotion = \"{motion}\""))
    };
    let read =
        |supports: String| Folder::new().read(&(MADE.to_owned() + &part("wall", "sheet") + &supports + STEP));
    // The fittings of our own mesh are placed unless the case says otherwise.
    assert_eq!(read(motion("loaded")).unwrap().fittings[1].1, Fitting::Loaded);
    assert_eq!(read(motion("loaded") + &motion("loaded")).unwrap().fittings[1].1, Fitting::Loaded);
    let parts = ["the fitting `top` has another motion", "state it once"];
    refused(read(motion("loaded") + &motion("placed")), &parts);
    refused(read(motion("placed") + &motion("loaded")), &parts);
    let own = support("last", "kind = \"cyclic\"\npartner = \"last\"\nangle = \"30 deg\"");
    refused(read(own), &["`last` is its own partner", "the other edge"]);
}

#[test]
fn iterations_out_of_range() {
    let read = |count: &str| {
        let text = format!("{MADE}{}{STEP}[solver]\niterations = {count}\n", part("wall", "sheet"));
        Folder::new().read(&text)
    };
    assert_eq!(read("100000").unwrap().tolerance.iterations, 100_000);
    for count in ["0", "100001", "1000000000"] {
        refused(
            read(count),
            &[&format!("`iterations` is {count}, but must be from 1 to 100000"), "iterations = 2000"],
        );
    }
}

#[test]
#[cfg(unix)]
fn a_mesh_that_is_no_file() {
    let read = |mesh: &str| {
        let text = format!("mesh = \"{mesh}\"\n[scale]\nunit = \"m\"\n{}{STEP}", part("wall", "sheet"));
        Folder::new().read(&text)
    };
    for mesh in ["/dev/zero", "/dev/null", "."] {
        refused(read(mesh), &["is no file", ":1:8", ".msh"]);
    }
    // A pipe to which nothing is ever written.
    let folder = Folder::new();
    let pipe = folder.0.path().join("pipe.msh");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    refused(read(pipe.to_str().unwrap()), &["pipe.msh is no file"]);
}
