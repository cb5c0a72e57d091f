//! Muscle files: every mistake is answered with its place and its cure, every muscle survives writing and
//! reading.

#![expect(clippy::unwrap_used, clippy::panic, reason = "helpers of tests may fail like the tests")]

use bulge_muscles::{
    Angle, Area, Braided, Construction, Dimension, Ends, Fibre, FibreCount, FileError, Force, Instrument,
    Instruments, Learnt, LearntValue, Length, Muscle, PRESETS, Parameter, Pleated, Ratio, Specimen,
    from_toml, read, to_toml, units,
};

const PLEATED: &str =
    "name = \"p\"\nkind = \"pleated\"\nlength = \"110 mm\"\nradius = \"16 mm\"\nfibres = 40\n";
const BRAIDED: &str =
    "name = \"b\"\nkind = \"braided\"\nlength = \"250 mm\"\nradius = \"10 mm\"\nbraid_angle = \"25 deg\"\n";

const FULL: &str = r#"# everything at once
name = "full µ braid"
kind = "braided"
length = "250 mm +- 0.2 mm"
radius = "10 mm ± 1 %"
fibres = 64
braid_angle = "25 °"
ends = "cylinder"
fibre = { stiffness = "12 kN", section = "0.3 mm²" }
wall = "2 mm"

[effects.bladder-elasticity]
c10 = "0.2 MPa"
c01 = "50 kPa +- 5 kPa"

[effects.limited-unfolding]
hoop_stiffness = "81 kN/m"
unfolded_radius = "52.6 mm"

[effects.end-radius]
radius = "9 mm +- 0.1 mm"

[effects.coulomb-friction]
force = "14 N +- 2 N"
share = 0.25

[instruments]
force = { noise = "4 N", zero = "1 N", gain = "0.1 %" }
pressure = { noise = "30 Pa", zero = "200 Pa", gain = 0.001 }
length = { noise = "5 um", zero = "0.05 mm" }
"#;

fn complaint(text: &str) -> FileError {
    match from_toml(text, "m.toml") {
        Ok(muscle) => panic!("{text}\nwas accepted as {muscle:?}"),
        Err(error) => error,
    }
}

/// The text must be refused at `line:column`, and the message must say all `parts`.
#[track_caller]
fn refused(text: &str, place: (usize, usize), parts: &[&str]) {
    let error = complaint(text);
    let message = error.to_string();
    assert_eq!((error.line(), error.column()), (Some(place.0), Some(place.1)), "{message}");
    assert!(message.starts_with(&format!("m.toml:{}:{}: ", place.0, place.1)), "{message}");
    // The line itself, with a caret under the column.
    let shown = message.lines().find(|line| line.starts_with(&format!("{} | ", place.0)));
    let shown_text = shown.unwrap_or_else(|| panic!("no line shown: {message}"));
    assert!(shown_text.ends_with(text.lines().nth(place.0 - 1).unwrap_or("")), "{message}");
    let margin = place.0.to_string().len() + 3;
    let caret = message.lines().find_map(|line| line.strip_prefix(&format!("{:1$} | ", "", margin - 3)));
    assert_eq!(caret.and_then(|line| line.find('^')), Some(place.1 - 1), "{message}");
    assert!(!error.instead().is_empty(), "{message}");
    for part in parts {
        assert!(message.contains(part), "does not say {part:?}: {message}");
    }
}

/// One line of a valid file, exchanged.
fn with_line(text: &str, line: usize, new: &str) -> String {
    let lines = text.lines().enumerate().map(|(i, old)| if i + 1 == line { new } else { old });
    lines.collect::<Vec<_>>().join("\n")
}

#[test]
fn the_whole_contract_is_read() {
    let muscle = from_toml(FULL, "full").unwrap();
    assert_eq!(muscle.name(), "full µ braid");
    assert_eq!(
        (muscle.length(), muscle.radius(), muscle.end_radius()),
        (Length::mm(250.0), Length::mm(10.0), Length::mm(9.0))
    );
    assert_eq!((muscle.fibres(), muscle.wall()), (Some(64), Some(Length::mm(2.0))));
    let Construction::Braided(braid) = muscle.construction() else { panic!("braided") };
    assert_eq!((braid.ends(), braid.braid_angle()), (Ends::Cylinder, Angle::deg(25.0)));
    let fibre = muscle.fibre().unwrap();
    assert_eq!((fibre.stiffness(), fibre.section()), (Force::kn(12.0), Some(Area::mm2(0.3))));
    assert_eq!(muscle.bladder_wall(), Some(Length::mm(2.0)));
    for (parameter, value) in [
        (Parameter::C10, 2e5),
        (Parameter::C01, 5e4),
        (Parameter::HoopStiffness, 81e3),
        (Parameter::UnfoldedRadius, 0.0526),
    ] {
        assert_eq!(muscle.get(parameter), Some(value));
    }
    let instruments = muscle.instruments();
    assert_eq!(instruments.force, Instrument::new(4.0, 1.0, Ratio::percent(0.1)).ok());
    assert_eq!(instruments.pressure, Instrument::new(30.0, 200.0, Ratio::percent(0.1)).ok());
    assert_eq!(instruments.length, Instrument::new(5e-6, 5e-5, Ratio::one(0.0)).ok());
    let widths: Vec<Parameter> = muscle.widths().iter().map(|(parameter, _)| *parameter).collect();
    assert_eq!(widths, [Parameter::Length, Parameter::Radius, Parameter::FittingRadius, Parameter::C01]);
    assert_eq!(muscle.width(Parameter::Radius), Some(0.0001));
}

