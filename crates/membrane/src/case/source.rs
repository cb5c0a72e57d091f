//! The mesh of a case: from a file, or from one of our meshers.

use bulge_muscles::settings::{Keys, Settings};
use bulge_muscles::{Dimension, FileError, Length, Muscle, Parameter};
use std::io::Read as _;
use std::path::Path;

use super::nested::Lattice;
use super::read::{copies, in_range, name, needed, number, positive};
use crate::mesh::Mesh;
use crate::mesher::{Grading, Pleated, Surface, grid, revolved, tube};
use crate::state::Copies;
use crate::structure::{Fitting, Support};
use core::f64::consts::{FRAC_PI_2, PI};

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

pub(super) const SCALE: Keys = &[
    ("unit", "unit = \"mm\""),
    ("around", "around = 1"),
    ("along", "along = 1"),
    ("length", "length = \"60 mm\""),
];

/// Most cells along a side.
const MOST_CELLS: u64 = 100_000;
/// Most elements of a mesh.
const MOST_ELEMENTS: u64 = 2_000_000;
/// Largest size of a mesh file in bytes.
const MOST_BYTES: u64 = 1 << 31;

/// A mesh with its known properties.
pub(super) struct Source {
    pub(super) mesh: Mesh,
    pub(super) lattice: Option<Lattice>,
    pub(super) copies: Copies,
    pub(super) length: Option<f64>,
    pub(super) unfolded_radius: Option<f64>,
    pub(super) muscle: Option<Muscle>,
    /// Supports that follow from its symmetry.
    pub(super) supports: Vec<(String, Support)>,
    /// Groups of these in whose plane the cloth meets its mirror image.
    pub(super) contacts: Vec<String>,
    pub(super) fittings: Vec<(String, Fitting)>,
}

#[derive(Debug, Clone, Copy)]
enum Mesher {
    Tube,
    Disc,
    Sphere,
    Square,
    Pleated,
}

const MESHERS: &[(&str, Mesher)] = &[
    ("tube", Mesher::Tube),
    ("disc", Mesher::Disc),
    ("sphere", Mesher::Sphere),
    ("square", Mesher::Square),
    ("pleated", Mesher::Pleated),
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
                let what =
                    "`[scale]` is for a mesh from a file: our own meshes know their size and their symmetry";
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
        settings.error(
            settings.value_span("mesh"),
            what,
            "name a Gmsh (.msh) or VTK (.vtu) mesh beside the case",
        )
    };
    let bytes = bytes(&path).map_err(refused)?;
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
        lattice: None,
        copies: copies(&scale)?,
        length: positive(&scale, "length", Dimension::LENGTH)?,
        unfolded_radius: None,
        muscle: None,
        supports: Vec::new(),
        contacts: Vec::new(),
        fittings: Vec::new(),
    })
}

/// Reads a mesh file. Only regular files are accepted: a device may be endless, and a pipe may never deliver.
fn bytes(path: &Path) -> Result<Vec<u8>, String> {
    let unreadable = |error: std::io::Error| format!("cannot read {}: {error}", path.display());
    let too_large = || format!("{} is larger than 2 GiB", path.display());
    let known = std::fs::metadata(path).map_err(unreadable)?;
    if !known.is_file() {
        return Err(format!("{} is no file", path.display()));
    }
    if known.len() > MOST_BYTES {
        return Err(too_large());
    }
    let mut bytes = Vec::new();
    let size = usize::try_from(known.len()).map_err(|_| too_large())?;
    bytes.try_reserve_exact(size).map_err(|_| format!("no memory for the bytes of {}", path.display()))?;
    let file = std::fs::File::open(path).map_err(unreadable)?;
    // The file may have grown since.
    file.take(MOST_BYTES + 1).read_to_end(&mut bytes).map_err(unreadable)?;
    if bytes.len() as u64 > MOST_BYTES {
        return Err(too_large());
    }
    Ok(bytes)
}

/// The keys of a kind of mesh.
fn known(kind: Mesher) -> &'static [&'static str] {
    match kind {
        Mesher::Tube => &["muscle", "radius", "length", "grading"],
        Mesher::Disc | Mesher::Sphere => &["radius"],
        Mesher::Square => &["side"],
        Mesher::Pleated => &["muscle", "radius", "length", "fibres", "circumference", "depth"],
    }
}

/// The options of `[mesher]` that any mesh has.
struct MesherOptions<'a, 't> {
    table: &'a Settings<'t>,
    cells: Vec<usize>,
    is_quadratic: bool,
    muscle: Option<Muscle>,
}

