//! The ends of a muscle: signs of contraction and force, loads that turn the membrane inside out, limit
//! points that are detected before they are reported, and the last equilibrium before a state that wasn't
//! reached.

#![expect(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]
#![expect(clippy::float_cmp, reason = "what is prescribed, and zero, come back to the bit")]

use bulge_membrane::MembraneError;
use bulge_membrane::case::{Case, CaseError, Row};
use bulge_membrane::mesher::{Grading, revolved};

const RUBBER: &str = "
[[material]]
name = \"rubber\"
law = \"neo-hooke\"
thickness = \"1 mm\"
shear = \"0.4 MPa\"

[[part]]
group = \"wall\"
kind = \"sheet\"
material = \"rubber\"
";
const BAG: &str = "
[mesher]
kind = \"square\"
side = \"848.53 mm\"
cells = [8, 8]

[[material]]
name = \"foil\"
law = \"st-venant\"
thickness = \"0.6 mm\"
young = \"588 MPa\"
poisson = 0.4

[[part]]
group = \"cloth\"
kind = \"membrane\"
material = \"foil\"
";
const TUBE: &str = "
[mesher]
kind = \"tube\"
radius = \"10 mm\"
length = \"60 mm\"
cells = [30]
order = 2
grading = 3.0
";

fn rows(text: &str, folder: Option<&std::path::Path>) -> (Vec<Row>, Option<CaseError>, Option<Row>) {
    let case = Case::from_toml(text, "case.toml", folder).unwrap();
    let mut run = case.start().unwrap();
    let mut rows = Vec::new();
    while let Some(next) = run.advance(|_, _| ()) {
        match next {
            Ok((row, _, _)) => rows.push(row),
            Err(error) => return (rows, Some(error), run.rescued().map(|(row, _, _)| row)),
        }
    }
    (rows, None, None)
}

fn source(error: Option<CaseError>) -> MembraneError {
    match error {
        Some(CaseError::State { source, .. }) => source,
        other => panic!("{other:?}"),
    }
}

/// The muscle is the same whichever end is named first, and whichever end moves.
#[test]
fn the_order_of_the_supports_is_no_matter() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("tube.msh");
    let mesh = revolved(|t| [10e-3, 60e-3 * t], 40, true, Grading::Ends(3.0));
    std::fs::write(&file, mesh.to_msh()).unwrap();
    let bottom = "[[support]]\ngroup = \"first\"\nkind = \"fitting\"\nfitting = \"bottom\"\n";
    let top = "[[support]]\ngroup = \"last\"\nkind = \"fitting\"\nfitting = \"top\"\n";
    let head = "mesh = \"tube.msh\"\n[scale]\nunit = \"m\"\nlength = \"60 mm\"\n";
    let steps = "[[step]]\npressure = \"10 kPa\"\n[[step]]\ncontraction = \"4 %\"\n";
    let run = |supports: &[&str], steps: &str| {
        let text = format!("{head}{RUBBER}{}{steps}", supports.concat());
        let (rows, error, _) = rows(&text, Some(folder.path()));
        assert!(error.is_none(), "{error:?}");
        rows
    };
    let (up, down) = (run(&[bottom, top], steps), run(&[top, bottom], steps));
    for (a, b) in up.iter().zip(&down) {
        assert!((a.force.unwrap() / b.force.unwrap() - 1.0).abs() < 1e-9, "{a:?} {b:?}");
        assert!((a.contraction.unwrap() - b.contraction.unwrap()).abs() < 1e-12);
        assert!((a.volume / b.volume - 1.0).abs() < 1e-9);
    }
    assert!((up[1].contraction.unwrap() - 0.04).abs() < 1e-12);
    // Pressure pushes the ends apart, more strongly the more it is contracted.
    assert!(up[0].force.unwrap() < 0.0 && up[1].force.unwrap() < up[0].force.unwrap());
    // Raising the lower end is the same contraction, also if the other one has been moved.
    let moved = run(
        &[bottom, top],
        "[[step]]\npressure = \"10 kPa\"\nplaces = { bottom = \"3 mm\" }\n[[step]]\ncontraction = \"4 %\"\n",
    );
    assert!((moved[0].contraction.unwrap() - 0.05).abs() < 1e-12);
    assert!((moved[1].contraction.unwrap() - 0.04).abs() < 1e-12);
    assert!((moved[1].force.unwrap() / up[1].force.unwrap() - 1.0).abs() < 1e-6);
    // A single fitting below a plane that doesn't move.
    let plane = "[[support]]\ngroup = \"last\"\nkind = \"plane\"\nnormal = [0, 0, 1]\n";
    let half = revolved(|t| [10e-3, 30e-3 * t], 20, true, Grading::Even);
    std::fs::write(&file, half.to_msh()).unwrap();
    let head = head.replace("60 mm\"\n", "60 mm\"\nalong = 2\n");
    let text = format!("{head}{RUBBER}{bottom}{plane}{steps}");
    let (half, error, _) = rows(&text, Some(folder.path()));
    assert!(error.is_none(), "{error:?}");
    assert!((half[1].contraction.unwrap() - 0.04).abs() < 1e-12);
    assert!((half[1].force.unwrap() / up[1].force.unwrap() - 1.0).abs() < 5e-3, "{half:?} {up:?}");
}

