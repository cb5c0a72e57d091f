//! `bulge demo`: the tour, on shipped muscles.

mod hidden;
mod own_form;
mod tabulated;

use bulge_effects::Catalogue;
use bulge_fibre::{Approach, FibreError, Given, Problem, Response, isobars};
use bulge_inference::{Comparison, Diagnosis, Options, Verdict, compare_with_rows};
use bulge_measurements::Data;
use bulge_muscles::{Ends, Muscle, MuscleError, Parameter, Pressure, from_toml, preset};
use bulge_sweep::TableDescription;
use bulge_vtk::{write_series, write_vtp};
use clap::Args;
use serde::Serialize;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::arguments::{Json, about, pretty};
use crate::characteristics;
use crate::compare::{ladder, parameters, report};
use crate::failure::Failure;
use crate::files;
use crate::shape::bulge;
use crate::sketch::sketch;
use crate::text::{significant, table};

/// Measurements of the tour, and the muscle as described in its data sheet.
pub(crate) const DATA: (&str, &str) = ("braid-loops.csv", include_str!("../data/braid-loops.csv"));
pub(crate) const MUSCLE: (&str, &str) = ("braid.toml", include_str!("../data/braid.toml"));
/// Effects that the tour adds to the muscle.
const ADDED: [&str; 3] = ["end-taper", "bladder-elasticity", "coulomb-friction"];
/// Frames of the time series.
const FRAMES: u32 = 21;

/// The tour, on shipped muscles.
#[derive(Debug, Args)]
pub(crate) struct Demo {
    /// Folder for the files of the tour
    #[arg(long, default_value = "bulge-demo")]
    out: PathBuf,
    #[command(flatten)]
    json: Json,
}

impl Default for Demo {
    fn default() -> Self {
        Self { out: PathBuf::from("bulge-demo"), json: Json::default() }
    }
}

/// One model of the braid and its result.
#[derive(Debug, Serialize)]
struct Step {
    model: &'static str,
    #[serde(flatten)]
    response: Response,
}

/// The JSON document.
#[derive(Debug, Serialize)]
struct Document {
    schema: &'static str,
    pleated: Response,
    shooting_minus_closed_form: f64,
    braid: Vec<Step>,
    /// Titles of the rungs with their errors \[N\].
    ladder: Vec<(String, f64)>,
    /// Diagnosis of measurements with a hidden effect, and diagnosis after it was added.
    hidden: [Found; 2],
    /// The same for a hidden effect of another form than its formula, and after that form was written as an
    /// effect.
    own_form: [Found; 2],
    /// The table of a family of muscles.
    table: TableDescription,
    files: Vec<PathBuf>,
}

/// Summary of a diagnosis.
#[derive(Debug, Serialize)]
struct Found {
    verdict: Verdict,
    missing: Vec<String>,
    /// Error of the model with the missing effects by their formulas, and the noise floor \[N\].
    rmse_n: f64,
    noise_floor_n: f64,
}

impl Found {
    fn of(diagnosis: &Diagnosis) -> Self {
        Self {
            verdict: diagnosis.verdict,
            missing: diagnosis.missing.iter().map(|missing| missing.effect.clone()).collect(),
            rmse_n: diagnosis.ladder.iter().rfind(|step| !step.bent).map_or(0.0, |step| step.rmse_n),
            noise_floor_n: diagnosis.noise_floor_n,
        }
    }
}

impl Demo {
    pub(crate) fn run(&self) -> Result<String, Failure> {
        files::folder(&self.out)?;
        let mut text = String::from("A tour of Bulge\n\n");
        let mut written = Vec::new();
        let (pleated, difference) = pleated(&self.out, &mut text, &mut written)?;
        let braid = braid(&self.out, &mut text, &mut written)?;
        let comparison = measured(&self.out, &mut text, &mut written)?;
        let hidden = hidden::hidden(&self.out, &mut text, &mut written)?;
        let own_form = own_form::own_form(&self.out, &mut text, &mut written)?;
        let table = tabulated::tabulated(&self.out, &mut text, &mut written)?;
        if self.json.wanted {
            let document = Document {
                schema: "bulge.demo/1",
                pleated,
                shooting_minus_closed_form: difference,
                braid,
                ladder: comparison.ladder.iter().map(|rung| (rung.title.clone(), rung.rmse_n)).collect(),
                hidden: hidden.each_ref().map(Found::of),
                own_form: own_form.each_ref().map(Found::of),
                table,
                files: written,
            };
            return pretty(&document);
        }
        text.push_str("Files of this tour (open report.html and the .svg in a browser, the .pvd or a .vtp in ParaView):\n\n");
        for path in &written {
            let _ = writeln!(text, "  {}", path.display());
        }
        text.push_str("\nNext: `bulge muscle ppam-2-r16 > my.toml`, change it, then `bulge shape my.toml --pressure \"2 bar\" --force \"500 N\"`.\n");
        let (data, muscle) = (self.out.join(DATA.0), self.out.join(MUSCLE.0));
        let _ = writeln!(
            text,
            "Or see what another effect does: `bulge compare {} --muscle {} --with {},pressure-friction`.\n\
             By hand, in the browser: `bulge open` (`cargo run --release -- open`).",
            data.display(),
            muscle.display(),
            ADDED.join(",")
        );
        Ok(text)
    }
}

