//! Sweep files: every key, every default, and what is answered to every mistake.

use super::*;
use crate::plan::{Spacing, TableForm};
use bulge_muscles::Parameter;

const SHORT: &str = "muscle = \"ppam-2-r16\"\n[axes.contraction]\nrange = \"1 %..20 %\"\npoints = 20\n[axes.pressure]\nlist = \"1,2 bar\"\n";
const BRAID: &str = "muscle = \"dmsp-20-250\"\n[axes.contraction]\nrange = \"0 %..limit\"\npoints = 20\n";
const TABLE: &str =
    "muscle = \"ppam-2-r16\"\n[axes.contraction]\nrange = \"0 %..20 %\"\n[table]\ntolerance = 1e-5\n";

const STRETCHY: &str = "name = \"x\"\nkind = \"pleated\"\nlength = \"110 mm\"\nradius = \"16 mm\"\nfibres = 40\nfibre.stiffness = \"10 kN\"\n";

fn from(text: &str) -> Result<Plan, FileError> {
    Plan::from_toml(text, "s.toml", None)
}

#[track_caller]
fn read(text: &str) -> Plan {
    from(text).unwrap_or_else(|error| panic!("{error}"))
}

#[track_caller]
fn refused(text: &str, parts: &[&str]) {
    let message = from(text).map(|plan| plan.axes).unwrap_err().to_string();
    for part in parts {
        assert!(message.contains(part), "{message:?} does not say {part:?}");
    }
}

/// A folder of its own that is deleted afterwards.
fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

#[test]
fn every_key_is_read() {
    let found = read(SWEEP_EXAMPLE);
    assert_eq!((found.name.as_str(), found.muscle.name()), ("pleated family", "ppam-2-r16"));
    assert_eq!((found.pressure_pa, found.contraction, found.approach), (1e5, None, Approach::Auto));
    assert_eq!((found.design, found.chunk, found.points()), (Some(Design::Grid), 65_536, 5050));
    assert_eq!(found.outputs, [Output::ForceF, Output::VolumeV]);
    let [contraction, slenderness] = found.axes.as_slice() else { panic!("two axes") };
    assert_eq!((contraction.name.as_str(), contraction.unit.as_str()), ("contraction", "1"));
    let line = |from, to, points, spacing| Range::Between { from, to, points: Some(points), spacing };
    assert_eq!(contraction.range, line(0.005, crate::plan::End::Limit, 101, Spacing::Linear));
    assert_eq!(slenderness.quantity, Quantity::Slenderness);
    assert_eq!(slenderness.range, line(2.0, crate::plan::End::Value(100.0), 50, Spacing::Log));
    let table = found.table.unwrap();
    assert_eq!((table.tolerance, table.gradient, table.max_bytes), (1e-6, 1e-4, 65_536));
    assert_eq!((table.form, table.checks, table.outputs.len()), (TableForm::Fastest, 131_072, 2));
    // Every key of the lists is in the example, in a comment at least.
    for (key, _) in TOP.iter().chain(axes::AXIS).chain(wish::TABLE) {
        assert!(
            SWEEP_EXAMPLE.contains(&format!("{key} =")) || SWEEP_EXAMPLE.contains(&format!("[{key}")),
            "{key}"
        );
    }
    // What is in comments holds as well, where it fits together.
    let fixed = SWEEP_EXAMPLE.replace("# contraction", "contraction").replace("# chunk", "chunk");
    let fixed = fixed
        .replace("[axes.contraction]\nrange = \"0.5 %..limit\"", "[axes.length]\nrange = \"80..120 mm\"");
    assert_eq!(read(&fixed).contraction, Some(0.2));
    let fibres = SWEEP_EXAMPLE.replace("# [axes.f", "[axes.f").replace("# list", "list");
    assert_eq!(read(fibres.split("[table]").next().unwrap()).points(), 15_150);
    let random = SWEEP_EXAMPLE.replace("\"grid\"", "\"random\"").replace("# points = ", "points = ");
    let random = random.replace("# seed = 1", "seed = 7").replace("\npoints = 50\n", "\n");
    let random = random.replace("\npoints = 101 ", "\n");
    assert_eq!(read(&random).design, Some(Design::Random { points: 10_000, seed: 7 }));
}

