//! Where the mesh of a case comes from: a file, or one of our meshers.

use bulge_muscles::settings::{Keys, Settings};
use bulge_muscles::{Construction, Dimension, FileError, Length, Muscle};
use core::f64::consts::FRAC_PI_2;
use std::path::Path;

use super::read::{copies, in_range, name, needed, number, positive};
use crate::mesh::Mesh;
use crate::mesher::{Grading, Pleated, Surface, grid, revolved};
use crate::solver::Copies;
use crate::structure::{Fitting, Support};
use core::f64::consts::PI;

const KEYS: Keys = &[
    ("kind", "kind = \"tube\""),
    ("muscle", "muscle = \"ppam-2-r16\""),
    ("radius", "radius = \"10 mm\""),
    ("length", "length = \"60 mm\""),
    ("side", "side = \"800 mm\""),
    ("circumference", "circumference = \"288 mm\""),
    ("depth", "depth = \"4.5 mm\""),
    ("fibres", "fibres = 40"),
    ("cells", "cells = [60, 18]"),
    ("order", "order = 1"),
    ("grading", "grading = 3.0"),
];

const SCALE: Keys = &[
    ("unit", "unit = \"mm\""),
    ("around", "around = 1"),
    ("along", "along = 1"),
    ("length", "length = \"60 mm\""),
];

/// Most cells along a side.
const MOST_CELLS: u64 = 100_000;
/// Most elements of a mesh.
const MOST_ELEMENTS: u64 = 2_000_000;
/// Bytes of a mesh file.
const MOST_BYTES: u64 = 1 << 31;

/// A mesh, and what is known about it.
pub(super) struct Source {
    pub(super) mesh: Mesh,
    pub(super) copies: Copies,
    pub(super) length: Option<f64>,
    pub(super) muscle: Option<Muscle>,
    /// What holds it by its symmetry.
    pub(super) supports: Vec<(String, Support)>,
    pub(super) fittings: Vec<(String, Fitting)>,
}

#[derive(Debug, Clone, Copy)]
enum Kind {
    Tube,
    Disc,
    Sphere,
    Square,
    Pleated,
}

const KINDS: &[(&str, Kind)] = &[
    ("tube", Kind::Tube),
    ("disc", Kind::Disc),
    ("sphere", Kind::Sphere),
    ("square", Kind::Square),
    ("pleated", Kind::Pleated),
];

pub(super) fn read(settings: &Settings<'_>, folder: Option<&Path>) -> Result<Source, FileError> {
    match (settings.text("mesh")?, settings.table("mesher", "`[mesher]`", KEYS)?) {
        (Some(_), Some(_)) => Err(settings.error(
            settings.key_span("mesher"),
            "the case has a `mesh` and a `[mesher]`",
            "keep one of them",
        )),
        (None, None) => Err(settings.missing("mesh")),
        (Some(_), None) => from_file(settings, folder),
        (None, Some(table)) => {
            if settings.get("scale").is_some() {
                let what = "`[scale]` is for a mesh from a file: our own meshes know their size and their symmetry";
                return Err(settings.error(settings.key_span("scale"), what, "leave it out"));
            }
            table.check_keys()?;
            made(&table, folder)
        }
    }
}

fn from_file(settings: &Settings<'_>, folder: Option<&Path>) -> Result<Source, FileError> {
    let named = name(settings, "mesh")?;
    let path = folder.map_or_else(|| named.into(), |folder| folder.join(named));
    let refused = |what: String| {
        settings.error(settings.value_span("mesh"), what, "name a Gmsh (.msh) or VTK (.vtu) mesh beside the case")
    };
    let size = std::fs::metadata(&path).map_err(|error| refused(format!("cannot read {}: {error}", path.display())))?;
    if size.len() > MOST_BYTES {
        return Err(refused(format!("{} is larger than 2 GiB", path.display())));
    }
    let bytes = std::fs::read(&path).map_err(|error| refused(format!("cannot read {}: {error}", path.display())))?;
    let mut mesh = Mesh::from_bytes(&bytes, &path.display().to_string())
        .map_err(|error| FileError::whole(&error.file, error.what.clone(), error.instead.clone()))?;
    let scale = settings.table("scale", "`[scale]`", SCALE)?.ok_or_else(|| settings.missing("scale"))?;
    scale.check_keys()?;
    let unit = name(&scale, "unit")?;
    let metres = bulge_muscles::units::factor::<Length>(unit).map_err(|error| {
        scale.error(scale.value_span("unit"), error.to_string(), "write such as `unit = \"mm\"`")
    })?;
    for node in &mut mesh.nodes {
        *node = node.map(|x| x * metres);
    }
    for block in &mut mesh.blocks {
        for place in block.pattern.iter_mut().flatten() {
            *place = place.map(|x| x * metres);
        }
    }
    Ok(Source {
        mesh,
        copies: copies(&scale)?,
        length: positive(&scale, "length", Dimension::LENGTH)?,
        muscle: None,
        supports: Vec::new(),
        fittings: Vec::new(),
    })
}