/// The pleated muscle: two methods that share no formula, the bulge, the characteristics.
fn pleated(out: &Path, text: &mut String, written: &mut Vec<PathBuf>) -> Result<(Response, f64), Failure> {
    let muscle = preset("ppam-2-r16")?;
    let pressure = Pressure::bar(2.0);
    let about = about(&muscle, pressure);
    let problem = Problem::new(&muscle, pressure).map_err(&about)?;
    let given = Given::Contraction(0.2);
    let shape = problem.shape(given, Approach::ClosedForm, 121).map_err(&about)?;
    let shot = problem.solve(given, Approach::Shooting).map_err(&about)?;
    let exact = shape.response;
    let difference = shot.force_n / exact.force_n - 1.0;
    let _ = writeln!(
        text,
        "1. The second-generation PPAM (110 mm, 40 fibres on R = 16 mm) at 2 bar, contracted by 20 %\n\n\
         {}\n  It pulls {} N and holds {} ml. Closed form and shooting differ by {difference:.0e}.\n",
        sketch(&shape.meridian, 48),
        significant(exact.force_n, 5),
        significant(1e6 * exact.volume_m3, 4),
    );
    let path = out.join("ppam.vtp");
    write_vtp(&path, &bulge(&muscle, &shape, None, None))?;
    written.push(path);

    let pressures = [1.0, 2.0, 3.0].map(Pressure::bar);
    let limit = problem.contraction_limit(Approach::Auto).map_err(&about)?;
    let contractions: Vec<f64> = (0..=200).map(|i| 0.02 + (limit - 0.02) * f64::from(i) / 200.0).collect();
    let curves = isobars(&muscle, &pressures, &contractions, Approach::Auto).map_err(&about)?;
    for (name, content) in [
        ("ppam-characteristics.csv", characteristics::csv(&curves)),
        ("ppam-characteristics.svg", characteristics::svg(muscle.name(), &curves)?),
    ] {
        let path = out.join(name);
        files::write(&path, content.as_bytes())?;
        written.push(path);
    }
    let shapes: Vec<_> = (0..FRAMES)
        .map(|i| {
            let contraction = 0.01 + (0.99 * limit - 0.01) * f64::from(i) / f64::from(FRAMES - 1);
            Ok((contraction, problem.shape(Given::Contraction(contraction), Approach::Auto, 61)?))
        })
        .collect::<Result<_, FibreError>>()
        .map_err(&about)?;
    let frames: Vec<_> =
        shapes.iter().map(|(c, shape)| (100.0 * c, bulge(&muscle, shape, None, None))).collect();
    written.push(write_series(out.join("ppam-series"), "ppam", &frames)?);
    Ok((exact, difference))
}