#[test]
fn what_is_left_out_has_a_default() {
    let short = read(SHORT);
    assert_eq!((short.name.as_str(), short.points()), ("ppam-2-r16", 40));
    assert_eq!(short.axes[1].range, Range::List(vec![1e5, 2e5]));
    assert_eq!((short.design, short.table, short.outputs.len()), (Some(Design::Grid), None, 2));
    let table = read(TABLE);
    let wish = table.table.unwrap();
    assert_eq!(
        (table.design, wish.outputs, wish.gradient),
        (None, vec![Output::ForceF, Output::VolumeV], 1e-4)
    );
    // A meridian to integrate takes longer.
    assert_eq!((read(BRAID).chunk, short.chunk), (2048, 65_536));
    assert_eq!(read(&format!("method = \"shooting\"\n{SHORT}")).chunk, 2048);
    assert_eq!(read(&format!("chunk = 7\n{BRAID}")).chunk, 7);
    let helix = "[axes.misalignment]\nlist = [\"0 deg\", \"5 deg\"]";
    assert_eq!(read(&format!("{SHORT}{helix}")).chunk, 2048);
    let sobol = TABLE.replace("0 %", "1 %");
    let scattered = |design: &str| read(&format!("design = \"{design}\"\npoints = 9\n{sobol}")).design;
    assert_eq!(scattered("sobol"), Some(Design::Sobol { points: 9 }));
    assert_eq!(scattered("latin-hypercube"), Some(Design::LatinHypercube { points: 9, seed: 1 }));
}

#[test]
fn axes_by_name_by_key_and_of_effects() {
    let muscle = "name = \"x\"\nkind = \"pleated\"\nlength = \"110 mm\"\nradius = \"16 mm\"\nfibres = 40\n[effects.coulomb-friction]\nforce = \"14 N\"\n";
    let folder = folder(&[("m.toml", muscle)]);
    let text = "muscle = \"m.toml\"\ncontraction = \"20 %\"\n[axes.\"fibre.stiffness\"]\nlist = \"5,10 kN\"\n[axes.\"coulomb-friction.force\"]\nrange = \"1..20 N\"\npoints = 3\n[axes.radius]\nrange = \"10..20 mm\"\npoints = 2";
    let plan = Plan::from_toml(text, "s.toml", Some(folder.path())).unwrap();
    let names: Vec<(&str, &str)> =
        plan.axes.iter().map(|axis| (axis.name.as_str(), axis.unit.as_str())).collect();
    assert_eq!(names, [("fibre_stiffness", "N"), ("coulomb-friction.force", "N"), ("radius", "m")]);
    assert_eq!(plan.axes[0].quantity, Quantity::Parameter(Parameter::FibreStiffness));
    let (effect, key) = ("coulomb-friction".to_owned(), "force".to_owned());
    assert_eq!(plan.axes[1].quantity, Quantity::Effect { effect, key });
    let of = |from: &str, to: &str| {
        let error = Plan::from_toml(&text.replace(from, to), "s.toml", Some(folder.path())).unwrap_err();
        error.to_string()
    };
    assert!(of("friction.force", "friction.forse").contains("did you mean `coulomb-friction.force`?"));
    assert!(of("1..20 N", "-5..20 N").contains("s.toml:6:9: `force` = -5 N is out of the bounds"));
    assert!(of("1..20 N", "1..20 mm").contains("range = \"14 N..28 N\""));
    let long = text.replace("\"coulomb", "\"effects.coulomb");
    let long = Plan::from_toml(&long, "s.toml", Some(folder.path())).unwrap();
    assert_eq!((&long.axes[1].name, &long.axes[1].quantity), (&plan.axes[1].name, &plan.axes[1].quantity));
    // The same by another name.
    assert!(of("coulomb-friction.force", "fibre.stiffness").contains("duplicate"));
    let twice = of(
        "[axes.\"coulomb-friction.force\"]\nrange = \"1..20 N\"",
        "[axes.fibre_stiffness]\nrange = \"1..20 N\"",
    );
    assert!(
        twice.contains("s.toml:5:7: the axes `fibre_stiffness` and `fibre_stiffness` vary the same"),
        "{twice}"
    );
}