#[test]
fn pleated_effects_are_read() {
    let text = format!(
        "{PLEATED}[effects]\nend-radius = {{ radius = \"15 mm\" }}\npleat-depth.depth = \"4.5 mm\"\n\
         fibre-misalignment = {{ angle = \"-2 deg\" }}"
    );
    let muscle = from_toml(&text, "m").unwrap();
    assert_eq!(muscle.radius(), Length::mm(15.0));
    assert!(to_toml(&muscle).contains("\nradius = \"16 mm\"\nfibres"));
    let angle = muscle.get(Parameter::Misalignment).map(Angle::rad);
    assert_eq!((muscle.get(Parameter::PleatDepth), angle), (Some(0.0045), Some(Angle::deg(-2.0))));
    let lobes = format!("{PLEATED}[effects.lobes]\ncircumference = \"330 mm +- 2 mm\"");
    let muscle = from_toml(&lobes, "m").unwrap();
    assert_eq!(muscle.get(Parameter::ClothCircumference), Some(0.33));
    assert_eq!(muscle.width(Parameter::ClothCircumference), Some(0.002));
    let continuous = with_line(PLEATED, 5, "fibres = \"continuous\"");
    assert_eq!(from_toml(&continuous, "m").unwrap().fibres(), None);
    let windows = format!("\u{feff}{}", PLEATED.replace('\n', "\r\n"));
    assert_eq!(from_toml(&windows, "m"), from_toml(PLEATED, "m"));
}

/// Escapes could write into a name what no editor shows, and a terminal obeys.
#[test]
fn names_are_what_can_be_printed() {
    let named = |name: &str| with_line(PLEATED, 1, &format!("name = {name}"));
    refused(&named("\"a\\u001b[31m\""), (1, 8), &["control character U+001B", "delete it"]);
    refused(&named("\"a\\u009b\""), (1, 8), &["U+009B"]);
    refused(&named("\"a\\nb\""), (1, 8), &["`name` has a line break", "on one line"]);
    assert_eq!(complaint(&named("\"\"\"a\nb\"\"\"")).line(), Some(1));
    let long = complaint(&named(&format!("\"{}\"", "x".repeat(1001))));
    assert_eq!((long.column(), long.what()), (Some(8), "`name` is longer than 1000 bytes"));
    let key = |key: &str| format!("{PLEATED}\n[effects]\n{key} = 1\n");
    assert!(complaint(&key("\"a\\nb\"")).what().starts_with("the key `a b` has control characters"));
    assert!(complaint(&key(&"x".repeat(1001))).what().contains("too long for a name"));
    // What isn't from a file is kept as a file can state it.
    let own = |name: &str| from_toml(PLEATED, "m").unwrap().with_name(name).unwrap().name().to_owned();
    assert_eq!((own("a\nb\u{1b}"), own(&"x".repeat(2000))), ("a b ".to_owned(), "x".repeat(1000)));
    // Others write from right to left, and may.
    let other = from_toml(&named("\"\u{5e9}\u{5e8}\u{5d9}\u{5e8}\u{200f}\""), "m").unwrap();
    assert!(other.name().ends_with('\u{200f}'));
}

#[test]
fn the_inner_wall_is_read() {
    let text = format!("{BRAIDED}wall = \"2 mm\"\n[effects.wall-thickness]\n");
    let muscle = from_toml(&text, "m").unwrap();
    assert_eq!(muscle.get(Parameter::GasWall), Some(0.002));
    assert!(to_toml(&muscle).contains("[effects.wall-thickness]\n"));
    let own = from_toml(&format!("{text}thickness = \"1.5 mm +- 0.1 mm\""), "m").unwrap();
    assert_eq!((own.get(Parameter::GasWall), own.wall()), (Some(0.0015), Some(Length::mm(2.0))));
    assert_eq!(own.width(Parameter::GasWall), Some(0.0001));
    for muscle in [muscle, own] {
        assert_eq!(from_toml(&to_toml(&muscle), "copy").unwrap(), muscle);
    }
}

#[test]
fn values_that_are_no_quantities() {
    let length = |value: &str| with_line(PLEATED, 3, &format!("length = {value}"));
    refused(&length("110"), (3, 10), &["`110` has no unit", "length = \"110 mm\""]);
    refused(&length("110.5"), (3, 10), &["`110.5` has no unit"]);
    refused(&length("nan"), (3, 10), &["not finite", "length = \"110 mm\""]);
    refused(&length("\"110\""), (3, 10), &["`110` has no unit"]);
    refused(&length("\"110 mn\""), (3, 10), &["unknown unit `mn`", "did you mean `mm`?"]);
    refused(&length("\"110 MM\""), (3, 10), &["did you mean `mm`?"]);
    refused(&length("\"110 furlongs\""), (3, 10), &["unknown unit `furlongs`", "known: m, cm, mm"]);
    refused(&length("\"2 bar\""), (3, 10), &["is a pressure, here a length is needed"]);
    refused(&length("\"long\""), (3, 10), &["does not begin with a number"]);
    refused(&length("\"\""), (3, 10), &["no length is given"]);
    refused(&length("\"inf mm\""), (3, 10), &["not finite"]);
    refused(&length("\"1,1 m\""), (3, 10), &["\"1.1 m\""]);
    refused(&length("true"), (3, 10), &["`length` is true or false", "length = \"110 mm\""]);
    refused(&length("[1]"), (3, 10), &["is a list"]);
    refused(&length("{ mm = 110 }"), (3, 10), &["is a table"]);
    refused(&length("1979-05-27"), (3, 10), &["is a date"]);
    refused(&length("\"110 mm +- -1 mm\""), (3, 10), &["can't be negative"]);
}

