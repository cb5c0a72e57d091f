//! Cloth and cables in triangles: pleated sectors, an airbag, a wrinkled panel.

use bulge_membrane::case::{Case, Row};
use bulge_membrane::mesher::{Pleated, Surface, grid};
use bulge_membrane::{Block, CellKind, Cloth, Fitting, Inflation, Law, Part, Sheet, Support, Thread};
use std::f64::consts::PI;

use super::rig::{order, plane, solver, to};
use super::rows;
use crate::check::{Check, Claim, Tally, Trouble};

/// Force of N inextensible fibres with flat facets without stiffness: R = 16, l0 = 110 mm, 20 %, 3 bar.
fn facets_force(fibres: u32, elements: usize) -> Result<f64, Trouble> {
    let muscle = Pleated {
        fibres: fibres as usize,
        radius: 0.016,
        length: 0.11,
        circumference: 2.0 * PI * 0.016,
        depth: 0.0,
        cells: [1, elements],
        is_quadratic: false,
    };
    let mut mesh = muscle.lobe();
    for block in &mut mesh.blocks {
        block.pattern = None;
    }
    let angle = 2.0 * PI / f64::from(fibres);
    let mut sector = solver(
        &mesh,
        &[
            ("cloth", Part::Membrane { sheet: None, warp: [0.0, 0.0, 1.0] }),
            ("fibre", Part::Cable { thread: Thread::Inextensible, share: 1.0 }),
        ],
        &[
            ("top", Support::Cyclic { partner: "fibre".to_owned(), angle }),
            ("middle", plane([0.0, 0.0, 1.0])),
            ("end", Support::Fitting { fitting: 0 }),
        ],
        &[Fitting::Placed],
        [f64::from(fibres), 2.0],
    )?;
    let rest = sector.at_rest();
    let state = to(&mut sector, &rest, Inflation::Pressure(3e5), &[-0.011])?;
    state.forces.first().copied().ok_or_else(|| "the sector has no fitting".into())
}

/// c = sin(2 pi/N)/(2 pi/N) of the pleated muscle.
fn facets_exact(fibres: u32) -> f64 {
    let angle = 2.0 * PI / f64::from(fibres);
    0.451_457_606_469 * 3e5 * 0.11 * 0.11 * angle.sin() / angle
}

/// Flat facets between fibres.
pub(crate) fn facets() -> Check {
    Claim {
        group: "membrane",
        name: "6, 12, 24 fibres without stretch and facets without stiffness, cyclic sector: force",
        source: "elliptic integrals times sin(2 pi/n)/(2 pi/n)",
        tolerance: 3e-4,
        why: "40 cables over half the length: second order",
    }
    .run(|tally| {
        for fibres in [6, 12, 24] {
            tally.relative(facets_force(fibres, 40)?, facets_exact(fibres), || format!("n = {fibres}"));
        }
        Ok(())
    })
}

/// Order of the error of flat facets.
pub(crate) fn facets_order() -> Check {
    Claim {
        group: "membrane",
        name: "order of convergence of the same: 2",
        source: "elliptic integrals times sin(2 pi/n)/(2 pi/n)",
        tolerance: 0.1,
        why: "20, 40, 80 cables are not yet asymptotic to more",
    }
    .run(|tally| {
        for fibres in [6, 12, 24] {
            let mut errors = Vec::new();
            for elements in [20, 40, 80] {
                errors.push(facets_force(fibres, elements)? / facets_exact(fibres) - 1.0);
            }
            order(tally, &format!("n = {fibres}"), &errors, 2.0);
        }
        Ok(())
    })
}

fn sector(
    fibres: u32,
    cells: [usize; 2],
    cloth: &str,
    fibre: &str,
    contraction: f64,
) -> Result<Row, Trouble> {
    let text = format!(
        "[mesher]\nkind = \"pleated\"\nradius = \"16 mm\"\nlength = \"110 mm\"\nfibres = {fibres}\ncircumference = \"288 mm\"\ncells = [{}, {}]\n{cloth}[[part]]\ngroup = \"fibre\"\nkind = \"cable\"\n{fibre}[[step]]\npressure = \"3 bar\"\ncontraction = {contraction}\n",
        cells[0], cells[1]
    );
    let rows = rows(&text)?;
    rows.last().cloned().ok_or_else(|| "the case has no state".into())
}