/// The braided muscle: how the ends and the bladder change the textbook formula.
fn braid(out: &Path, text: &mut String, written: &mut Vec<PathBuf>) -> Result<Vec<Step>, Failure> {
    let textbook = preset("dmsp-20-250")?;
    let pressure = Pressure::bar(3.0);
    let about = about(&textbook, pressure);
    let given = Given::Contraction(0.2);
    // 0.3 MPa is typical of a neo-Hookean bladder fitted to the forces of Festo muscles (0.28 to 0.39 MPa).
    let models =
        models(&textbook, 3e5).map_err(|error| Failure::Value { option: "demo", what: error.to_string() })?;
    let mut steps = Vec::new();
    for (model, muscle) in &models {
        let problem = Problem::new(muscle, pressure).map_err(&about)?;
        let shape = problem.shape(given, Approach::Auto, 161).map_err(&about)?;
        steps.push(Step { model, response: shape.response });
        if *model == "exact ends and rubber bladder" {
            let path = out.join("dmsp-20-250.vtp");
            write_vtp(&path, &bulge(muscle, &shape, None, None))?;
            written.push(path);
        }
    }
    let _ =
        writeln!(text, "2. A Festo DMSP-20-250 at 3 bar, contracted by 20 %: what the textbook leaves out\n");
    let mut rows = vec![
        ["model", "force [N]", "mid radius [mm]", "slope at the fittings [deg]"].map(String::from).to_vec(),
    ];
    for step in &steps {
        let r = &step.response;
        rows.push(vec![
            step.model.to_owned(),
            significant(r.force_n, 4),
            significant(1e3 * r.mid_radius_m, 4),
            significant(r.end_slope_rad.to_degrees(), 3),
        ]);
    }
    text.push_str(&table(&rows));
    text.push('\n');
    Ok(steps)
}

/// Measurements of a braid against the textbook, and the error as effects are added.
fn measured(out: &Path, text: &mut String, written: &mut Vec<PathBuf>) -> Result<Comparison, Failure> {
    for (name, content) in [DATA, MUSCLE] {
        let path = out.join(name);
        files::write(&path, content.as_bytes())?;
        written.push(path);
    }
    let muscle = from_toml(MUSCLE.1, MUSCLE.0)?;
    let data = Data::from_csv(DATA.1, DATA.0)?;
    let catalogue = Catalogue::builtin();
    let effects = ADDED.iter().map(|name| Ok(Arc::clone(catalogue.find(name)?)));
    let effects = effects.collect::<Result<Vec<_>, Failure>>()?;
    let (comparison, rows) = compare_with_rows(&data, &muscle, &Options::new(catalogue, effects))?;
    let _ = writeln!(
        text,
        "3. {} readings of a braid (simulated, with noise) against the textbook: the error falls as the right effects are added",
        data.len()
    );
    ladder(text, &comparison);
    if let Some(rung) = comparison.ladder.last()
        && let Some(fit) = &rung.fit
    {
        parameters(text, fit, &rung.held);
    }
    text.push_str("\n  It was simulated with c10 = 0.31 MPa and a friction of 14 N.\n\n");
    let document = pretty(&comparison)?;
    written.extend(report(&out.join("report"), &comparison, &rows, &document)?);
    Ok(comparison)
}

/// The same braid as a cylinder, with clamped ends, and with its bladder.
fn models(textbook: &Muscle, c10_pa: f64) -> Result<[(&'static str, Muscle); 3], MuscleError> {
    let clamped = textbook.clone().with_ends(Ends::Clamped);
    Ok([
        ("textbook cylinder", textbook.clone().with_ends(Ends::Cylinder)),
        ("exact clamped ends", clamped.clone()),
        ("exact ends and rubber bladder", clamped.with(Parameter::C10, c10_pa)?),
    ])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schema::holds;
    use bulge_table::Table;

    /// Muscles of the tour and a shipped table; the diagnoses are given as numbers, since they take long.
    #[test]
    fn the_document_holds_what_its_schema_names() {
        let folder = tempfile::tempdir().unwrap();
        let (mut text, mut files) = (String::new(), Vec::new());
        let (pleated, difference) = pleated(folder.path(), &mut text, &mut files).unwrap();
        let braid = braid(folder.path(), &mut text, &mut files).unwrap();
        let table = Table::from_bytes(include_bytes!("../../table/examples/data/ppam.table")).unwrap();
        let found = || Found {
            verdict: Verdict::Missing,
            missing: vec!["lobes".to_owned()],
            rmse_n: 11.0,
            noise_floor_n: 11.2,
        };
        let document = Document {
            schema: "bulge.demo/1",
            pleated,
            shooting_minus_closed_form: difference,
            braid,
            ladder: vec![("Constant friction".to_owned(), 2.1)],
            hidden: [found(), found()],
            own_form: [found(), found()],
            table: TableDescription::of(&table).unwrap(),
            files,
        };
        let (kind, fields) = holds(&serde_json::to_value(&document).unwrap());
        assert!(kind == "demo" && fields > 60, "{fields}");
    }
}