#[test]
fn values_out_of_range() {
    refused(&with_line(PLEATED, 3, "length = \"-110 mm\""), (3, 10), &["-0.11 m", "length = \"110 mm\""]);
    refused(&with_line(PLEATED, 3, "length = \"0 mm\""), (3, 10), &["greater than 0"]);
    // The range, and the line as an example: another length is no cure of a sign.
    let hint = "write a value greater than 0, such as `length = \"110 mm\"`";
    refused(&with_line(PLEATED, 3, "length = \"-5 mm\""), (3, 10), &["-0.005 m", hint]);
    refused(
        &with_line(PLEATED, 4, "radius = \"-1 mm\""),
        (4, 10),
        &["`radius` is -0.001 m", "radius = \"16 mm\""],
    );
    refused(&with_line(PLEATED, 1, "name = \" \""), (1, 8), &["`name` is empty"]);
    refused(&with_line(PLEATED, 1, "name = 5"), (1, 8), &["`name` is a number, but must be text"]);
    for angle in ["0 deg", "90 deg", "-25 deg", "100 deg"] {
        let text = with_line(BRAIDED, 5, &format!("braid_angle = \"{angle}\""));
        refused(&text, (5, 15), &["between 0 deg and 90 deg", "braid_angle = \"25 deg\""]);
    }
    refused(&format!("{BRAIDED}wall = \"0 mm\""), (6, 8), &["`wall` is 0 m", "wall = \"2 mm\""]);
    refused(&format!("{PLEATED}fibre = {{ stiffness = \"0 N\" }}"), (6, 23), &["greater than 0", "12 kN"]);
    refused(
        &format!("{PLEATED}fibre = {{ stiffness = \"1 N\", section = \"-1 mm^2\" }}"),
        (6, 40),
        &["`fibre.section`", "section = \"0.3 mm^2\""],
    );
    let effect = |text: &str, effect: &str| format!("{text}\n[effects.{effect}");
    refused(
        &effect(PLEATED, "pleat-depth]\ndepth = \"-1 mm\""),
        (8, 9),
        &["not negative", "depth = \"4.5 mm\""],
    );
    refused(
        &effect(PLEATED, "fibre-misalignment]\nangle = \"90 deg\""),
        (8, 9),
        &["between -90 deg and 90 deg"],
    );
    refused(&effect(PLEATED, "end-radius]\nradius = \"0 mm\""), (8, 10), &["greater than 0"]);
    refused(
        &effect(PLEATED, "limited-unfolding]\nhoop_stiffness = \"0 N/m\"\nunfolded_radius = \"1 mm\""),
        (8, 18),
        &["greater than 0", "81 kN/m"],
    );
    let rubber =
        |body: &str| effect(&format!("{BRAIDED}wall = \"2 mm\""), &format!("bladder-elasticity]\n{body}"));
    refused(&rubber("c10 = \"-1 MPa\""), (8, 7), &["not negative", "c10 = \"0.2 MPa\""]);
    refused(&rubber("c10 = \"0 MPa\""), (8, 7), &["c10 = 0 Pa and c01 = 0 Pa", "c10 = \"0.2 MPa\""]);
    refused(&rubber("c10 = \"1 MPa\"\nc01 = \"-1 Pa\""), (9, 7), &["c01", "not negative"]);
    refused(&rubber("c10 = \"1 MPa\"\nwall = \"-7.1 mm\""), (9, 8), &["is -0.0071 m", "greater than 0"]);
    refused(&rubber("c10 = \"1 MPa\"\nwall = \"1 mm +- 1 %\""), (9, 8), &["mm +- 1 %"]);
    let instrument = |body: &str| format!("{PLEATED}[instruments]\n{body}");
    refused(&instrument("force = { noise = \"-4 N\" }"), (7, 19), &["greater than 0", "noise = \"4 N\""]);
    refused(&instrument("force = { gain = 0.0 }"), (7, 18), &["greater than 0", "leave it out"]);
    refused(&instrument("force = {}"), (7, 9), &["at least one of", "noise = \"4 N\""]);
    refused(&instrument("force = { noise = \"4 Pa\" }"), (7, 19), &["a pressure, here a force is needed"]);
    refused(&instrument("force = 4"), (7, 9), &["must be a table", "noise = \"4 N\""]);
}

#[test]
fn numbers_of_fibres() {
    let fibres = |value: &str| with_line(PLEATED, 5, &format!("fibres = {value}"));
    refused(&fibres("40.5"), (5, 10), &["`fibres` is 40.5", "whole number", "fibres = 40`"]);
    refused(&fibres("nan"), (5, 10), &["whole number", "fibres = 40`"]);
    refused(&fibres("\"forty\""), (5, 10), &["\"forty\"", "fibres = 40`"]);
    refused(&fibres("\"40\""), (5, 10), &["without quotes: `fibres = 40`"]);
    refused(&fibres("\"continous\""), (5, 10), &["`fibres = \"continuous\"`"]);
    refused(&fibres("2"), (5, 10), &["at least 3", "fibres = 40`"]);
    refused(&fibres("-40"), (5, 10), &["at least 3"]);
    refused(&fibres("5000000000"), (5, 10), &["5000000000"]);
    refused(&fibres("99999999999999999999999999999999999999999999"), (5, 10), &["fibres = 40`"]);
    refused(&fibres("true"), (5, 10), &["true or false"]);
    refused(&format!("{BRAIDED}fibres = \"continuous\""), (6, 10), &["whole number of at least 3"]);
    assert_eq!(from_toml(&fibres("0x28"), "m").unwrap().fibres(), Some(40));
    let uncounted = format!("{BRAIDED}fibre = {{ stiffness = \"12 kN\" }}");
    refused(&uncounted, (6, 9), &["how many the braid has", "`fibres = 60`"]);
}

