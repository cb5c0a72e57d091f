//! Wrong sweep files: each message states the place, the mistake, and the correction.

use super::*;

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

/// Wrong files, each with parts of the expected message: place, mistake, correction.
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
        ("x = 40 s".to_owned(), ["s.toml:1:", "not TOML", "put text in quotes: `x = \"40 s\"`"]),
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
        (line("1 %..20 %", "20 %..1 %"), ["s.toml:3:9", "must rise", "`20 %..1 %` doesn't"]),
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
        (format!("pressure = \"0 bar\"\n{BRAID}"), ["s.toml:1:12", "the pressure 0 bar", "1 bar"]),
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
    // 65536^4 = 2^64 points would wrap to 0.
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