/// The keys that a kind of mesh has.
fn known(kind: Kind) -> &'static [&'static str] {
    match kind {
        Kind::Tube => &["muscle", "radius", "length", "grading"],
        Kind::Disc | Kind::Sphere => &["radius"],
        Kind::Square => &["side"],
        Kind::Pleated => &["muscle", "radius", "length", "fibres", "circumference", "depth"],
    }
}

fn made(table: &Settings<'_>, folder: Option<&Path>) -> Result<Source, FileError> {
    let kind = table.word("kind", KINDS)?.ok_or_else(|| table.missing("kind"))?;
    for (key, _) in KEYS {
        let is_known = ["kind", "cells", "order"].contains(key) || known(kind).contains(key);
        if table.get(key).is_some() && !is_known {
            let what = format!("this kind of mesh has no `{key}`");
            return Err(table.error(table.key_span(key), what, format!("it has {}", known(kind).join(", "))));
        }
    }
    let muscle = table.get("muscle").map(|_| table.muscle("muscle", folder)).transpose()?;
    let of_muscle = |key: &str, value: Option<f64>| -> Result<f64, FileError> {
        match positive(table, key, Dimension::LENGTH)?.or(value) {
            Some(value) => Ok(value),
            None => Err(table.missing(key)),
        }
    };
    let order = number(table, "order", |x| x == 1.0 || x == 2.0, "1 or 2")?.unwrap_or(1.0);
    let is_quadratic = order > 1.0;
    let fitting = |name: &str| (name.to_owned(), Fitting::Placed);
    let held = |group: &str, support: Support| (group.to_owned(), support);
    let plane = |normal: [f64; 3]| Support::Plane { normal };
    let single = |cells: &[usize]| -> Result<usize, FileError> {
        match cells {
            [one] => Ok(*one),
            _ => Err(table.error(table.value_span("cells"), "this mesh is a line: it takes one number of cells", "write such as `cells = [60]`")),
        }
    };
    let pair = |cells: &[usize]| -> Result<[usize; 2], FileError> {
        match cells {
            [u, v] => Ok([*u, *v]),
            _ => Err(table.error(table.value_span("cells"), "this mesh is a surface: it takes two numbers of cells", "write such as `cells = [18, 60]`: round, and along")),
        }
    };
    let cells = cells(table)?;
    let mut source = Source {
        mesh: Mesh::default(),
        copies: Copies::ONE,
        length: None,
        supports: Vec::new(),
        fittings: Vec::new(),
        muscle: None,
    };
    match kind {
        Kind::Tube => {
            let radius = of_muscle("radius", muscle.as_ref().map(|m| m.end_radius().to_m()))?;
            let length = of_muscle("length", muscle.as_ref().map(|m| m.length().to_m()))?;
            let grading = number(table, "grading", |x| (1.0..=1e4).contains(&x), "from 1 to 10000")?.unwrap_or(1.0);
            source.mesh =
                revolved(|t| [radius, length * t], single(&cells)?, is_quadratic, Grading::Ends(grading));
            source.length = Some(length);
            source.fittings = vec![fitting("bottom"), fitting("top")];
            source.supports = vec![
                held("first", Support::Fitting { fitting: 0 }),
                held("last", Support::Fitting { fitting: 1 }),
            ];
        }
        Kind::Disc => {
            let radius = needed(table, "radius", Dimension::LENGTH)?;
            source.mesh =
                revolved(|t| [radius * (1.0 - t), 0.0], single(&cells)?, is_quadratic, Grading::Even);
            source.supports = vec![held("first", Support::Fixed), held("last", Support::Axis)];
        }
        Kind::Sphere => {
            let radius = needed(table, "radius", Dimension::LENGTH)?;
            let arc = |t: f64| {
                let angle = FRAC_PI_2 * t;
                [if t >= 1.0 { 0.0 } else { radius * angle.cos() }, radius * angle.sin()]
            };
            source.mesh = revolved(arc, single(&cells)?, is_quadratic, Grading::Even);
            source.supports = vec![held("first", plane([0.0, 0.0, 1.0])), held("last", Support::Axis)];
            source.copies = Copies { around: 1.0, along: 2.0 };
        }
        Kind::Square => {
            let half = 0.5 * needed(table, "side", Dimension::LENGTH)?;
            let place = |u: f64, v: f64| [half * u, half * v, 0.0];
            source.mesh = grid(&Surface { place: &place, pattern: None, cells: pair(&cells)?, is_quadratic });
            source.supports = vec![
                held("u0", plane([1.0, 0.0, 0.0])),
                held("v0", plane([0.0, 1.0, 0.0])),
                held("u1", plane([0.0, 0.0, 1.0])),
                held("v1", plane([0.0, 0.0, 1.0])),
            ];
            source.copies = Copies { around: 4.0, along: 2.0 };
        }
        Kind::Pleated => {
            let pleated = pleated(table, muscle.as_ref(), pair(&cells)?, is_quadratic)?;
            source.mesh = pleated.half_lobe();
            let angle = PI / pleated.fibres as f64;
            source.supports = vec![
                held("fibre", plane([0.0, 1.0, 0.0])),
                held("top", plane([-angle.sin(), angle.cos(), 0.0])),
                held("middle", plane([0.0, 0.0, 1.0])),
                held("end", Support::Fitting { fitting: 0 }),
            ];
            source.fittings = vec![fitting("top")];
            source.copies = Copies { around: 2.0 * pleated.fibres as f64, along: 2.0 };
            source.length = Some(pleated.length);
        }
    }
    source.muscle = muscle;
    Ok(source)
}