#[test]
fn keys_that_are_missing_or_unknown() {
    for (text, missing, example) in [
        (PLEATED, "name", "name = \"my muscle\""),
        (PLEATED, "length", "length = \"110 mm\""),
        (PLEATED, "radius", "radius = \"16 mm\""),
        (PLEATED, "fibres", "fibres = 40"),
        (BRAIDED, "braid_angle", "braid_angle = \"25 deg\""),
        (BRAIDED, "radius", "radius = \"16 mm\""),
    ] {
        let kind = text.lines().nth(1).unwrap();
        let short: Vec<&str> = text.lines().filter(|line| !line.starts_with(missing)).collect();
        let line = short.iter().position(|line| *line == kind).unwrap() + 1;
        refused(
            &short.join("\n"),
            (line, 8),
            &[&format!("needs `{missing}`, which is missing"), kind, example],
        );
    }
    refused(
        &with_line(PLEATED, 2, ""),
        (1, 1),
        &["`kind` is missing", "kind = \"pleated\"", "kind = \"braided\""],
    );
    refused(
        &with_line(PLEATED, 2, "kind = \"pleeted\""),
        (2, 8),
        &["\"pleeted\"", "write `kind = \"pleated\"`"],
    );
    refused(&with_line(PLEATED, 2, "kind = \"McKibben\""), (2, 8), &["write `kind = \"braided\"`"]);
    refused(
        &with_line(PLEATED, 2, "kind = \"x\""),
        (2, 8),
        &["`kind = \"pleated\"` or `kind = \"braided\"`"],
    );
    refused(&with_line(PLEATED, 2, "kind = 1"), (2, 8), &["must be text"]);
    refused(
        &with_line(PLEATED, 3, "lenght = \"110 mm\""),
        (3, 1),
        &["unknown key `lenght`", "did you mean `length`?"],
    );
    refused(&with_line(PLEATED, 3, "l0 = \"110 mm\""), (3, 1), &["length = \"110 mm\""]);
    // The first of several mistakes is the one named.
    refused(&format!("{PLEATED}zeta = 1\nbeta = 2"), (6, 1), &["unknown key `zeta`"]);
    refused(&format!("{PLEATED}colour = 1"), (6, 1), &["unknown key `colour`", "known here: name"]);
    refused(&format!("{PLEATED}c10 = \"1 MPa\""), (6, 1), &["[effects.bladder-elasticity]"]);
    refused(
        &format!("{PLEATED}braid_angle = \"25 deg\""),
        (6, 1),
        &["belongs to a braided muscle", "kind = \"braided\""],
    );
    refused(&format!("{PLEATED}ends = \"clamped\""), (6, 1), &["delete `ends`"]);
    refused(&format!("{PLEATED}wall = \"1 mm\""), (6, 1), &["belongs to a braided muscle"]);
    refused(&format!("{BRAIDED}ends = \"clampd\""), (6, 8), &["write `ends = \"clamped\"`"]);
    refused(
        &format!("{BRAIDED}ends = \"round\""),
        (6, 8),
        &["`ends = \"clamped\"` or `ends = \"cylinder\"`"],
    );
    refused(&format!("{PLEATED}fibre = \"12 kN\""), (6, 9), &["`fibre = { stiffness = \"12 kN\" }`"]);
    refused(
        &format!("{PLEATED}fibre = {{ stifness = \"12 kN\" }}"),
        (6, 11),
        &["in `[fibre]`", "did you mean `stiffness`?"],
    );
    refused(&format!("{PLEATED}fibre = {{ section = \"1 mm^2\" }}"), (6, 9), &["needs `stiffness`", "12 kN"]);
    refused(
        &format!("{PLEATED}[instruments]\ntorque = {{}}"),
        (7, 1),
        &["in `[instruments]`", "force, pressure, length"],
    );
    refused(&format!("{PLEATED}[instruments.force]\nnoice = \"1 N\""), (7, 1), &["did you mean `noise`?"]);
}

#[test]
fn effects_that_are_wrong() {
    let effect = |text: &str, effect: &str| format!("{text}[effects.{effect}");
    refused(
        &effect(PLEATED, "bladder-elasticity]\nc10 = \"1 MPa\""),
        (6, 10),
        &["belongs to a braided muscle"],
    );
    refused(&effect(BRAIDED, "pleat-depth]\ndepth = \"1 mm\""), (6, 10), &["belongs to a pleated muscle"]);
    refused(
        &effect(BRAIDED, "fibre-misalignment]\nangle = \"1 deg\""),
        (6, 10),
        &["belongs to a pleated muscle"],
    );
    refused(
        &effect(BRAIDED, "bladder-elasticity]\nc10 = \"1 MPa\""),
        (6, 1),
        &["`wall` is not stated", "wall = \"2 mm\""],
    );
    refused(
        &effect(BRAIDED, "bladder-elasticity]\nwall = \"1 mm\""),
        (6, 1),
        &["needs `c10`", "c10 = \"0.2 MPa\""],
    );
    refused(&effect(BRAIDED, "wall-thickness]"), (6, 1), &["how thick the wall is", "wall = \"2 mm\""]);
    refused(
        &effect(BRAIDED, "wall-thickness]\nthickness = \"-1 mm\""),
        (7, 13),
        &["not negative", "thickness = \"2 mm\""],
    );
    refused(&effect(PLEATED, "wall-thickness]"), (6, 10), &["belongs to a braided muscle"]);
    refused(&effect(BRAIDED, "lobes]"), (6, 10), &["belongs to a pleated muscle"]);
    refused(&effect(PLEATED, "lobes]"), (6, 1), &["needs `circumference`", "circumference = \"330 mm\""]);
    let continuous = with_line(PLEATED, 5, "fibres = \"continuous\"");
    refused(
        &format!("{continuous}\n[effects.lobes]\ncircumference = \"330 mm\""),
        (6, 1),
        &["can be counted", "fibres = 40"],
    );
    refused(&effect(BRAIDED, "bladder-elasticity]\nc20 = \"1 MPa\""), (7, 1), &["did you mean `c10`?"]);
    refused(&effect(PLEATED, "end-radius]"), (6, 1), &["`[effects.end-radius]` needs `radius`"]);
    refused(
        &effect(PLEATED, "limited-unfolding]\nhoop_stiffness = \"1 N/m\""),
        (6, 1),
        &["needs `unfolded_radius`", "52.6 mm"],
    );
    refused(&format!("{PLEATED}effects = 1"), (6, 11), &["`effects` is a number, but must be a table"]);
    refused(
        &format!("{PLEATED}effects.end-radius = \"1 mm\""),
        (6, 22),
        &["must be a table", "radius = \"16 mm\""],
    );
    refused(&format!("{PLEATED}[[effects]]"), (6, 1), &["is a list"]);
}