#[test]
fn a_sweep_beside_its_muscle() {
    let folder = folder(&[
        ("s.toml", &SHORT.replace("ppam-2-r16", "m.toml")),
        ("t.toml", &SHORT.replace("ppam-2-r16", "none.toml")),
        ("u.toml", "muscle = \"u.toml\""),
        (
            "m.toml",
            "name = \"mine\"\nkind = \"pleated\"\nlength = \"110 mm\"\nradius = \"16 mm\"\nfibres = 40\n",
        ),
    ]);
    let at = |name: &str| Plan::read(folder.path().join(name));
    assert_eq!(at("s.toml").unwrap().name, "mine");
    let missing = at("t.toml").unwrap_err();
    assert!(missing.origin().ends_with("none.toml") && missing.what().contains("no such file"), "{missing}");
    assert!(at("u.toml").unwrap_err().what().contains("unknown key `muscle`"));
    assert!(at("v.toml").unwrap_err().what().contains("cannot be read"));
    assert!(Plan::read(folder.path()).unwrap_err().what().contains("a folder, not a sweep file"));
}

#[test]
fn braids_and_members_that_need_each_other() {
    // The number of fibres makes their stiffness possible, and a wall the bladder.
    let text = format!("{BRAID}[axes.fibres]\nlist = [60, 80]\n[axes.fibre_stiffness]\nlist = \"5 kN\"\n");
    assert_eq!(read(&text).points(), 40);
    let continuous = "muscle = \"ppam-1\"\ncontraction = \"10 %\"\n[axes.elastic_group]\nlist = [1e-4]\n";
    assert_eq!(read(&format!("{continuous}[axes.fibres]\nlist = [20]")).points(), 1);
    refused(continuous, &["s.toml:3:7", "n -> infinity", "axes.fibres.list"]);
    // Only straight fibres that don't stretch have an infinite force.
    let zero = SHORT.replace("\"1 %..20 %\"", "\"-1 %..20 %\"");
    refused(&zero, &["s.toml:3:9", "-0.01", "infinite at 0", "range = \"1 %..20 %\""]);
    read(&format!("{zero}[axes.elastic_group]\nlist = [1e-4]"));
    read(&format!("{zero}[axes.misalignment]\nlist = \"5,10 deg\""));
    refused(&format!("{zero}[axes.misalignment]\nlist = \"0,10 deg\""), &["infinite at 0"]);
    refused(&format!("{zero}[axes.misalignment]\nrange = \"-5..5 deg\"\npoints = 2"), &["infinite at 0"]);
    read(&format!("{zero}[axes.misalignment]\nrange = \"1..5 deg\"\npoints = 2"));
    read(&BRAID.replace("0 %", "-2 %"));
    let folder = folder(&[("m.toml", STRETCHY)]);
    let stretchy = zero.replace("ppam-2-r16", "m.toml");
    assert!(Plan::from_toml(&stretchy, "s.toml", Some(folder.path())).is_ok());
    // The braid and its fittings have a radius each.
    let radii = "[axes.radius]\nlist = [\"10 mm\"]\n[axes.fitting_radius]\nlist = [\"9 mm\"]\n";
    assert_eq!(read(&format!("{BRAID}{radii}")).axes.len(), 3);
    // Numbers of fibres from a range.
    let fibres = |points: &str| format!("{SHORT}[axes.fibres]\nrange = \"20..60\"\npoints = {points}");
    assert_eq!(read(&fibres("41")).points(), 1640);
    refused(&fibres("4"), &["s.toml:8:9", "33.33", "whole", "list = [20, 40, 60]"]);
}