fn made(table: &Settings<'_>, folder: Option<&Path>) -> Result<Source, FileError> {
    let kind = table.word("kind", MESHERS)?.ok_or_else(|| table.missing("kind"))?;
    for (key, _) in KEYS {
        let is_known = ["kind", "cells", "order"].contains(key) || known(kind).contains(key);
        if table.get(key).is_some() && !is_known {
            let what = format!("this kind of mesh has no `{key}`");
            return Err(table.error(table.key_span(key), what, format!("it has {}", known(kind).join(", "))));
        }
    }
    let is_quadratic = match table.count::<u8>("order")? {
        None | Some(1) => false,
        Some(2) => true,
        Some(_) => {
            let what = "`order` is 1 (straight edges) or 2 (a node on each edge)";
            return Err(table.error(table.value_span("order"), what, "write `order = 1` or `order = 2`"));
        }
    };
    let muscle = table.get("muscle").map(|_| table.muscle("muscle", folder)).transpose()?;
    let wish = MesherOptions { table, cells: cells(table)?, is_quadratic, muscle };
    let mut source = match kind {
        Mesher::Tube => wish.tube(),
        Mesher::Disc => wish.disc(),
        Mesher::Sphere => wish.sphere(),
        Mesher::Square => wish.square(),
        Mesher::Pleated => wish.pleated(),
    }?;
    if let [nu, nv] = wish.cells[..] {
        source.lattice = Some(Lattice { cells: [nu, nv], is_quadratic });
    }
    source.muscle = wish.muscle;
    Ok(source)
}

fn placed(name: &str) -> (String, Fitting) {
    (name.to_owned(), Fitting::Placed)
}

fn held(group: &str, support: Support) -> (String, Support) {
    (group.to_owned(), support)
}

fn plane(normal: [f64; 3]) -> Support {
    Support::Plane { normal }
}

fn source(mesh: Mesh, copies: Copies, supports: Vec<(String, Support)>) -> Source {
    Source {
        mesh,
        copies,
        supports,
        lattice: None,
        length: None,
        unfolded_radius: None,
        contacts: Vec::new(),
        fittings: Vec::new(),
        muscle: None,
    }
}

impl MesherOptions<'_, '_> {
    /// Number of elements of a line.
    fn line(&self) -> Result<usize, FileError> {
        let [one] = self.cells[..] else {
            let what = "this mesh is a line: it takes one number of cells";
            return Err(self.table.error(
                self.table.value_span("cells"),
                what,
                "write such as `cells = [60]`",
            ));
        };
        Ok(one)
    }

    /// Numbers of cells of a surface.
    fn surface(&self) -> Result<[usize; 2], FileError> {
        let [u, v] = self.cells[..] else {
            let what = "this mesh is a surface: it takes two numbers of cells";
            let instead = "write such as `cells = [18, 60]`: round, and along";
            return Err(self.table.error(self.table.value_span("cells"), what, instead));
        };
        Ok([u, v])
    }

    /// A length from the table, or else from the muscle.
    fn length(&self, key: &str, of_muscle: impl Fn(&Muscle) -> Option<Length>) -> Result<f64, FileError> {
        let stated = positive(self.table, key, Dimension::LENGTH)?;
        let known = || self.muscle.as_ref().and_then(of_muscle).map(Length::to_m);
        stated.or_else(known).ok_or_else(|| self.table.missing(key))
    }

    fn tube(&self) -> Result<Source, FileError> {
        let radius = self.length("radius", |muscle| Some(muscle.end_radius()))?;
        let length = self.length("length", |muscle| Some(muscle.length()))?;
        let range = |ratio: f64| (1.0..=1e4).contains(&ratio);
        let grading = number(self.table, "grading", range, "from 1 to 10000")?.unwrap_or(1.0);
        let fittings = vec![placed("bottom"), placed("top")];
        let mut supports = vec![
            held("first", Support::Fitting { fitting: 0 }),
            held("last", Support::Fitting { fitting: 1 }),
        ];
        let made = if let [round, along] = self.cells[..] {
            let mesh = tube(radius, length, [round, along], self.is_quadratic, Grading::Ends(grading));
            supports.extend([held("left", plane([0.0, 1.0, 0.0])), held("right", plane([1.0, 0.0, 0.0]))]);
            source(mesh, Copies { around: 4.0, along: 1.0 }, supports)
        } else {
            let line = |t: f64| [radius, length * t];
            let mesh = revolved(line, self.line()?, self.is_quadratic, Grading::Ends(grading));
            source(mesh, Copies::ONE, supports)
        };
        Ok(Source { fittings, length: Some(length), ..made })
    }