/// Names are checked by the code that knows them all. A slip in the name of a shape effect is answered as
/// well.
#[test]
fn learnt_effects() {
    let text = format!(
        "{PLEATED}[effects.coulomb-friction]\nforce = \"14 N +- 2 N\" # both ways\n[effects.lobes]\ncircumference = \"330 mm\"\n\
         [effects.creep]\nrate = \"1e-3 1/decade\"\n  start = \"5 min\"\nshare = 0.25\n\n[effects.end-taper]\n"
    );
    let muscle = from_toml(&text, "m.toml").unwrap();
    let names: Vec<&str> = muscle.learnt().iter().map(Learnt::name).collect();
    assert_eq!(names, ["coulomb-friction", "creep", "end-taper"]);
    assert_eq!(muscle.get(Parameter::ClothCircumference), Some(0.33));
    let creep = &muscle.learnt()[1];
    assert_eq!((creep.line(), creep.column()), (Some(10), Some(10)));
    let keys: Vec<&str> = creep.values().iter().map(|value| value.key.as_str()).collect();
    assert_eq!(keys, ["rate", "start", "share"]);
    let start = creep.value("start").unwrap();
    assert_eq!((start.si, start.dimension, start.unit.as_str()), (300.0, Dimension::TIME, "min"));
    assert!(muscle.learnt()[2].values().is_empty());
    let error = creep.value_error("start", "this is too late", "write less");
    assert!(error.to_string().starts_with("m.toml:12:11: this is too late"), "{error}");
    assert_eq!(muscle.learnt_error(0, "w", "i").line(), Some(6));
    assert_eq!(muscle.learnt_error(9, "w", "i").line(), None);
    // Effects are equal wherever they stand, and whatever the file is called.
    let moved = from_toml(&text.replace("[effects.coulomb", "\n\n[effects.coulomb"), "n.toml").unwrap();
    assert_eq!(moved, muscle);
    assert_eq!(from_toml(&to_toml(&muscle), "copy").unwrap(), muscle);
    assert!(
        to_toml(&muscle)
            .contains("[effects.creep]\nrate = \"0.001 1/decade\"\nstart = \"5 min\"\nshare = 0.25\n")
    );
    assert_eq!(muscle.clone().without_learnt().learnt(), []);
    let other = Learnt::new("creep", vec![]).unwrap();
    let changed = muscle.clone().with_learnt(other);
    assert!(changed != muscle && changed.learnt().len() == 3 && changed.learnt()[1].values().is_empty());
    // Names.
    assert!(muscle.check_learnt(&["creep", "end-taper", "coulomb-friction"]).is_ok());
    let message = muscle.check_learnt(&["crepe", "end-taper", "coulomb-friction"]).unwrap_err().to_string();
    assert!(message.starts_with("m.toml:10:10: unknown effect `creep`"), "{message}");
    assert!(message.contains("did you mean `crepe`?"), "{message}");
    // A learnt muscle with an effect of the user's own, without the file of that effect.
    let own = from_toml(&format!("{PLEATED}[effects.hose]\nk = \"5 N\""), "m.toml").unwrap();
    let message = own.check_learnt(&["creep"]).unwrap_err().to_string();
    for part in
        ["unknown effect `hose`: it is not in the catalogue", "effect of your own", "`--effects FILE`"]
    {
        assert!(message.contains(part), "{message}");
    }
    assert!(own.check_learnt(&["creep", "hose"]).is_ok());
    for (name, near) in
        [("bladder-elasticty", "bladder-elasticity"), ("end-radios", "end-radius"), ("lobe", "lobes")]
    {
        let muscle = from_toml(&format!("{PLEATED}[effects.{name}]\nx = 1"), "m.toml").unwrap();
        let message = muscle.check_learnt(&["creep"]).unwrap_err().to_string();
        assert!(message.starts_with(&format!("m.toml:6:10: unknown effect `{name}`")), "{message}");
        assert!(message.contains(&format!("did you mean `{near}`?")), "{message}");
    }
}

#[test]
fn learnt_effects_that_are_wrong() {
    let effect = |body: &str| format!("{PLEATED}[effects.creep]\n{body}");
    refused(&effect("on = true"), (7, 6), &["`on` is true or false", "`on = \"4 N s\"`"]);
    refused(&effect("x = [1]"), (7, 5), &["`x` is a list", "a number with its unit"]);
    refused(&effect("x = { y = 1 }"), (7, 5), &["`x` is a table"]);
    refused(&effect("x.y = 1"), (7, 1), &["`x` is a table"]);
    refused(&effect("x = 1979-05-27"), (7, 5), &["`x` is a date"]);
    refused(&effect("x = 0x10"), (7, 5), &["`x` is not decimal"]);
    refused(&effect("x = nan"), (7, 5), &["finite", "`x = \"4 N s\"`"]);
    refused(&effect("x = \"4 furlongs\""), (7, 5), &["unknown unit"]);
    refused(&effect("x = \"14 N +- 2 mm\""), (7, 5), &["mm"]);
    refused(&effect("x = \"14 N +- -1 N\""), (7, 5), &["can't be negative"]);
    refused(&effect("\"two words\" = 1"), (7, 1), &["`two words`", "write a word"]);
    refused(&format!("{PLEATED}[effects.\"\"]"), (6, 10), &["write a word"]);
    refused(&format!("{PLEATED}[effects]\ncreep = 3"), (7, 9), &["`creep` is a number", "[effects.creep]"]);
    refused(&format!("{PLEATED}[effects]\ncreep = \"on\""), (7, 9), &["`creep` is text"]);
}