#[test]
fn a_contraction_and_a_force_contradict_each_other() {
    let support =
        "[[support]]\ngroup = \"last\"\nkind = \"fitting\"\nfitting = \"top\"\nmotion = \"loaded\"\n";
    let text = format!("{TUBE}{RUBBER}{support}[[step]]\npressure = \"10 kPa\"\ncontraction = \"10 %\"\n");
    let error = Case::from_toml(&text, "case.toml", None).unwrap_err().to_string();
    assert!(error.contains("can't be prescribed where the force") && error.contains("`forces`"), "{error}");
}

#[test]
fn ends_do_not_pass_each_other() {
    for (place, distance) in [("-61 mm", "1.000000 mm"), ("-200 mm", "140.000000 mm")] {
        let text =
            format!("{TUBE}{RUBBER}[[step]]\npressure = \"10 kPa\"\nplaces = {{ top = \"{place}\" }}\n");
        let error = Case::from_toml(&text, "case.toml", None).unwrap_err().to_string();
        assert!(error.contains(distance), "{error}");
    }
    // A force that no tube can bear doesn't turn it inside out.
    let support =
        "[[support]]\ngroup = \"last\"\nkind = \"fitting\"\nfitting = \"top\"\nmotion = \"loaded\"\n";
    for force in ["-5 N", "-500 N"] {
        let text = format!(
            "{TUBE}{RUBBER}{support}[[step]]\npressure = \"10 kPa\"\nforces = {{ top = \"{force}\" }}\n"
        );
        let (rows, error, _) = rows(&text, None);
        assert!(rows.is_empty(), "{rows:?}");
        assert!(error.is_some());
    }
}

/// The largest pressure of the clamped tube, to the digits that the step search finds; the state there is
/// kept.
#[test]
fn a_limit_point_is_seen_before_it_is_claimed() {
    let (found, error, rescued) = rows(&format!("{TUBE}{RUBBER}[[step]]\npressure = \"50 kPa\"\n"), None);
    assert!(found.is_empty());
    match source(error) {
        MembraneError::LimitPoint { pressure, last, .. } => {
            assert!(pressure == 5e4 && (last / 34342.062 - 1.0).abs() < 1e-3, "{last}");
        }
        other => panic!("{other}"),
    }
    let rescued = rescued.unwrap();
    assert!((rescued.pressure / 34342.062 - 1.0).abs() < 1e-3 && rescued.state == 1, "{rescued:?}");
    // A bag of linear foil has no limit point, however far the next pressure is.
    let (found, error, _) =
        rows(&format!("{BAG}[[step]]\npressure = \"5 kPa\"\n[[step]]\npressure = \"1e6 bar\"\n"), None);
    assert!(error.is_none() && found[1].pressure == 1e11, "{error:?}");
}

#[test]
fn a_volume_from_a_flat_start() {
    let volume = |text: &str| {
        let (found, error, _) = rows(&format!("{BAG}[[step]]\n{text}\n"), None);
        assert!(error.is_none(), "{error:?}");
        found[0].clone()
    };
    let by_pressure = volume("pressure = \"5 kPa\"");
    let by_volume = volume(&format!("volume = \"{} m^3\"", by_pressure.volume));
    assert!((by_volume.pressure / 5e3 - 1.0).abs() < 1e-6, "{by_volume:?}");
}

#[test]
fn gas_needs_a_volume() {
    let (found, error, _) =
        rows(&format!("{BAG}[[step]]\npressure = \"0 bar\"\n[[step]]\ngas = \"isothermal\"\n"), None);
    assert_eq!(found.len(), 1);
    assert!(matches!(source(error), MembraneError::NoGas { .. }));
}

/// Fibres extended beyond their length.
#[test]
fn threads_without_stretch_end_where_they_are_straight() {
    let threads = "[[part]]\ngroup = \"wall\"\nkind = \"threads\"\nangle = \"25 deg\"\n";
    // Straight at 1/cos(25 degrees): 10.3 % longer.
    let text = format!("{TUBE}{RUBBER}{threads}[[step]]\npressure = \"1 bar\"\ncontraction = \"-12 %\"\n");
    let (found, error, _) = rows(&text, None);
    assert!(found.is_empty());
    let error = source(error);
    assert!(
        matches!(error, MembraneError::Overstretched { .. } | MembraneError::NotConverged { .. }),
        "{error}"
    );
}

/// Pulled cloth gets narrower without a fold.
#[test]
fn taut_cloth_has_no_folds() {
    let case = format!("{TUBE}{RUBBER}[[step]]\npressure = \"1 kPa\"\ncontraction = \"-30 %\"\n");
    let case = Case::from_toml(&case, "case.toml", None).unwrap();
    let mut run = case.start().unwrap();
    let (row, _, fields) = run.advance(|_, _| ()).unwrap().unwrap();
    assert!(row.taut == 1.0);
    let sheet = &fields.groups[0].sheets[0];
    assert!(sheet.iter().any(|field| field.stretch[1] < 0.99), "none is narrower: {row:?}");
    assert!(sheet.iter().all(|field| field.folded == 0.0));
}