/// Half lobes with cloth between the fibres.
pub(crate) fn sectors() -> Check {
    Claim {
        group: "membrane",
        name: "pleated sectors with cloth (50 N/mm, tension field), n = 8, 12, 24: force and volume",
        source: "an independent prototype, converged to 3e-4",
        tolerance: 1e-3,
        why: "12 x 40 cells; the reference has 18 x 60",
    }
    .run(|tally| {
        let cloth = "[[material]]\nname = \"cloth\"\nlaw = \"st-venant\"\nthickness = \"0.1 mm\"\nyoung = \"500 MPa\"\npoisson = 0.3\n[[part]]\ngroup = \"cloth\"\nkind = \"membrane\"\nmaterial = \"cloth\"\n";
        for (fibres, force, volume) in [(8, 884.25, 479_439.0), (12, 1064.44, 456_851.0), (24, 1320.17, 422_513.0)] {
            let stiffness = format!("stiffness = \"{} N\"\n", 12e6 / f64::from(fibres));
            let row = sector(fibres, [12, 40], cloth, &stiffness, 0.2)?;
            tally.relative(row.force.unwrap_or(f64::NAN), force, || format!("force, n = {fibres}"));
            tally.relative(row.volume, 1e-9 * volume, || format!("volume, n = {fibres}"));
        }
        Ok(())
    })
}

/// An airbag inflated from flat, as one eighth with 40 x 40 cells: volume, height of its middle, inward
/// displacement of a corner, and stress in the middle.
fn airbag_of(thickness: f64) -> Result<[f64; 4], Trouble> {
    let text = format!(
        "[mesher]\nkind = \"square\"\nside = \"848.53 mm\"\ncells = [40, 40]\n[[material]]\nname = \"foil\"\nlaw = \"st-venant\"\nthickness = \"{thickness} m\"\nyoung = \"588 MPa\"\npoisson = 0.4\n[[part]]\ngroup = \"cloth\"\nkind = \"membrane\"\nmaterial = \"foil\"\n[[step]]\npressure = \"5 kPa\"\n"
    );
    let case = Case::from_toml(&text, "airbag.toml", None)?;
    let mut run = case.start()?;
    let (row, _, fields) = run.advance(|_, _| ()).ok_or("the case has no state")??;
    let distance = |node: &usize| case.mesh.nodes[*node][0].hypot(case.mesh.nodes[*node][1]);
    let nodes = || 0..case.mesh.nodes.len();
    let middle = nodes().min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0);
    let corner = nodes().max_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0);
    let group = &fields.groups[0];
    let at = group.cells.chunks_exact(3).position(|cell| cell.contains(&u32::try_from(middle).unwrap_or(0)));
    let sheet = &group.sheets[0][at.ok_or("no element is in the middle")?];
    // Second Piola-Kirchhoff stress, from the force per current length.
    let stress = sheet.force[0] * sheet.stretch[1] / sheet.stretch[0] / thickness;
    Ok([row.volume, fields.places[middle][2], fields.displacements[corner][0], stress])
}

/// Measures of the square airbag, with those of an independent prototype: 0.6 and 0.1 mm thick.
fn airbags(whats: [&str; 4], measure: impl Fn(usize) -> bool, tally: &mut Tally) -> Result<(), Trouble> {
    let known = [
        (0.6e-3, [0.124_995, 0.216_7, -0.034_78, 3.90e6]),
        (0.1e-3, [0.129_694, 0.223_91, -0.031_259, 17.505e6]),
    ];
    for (thickness, exact) in known {
        let found = airbag_of(thickness)?;
        for (i, what) in whats.into_iter().enumerate().filter(|(i, _)| measure(*i)) {
            tally.relative(found[i], exact[i], || format!("{what}, {} mm", 1e3 * thickness));
        }
    }
    Ok(())
}

const AIRBAG: [&str; 4] = ["volume", "height", "corner", "stress"];

/// The square airbag.
pub(crate) fn airbag() -> Check {
    Claim {
        group: "membrane",
        name: "square airbag of 1.2 m diagonal, 0.6 and 0.1 mm, 5 kPa: volume, height, corner",
        source: "an independent prototype, 12800 triangles (0.1 mm: 3200)",
        tolerance: 2e-3,
        why: "3200 triangles, and the prototype's cloth may pass through itself",
    }
    .run(|tally| airbags(AIRBAG, |i| i < 3, tally))
}

/// The stress in its middle.
pub(crate) fn airbag_stress() -> Check {
    Claim {
        group: "membrane",
        name: "stress in the middle of the same airbags",
        source: "an independent prototype, 12800 triangles (0.1 mm: 3200)",
        tolerance: 8e-3,
        why: "a single cell of 3200, and the prototype's cloth may pass through itself",
    }
    .run(|tally| airbags(AIRBAG, |i| i == 3, tally))
}