    fn disc(&self) -> Result<Source, FileError> {
        let radius = needed(self.table, "radius", Dimension::LENGTH)?;
        // From the rim inwards, so that z grows along the line as it is inflated.
        let line = |t: f64| [radius * (1.0 - t), 0.0];
        let mesh = revolved(line, self.line()?, self.is_quadratic, Grading::Even);
        let supports = vec![held("first", Support::Fixed), held("last", Support::Axis)];
        Ok(source(mesh, Copies::ONE, supports))
    }

    fn sphere(&self) -> Result<Source, FileError> {
        let radius = needed(self.table, "radius", Dimension::LENGTH)?;
        let arc = |t: f64| {
            let angle = FRAC_PI_2 * t;
            [if t >= 1.0 { 0.0 } else { radius * angle.cos() }, radius * angle.sin()]
        };
        let mesh = revolved(arc, self.line()?, self.is_quadratic, Grading::Even);
        let supports = vec![held("first", plane([0.0, 0.0, 1.0])), held("last", Support::Axis)];
        Ok(source(mesh, Copies { around: 1.0, along: 2.0 }, supports))
    }

    fn square(&self) -> Result<Source, FileError> {
        let half = 0.5 * needed(self.table, "side", Dimension::LENGTH)?;
        let place = |u: f64, v: f64| [half * u, half * v, 0.0];
        let (cells, is_quadratic) = (self.surface()?, self.is_quadratic);
        let mesh = grid(&Surface { place: &place, pattern: None, cells, is_quadratic });
        let supports = vec![
            held("u0", plane([1.0, 0.0, 0.0])),
            held("v0", plane([0.0, 1.0, 0.0])),
            held("u1", plane([0.0, 0.0, 1.0])),
            held("v1", plane([0.0, 0.0, 1.0])),
        ];
        // Where an edge is pulled in, the cloth folds, and would pass through itself.
        let contacts = ["u0", "v0"].map(str::to_owned).to_vec();
        Ok(Source { contacts, ..source(mesh, Copies { around: 4.0, along: 2.0 }, supports) })
    }

    fn pleated(&self) -> Result<Source, FileError> {
        let pleated = pleated(self)?;
        let angle = PI / pleated.fibres as f64;
        let supports = vec![
            held("fibre", plane([0.0, 1.0, 0.0])),
            held("top", plane([-angle.sin(), angle.cos(), 0.0])),
            held("middle", plane([0.0, 0.0, 1.0])),
            held("end", Support::Fitting { fitting: 0 }),
        ];
        let copies = Copies { around: 2.0 * pleated.fibres as f64, along: 2.0 };
        let whole = source(pleated.half_lobe(), copies, supports);
        let unfolded_radius = Some(pleated.circumference / (2.0 * PI));
        Ok(Source { fittings: vec![placed("top")], length: Some(pleated.length), unfolded_radius, ..whole })
    }
}

fn pleated(wish: &MesherOptions<'_, '_>) -> Result<Pleated, FileError> {
    let (table, muscle) = (wish.table, wish.muscle.as_ref());
    if muscle.is_some_and(|muscle| !muscle.is_pleated()) {
        let what = "a pleated mesh needs a pleated muscle, and this one is braided";
        return Err(table.error(table.value_span("muscle"), what, "write `kind = \"tube\"`"));
    }
    let stated = table.count::<u32>("fibres")?;
    let fibres = stated.or(muscle.and_then(Muscle::fibres)).ok_or_else(|| table.missing("fibres"))?;
    if !(3..=10_000).contains(&fibres) {
        let what = format!("{fibres} fibres are not possible: 3 to 10000 are");
        return Err(table.error(table.value_span("fibres"), what, "write such as `fibres = 40`"));
    }
    let own = |parameter| muscle.and_then(|muscle| muscle.get(parameter)).map(Length::m);
    let radius = wish.length("radius", |_| muscle.map(Muscle::radius))?;
    let circumference = wish.length("circumference", |_| own(Parameter::ClothCircumference))?;
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
        length: wish.length("length", |muscle| Some(muscle.length()))?,
        circumference,
        depth: depth.or(own(Parameter::PleatDepth).map(Length::to_m)).unwrap_or(0.0),
        cells: wish.surface()?,
        is_quadratic: wish.is_quadratic,
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
        let what = format!(
            "`cells` must be one or two whole numbers from 1 to {MOST_CELLS}, for at most {MOST_ELEMENTS} elements"
        );
        return Err(table.error(value.span(), what, "write such as `cells = [60]` or `cells = [18, 60]`"));
    }
    numbers.into_iter().map(|n| usize::try_from(n).map_err(|_| table.missing("cells"))).collect()
}