#[test]
fn outputs_and_tables_of_what_the_muscle_has() {
    let with = |outputs: &str| format!("outputs = [{outputs}]\n{SHORT}");
    let plan = read(&with("\"force_by_pressure\", \"volume_by_pleat_depth\""));
    assert_eq!(plan.outputs[0].name(), "force_by_pressure");
    refused(&with("\"force_by_braid_angle\""), &["s.toml:1:12", "doesn't have", "`braid_angle`"]);
    refused(&with("\"force_by_fibre_stiffness\""), &["doesn't have", "`fibre.stiffness`"]);
    read(&format!("{}[axes.elastic_group]\nlist = [1e-4]", with("\"force_by_fibre_stiffness\"")));
    let many = "\"force\", \"volume\", \"force_f\", \"volume_v\", \"stiffness\", \"max_radius\", \"radius_ratio\", \"end_slope\"";
    assert_eq!(read(&format!("{TABLE}outputs = [{many}]")).table.unwrap().outputs.len(), 8);
    refused(
        &format!("{TABLE}outputs = [{many}, \"fibre_strain\"]"),
        &["s.toml:6:11", "9 outputs", "at most 8"],
    );
    refused(&format!("outputs = [{many}, \"fibre_strain\"]\n{TABLE}"), &["9 outputs"]);
}

fn line(old: &str, new: &str) -> String {
    assert!(SHORT.contains(old));
    SHORT.replace(old, new)
}

fn list(text: &str) -> String {
    line("\"1,2 bar\"", text)
}

fn top(text: &str) -> String {
    format!("{text}\n{SHORT}")
}

fn more(text: &str) -> String {
    format!("{SHORT}{text}")
}

fn scattered(text: &str) -> String {
    format!("{text}\n{}", TABLE.replace("0 %..", "1 %.."))
}