/// A panel of unit height, width and stiffness that is bent until a band of it is slack: M/(P h), largest
/// stress and curvature, all dimensionless.
fn panel(band: f64, cells: usize) -> Result<[f64; 3], Trouble> {
    // The ends stay plane: z = 1 + k (x - b). The mesh has this shape from the start, but the pattern
    // doesn't. The curvature is small because in the theory stresses are linear in strain.
    let curvature = 1e-7;
    let place = |u: f64, v: f64| [u, 0.0, v * (1.0 + curvature * (u - band))];
    let pattern = |u: f64, v: f64| [u, v];
    let mut mesh =
        grid(&Surface { place: &place, pattern: Some(&pattern), cells: [cells; 2], is_quadratic: false });
    // One corner is fixed; all other nodes may move laterally as the panel bends.
    mesh.blocks.push(Block {
        group: "corner".to_owned(),
        kind: CellKind::Point,
        cells: vec![cells],
        numbers: vec![1],
        pattern: None,
    });
    let law = Law::SaintVenantKirchhoff { stiffness: 1.0, poisson: 0.3 };
    let sheet = Sheet { cloth: Cloth::Isotropic(law), wrinkles: true, residual: 1e-4 };
    let level = plane([0.0, 0.0, 1.0]);
    let mut panel = solver(
        &mesh,
        &[("cloth", Part::Membrane { sheet: Some(sheet), warp: [1.0, 0.0, 0.0] })],
        &[
            ("cloth", plane([0.0, 1.0, 0.0])),
            ("v0", level.clone()),
            ("v1", level),
            ("corner", plane([1.0, 0.0, 0.0])),
        ],
        &[],
        [1.0, 1.0],
    )?;
    let rest = panel.at_rest();
    let state = to(&mut panel, &rest, Inflation::Pressure(0.0), &[])?;
    let fields = panel.fields(&state);
    let group = &fields.groups[0];
    let (mut force, mut moment, mut top) = (0.0, 0.0, 0.0);
    for (cell, (sheet, area)) in group.cells.chunks_exact(3).zip(group.sheets[0].iter().zip(&group.areas)) {
        let x = cell.iter().map(|node| mesh.nodes[*node as usize][0]).sum::<f64>() / 3.0;
        // The force is per length of the pattern across, which wrinkles shorten.
        let pull = sheet.force[0] * sheet.stretch[1] * area;
        force += pull;
        moment += pull * (x - 0.5);
        if x > 1.0 - 1.0 / cells as f64 {
            top += pull * cells as f64;
        }
    }
    // Linear extrapolation from the middle of the outermost cells to the edge.
    let edge = top * (1.0 - band) / (1.0 - band - 0.5 / cells as f64);
    Ok([moment / force, edge / force, curvature / (2.0 * force)])
}

/// A panel in bending, wrinkled where it would be compressed.
pub(crate) fn wrinkled_panel() -> Check {
    Claim {
        group: "membrane",
        name: "wrinkled panel in bending, M/(P h) = 0.2, 0.3, 0.4: moment, largest stress, curvature",
        source: "Stein and Hedgepeth",
        tolerance: 1e-4,
        why: "10 x 10 cells",
    }
    .run(|tally| {
        for band in [0.1, 0.4, 0.7] {
            let [moment, stress, curvature] = panel(band, 10)?;
            let exact = (band + 0.5) / 3.0;
            tally.relative(moment, exact, || format!("moment, b/h = {band}"));
            tally.relative(stress, 2.0 / (1.0 - band), || format!("stress, b/h = {band}"));
            tally.relative(curvature, (1.0 - band).powi(-2), || format!("curvature, b/h = {band}"));
        }
        Ok(())
    })
}

/// Order of the errors of the wrinkled panel.
pub(crate) fn wrinkled_panel_order() -> Check {
    Claim {
        group: "membrane",
        name: "order of convergence of the panel's moment and stress: 2",
        source: "Stein and Hedgepeth",
        tolerance: 0.2,
        why: "10, 20 and 40 cells: 1.9",
    }
    .run(|tally| {
        for band in [0.1, 0.4, 0.7] {
            let mut errors = [Vec::new(), Vec::new()];
            for cells in [10, 20, 40] {
                let [moment, stress, _] = panel(band, cells)?;
                errors[0].push(3.0 * moment / (band + 0.5) - 1.0);
                errors[1].push(stress * (1.0 - band) / 2.0 - 1.0);
            }
            for (errors, what) in errors.iter().zip(["moment", "stress"]) {
                order(tally, &format!("{what}, b/h = {band}"), errors, 2.0);
            }
        }
        Ok(())
    })
}
