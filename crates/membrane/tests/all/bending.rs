//! Sheets that resist bending: against the theory of plates, at planes of symmetry, and what they make of slack cloth.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use bulge_membrane::case::{Case, Row};
use bulge_membrane::mesher::{Surface, grid};
use bulge_membrane::{
    CellKind, Cloth, Copies, Inflation, Law, Load, MembraneError, Mesh, Part, Sheet, Solver, Structure,
    Support, Tolerance,
};
use std::collections::BTreeSet;

/// D and the side of a square plate of N, mm.
const BENDING: f64 = 0.8;
const SIDE: f64 = 10.0;

fn plane(normal: [f64; 3]) -> Support {
    Support::Plane { normal }
}

/// A quarter of a square plate.
fn quarter(cells: usize) -> Mesh {
    let place = |u: f64, v: f64| [0.5 * SIDE * u, 0.5 * SIDE * v, 0.0];
    grid(&Surface { place: &place, pattern: None, cells: [cells; 2], is_quadratic: false })
}

/// Deflection of the middle of a square plate under a small pressure; `u0` is the normal of its first plane of symmetry.
fn deflection(mesh: &Mesh, u0: [f64; 3], pressure: f64) -> f64 {
    let law = Law::SaintVenantKirchhoff { stiffness: 1e4, poisson: 0.3 };
    let sheet = Sheet { cloth: Cloth::Isotropic(law), wrinkles: false, residual: 0.0 };
    let part = || Part::Membrane { sheet: Some(sheet), warp: [1.0, 0.0, 0.0] };
    let groups: BTreeSet<&str> = mesh
        .blocks
        .iter()
        .filter(|block| block.kind == CellKind::Triangle3)
        .map(|block| &block.group[..])
        .collect();
    let parts: Vec<(String, Part)> = groups.iter().map(|group| ((*group).to_owned(), part())).collect();
    let bending: Vec<(String, f64)> = groups.iter().map(|group| ((*group).to_owned(), BENDING)).collect();
    let supports = [
        ("u0".to_owned(), plane(u0)),
        ("v0".to_owned(), plane([0.0, 1.0, 0.0])),
        ("u1".to_owned(), plane([0.0, 0.0, 1.0])),
        ("v1".to_owned(), plane([0.0, 0.0, 1.0])),
    ];
    let structure = Structure::new(mesh, &parts, &supports, &[]).unwrap();
    let structure = structure.resisting_bending(mesh, &supports, &bending).unwrap();
    let mut solver = Solver::new(structure, Copies::ONE, Tolerance::default()).unwrap();
    let rest = solver.at_rest();
    let load = |pressure| Load { inflation: Inflation::Pressure(pressure), fittings: Vec::new() };
    let state = solver.follow(&load(0.0), &rest, &load(pressure), |_, _| ()).unwrap();
    solver.fields(&state).places[0][2].abs()
}

/// A square plate whose edges are held and free to turn: w = 0.00406235 p a^4/D in its middle (Navier). Its sheet goes on
/// beyond the two planes of symmetry; where it touches the plane of its edges it hinges freely.
#[test]
fn a_square_under_pressure_bends_as_a_plate() {
    let pressure = 1e-7;
    let exact = 0.004_062_353 * pressure * SIDE.powi(4) / BENDING;
    let across = [1.0, 0.0, 0.0];
    let errors = [6, 12, 24].map(|cells| deflection(&quarter(cells), across, pressure) / exact - 1.0);
    let orders = [(errors[0] / errors[1]).log2(), (errors[1] / errors[2]).log2()];
    assert!(errors[2].abs() < 2e-3 && orders.iter().all(|order| *order > 1.8), "{errors:?} {orders:?}");
}

/// Two groups are one sheet where they meet, and a plane is one plane whichever way its normals point.
#[test]
fn groups_that_meet_and_normals_that_differ_change_nothing() {
    let (mesh, pressure) = (quarter(6), 1e-7);
    let expected = deflection(&mesh, [1.0, 0.0, 0.0], pressure);
    let mut parted = mesh.clone();
    let cloth = parted.blocks.iter().position(|block| block.kind == CellKind::Triangle3).unwrap();
    let mut other = parted.blocks[cloth].clone();
    let half = other.cells.len() / 6 * 3;
    "more".clone_into(&mut other.group);
    other.cells.drain(..half);
    parted.blocks[cloth].cells.truncate(half);
    parted.blocks.push(other);
    for (mesh, normal) in [(&parted, [1.0, 0.0, 0.0]), (&mesh, [-2.0, 1e-17, 0.0])] {
        let found = deflection(mesh, normal, pressure);
        assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
    }
}