#[test]
fn specimens_have_numbers_of_their_own() {
    let text = format!(
        "{BRAIDED}wall = \"2 mm\"\n[effects.bladder-elasticity]\nc10 = \"0.2 MPa\"\n\n[specimens.short]\nlength = \"60 mm\"\n\
         [specimens.\"no. 3\"]\nbraid_angle = \"24 deg\"\nfibres = 64\neffects.bladder-elasticity.c10 = \"0.3 MPa\"\n\
         effects.end-radius.radius = \"9 mm\"\nwall = \"1.5 mm\"\n[specimens.same]\n"
    );
    let muscle = from_toml(&text, "m.toml").unwrap();
    let names: Vec<&str> = muscle.specimens().iter().map(Specimen::name).collect();
    assert_eq!(names, ["short", "no. 3", "same"]);
    let short = muscle.of_specimen("short").unwrap();
    assert_eq!(
        (short.length(), short.radius(), short.specimens().len()),
        (Length::mm(60.0), Length::mm(10.0), 0)
    );
    let third = muscle.of_specimen("no. 3").unwrap();
    assert_eq!(
        (third.end_radius(), third.fibres(), third.wall()),
        (Length::mm(9.0), Some(64), Some(Length::mm(1.5)))
    );
    assert_eq!(third.bladder_wall(), Some(Length::mm(1.5)));
    assert_eq!(third.get(Parameter::C10), Some(3e5));
    let base = muscle.clone().without_specimens();
    for name in ["same", "unknown"] {
        assert_eq!(muscle.of_specimen(name).unwrap(), base);
    }
    assert_eq!(from_toml(&to_toml(&muscle), "copy").unwrap(), muscle);
    // A number stated for all specimens applies to those that don't state it.
    let wide = muscle.with(Parameter::Radius, 0.012).unwrap();
    assert_eq!(wide.of_specimen("short").unwrap().radius(), Length::mm(12.0));
    let longer = muscle.with(Parameter::Length, 0.275).unwrap().with_specimens_following(&muscle);
    assert!((longer.of_specimen("short").unwrap().length().to_mm() - 66.0).abs() < 1e-9);
    assert!((longer.of_specimen("no. 3").unwrap().length().to_mm() - 275.0).abs() < 1e-9);
}

#[test]
fn specimens_that_are_wrong() {
    let of = |body: &str| format!("{BRAIDED}[specimens.short]\n{body}");
    refused(&of("lenght = \"60 mm\""), (7, 1), &["in `[specimens.short]`", "did you mean `length`?"]);
    refused(&of("kind = \"pleated\""), (7, 1), &["unknown key `kind`", "known here: length, radius"]);
    refused(&of("length = 60"), (7, 10), &["`60` has no unit", "length = \"60 mm\"", "[specimens.short]"]);
    refused(&of("length = \"-60 mm\""), (7, 10), &["greater than 0", "110 mm"]);
    refused(&of("length = \"60 mm +- 1 mm\""), (7, 10), &["no width of its own", "of all specimens"]);
    refused(&of("fibres = \"40\""), (7, 10), &["a whole number"]);
    refused(&of("fibres = 2"), (7, 10), &["at least 3"]);
    refused(&of("fibre.stiffness = \"1 kN\""), (7, 1), &["how many the braid has"]);
    refused(&of("effects.pleat-depth.depth = \"1 mm\""), (7, 29), &["belongs to a pleated muscle"]);
    refused(&of("effects.creep.rate = \"1 %\""), (7, 9), &["`creep` can't differ", "[effects.creep]"]);
    refused(&of("effects = 1"), (7, 11), &["must be a table"]);
    refused(&format!("{BRAIDED}[specimens]\nshort = 60"), (7, 9), &["must be a table", "[specimens.short]"]);
    refused(&format!("{BRAIDED}[specimens.'a\"b']\n"), (6, 12), &["without quotes"]);
    refused(&format!("{BRAIDED}specimens = 3"), (6, 13), &["must be a table"]);
}

#[test]
fn specimens_and_data_must_agree() {
    let muscle = from_toml(&format!("{BRAIDED}[specimens.short]\n[specimens.hose-2]\n"), "m.toml").unwrap();
    let check = |names: &[&str]| {
        let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
        let found = muscle.check_specimens(&names);
        found.map(|others| others.join(",")).map_err(|error| error.to_string())
    };
    assert_eq!(check(&["hose-2", "short"]).as_deref(), Ok(""));
    assert_eq!(check(&["hose-2", "hose-1", "short", "x"]).as_deref(), Ok("hose-1,x"));
    let message = check(&["hose-2", "shrot"]).unwrap_err();
    assert!(message.starts_with("m.toml:6:12: no row of the data is of the specimen `short`"), "{message}");
    assert!(message.contains("`[specimens.shrot]`"), "{message}");
    let message = check(&["1"]).unwrap_err();
    assert!(message.contains("the data have `1`"), "{message}");
    let message = check(&["short", "hose-2", "Shorrt"]).unwrap_err();
    assert!(message.contains("rows of `Shorrt` and of the specimen `short`"), "{message}");
    let plain = from_toml(BRAIDED, "m.toml").unwrap();
    assert_eq!(plain.check_specimens(&["any".to_owned()]), Ok(vec![]));
}