fn pleated(
    table: &Settings<'_>,
    muscle: Option<&Muscle>,
    cells: [usize; 2],
    is_quadratic: bool,
) -> Result<Pleated, FileError> {
    let own = muscle.and_then(|muscle| match muscle.construction() {
        Construction::Pleated(pleated) => Some(*pleated),
        Construction::Braided(_) => None,
    });
    if muscle.is_some() && own.is_none() {
        let what = "a pleated mesh needs a pleated muscle, and this one is braided";
        return Err(table.error(table.value_span("muscle"), what, "write `kind = \"tube\"`"));
    }
    let fibres = match (table.count::<u32>("fibres")?, muscle.and_then(Muscle::fibres)) {
        (Some(count), _) | (None, Some(count)) => count,
        (None, None) => return Err(table.missing("fibres")),
    };
    if !(3..=10_000).contains(&fibres) {
        let what = format!("{fibres} fibres are not possible: 3 to 10000 are");
        return Err(table.error(table.value_span("fibres"), what, "write such as `fibres = 40`"));
    }
    let length = |key: &str, value: Option<f64>| -> Result<f64, FileError> {
        let stated = positive(table, key, Dimension::LENGTH)?;
        stated.or(value).ok_or_else(|| table.missing(key))
    };
    let radius = length("radius", own.map(|p| p.radius().to_m()))?;
    let circumference =
        length("circumference", own.and_then(|p| p.cloth_circumference()).map(|c| c.to_m()))?;
    if circumference < 2.0 * PI * radius {
        let what = format!(
            "a cloth of {:.4} mm doesn't reach round the fibres' circle of {:.4} mm",
            1e3 * circumference,
            2e3 * PI * radius
        );
        return Err(table.error(table.value_span("circumference"), what, "write its length spread out flat"));
    }
    let depth = in_range(table, "depth", Dimension::LENGTH, |d| d >= 0.0, "at least 0")?;
    Ok(Pleated {
        fibres: fibres as usize,
        radius,
        length: length("length", muscle.map(|m| m.length().to_m()))?,
        circumference,
        depth: depth.or(own.map(|p| p.pleat_depth().to_m())).unwrap_or(0.0),
        cells,
        is_quadratic,
    })
}

/// One or two numbers of cells.
fn cells(table: &Settings<'_>) -> Result<Vec<usize>, FileError> {
    let value = table.get("cells").ok_or_else(|| table.missing("cells"))?;
    let items = value.items().unwrap_or_default();
    let numbers: Vec<u64> = items.iter().filter_map(|item| item.whole()).collect();
    let is_good = numbers.len() == items.len()
        && (1..=2).contains(&numbers.len())
        && numbers.iter().all(|n| (1..=MOST_CELLS).contains(n))
        && 2 * numbers.iter().product::<u64>() <= MOST_ELEMENTS;
    if !is_good {
        let what = format!("`cells` must be one or two whole numbers from 1 to {MOST_CELLS}, for at most {MOST_ELEMENTS} elements");
        return Err(table.error(value.span(), what, "write such as `cells = [60]` or `cells = [18, 60]`"));
    }
    numbers
        .into_iter()
        .map(|n| usize::try_from(n).map_err(|_| table.missing("cells")))
        .collect()
}
