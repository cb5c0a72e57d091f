//! Sweep files: every key, every default, and the message for every mistake.

mod mistakes;

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

/// A temporary folder, deleted afterwards.
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
    // The lines in comments are valid as well, as far as they are compatible.
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
    // Points that need the integration of a meridian take longer, so chunks are smaller.
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
    // The same axis under another name.
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
    assert!(at("v.toml").unwrap_err().what().contains("there is no such file"));
    assert!(Plan::read(folder.path()).unwrap_err().what().contains("a directory, not a sweep file"));
}

#[test]
fn braids_and_members_that_need_each_other() {
    // A number of fibres is needed for their stiffness, and a wall for the bladder.
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
    // The braid and its fittings each have a radius.
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