#[test]
fn text_that_is_not_toml() {
    refused(&with_line(PLEATED, 3, "length = 110 mm"), (3, 10), &["not TOML", "`length = \"110 mm\"`"]);
    refused(&with_line(PLEATED, 2, "kind = pleated # x"), (2, 8), &["`kind = \"pleated\"`"]);
    refused(&with_line(PLEATED, 3, "length \"110 mm\""), (3, 8), &["not TOML", "`key = value`"]);
    refused(&format!("{PLEATED}length = \"110 mm\"\n"), (6, 1), &["duplicate key", "delete one of the two"]);
    let error = complaint(&with_line(PLEATED, 3, "length = \"110 mm"));
    assert_eq!(error.line(), Some(3));
    for empty in ["", "\n\n", "# nothing\n"] {
        let message = complaint(empty).to_string();
        assert!(message.starts_with("m.toml:1:1: the file states nothing"), "{message}");
        assert!(
            message.contains("`name`, `kind`, `length` and `radius`") && message.lines().count() > 10,
            "{message}"
        );
    }
    // The example in that message is itself a muscle file.
    let example = complaint("").instead().lines().skip(1).collect::<Vec<_>>().join("\n");
    assert_eq!(from_toml(&example, "example").unwrap().fibres(), Some(40));
    let uncommented = example.replace("\n# [", "\n[").replace("\n# f", "\nf").replace("\n# p", "\np");
    assert!(from_toml(&uncommented, "example").unwrap().instruments().force.is_some());
    // Depth, size and width of a file are bounded.
    let deep = format!("{PLEATED}a = {}", "[".repeat(100_000));
    assert!(complaint(&deep).to_string().len() < 1000);
    assert!(complaint(&" ".repeat((1 << 20) + 1)).to_string().contains("larger than 1 MiB"));
    let wide = format!("{PLEATED}x = \"{}\"", "y".repeat(500_000));
    assert!(complaint(&wide).to_string().len() < 1000);
}

#[test]
fn files_that_cannot_be_read() {
    let directory = std::env::temp_dir().join(format!("bulge-muscles-{}", std::process::id()));
    std::fs::create_dir_all(&directory).unwrap();
    let file = |name: &str, bytes: &[u8]| {
        let path = directory.join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    };
    let muscle = file("muscle.toml", PLEATED.as_bytes());
    assert_eq!(read(&muscle), from_toml(PLEATED, ""));
    let message = |path: &std::path::Path| read(path).unwrap_err().to_string();
    let missing = message(&directory.join("musle.toml"));
    assert!(
        missing.contains("musle.toml: there is no such file") && missing.contains("did you mean"),
        "{missing}"
    );
    assert!(message(&directory.join("other/x.toml")).contains("check the path"));
    assert!(message(&directory).contains("directory") && message(&directory).contains("name a file in it"));
    let latin = message(&file("latin.toml", b"name = \"x\"\nlength = \"5 \xb5m\"\n"));
    assert!(
        latin.contains("latin.toml:2:13: byte 23 is not UTF-8 text") && latin.contains("UTF-8"),
        "{latin}"
    );
    let huge = message(&file("huge.toml", &vec![b'#'; (1 << 20) + 1]));
    assert!(huge.contains("larger than 1 MiB"), "{huge}");
    let empty = message(&file("empty.toml", b""));
    assert!(empty.contains("empty.toml:1:1") && empty.contains("kind = \"pleated\""), "{empty}");
    let wrong = read(file("wrong.toml", b"kind = \"pleated\"\nlength = 110\n")).unwrap_err();
    assert_eq!((wrong.line(), wrong.column()), (Some(2), Some(10)));
    std::fs::remove_dir_all(&directory).unwrap();
}

/// Numbers without structure, the same in every run.
struct Lcg(u64);

impl Lcg {
    fn next(&mut self, below: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        usize::try_from(self.0 >> 33).unwrap() % below
    }

    /// Between 0 and 1, both excluded, with all digits.
    #[expect(clippy::cast_precision_loss, reason = "a random number")]
    fn fraction(&mut self) -> f64 {
        (self.next(1 << 30) as f64 + 0.5) / f64::from(1 << 30)
    }
}

fn some_instrument(random: &mut Lcg) -> Option<Instrument> {
    let mut part = |scale: f64| if random.next(3) == 0 { 0.0 } else { random.fraction() * scale };
    Instrument::new(part(5.0), part(1e-3), Ratio::one(part(0.01))).ok()
}

fn some_value(random: &mut Lcg, i: usize) -> LearntValue {
    let units =
        ["", "%", "N", "kN", "N s/mm", "mm", "1/K", "Pa^0.5", "psi", "deg", "min", "permille", "lbf/in^2"];
    let unit = units[random.next(units.len())];
    let (factor, dimension) = units::unit(unit).unwrap();
    let sign = if random.next(2) == 0 { -1.0 } else { 1.0 };
    let size = 10.0_f64.powi(i32::try_from(random.next(40)).unwrap() - 20);
    // Any double, or one that people write.
    let si = if random.next(2) == 0 {
        sign * random.fraction() * size
    } else {
        f64::from(i32::try_from(i).unwrap()) * factor
    };
    let width = (random.next(2) == 0).then(|| random.fraction() * size);
    LearntValue { key: format!("k{i}"), si, dimension, unit: unit.to_owned(), width }
}