/// Mistaken files, each with parts of the answer: place, what, cure.
type Mistakes<'m> = &'m [(String, [&'m str; 3])];

#[track_caller]
fn all_refused(mistakes: Mistakes<'_>) {
    for (text, parts) in mistakes {
        refused(text, parts);
    }
}

#[test]
fn mistakes_in_the_file_as_a_whole() {
    all_refused(&[
        ("x = 40 s".to_owned(), ["s.toml:1:", "not TOML", "`pressure = \"1 bar\"`"]),
        (String::new(), ["s.toml:1:1", "needs `muscle`", "add such as `muscle = \"ppam-2-r16\"`"]),
        ("muscle = \"ppam-1\"".to_owned(), ["s.toml:1:1", "needs `axes`", "axes.contraction = "]),
        ("muscle = \"ppam-1\"\n[axes]".to_owned(), ["s.toml:1:1", "needs `axes`", "axes.contraction = "]),
        (top("desing = \"grid\""), ["s.toml:1:1", "unknown key `desing`", "did you mean `design`?"]),
        (
            line("ppam-2-r16", "ppam-2-r61"),
            ["s.toml:1:10", "neither a muscle file", "did you mean `ppam-2-r16`?"],
        ),
        (line("\"ppam-2-r16\"", "16"), ["s.toml:1:10", "`muscle` is a number", "text in quotes"]),
        (top("name = \" \""), ["s.toml:1:8", "`name` is empty", "leave it out"]),
    ]);
}

#[test]
fn mistakes_in_axes() {
    all_refused(&[
        (
            line("axes.pressure", "axes.presure"),
            ["s.toml:5:7", "unknown axis `presure`", "did you mean `pressure`?"],
        ),
        (
            line("axes.pressure", "axes.voltage"),
            [
                "s.toml:5:7",
                "unknown axis `voltage`",
                "known for this muscle: contraction, pressure, slenderness",
            ],
        ),
        (
            line("axes.pressure", "axes.fibre.stiffness"),
            ["s.toml:5:7", "unknown axis `fibre`", "in quotes: `[axes.\"fibre.stiffness\"]`"],
        ),
        (
            line("axes.pressure", "axes.wall"),
            ["s.toml:5:7", "a pleated muscle has no `wall`", "delete the axis"],
        ),
        (more("[axes]\npressure = 3"), ["s.toml:", "not TOML", "duplicate key"]),
        (
            "muscle = \"ppam-1\"\naxes.pressure = 3".to_owned(),
            ["s.toml:2:17", "`pressure` is a number", "must be a table"],
        ),
        (
            line("points = 20", "point = 20"),
            ["s.toml:4:1", "unknown key `point` in `[axes.contraction]`", "did you mean `points`?"],
        ),
        (
            line("range = \"1 %..20 %\"", ""),
            ["s.toml:2:7", "no values", "add such as `range = \"1 %..20 %\"`"],
        ),
        (line("list =", "range = \"1..2 bar\"\nlist ="), ["s.toml:7:8", "has both", "delete one"]),
        (line("1 %..20 %", "1 %"), ["s.toml:3:9", "no range", "range = \"1 %..20 %\""]),
        (line("\"1 %..20 %\"", "20"), ["s.toml:3:9", "a range in quotes", "range = \"2..100\""]),
        (line("1 %..20 %", "20 %..1 %"), ["s.toml:3:9", "must rise", "from 0.2 to 0.01"]),
        (line("1 %..20 %", "1 %..1 %"), ["s.toml:3:9", "must rise", "range = \"1 %..20 %\""]),
        (
            line("1 %..20 %", "1 %..100 %"),
            ["s.toml:3:9", "the contraction 1 is not possible", "range = \"1 %..20 %\""],
        ),
        (line("1 %..20 %", "0 %..20 %"), ["s.toml:3:9", "infinite at 0", "range = \"1 %..20 %\""]),
        (line("1 %..20 %", "1 mm..20 mm"), ["s.toml:3:9", "`1 mm` is a length (m)", "range = \"1 %..20 %\""]),
        (line("1 %..20 %", "-1 %..20 %\"\nspacing = \"log"), ["s.toml:4:11", "> 0", "spacing = \"linear\""]),
    ]);
}

#[test]
fn mistakes_in_points_and_lists() {
    all_refused(&[
        (
            more("[axes.length]\nrange = \"1e-300..1e300 m\"\nspacing = \"log\""),
            ["s.toml:9:11", "not possible", "linear"],
        ),
        (more("[axes.length]\nrange = \"-1e308..1e308 m\""), ["s.toml:8:9", "a finite length", "10 mm"]),
        (
            line("points = 20", "spacing = \"cubic\""),
            ["s.toml:4:11", "linear, log, chebyshev", "write `spacing ="],
        ),
        (line("points = 20", "points = 1"), ["s.toml:4:10", "1 points", "`list = [2]`"]),
        (line("points = 20", "points = 1_000_000_001"), ["s.toml:4:10", "2 to 1000000000", "points = 101"]),
        (line("points = 20", "points = 2.5"), ["s.toml:4:10", "a whole number", "points = 101"]),
        (
            line("points = 20", ""),
            ["s.toml:2:1", "`[axes.contraction]` needs `points`", "add such as `points = 101`"],
        ),
        (
            line("list = \"1,2 bar\"", "range = \"1 bar..limit\"\npoints = 2"),
            ["s.toml:6:9", "`limit` is the contraction", "1 bar..4 bar"],
        ),
        (list("\"2,1 bar\""), ["s.toml:6:8", "100000 comes after 200000", "sort"]),
        (list("[\"1 bar\", \"1 bar\"]"), ["s.toml:6:8", "100000 comes after 100000", "each once"]),
        (list("[]"), ["s.toml:6:8", "at least one value", "list = [\"1 bar\", \"4 bar\"]"]),
        (list("[\"1 bar\", 2]"), ["s.toml:6:18", "`2` is a pure number", "list = [\"1 bar\", \"4 bar\"]"]),
        (list("[inf]"), ["s.toml:6:9", "not a finite number", "1 bar"]),
        (list("[true]"), ["s.toml:6:9", "true or false", "a list of values"]),
        (list("true"), ["s.toml:6:8", "true or false", "a list of values"]),
        (list("\"0,1 bar\""), ["s.toml:6:8", "the pressure 0 is not possible", "> 0"]),
        (list("\"1,2 bar\"\nspacing = \"log\""), ["s.toml:7:1", "belongs to a `range`", "delete `spacing`"]),
    ]);
}

#[test]
fn mistakes_that_the_muscle_answers() {
    all_refused(&[
        (more("[axes.radius]\nlist = [\"-5 mm\"]"), ["s.toml:8:8", "`radius` is -0.005 m", "10 mm"]),
        (
            more("[axes.radius]\nlist = [\"5 mm\"]\n[axes.slenderness]\nlist = [5]"),
            ["s.toml:9:7", "`radius` and `slenderness`", "delete one"],
        ),
        (
            more("[axes.fitting_radius]\nlist = [\"5 mm\"]\n[axes.radius]\nlist = [\"5 mm\"]"),
            ["s.toml:9:7", "vary the same number", "delete one"],
        ),
        (
            more("[axes.fibre_stiffness]\nlist = [\"5 kN\"]\n[axes.elastic_group]\nlist = [5]"),
            ["s.toml:9:7", "`fibre_stiffness` and `elastic_group`", "delete one"],
        ),
        (more("[axes.elastic_group]\nlist = [0, 1e-3]"), ["s.toml:8:8", "the elastic group 0", "> 0"]),
        (
            more("[axes.slenderness]\nrange = \"0..5\"\npoints = 2"),
            ["s.toml:8:9", "the slenderness 0", "> 0"],
        ),
        (more("[axes.hoop_stiffness]\nlist = [\"5 N/mm\"]"), ["s.toml:8:8", "needed together", "N/mm"]),
        (more("[axes.fibres]\nlist = [20.5]"), ["s.toml:8:8", "20.5 is not a number of fibres", "list = "]),
        (
            more("[axes.fibres]\nlist = [20, 30.5, 40]"),
            ["s.toml:8:8", "30.5 is not a number of fibres", "list = [20, 40, 60]"],
        ),
        (more("[axes.fibres]\nlist = [2, 3]"), ["s.toml:8:8", "2 is not a number of fibres", "at least 3"]),
        (
            format!("{BRAID}[axes.elastic_group]\nlist = [1]"),
            ["s.toml:5:7", "belongs to pleated", "axes.fibre_stiffness"],
        ),
        (
            format!("{BRAID}[axes.fibre_stiffness]\nlist = [\"5 kN\"]"),
            ["s.toml:6:8", "does not say how many", "kN"],
        ),
    ]);
}

#[test]
fn mistakes_in_values_methods_and_outputs() {
    all_refused(&[
        (top("contraction = \"20 %\""), ["s.toml:1:1", "an axis varies it", "delete `contraction`"]),
        (top("pressure = \"2 bar\""), ["s.toml:1:1", "an axis varies it", "delete `pressure`"]),
        (
            BRAID.replace("axes.contraction", "axes.length").replace("0 %..limit", "1..2 m"),
            ["s.toml:2:2", "neither a value nor an axis", "contraction = \"20 %\""],
        ),
        (
            format!(
                "contraction = \"100 %\"\n{}",
                line("axes.contraction", "axes.length").replace("1 %..20 %", "1..2 m")
            ),
            ["s.toml:1:15", "between -1 and 1", "contraction = \"20 %\""],
        ),
        (
            format!(
                "contraction = 0\n{}",
                TABLE.replace("axes.contraction", "axes.length").replace("0 %..20 %", "1..2 m")
            ),
            ["s.toml:1:15", "infinite at 0", "contraction = \"20 %\""],
        ),
        (format!("pressure = \"0 bar\"\n{BRAID}"), ["s.toml:1:12", "the pressure 0 Pa", "1 bar"]),
        (
            top("method = \"shoting\""),
            ["s.toml:1:10", "auto, closed-form, shooting", "method = \"shooting\""],
        ),
        (
            format!("method = \"closed-form\"\n{BRAID}"),
            ["s.toml:1:10", "no closed form", "method = \"auto\""],
        ),
        (top("outputs = [\"forse\"]"), ["s.toml:1:12", "unknown output `forse`", "did you mean `force`?"]),
        (top("outputs = [\"xyzzy\"]"), ["s.toml:1:12", "unknown output `xyzzy`", "known are force_f"]),
        (top("outputs = [\"force\", \"force\"]"), ["s.toml:1:21", "named twice", "delete one"]),
        (top("outputs = []"), ["s.toml:1:11", "at least one output", "outputs = ["]),
        (top("outputs = \"force\""), ["s.toml:1:11", "a list of names", "outputs = ["]),
        (top("chunk = 0"), ["s.toml:1:9", "0 points", "chunk = 65536"]),
    ]);
}

#[test]
fn mistakes_in_designs() {
    all_refused(&[
        (top("points = 9"), ["s.toml:1:1", "`points` means nothing", "design = \"latin-hypercube\""]),
        (top("design = \"grid\"\nseed = 9"), ["s.toml:2:1", "`seed` means nothing", "delete `seed`"]),
        (
            scattered("design = \"sobol\"\nseed = 9\npoints = 9"),
            ["s.toml:2:1", "`seed` means nothing", "delete `seed`"],
        ),
        (scattered("design = \"sobol\""), ["s.toml:1:1", "needs `points`", "points = 10000"]),
        (scattered("design = \"random\"\npoints = 0"), ["s.toml:2:10", "0 points", "points = 10000"]),
        (top("design = \"random\"\npoints = 9"), ["s.toml:6:1", "all share one number", "design = \"grid\""]),
        (
            top("design = \"random\"\npoints = 9").replace("points = 20", ""),
            ["s.toml:8:8", "this axis is a list", "write a `range`"],
        ),
        (top("design = \"radnom\""), ["s.toml:1:10", "one of: grid, random", "design = \"random\""]),
        (
            line(
                "points = 20",
                "points = 1000000000\n[axes.length]\nrange = \"1..2 m\"\npoints = 1000000000",
            ),
            ["s.toml:2:", "more than 281474976710656 points", "fewer `points`"],
        ),
        (TABLE.split("[table]").next().unwrap().to_owned(), ["s.toml:2:", "nothing to do", "`[table]`"]),
        (TABLE.replace("\"0 %", "\"-1 %"), ["s.toml:3:9", "infinite at 0", "1 %..20 %"]),
    ]);
}

#[test]
fn mistakes_in_tables() {
    all_refused(&[
        (format!("design = \"grid\"\n{TABLE}"), ["s.toml:3:1", "needs `points`", "points = 101"]),
        (more("[table]"), ["s.toml:6:8", "this axis is a list", "write a `range`"]),
        (
            TABLE.replace("[table]", "[axes.fibres]\nrange = \"20..40\"\n[table]"),
            ["s.toml:5:9", "only a grid", "list = [20, 40, 60]"],
        ),
        (
            TABLE
                .replace("[table]", "points = 2\n[axes.fibres]\nrange = \"20..40\"\npoints = 3\n[table]")
                .replace("0 %..", "1 %.."),
            ["s.toml:5:7", "nothing between two", "delete `[table]`"],
        ),
        (TABLE.replace("1e-5", "1e-11"), ["s.toml:5:13", "between 1e-10 and 0.1", "tolerance = 1e-6"]),
        (TABLE.replace("1e-5", "0.2"), ["s.toml:5:13", "`tolerance` is 0.2", "tolerance = 1e-6"]),
        (
            TABLE.replace("tolerance = 1e-5", "gradient = 2"),
            ["s.toml:5:12", "between 1e-8 and 1", "gradient = 1e-4"],
        ),
        (
            TABLE.replace("tolerance = 1e-5", "max_size = 1023"),
            ["s.toml:5:12", "1023 bytes", "max_size = \"64 KiB\""],
        ),
        (
            TABLE.replace("tolerance = 1e-5", "max_size = \"65 MiB\""),
            ["s.toml:5:12", "68157440 bytes", "1 KiB to 64 MiB"],
        ),
        (
            TABLE.replace("tolerance = 1e-5", "max_size = \"64 K\""),
            ["s.toml:5:12", "B, kB, KiB", "max_size = \"64 KiB\""],
        ),
        (
            TABLE.replace("tolerance = 1e-5", "checks = 99999"),
            ["s.toml:5:10", "`checks` is 99999", "checks = 131072"],
        ),
        (
            TABLE.replace("tolerance = 1e-5", "form = \"fast\""),
            ["s.toml:5:8", "splines, chebyshev", "write `form = \"fastest\"`"],
        ),
        (
            TABLE.replace("tolerance", "tolerence"),
            ["s.toml:5:1", "in `[table]`", "did you mean `tolerance`?"],
        ),
    ]);
}

#[test]
fn axes_are_known_and_not_too_many() {
    let unknown = format!("{BRAID}[axes.voltage]\nlist = [1]");
    refused(&unknown, &["s.toml:5:7", "fitting_radius, braid_angle, fibres", "gas_wall"]);
    let names = ["length", "radius", "pressure", "pleat_depth"];
    let ranges = ["1..2 m", "10..20 mm", "1..2 bar", "1..2 mm"];
    let axes: Vec<String> = names
        .iter()
        .zip(ranges)
        .map(|(name, range)| format!("[axes.{name}]\nrange = \"{range}\"\n"))
        .collect();
    let five = TABLE.replace("[table]", &format!("{}[table]", axes.concat()));
    refused(&five, &["s.toml:12:", "5 axes", "at most 4"]);
    assert_eq!(read(&five.replace("[axes.pleat_depth]\nrange = \"1..2 mm\"\n", "")).axes.len(), 4);
    // 65536^4 = 2^64 points would wrap to none.
    let grid = axes.concat().replace("\"\n", "\"\npoints = 65536\n");
    let grid = format!("muscle = \"ppam-2-r16\"\ncontraction = 0.1\n{grid}");
    refused(&grid, &["more than 281474976710656 points", "fewer"]);
    let many: Vec<String> = (0..17).map(|i| format!("[axes.a{i}]\nlist = [1]\n")).collect();
    refused(&format!("muscle = \"ppam-1\"\n{}", many.concat()), &["s.toml:34:7", "17 axes", "at most 16"]);
}

#[test]
fn a_cylinder_has_nothing_to_shoot() {
    let text = "name = \"x\"\nkind = \"braided\"\nlength = \"250 mm\"\nradius = \"10 mm\"\nbraid_angle = \"25 deg\"\nends = \"cylinder\"\n";
    let folder = folder(&[("m.toml", text)]);
    let sweep = BRAID.replace("dmsp-20-250", "m.toml");
    let at = |text: &str| Plan::from_toml(text, "s.toml", Some(folder.path()));
    assert_eq!(at(&sweep).unwrap().chunk, 65_536);
    assert!(at(&format!("method = \"closed-form\"\n{sweep}")).is_ok());
    assert!(at(&format!("method = \"shooting\"\n{sweep}")).unwrap_err().what().contains("no meridian"));
}