/// A square airbag whose foil resists bending as it is thick.
fn airbag(cells: usize) -> Row {
    let text = include_str!("../../../../meshes/airbag.toml").replace("40", &cells.to_string());
    let text = text.replace("poisson = 0.4", "poisson = 0.4\nbending = true");
    let case = Case::from_toml(&text, "airbag.toml", None).unwrap();
    // 588 MPa, 0.6 mm, 0.4.
    assert!((case.bending[0].1 / 0.0126 - 1.0).abs() < 1e-12, "{:?}", case.bending);
    case.start().unwrap().last_row(|_| ()).unwrap()
}

/// Folds become as wide as the foil is stiff, and no finer with the mesh: iterations don't grow, and volumes converge.
#[test]
fn foil_that_resists_bending_folds_alike_on_finer_meshes() {
    let [coarse, middle, fine] = [16, 32, 64].map(airbag);
    for row in [&coarse, &middle, &fine] {
        assert!(row.iterations <= 24, "{}", row.iterations);
    }
    let ratio = (middle.volume - coarse.volume) / (fine.volume - middle.volume);
    assert!((3.0..5.0).contains(&ratio), "{ratio}");
    // Of 320 cells: 0.1249688 m^3.
    let volume = fine.volume + (fine.volume - middle.volume) / 3.0;
    assert!((volume / 0.124_969 - 1.0).abs() < 1e-5, "{volume}");
}

#[test]
fn only_triangles_with_three_nodes_bend_and_no_woven_cloth() {
    let airbag = include_str!("../../../../meshes/airbag.toml").replace("40", "8");
    let bends = airbag.replace("poisson = 0.4", "poisson = 0.4\nbending = true");
    let refused = |text: &str, what: &str| {
        let error = Case::from_toml(text, "case.toml", None).unwrap_err().to_string();
        assert!(error.contains("case.toml:") && error.contains(what), "{error}");
    };
    refused(&bends.replace("cells = [8, 8]", "cells = [8, 8]\norder = 2"), "`order = 1`");
    let woven = bends
        .replace("st-venant", "orthotropic")
        .replace("young", "weft = \"588 MPa\"\nshear = \"9 MPa\"\nyoung");
    refused(&woven, "leave `bending` out");
    refused(&bends.replace("bending = true", "bending = 1"), "bending");
    let foil = "law = \"st-venant\"\nyoung = \"1 MPa\"\npoisson = 0.4\nbending = true\n";
    let tube = |file: &str| file.replace("law = \"neo-hooke\"\n", foil).replace("shear = \"0.4 MPa\"\n", "");
    refused(&tube(include_str!("../../../../meshes/tube.toml")), "only triangles with three nodes");
    refused(
        &include_str!("../../../../meshes/tube-3d.toml").replace("shear", "bending = true\nshear"),
        "rubber",
    );
    let curved =
        Case::from_toml(&tube(include_str!("../../../../meshes/tube-3d.toml")), "case.toml", None).unwrap();
    let error = curved.start().err().unwrap().to_string();
    assert!(error.contains("curved at node") && error.contains("a flat pattern"), "{error}");
    let case = Case::from_toml(&bends, "case.toml", None).unwrap();
    let structure = |supports: &[(String, Support)], group: &str| {
        let structure = Structure::new(&case.mesh, &case.parts, &case.supports, &[]).unwrap();
        structure.resisting_bending(&case.mesh, supports, &[(group.to_owned(), BENDING)])
    };
    let cyclic = Support::Cyclic { partner: "u0".to_owned(), angle: 1.0 };
    let says = |found: Result<Structure, MembraneError>| found.unwrap_err().to_string();
    assert!(says(structure(&[("v0".to_owned(), cyclic)], "cloth")).contains("as `v0` does"));
    assert!(says(structure(&case.supports, "bag")).contains("`bag`"));
    // Without the plane of its seam.
    let free: Vec<(String, Support)> =
        case.supports.iter().filter(|(name, _)| ["u0", "v0"].contains(&name.as_str())).cloned().collect();
    assert!(says(structure(&free, "cloth")).contains("where nothing holds it"));
}