fn some_muscle(random: &mut Lcg) -> Muscle {
    let radius = Length::m(random.fraction() * 0.1);
    let is_pleated = random.next(2) == 0;
    let count = 3 + u32::try_from(random.next(200)).unwrap();
    let mut construction = if is_pleated {
        let fibres = if random.next(4) == 0 { FibreCount::Continuous } else { FibreCount::Discrete(count) };
        Construction::Pleated(Pleated::new(radius, fibres).unwrap())
    } else {
        let braid =
            Braided::new(radius, Angle::rad(random.fraction() * 1.5)).unwrap().with_fibres(count).unwrap();
        Construction::Braided(if random.next(2) == 0 { braid.with_ends(Ends::Cylinder) } else { braid })
    };
    if let (Construction::Braided(braid), 0) = (construction, random.next(2)) {
        construction = Construction::Braided(
            braid.with_wall(Length::m(bulge_muscles::Quantity::si(radius) * random.fraction())).unwrap(),
        );
    }
    let names =
        ["plain", "with \"quotes\" and \\", "two\nlines", "''' \"\"\" '", "µ \u{7f} \u{1b} \t", "= # ["];
    let mut muscle =
        Muscle::new(names[random.next(names.len())], Length::m(random.fraction()), construction).unwrap();
    if random.next(2) == 0 {
        let fibre = Fibre::new(Force::n(random.fraction() * 1e5)).unwrap();
        let fibre = if random.next(2) == 0 {
            fibre
        } else {
            fibre.with_section(Area::m2(random.fraction() * 1e-6)).unwrap()
        };
        muscle = muscle.with_fibre(fibre).unwrap();
    }
    if !is_pleated && random.next(2) == 0 {
        let c01 = if random.next(2) == 0 { 0.0 } else { random.fraction() * 1e5 };
        let c10 = random.fraction() * 1e6;
        muscle = match random.next(3) {
            // A bladder that is thicker or thinner than the wall can only be read.
            0 => {
                let text = to_toml(&muscle);
                let thickness = radius.to_m() * random.fraction();
                let rubber = format!("c10 = \"{c10} Pa\"\nc01 = \"{c01} Pa\"\nwall = \"{thickness} m\"");
                from_toml(&format!("{text}\n[effects.bladder-elasticity]\n{rubber}"), "m").unwrap()
            }
            _ => muscle.with_all(&[(Parameter::C10, c10), (Parameter::C01, c01)]).unwrap_or(muscle),
        };
    }
    if random.next(3) == 0 {
        let limit = [
            (Parameter::HoopStiffness, random.fraction() * 1e5),
            (Parameter::UnfoldedRadius, random.fraction()),
        ];
        muscle = muscle.with_all(&limit).unwrap();
    }
    let effects = [
        Parameter::FittingRadius,
        Parameter::PleatDepth,
        Parameter::Misalignment,
        Parameter::GasWall,
        Parameter::ClothCircumference,
    ];
    for parameter in effects {
        if random.next(2) == 0 {
            muscle = muscle.with(parameter, random.fraction() * 0.1).unwrap_or(muscle);
        }
    }
    if random.next(4) == 0 {
        muscle = muscle.clone().with_gas_wall(None).unwrap_or(muscle);
    }
    for parameter in Parameter::ALL {
        if random.next(3) == 0 {
            let width = if random.next(4) == 0 { 0.0 } else { random.fraction() * 1e-3 };
            muscle = muscle.clone().with_width(parameter, width).unwrap_or(muscle);
        }
    }
    for name in ["creep", "coulomb-friction", "x_9"] {
        if random.next(4) == 0 {
            let values = (0..random.next(4)).map(|i| some_value(random, i)).collect();
            muscle = muscle.with_learnt(Learnt::new(name, values).unwrap());
        }
    }
    let (force, pressure, length) =
        (some_instrument(random), some_instrument(random), some_instrument(random));
    muscle.with_instruments(Instruments { force, pressure, length })
}

#[test]
fn writing_and_reading_changes_nothing() {
    for text in PRESETS.iter().map(|preset| preset.text).chain([FULL, PLEATED, BRAIDED]) {
        let muscle = from_toml(text, "m").unwrap();
        assert_eq!(from_toml(&to_toml(&muscle), "copy").unwrap(), muscle);
    }
    let mut random = Lcg(1);
    for _ in 0..3000 {
        let muscle = some_muscle(&mut random);
        let text = to_toml(&muscle);
        let back = from_toml(&text, "copy").unwrap_or_else(|error| panic!("{error}\n{text}"));
        assert_eq!(back, muscle, "{text}");
    }
}

#[test]
fn written_files_are_plain() {
    let muscle = from_toml(FULL, "m").unwrap();
    let text = to_toml(&muscle);
    for line in [
        "length = \"250 mm +- 0.2 mm\"",
        "braid_angle = \"25 deg\"",
        "fibre = { stiffness = \"12 kN\", section = \"0.3 mm^2\" }",
        "c10 = \"0.2 MPa\"",
        "c01 = \"0.05 MPa +- 0.005 MPa\"",
        "pressure = { noise = \"30 Pa\", zero = \"200 Pa\", gain = \"0.1 %\" }",
        "force = { noise = \"4 N\", zero = \"1 N\", gain = \"0.1 %\" }",
    ] {
        assert!(text.lines().any(|other| other == line), "no line {line:?} in\n{text}");
    }
}

#[test]
fn damaged_files_never_panic() {
    let mut random = Lcg(2);
    let pieces: Vec<&[u8]> = [
        "\"",
        "'",
        "=",
        "[",
        "]",
        "{",
        "}",
        "\n",
        "#",
        ".",
        ",",
        "-",
        "9",
        "e",
        "nan",
        "\u{b1}",
        "+-",
        "mm",
        "\\u0000",
        "\u{1f600}",
        "fibres",
        "[[",
        "\u{0}",
        " ",
        "\t",
        "\"\"\"",
    ]
    .iter()
    .map(|piece| piece.as_bytes())
    .collect();
    let sources: Vec<&str> =
        PRESETS.iter().map(|preset| preset.text).chain([FULL, PLEATED, BRAIDED]).collect();
    let (mut accepted, mut refused) = (0, 0);
    for round in 0..30_000 {
        let mut bytes = sources[round % sources.len()].as_bytes().to_vec();
        for _ in 0..=random.next(4) {
            if bytes.is_empty() {
                break;
            }
            let at = random.next(bytes.len());
            match random.next(4) {
                0 => bytes[at] = u8::try_from(random.next(256)).unwrap(),
                1 => drop(bytes.remove(at)),
                2 => drop(bytes.splice(at..at, pieces[random.next(pieces.len())].iter().copied())),
                _ => bytes.truncate(at.max(1)),
            }
        }
        match from_toml(&String::from_utf8_lossy(&bytes), "m.toml") {
            Ok(muscle) => {
                accepted += 1;
                assert_eq!(from_toml(&to_toml(&muscle), "copy").as_ref(), Ok(&muscle));
            }
            Err(error) => {
                refused += 1;
                let message = error.to_string();
                assert!(message.starts_with("m.toml:") && error.line().is_some(), "{message}");
                assert!(!error.instead().is_empty() && message.len() < 2500, "{message}");
            }
        }
    }
    assert!(accepted > 1000 && refused > 1000, "{accepted} accepted, {refused} refused");
}
